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
