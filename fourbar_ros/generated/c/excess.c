/* A number that rises above zero where the other coordinate takes over. */
static int excess_of(int phase, double position, double *to)
{
  double read[3], ratio;
  const int refused = reading(phase, &position, read);
  ratio = fabs(read[1]) * RATIO[phase];
  *to = (1e3 < ratio ? 1e3 : ratio) - LONGEST;
  return refused ? LIMIT : 0;
}

