/* Steps of given length as the node makes them, decision by decision those of the class Mover of
   fourbar_ros/dynamics/node_step.py; the formulas place, attempt and euler are written from its
   traces. The state is (p, u, s, v, z): coordinate and its rate, twist of the shaft, speed of the
   motor behind the gear, state of the source. A phase is a coordinate and an assembly mode. */
typedef struct {
  int phase, evaluations;
  double x[5], command;
} At;

enum { ROOM, OTHER, OTHER_RATIO, TO_BEND, ACCELERATION, ON_INPUT, OF_MOTOR, LINEAR,
       PLACE = LINEAR + 14 };

static int are_finite(const double *x)
{
  int i;
  for (i = 0; i < 5; ++i) if (!is_finite(x[i])) return 0;
  return 1;
}

static double larger(double a, double b)
{
  return b > a ? b : a;
}

static int place_of(const At *at, double *to)
{
  double given[6];
  memcpy(given, at->x, sizeof at->x);
  given[5] = at->command;
  return place(at->phase, given, to);
}

/* What is known of a state after another one; not 0: its coordinate is not regular there. */
static int is_beyond(const At *at, double *to)
{
  return place_of(at, to) || !(to[ROOM] >= -DEEPEST);
}

static int by_formula(int (*formula)(int, const double *, double *), const At *at, double h,
                      const double *known, double *to)
{
  double given[21];
  memcpy(given, at->x, sizeof at->x);
  given[5] = h;
  given[6] = at->command;
  memcpy(given + 7, known + LINEAR, 14 * sizeof *given);
  return formula(at->phase, given, to);
}

/* A step of RODAS from `at` to `next`, and the next length over this one, at least `least`; else
   it is to be made again, so much shorter. */
static int attempted(At *at, double h, double least, const double *known, At *next,
                     double *there, double *scale)
{
  double found[6];
  at->evaluations += OF_ATTEMPT;
  *next = *at;
  *scale = SMALLEST;
  if (by_formula(attempt, at, h, known, found)) return !HAS_LIMITS;
  *scale = found[5];
  memcpy(next->x, found, sizeof next->x);
  if (*scale >= least && is_beyond(next, there)) *scale = SHORTER;
  return 0;
}

/* The state after all the time left in one step, as the budget is used up. */
static int rest(At *at, double *left, double *known)
{
  At next = *at;
  double there[PLACE], scale = 0.0;
  if (at->evaluations + OF_ATTEMPT <= BUDGET
      && attempted(at, *left, LEAST, known, &next, there, &scale)) return 1;
  if (!(scale >= LEAST) || is_beyond(&next, there)) {
    at->evaluations += OF_EULER;
    if (by_formula(euler, at, *left, known, next.x)) return 1;
    if (is_beyond(&next, there)) return 0;
  }
  next.evaluations = at->evaluations;
  *at = next;
  memcpy(known, there, sizeof there);
  *left = 0.0;
  return 0;
}

/* Move on in one coordinate until no time is left or another one takes over; `known`: of the
   state, first and last. Not good: the error is above the tolerance, and if time is left, this
   coordinate cannot finish the step. */
static int part_of_step(At *at, double *left, double *known, int *is_good)
{
  const double latest = LATE * *left;
  double h = *left;
  *is_good = 1;
  while (*left > 0.0) {                 /* as often as the budget allows */
    Pieces pieces;
    At next;
    double there[PLACE], longest, scale;
    at->evaluations += OF_PLACE;
    if (pieces_at(at->phase, at->x[0], &pieces)) return 1;
    for (;;) {
      longest = *left < h ? *left : h;
      h = larger(known[TO_BEND], latest);
      h = h < longest ? h : longest;
      if (TABLES) h = h * to_table(at->phase, &pieces, h * at->x[1],
                                   0.5 * h * h * known[LINEAR + 1]);
      if (at->evaluations + OF_ATTEMPT + (*left > h ? OF_PLACE + OF_ATTEMPT : 0) > BUDGET) {
        *is_good = 0;
        return rest(at, left, known);
      }
      if (attempted(at, h, 1.0, known, &next, there, &scale)) return 1;
      if (scale >= 1.0) break;
      h *= scale;
    }
    next.evaluations = at->evaluations;
    *at = next;
    memcpy(known, there, sizeof there);
    *left -= h;
    h = larger(h * scale, longest);
    if (*left > 0.0 && known[ROOM] < 0.0) return 0;
  }
  return 0;
}

/* The same state in the coordinate that takes over. */
static int handed_over(At *at, double *known)
{
  at->phase = NEXT[at->phase][known[OTHER_RATIO] > 0.0];
  at->x[0] = IS_INPUT[at->phase] ? continuous(known[OTHER]) : known[OTHER];
  at->x[1] = known[OTHER_RATIO] * at->x[1];
  return place_of(at, known);
}

static int stepped(At *at, double left, double *known, int *is_good)
{
  *is_good = 1;
  if (place_of(at, known)) return 1;
  if (PASSES && IS_INPUT[at->phase] && known[ROOM] < 0.0 && handed_over(at, known)) return 1;
  for (;;) {                            /* as often as the budget allows */
    int is_part_good;
    if (part_of_step(at, &left, known, &is_part_good)) return 1;
    if (left > 0.0 && !(PASSES && (*is_good || is_part_good))) return 1;
    *is_good = *is_good && is_part_good;
    if (!(left > 0.0)) break;
    if (handed_over(at, known)) return 1;
  }
  if (!IS_INPUT[at->phase] && are_finite(at->x)) {
    At in_input = *at;
    double there[PLACE];
    memcpy(there, known, sizeof there);
    if (!handed_over(&in_input, there) && there[ROOM] >= 0.0) {
      *at = in_input;
      memcpy(known, there, sizeof there);
    }
  }
  return 0;
}
