// --- held
typedef struct {
  Moving it;
} Place;

/* Where a state of the input is. */
static void place_at(Place *at, double mode)
{
  (void)mode;
  at->it.phase = 0;
}

static int state_of_input(const Place *at, double *to)
{
  memcpy(to, at->it.state, sizeof at->it.state);
  return 0;
}

static int move(Place *at, double left, int *is_good)
{
  return part_of_step(&at->it, &left, is_good);
}

// --- toggles
/* Steps through toggles: fourbar_ros.dynamics.node_step. Near one another coordinate than the
   input tells where it is; phases 0 and 1 are the input in its two modes. */
typedef struct {
  Moving it;
  double mode, rising, turns;       /* rising: the mode in which the input grows with p */
} Place;

static void place_at(Place *at, double mode)
{
  at->it.phase = mode == MODES[1] ? 1 : mode == MODES[0] ? 0 : OWN_PHASE;
  at->mode = at->rising = MODES[at->it.phase];
  at->turns = 0.0;
}

static double partner(double mode)
{
  return MODES[mode == MODES[0]];
}

/* The input and its derivatives by the coordinate. */
static int input_of(const Place *at, double *to)
{
  const double position = at->it.state[0];
  int refused;
  if (IS_INPUT[at->it.phase]) {
    to[0] = position;
    to[1] = 1.0;
    return 0;
  }
  refused = input_from(at->it.phase, &position, to);
  to[0] = continuous(to[0]);
  return refused;
}

static int state_of_input(const Place *at, double *to)
{
  double found[3];
  const int refused = input_of(at, found);
  memcpy(to, at->it.state, sizeof at->it.state);
  if (!IS_INPUT[at->it.phase]) {
    to[0] = found[0] + at->turns;
    to[1] = found[1] * at->it.state[1];
  }
  return refused;
}

/* Whether input, rate and mode tell a place. */
static int tells_all(const Place *at)
{
  double excess;
  return IS_INPUT[at->it.phase] && !excess_of(at->it.phase, at->it.state[0], &excess)
         && excess <= 0.0;
}

static int to_input(Place *at)
{
  double found[3], state[5];
  const int refused = input_of(at, found) | state_of_input(at, state);
  const double mode = found[1] > 0.0 ? at->rising : partner(at->rising);
  memcpy(at->it.state, state, sizeof state);
  place_at(at, mode);
  at->it.known[0] = NAN;
  return refused ? LIMIT : 0;
}

/* Of the two phases of another coordinate that whose pose is the nearest. */
static int nearest_phase(const double *pose, double position)
{
  double least = HUGE_VAL, other[POSE];
  int i, phase, found = 2;
  for (phase = 2; phase < PHASES; ++phase) {
    double far = 0.0;
    if (pose_of(phase, &position, other)) continue;
    for (i = 0; i < POSE; ++i) far += power(pose[i] - other[i], 2.0);
    if (far < least) {
      least = far;
      found = phase;
    }
  }
  return found;
}

/* Go on in the coordinate that takes over. */
static int to_other(Place *at)
{
  const double q = at->it.state[0];
  double read[3], pose[POSE];
  if (!IS_INPUT[at->it.phase]) return to_input(at);
  at->turns = TURN * rint((q - continuous(q)) / TURN);
  if (reading(at->it.phase, &q, read) | pose_of(at->it.phase, &q, pose)) return LIMIT;
  at->it.phase = nearest_phase(pose, read[0]);
  at->it.state[0] = read[0];
  at->it.state[1] = read[1] * at->it.state[1];
  at->it.known[0] = NAN;
  if (input_of(at, read)) return LIMIT;
  at->rising = read[1] > 0.0 ? at->mode : partner(at->mode);
  return 0;
}

static int move(Place *at, double left, int *is_good)
{
  int refused = tells_all(at) || !IS_INPUT[at->it.phase] ? 0 : to_other(at), spent = 0;
  *is_good = 1;
  while (!refused) {                    /* as often as the budget allows */
    Place in_input;
    int is_part_good;
    refused = part_of_step(&at->it, &left, &is_part_good);
    if (refused) break;
    spent = at->it.evaluations;
    if (!(left > 0.0)) {
      *is_good = *is_good && is_part_good;
      if (IS_INPUT[at->it.phase]) return 0;
      in_input = *at;
      refused = to_input(&in_input);
      if (refused) break;
      if (tells_all(&in_input)) *at = in_input;
      else at->mode = in_input.mode;
      return 0;
    }
    if (!*is_good && !is_part_good) {
      refused = LIMIT;
      break;
    }
    *is_good = *is_good && is_part_good;
    refused = to_other(at);
  }
  at->it.evaluations = spent;
  return refused;
}

// --- no_toggles
/* The input tells all: no other coordinate takes over. */
static int excess_of(int phase, double position, double *to)
{
  (void)phase; (void)position;
  *to = -1.0;
  return 0;
}

// --- excess
/* A number that rises above zero where the other coordinate takes over. */
static int excess_of(int phase, double position, double *to)
{
  double read[3], ratio;
  const int refused = reading(phase, &position, read);
  ratio = fabs(read[1]) * RATIO[phase];
  *to = (1e3 < ratio ? 1e3 : ratio) - LONGEST;
  return refused ? LIMIT : 0;
}

// --- take_place
  if (from->place[0] > 0.0) {
    at->it.phase = (int)from->place[0] - 1;
    memcpy(state, from->place + 1, sizeof at->it.state);
    at->mode = from->mode;
    at->rising = from->place[6];
    at->turns = from->place[7];
  } else {
    at->it.known[0] = NAN;
  }
// --- give_place
  to->mode = at->mode;
  to->place[0] = 1.0 + it->phase;
  memcpy(to->place + 1, it->state, sizeof it->state);
  to->place[6] = at->rising;
  to->place[7] = at->turns;
