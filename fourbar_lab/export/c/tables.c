// --- no_tables
typedef int Pieces;

static int pieces_at(int phase, double position, Pieces *to)
{
  (void)phase; (void)position; *to = 0;
  return 0;
}

static double to_table(int phase, const Pieces *it, double gain, double bend)
{
  (void)phase; (void)it; (void)gain; (void)bend;
  return 1.0;
}
// --- tables
/* The pieces of all force tables at a position, and their ends. */
typedef struct {
  double position, start[TABLES], low[TABLES], high[TABLES], unit[TABLES];
} Pieces;

static int pieces_at(int phase, double position, Pieces *to)
{
  int i;
  if (places_of(phase, &position, to->start)) return 1;
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

/* Whether a position is beyond the pieces, or out of reach. */
static int is_beyond_pieces(int phase, const Pieces *it, double there)
{
  double places[TABLES], most = fabs(there - it->position) - REACHES[phase];
  int i;
  if (places_of(phase, &there, places)) return 1;
  for (i = 0; i < TABLES; ++i) {
    double place = places[i], below, above;
    if (IS_ANGLE[i]) place = it->start[i] + remainder(place - it->start[i], WHOLE_TURN);
    below = (it->low[i] - place) / it->unit[i];
    above = (place - it->high[i]) / it->unit[i];
    if (below > most) most = below;
    if (above > most) most = above;
  }
  return most > AT_PLACE;
}

/* The part of a step after which a table comes to its next piece; 1: it comes to none. */
static double to_table(int phase, const Pieces *it, double gain, double bend)
{
  double low = 0.0, high = 1.0;
  int i;
  if (!is_beyond_pieces(phase, it, it->position + (gain + bend))) return 1.0;
  for (i = 0; i < HALVINGS; ++i) {
    const double middle = 0.5 * (low + high);
    if (is_beyond_pieces(phase, it, it->position + middle * (gain + middle * bend)))
      high = middle;
    else low = middle;
    if (high - low <= LEAST_PART * high) break;
  }
  return high < 1.0 - LEAST_PART ? high : 1.0;
}
