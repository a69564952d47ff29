/* A law of the torque source next to a speed w with its state z, and where it ends:
   T = piece[0] + piece[1] w + piece[2] z, dz/dt = piece[3] + piece[4] w + piece[5] z. */
typedef struct {
  double piece[6];
  double edge[2];              /* z = edge[0] + edge[1] w while it slides along its limit */
  int slides, kind;            /* kind 0: it never ends */
  double side;                 /* of the limit */
  double wanted;               /* the speed that a controller wants */
} Regime;

// --- law
/* A source with one law. */
static Regime regime_at(double speed, double own, double slope, double near, double command)
{
  Regime found = {{0.0, 0.0, 0.0, 0.0, 0.0, 0.0}, {0.0, 0.0}, 0, 0, 0.0, 0.0};
  (void)own; (void)slope; (void)near;
  law(speed, command, found.piece);
  return found;
}

static double to_kink(const Regime *regime, double speed, double own, double slope,
                      double speed_after, double own_after, double h)
{
  (void)regime; (void)speed; (void)own; (void)slope; (void)speed_after; (void)own_after; (void)h;
  return 1.0;
}
// --- controller
/* The speed controller (D5) of fourbar_ros.dynamics.model.drives: its regimes and where they end.
   Between its limits, beyond one without and with integration, and sliding along it. */
enum { INNER = 1, HELD, BACK, ALONG };

/* The torque that it would give without limits. */
static double wanted_torque(double wanted, double speed, double own)
{
  return KP * wanted + -KP * speed + KI * own;
}

static Regime beyond(int kind, double side, double wanted)
{
  Regime found = {{0.0, 0.0, 0.0, 0.0, 0.0, 0.0}, {0.0, 0.0}, 0, 0, 0.0, 0.0};
  const int integrates = (kind == INNER || kind == BACK) && KI > 0.0;
  found.kind = kind;
  found.side = side;
  found.wanted = wanted;
  found.piece[0] = kind == INNER ? KP * wanted : side * TORQUE_LIMIT;
  if (kind == INNER) {
    found.piece[1] = -KP;
    found.piece[2] = KI;
  }
  if (integrates) {
    found.piece[3] = wanted;
    found.piece[4] = -1.0;
  }
  if (kind == ALONG) {
    found.slides = 1;
    found.edge[0] = (side * TORQUE_LIMIT - KP * wanted) / KI;
    found.edge[1] = KP / KI;
  }
  return found;
}

/* Which regime holds; a slope that is NaN: by speed and state alone. `near`: error of the speed,
   within which a limit counts as reached. */
static Regime regime_at(double speed, double own, double slope, double near, double wanted)
{
  const double torque = wanted_torque(wanted, speed, own), side = torque > 0.0 ? 1.0 : -1.0;
  const double over = side * torque - TORQUE_LIMIT, outward = side * slope;
  const double size = fabs(wanted) + fabs(speed);
  const double by_error = KP * near, most = NEAR * TORQUE_LIMIT;
  const double at_limit = (most < by_error ? most : by_error) + NEAREST * TORQUE_LIMIT
                          + EIGHT_EPS * KP * size;
  double error = side * (wanted - speed);
  int outside;
  if (fabs(error) <= NEAREST * size && !(slope != slope)) error = -outward;
  outside = error > 0.0 ? HELD : BACK;
  if (fabs(over) <= at_limit && !(slope != slope)) {
    const double grows = KI * error, falls = KP * outward;
    if (grows - falls <= NEAREST * (fabs(grows) + fabs(falls))) return beyond(INNER, side, wanted);
    if ((falls >= 0.0 || grows <= falls) && KI > 0.0) return beyond(ALONG, side, wanted);
    return beyond(outside, side, wanted);
  }
  return beyond(over <= 0.0 ? INNER : outside, side, wanted);
}

/* Numbers of which one falls below zero where the regime ends. */
static void margins_of(const Regime *regime, double speed, double own, double slope, double *to)
{
  const double wanted = regime->wanted, side = regime->side;
  const double torque = wanted_torque(wanted, speed, own);
  const double unit = (KI > KP ? KI : KP) / TORQUE_LIMIT;
  if (regime->kind == INNER) {
    to[0] = 1.0 - torque / TORQUE_LIMIT;
    to[1] = 1.0 + torque / TORQUE_LIMIT;
  } else if (regime->kind == ALONG) {
    const double falls = side * KP * slope;
    to[0] = (side * KI * (wanted - speed) - falls) / TORQUE_LIMIT;
    to[1] = KP > 0.0 ? falls / TORQUE_LIMIT : 0.0;
  } else {
    to[0] = side * torque / TORQUE_LIMIT - 1.0;
    to[1] = side * unit * (regime->kind == HELD ? wanted - speed : speed - wanted);
  }
}

static int ends_before(const Regime *regime, double part, const double *speeds,
                       const double *owns, const double *least, double h)
{
  const double gain = speeds[1], bend = speeds[2];
  const double there = speeds[0] + part * (gain + part * bend);
  const double own = regime->slides ? regime->edge[0] + regime->edge[1] * there
                                    : owns[0] + part * (owns[1] - owns[0]);
  double found[2];
  margins_of(regime, there, own, (gain + 2.0 * part * bend) / h, found);
  return found[0] < least[0] - NEAREST || found[1] < least[1] - NEAREST;
}

/* The part of a step after which another regime begins; 1: none does. The speed is taken as
   quadratic, `slope` its derivative at the start, the state as linear. */
static double to_kink(const Regime *regime, double speed, double own, double slope,
                      double speed_after, double own_after, double h)
{
  const double gain = h * slope;
  const double speeds[] = {speed, gain, speed_after - speed - gain}, owns[] = {own, own_after};
  double least[2], low = 0.0, high = 1.0;
  int i;
  margins_of(regime, speed, own, gain / h, least);
  for (i = 0; i < 2; ++i) if (!(least[i] < 0.0)) least[i] = 0.0;
  if (!ends_before(regime, 1.0, speeds, owns, least, h)) return 1.0;
  for (i = 0; i < BISECTIONS; ++i) {
    const double part = 0.5 * (low + high);
    if (ends_before(regime, part, speeds, owns, least, h)) high = part;
    else low = part;
  }
  if (!(high < 1.0 - SHORTEST)) return 1.0;
  return SHORTEST > high ? SHORTEST : high;
}
// --- no_tables
typedef int Pieces;

static int pieces_at(int phase, double position, Pieces *to)
{
  (void)phase; (void)position; *to = 0;
  return 0;
}

static int to_place(int phase, const Pieces *it, double gain, double bend, double *part)
{
  (void)phase; (void)it; (void)gain; (void)bend; (void)part;
  return 0;
}
// --- tables
/* The pieces of all force tables at a position, and their ends. */
typedef struct {
  double position, start[TABLES], low[TABLES], high[TABLES], unit[TABLES];
} Pieces;

static int pieces_at(int phase, double position, Pieces *to)
{
  int i;
  if (places_of(phase, &position, to->start)) return LIMIT;
  to->position = position;
  for (i = 0; i < TABLES; ++i) {
    const double place = to->start[i], base = base_of(i, place), shift = place - base;
    const int next = piece_at(base, ENDS[i], COUNTS[i]);
    to->low[i] = ENDS[i][next - 1] + shift;
    to->high[i] = ENDS[i][next] + shift;
    to->unit[i] = 1.0 + fabs(place);
  }
  return 0;
}

/* How far a position is beyond the pieces; negative within all. */
static int excess_at(int phase, const Pieces *it, double there, double *most)
{
  double places[TABLES];
  int i;
  if (places_of(phase, &there, places)) return LIMIT;
  *most = fabs(there - it->position) - REACHES[phase];
  for (i = 0; i < TABLES; ++i) {
    double place = places[i], below, above;
    if (IS_ANGLE[i]) place = it->start[i] + remainder(place - it->start[i], WHOLE_TURN);
    below = (it->low[i] - place) / it->unit[i];
    above = (place - it->high[i]) / it->unit[i];
    if (below > *most) *most = below;
    if (above > *most) *most = above;
  }
  return 0;
}

/* The part of a step after which a table comes to its next piece; 1: it comes to none. */
static int to_place(int phase, const Pieces *it, double gain, double bend, double *part)
{
  double low = 0.0, high = 1.0, most = 0.0;
  int refused = excess_at(phase, it, it->position + (gain + bend), &most), i;
  *part = 1.0;
  if (refused || !(most > AT_PLACE)) return refused;
  for (i = 0; i < HALVINGS; ++i) {
    const double middle = 0.5 * (low + high);
    refused = excess_at(phase, it, it->position + middle * (gain + middle * bend), &most);
    if (refused) return refused;
    if (most > AT_PLACE) high = middle;
    else low = middle;
    if (high - low <= LEAST_PART * high) break;
  }
  *part = high < 1.0 - LEAST_PART ? high : 1.0;
  return 0;
}
