static void take(Place *at, const NAME_drive *from, double torque)
{
  const double own = OWN_FIELD;
  double *state = at->it.state;
  state[0] = from->position;
  state[1] = from->velocity;
  state[2] = !HAS_SHAFT || from->twist != from->twist ? 0.0 : from->twist;
  state[3] = HAS_SHAFT ? from->motor_velocity : 0.0;
  state[4] = own != own ? 0.0 : own;
  at->it.torque = torque;
  at->it.evaluations = 0;
  memcpy(at->it.known, from->known, sizeof at->it.known);
  place_at(at, MODE_FIELD);
  TAKE_PLACE
}

/* All fields of a state but `step`. */
static void give(Place *at, NAME_drive *to, double evaluations)
{
  Moving *it = &at->it;
  const double own = it->state[4];
  double piece[6] = {0.0}, speed, given[18], change[5], state[5];
  double on_input = NAN, of_motor = NAN, slope = NAN;
  int refused = law_at(it, piece) | speed_of(it, it->state, &speed) | terms_at(it, it->state[0]);
  pack(it->known + 1, it->state, piece, given);
  refused |= derivative(given, change);
  if (!refused) {
    (void)torque_on_input(given, &on_input);
    of_motor = piece[0] + piece[1] * speed + piece[2] * own;
    slope = slope_of(it, it->known + 1, it->state, change);
  }
  if (state_of_input(at, state)) state[0] = state[1] = NAN;
  to->position = state[0];
  to->velocity = state[1];
  to->acceleration = slope;
  to->twist = HAS_SHAFT ? state[2] : NAN;
  to->motor_position = HAS_SHAFT ? state[0] + state[2] : state[0];
  to->motor_velocity = HAS_SHAFT ? state[3] : state[1];
  to->motor_torque = of_motor;
  to->torque = on_input;
  to->current = to->speed_error_integral = NAN;
  GIVE_OWN
  to->command = TAKES_TORQUE ? it->torque : NAN;
  to->evaluations = evaluations;
  memcpy(to->known, it->known, sizeof to->known);
  GIVE_PLACE
}

void NAME_complete(NAME_drive *drive ARGUMENT)
{
  Place at;
  drive->known[0] = NAN;
  FORGET_PLACE
  take(&at, drive, GIVEN_TORQUE);
  give(&at, drive, drive->evaluations);
}

void NAME_start(NAME_drive *drive ARGUMENT)
{
  memset(drive, 0, sizeof *drive);
STARTS
  NAME_complete(drive PASSED);
}

static int are_finite(const double *state)
{
  int i;
  for (i = 0; i < 5; ++i) if (!is_finite(state[i])) return 0;
  return 1;
}

NAME_drive_status NAME_advance(NAME_drive *drive, double step ARGUMENT)
{
  Place at, before;
  NAME_drive_status status = NAME_drive_not_finite;
  double state[5];
  int refused = DIVISION, is_good = 0, is_number, i;
  take(&at, drive, GIVEN_TORQUE);
  before = at;
  if (step > 0.0 && is_finite(step) && are_finite(at.it.state))
    refused = move(&at, step, &is_good);
  is_number = are_finite(at.it.state);
  if (HAS_LIMITS && ((refused & LIMIT) != 0 || (!refused && is_number && (
        state_of_input(&at, state) || is_at_end(state[0])))))
    status = NAME_drive_at_limit;
  else if (!refused && is_number)
    status = is_good ? NAME_drive_ok : NAME_drive_out_of_budget;
  if (status == NAME_drive_at_limit || status == NAME_drive_not_finite) {
    const int evaluations = at.it.evaluations;
    at = before;                     /* at rest, nothing twisted, nothing summed up */
    for (i = 1; i < 5; ++i) at.it.state[i] = 0.0;
    at.it.evaluations = evaluations;
  }
  drive->step = step;
  give(&at, drive, (double)at.it.evaluations);
  return status;
}
