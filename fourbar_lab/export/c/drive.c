/* Whether the input is at an end of its stroke, or at a toggle it cannot pass. */
static int is_at_end(const At *at, const double *known)
{
  const double q = IS_INPUT[at->phase] ? at->x[0] : continuous(known[OTHER]);
  return q <= LOW || q >= HIGH || (!PASSES && known[ROOM] <= 0.0);
}

static void take(At *at, const NAME_drive *from, double command)
{
  const double own = OWN_FIELD, mode = MODE_FIELD;
  int i;
  at->x[0] = from->position;
  at->x[1] = from->velocity;
  at->x[2] = !HAS_SHAFT || from->twist != from->twist ? 0.0 : from->twist;
  at->x[3] = HAS_SHAFT ? from->motor_velocity : 0.0;
  at->x[4] = own != own ? 0.0 : own;
  at->command = command;
  at->evaluations = at->phase = 0;
  for (i = 0; i < PHASES; ++i) if (IS_INPUT[i] && MODES[i] == mode) at->phase = i;
  TAKE_PLACE
}

/* All fields of a state but `step`; `known`: of that state, unless that is to be computed. */
static void give(const At *at, NAME_drive *to, double *known, int is_known)
{
  double own = at->x[4], q = at->x[0], w = at->x[1];
  const int is_input = IS_INPUT[at->phase];
  if (!is_known) is_known = !place_of(at, known);
  if (!is_input) {
    q = is_known ? continuous(known[OTHER]) : NAN;
    w = is_known ? known[OTHER_RATIO] * w : NAN;
  }
  to->position = q;
  to->velocity = w;
  to->acceleration = is_known ? known[ACCELERATION] : NAN;
  to->twist = HAS_SHAFT ? at->x[2] : NAN;
  to->motor_position = HAS_SHAFT ? q + at->x[2] : q;
  to->motor_velocity = HAS_SHAFT ? at->x[3] : w;
  to->motor_torque = is_known ? known[OF_MOTOR] : NAN;
  to->torque = is_known ? known[ON_INPUT] : NAN;
  to->current = to->speed_error_integral = NAN;
  GIVE_OWN
  to->command = TAKES_TORQUE ? at->command : NAN;
  to->evaluations = at->evaluations;
  GIVE_PLACE
  (void)own;
}

void NAME_complete(NAME_drive *drive ARGUMENT)
{
  At at;
  double known[PLACE];
  FORGET_PLACE
  take(&at, drive, GIVEN_COMMAND);
  at.evaluations = (int)drive->evaluations;
  give(&at, drive, known, 0);
}

void NAME_start(NAME_drive *drive ARGUMENT)
{
  memset(drive, 0, sizeof *drive);
STARTS
  NAME_complete(drive PASSED);
}

NAME_drive_status NAME_advance(NAME_drive *drive, double step ARGUMENT)
{
  At at, held;
  NAME_drive_status status = NAME_drive_not_finite;
  double known[PLACE];
  int is_good, is_held;
  take(&at, drive, GIVEN_COMMAND);
  held = at;                           /* at rest, nothing twisted, nothing summed up */
  memset(held.x + 1, 0, 4 * sizeof *held.x);
  if (step > 0.0 && is_finite(step) && are_finite(at.x)) {
    if (stepped(&at, step, known, &is_good))
      status = HAS_LIMITS ? NAME_drive_at_limit : NAME_drive_not_finite;
    else if (are_finite(at.x))
      status = HAS_LIMITS && is_at_end(&at, known) ? NAME_drive_at_limit
               : is_good ? NAME_drive_ok : NAME_drive_out_of_budget;
  }
  is_held = status == NAME_drive_at_limit || status == NAME_drive_not_finite;
  if (is_held) {
    held.evaluations = at.evaluations;
    at = held;
  }
  drive->step = step;
  give(&at, drive, known, !is_held);
  return status;
}
// --- header
/* Motion by torque. Whatever its length, a step takes at most BUDGET evaluations of the
   equation of motion; the node makes steps of STEP s. */
typedef enum {
STATUS
} NAME_drive_status;

STRUCT
/* The state at the start of the scene GIVEN. */
void NAME_start(NAME_drive *drive ARGUMENT);
/* Acceleration and torques of a state that was set: position, velocity, twist,
   motor_velocity, current, speed_error_integral AND_MODE. */
void NAME_complete(NAME_drive *drive ARGUMENT);
/* Move on by a step [s] GIVEN. At a limit, and where
   numbers overflow, it is held at rest. */
NAME_drive_status NAME_advance(NAME_drive *drive, double step ARGUMENT);

// --- self_check
  {
    static const double drive_of_python[] = {EXPECTED};
    NAME_drive drive;
    int i;
    NAME_start(&drive PASSED);
    for (i = 0; i < COUNT; ++i) (void)NAME_advance(&drive, STEP PASSED);
    differ += differing(&drive, drive_of_python, NUMBERS);
  }
