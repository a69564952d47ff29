/* A force over a place, of cubic pieces: fourbar_ros.dynamics.model.force_table. */
static double cubic(const double *piece, double place)
{
  const double t = place - piece[4];
  return ((piece[0] * t + piece[1]) * t + piece[2]) * t + piece[3];
}

/* How many of some places, in order, are not above one: at most as many halvings as they have
   binary digits. */
static int piece_at(double place, const double *places, int count)
{
  int low = 0, high = count;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (place < places[middle]) high = middle;
    else low = middle + 1;
  }
  return low;
}

