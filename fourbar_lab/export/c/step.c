/* A step of given length as the node makes it (fourbar_ros/dynamics/node_step.py), operation by operation.
   The state is (p, u, s, v, z): coordinate and its rate, twist of the shaft, speed of the motor
   behind the gear, state of the source. A phase is a coordinate and an assembly mode: the input,
   or next to a toggle the coordinate that goes on there. */
typedef struct {
  int phase, evaluations;
  double state[5], torque;
  double known[8];             /* the last position, and there J, J'/2, Q, D, of couples, r, r' */
} Moving;

/* The terms of the equation of motion, which the step before may have asked for. */
static int terms_at(Moving *it, double position)
{
  int refused;
  if (position == it->known[0] && it->known[1] > 0.0) return 0;
  refused = terms_of(it->phase, &position, it->known + 1);
  it->known[0] = refused ? NAN : position;
  return refused ? LIMIT : 0;
}

/* The speed of the motor behind the gear. */
static int speed_of(Moving *it, const double *state, double *to)
{
  const int is_own = HAS_SHAFT || IS_INPUT[it->phase];
  const int refused = is_own ? 0 : terms_at(it, state[0]);
  *to = is_own ? state[HAS_SHAFT ? 3 : 1] : it->known[6] * state[1];
  return refused;
}

/* The acceleration of the input, (T3). */
static double slope_of(const Moving *it, const double *terms, const double *state,
                       const double *change)
{
  return IS_INPUT[it->phase] ? change[1]
         : terms[5] * change[1] + terms[6] * state[1] * state[1];
}

/* (terms, state, piece) as formulas of the step take them. */
static void pack(const double *terms, const double *state, const double *piece, double *to)
{
  memcpy(to, terms, 7 * sizeof *to);
  memcpy(to + 7, state, 5 * sizeof *to);
  memcpy(to + 12, piece, 6 * sizeof *to);
}

static int change_of(const double *terms, const double *state, const double *piece, double *to)
{
  double given[18];
  pack(terms, state, piece, given);
  return derivative(given, to);
}

/* The law of the source next to the state: torque and the change of its state, linear in both. */
static int law_at(Moving *it, double *piece)
{
  double given[3];
  const int refused = speed_of(it, it->state, given);
  given[1] = it->state[4];
  given[2] = it->torque;
  return refused ? refused : piece_of(given, piece);
}

/* The part of a step after which another piece of the law of the source holds; 1: none does. The
   speed is taken as quadratic, `gain` its derivative times the length, the own state as linear. */
static int to_change(Moving *it, const double *piece, const double *next, double gain,
                     double *part)
{
  double given[3], found[6], speed, after, low = 0.0, high = 1.0, bend;
  int i, refused = speed_of(it, it->state, &speed);
  if (!refused) refused = speed_of(it, next, &after);
  if (refused) return refused;
  given[0] = after;
  given[1] = next[4];
  given[2] = it->torque;
  (void)piece_of(given, found);
  *part = 1.0;
  if (IS_SMOOTH || memcmp(found, piece, sizeof found) == 0) return 0;
  bend = after - speed - gain;
  for (i = 0; i < HALVINGS; ++i) {
    const double middle = 0.5 * (low + high);
    given[0] = speed + middle * (gain + middle * bend);
    given[1] = it->state[4] + middle * (next[4] - it->state[4]);
    (void)piece_of(given, found);
    if (memcmp(found, piece, sizeof found) != 0) high = middle;
    else low = middle;
    if (high - low <= LEAST_PART * high) break;
  }
  if (high < 1.0 - LEAST_PART) *part = high > LATE ? high : LATE;
  return 0;
}

/* Terms, dx/dt and, as a difference, the acceleration by the coordinate. */
static int linear(Moving *it, const double *piece, double *terms, double *change,
                  double *by_position)
{
  const double position = it->state[0];
  double aside = position + DIFFERENCE[it->phase], terms_aside[7], other[5];
  int refused;
  if (TABLES && it->state[1] < 0.0) aside = position - DIFFERENCE[it->phase];
  it->evaluations += 2;
  refused = terms_at(it, position);
  memcpy(terms, it->known + 1, 7 * sizeof *terms);
  if (!refused) refused = change_of(terms, it->state, piece, change);
  if (refused) return refused;
  if (terms_of(it->phase, &aside, terms_aside)) {                   /* next to the upper limit */
    aside = position - DIFFERENCE[it->phase];
    if (terms_of(it->phase, &aside, terms_aside)) return LIMIT;
  }
  refused = change_of(terms_aside, it->state, piece, other);
  if (aside - position == 0.0) refused |= DIVISION;
  *by_position = (other[1] - change[1]) / (aside - position);
  return refused;
}

/* Whether a state is where the coordinate of the phase can tell it. */
static int is_here(const Moving *it, const double *state)
{
  double excess;
  return !excess_of(it->phase, state[0], &excess) && excess <= DEEPEST;
}

static double larger(double a, double b)
{
  return b > a ? b : a;
}

/* The state after a time h, and the factor by which the next may be longer. */
static int attempt(Moving *it, double h, const double *piece, const double *terms,
                   double by_position, double *next, double *scale)
{
  double given[21], found[9], error, longer;
  int refused;
  memcpy(given, it->state, 5 * sizeof *given);
  given[5] = h;
  memcpy(given + 6, terms, 7 * sizeof *given);
  given[13] = by_position;
  memcpy(given + 14, piece, 6 * sizeof *given);
  given[20] = it->torque;
  it->evaluations += STAGES;
  *scale = SMALLEST;
  refused = rosenbrock(it->phase, given, found);
  if (PASSES && (refused & LIMIT) != 0) {
    memcpy(next, it->state, 5 * sizeof *next);                      /* a shorter step is inside */
    return 0;
  }
  if (refused) return refused;
  memcpy(next, found, 5 * sizeof *next);
  error = larger(larger(larger(fabs(found[5]), fabs(found[7])), h * fabs(found[6])),
                 h * fabs(found[8])) / TOLERANCE[it->phase];
  if (!is_finite(error)) return 0;
  if (PASSES && error <= 1.0 && !is_here(it, next)) {
    *scale = SHORTER;
    return 0;
  }
  longer = SAFETY * power(larger(error, 1e-10), -0.25);
  longer = larger(SMALLEST, longer);
  *scale = longer < LARGEST ? longer : LARGEST;
  return 0;
}

/* The state after all that is left, at one go: the budget allows no more. */
static int rest(Moving *it, double *left, const double *piece, const double *terms,
                const double *change, double by_position)
{
  double given[25], next[5], scale;
  int refused, i;
  if (it->evaluations + STAGES <= BUDGET) {
    refused = attempt(it, *left, piece, terms, by_position, next, &scale);
    if (refused) return refused;
    if (scale > SMALLEST && (!PASSES || is_here(it, next))) {
      memcpy(it->state, next, sizeof next);
      *left = 0.0;
      return 0;
    }
  }
  pack(terms, it->state, piece, given);
  given[18] = by_position;
  given[19] = 1.0 / *left;
  memcpy(given + 20, change, 5 * sizeof *given);
  refused = implicit_euler(given, next);
  for (i = 0; i < 5; ++i) next[i] = it->state[i] + next[i];
  if (refused || (PASSES && !is_here(it, next))) return refused;
  memcpy(it->state, next, sizeof next);
  *left = 0.0;
  return 0;
}

/* Move on in one coordinate, until no time is left or another one takes over; not good: the error
   is above the tolerance, and if time is left, this coordinate cannot finish the step. */
static int part_of_step(Moving *it, double *left, int *is_good)
{
  const double closest = PASSES ? CLOSEST * *left : 0.0, shortest = LATE * *left;
  double h = *left, longest = 0.0;
  *is_good = 1;
  while (*left > 0.0) {                 /* as often as the budget allows */
    Pieces pieces;
    double piece[6], terms[7], change[5], next[5], by_position, scale, ahead = 1.0, excess = 0.0;
    int refused = law_at(it, piece);
    if (!refused) refused = linear(it, piece, terms, change, &by_position);
    if (!refused) refused = pieces_at(it->phase, it->state[0], &pieces);
    if (refused) return refused;
    for (;;) {
      h = *left < h ? *left : h;
      if (TABLES) {
        longest = h;
        refused = to_place(it->phase, &pieces, h * it->state[1], 0.0, &ahead);
        if (refused) return refused;
        h = h * ahead;
      }
      if (it->evaluations + STAGES + (*left > h ? 2 + STAGES : 0) > BUDGET) {
        *is_good = 0;
        return rest(it, left, piece, terms, change, by_position);
      }
      refused = attempt(it, h, piece, terms, by_position, next, &scale);
      if (refused) return refused;
      if (scale >= 1.0) {
        double part = 1.0;
        if (h > shortest)
          refused = to_change(it, piece, next, h * (HAS_SHAFT ? change[3] : slope_of(
                                  it, terms, it->state, change)), &part);
        if (refused) return refused;
        if (TABLES) {
          const double gain = h * it->state[1];
          refused = to_place(it->phase, &pieces, gain, next[0] - it->state[0] - gain, &ahead);
          if (refused) return refused;
          part = ahead < part ? ahead : part;
        }
        if (part >= 1.0 || h <= closest) break;
        scale = larger(part, closest / h);
      }
      h *= scale;
    }
    memcpy(it->state, next, sizeof next);
    *left -= h;
    h = larger(h * scale, longest);
    if (PASSES && *left > 0.0) {
      refused = excess_of(it->phase, it->state[0], &excess);
      if (refused || excess > 0.0) return refused;
    }
  }
  return 0;
}

