/* The input tells all: no other coordinate takes over. */
static int excess_of(int phase, double position, double *to)
{
  (void)phase; (void)position;
  *to = -1.0;
  return 0;
}

