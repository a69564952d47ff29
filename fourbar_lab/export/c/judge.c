static int is_infinite(double x)
{
  return x > DBL_MAX || x < -DBL_MAX;
}

static int is_finite(double x)
{
  return x <= DBL_MAX && x >= -DBL_MAX;
}

/* The status by the input alone: 0, or 2 invalid, 4 rates unknown. */
static int first_look(double x, double rate, double acceleration)
{
  const double square = rate * rate;
  const double sum = x + square;
  if (!is_finite(x) || is_infinite(rate) || is_infinite(acceleration)) return 2;
  if (rate != rate || acceleration != acceleration) return 4;
  return is_finite(sum + acceleration) ? 0 : 2;
}

/* The sum of the sizes of some numbers, four at a time. */
static double size_of(const double *values, int count)
{
  double a = 0.0, b = 0.0, c = 0.0, d = 0.0;
  int i;
  for (i = 0; i + 3 < count; i += 4) {
    a += fabs(values[i]);
    b += fabs(values[i + 1]);
    c += fabs(values[i + 2]);
    d += fabs(values[i + 3]);
  }
  for (; i < count; ++i) a += fabs(values[i]);
  return (a + b) + (c + d);
}

/* The status by the results too. `closes` is a number where the links close, `condition` infinite
   at a flat position, a toggle. */
static int judged(int status, int refused, double closes, double condition, double x,
                  const double *values, int loads)
{
  double motion = 0.0, load = 0.0;
  int i;
  if (!reaches(x)) return 1;
  if (status == 0 && refused) status = is_infinite(condition) || is_at_limit(x) ? 3 : 1;
  if (status != 0) return closes != closes ? 1 : status;
  if (size_of(values, SUMMED) + size_of(values + MOTIONS, loads) < 1e300) return 0;
  for (i = 0; i < SUMMED; ++i) motion += values[i];
  for (i = MOTIONS; i < MOTIONS + loads; ++i) load += values[i];
  if (is_finite(motion + load)) return 0;
  return is_finite(load) && is_infinite(condition) ? 3 : 2;
}

/* What there is no answer to is NaN, and all that depends on a rate (1) or acceleration (2) that
   is NaN. */
static void without_answer(int status, double rate, double acceleration, double *values,
                           int loads)
{
  const int unknown = (rate != rate ? 1 : 0) | (acceleration != acceleration ? 2 : 0);
  int i;
  for (i = 0; i < MOTIONS + loads; ++i)
    if (status < 3 || i >= MOTIONS || !is_finite(values[i]) || (depends[i] & unknown) != 0)
      values[i] = NAN;
}

/* How many numbers differ in any bit. */
static int differing(const void *of_struct, const double *expected, size_t count)
{
  const unsigned char *bytes = (const unsigned char *)of_struct;
  int found = 0;
  size_t i;
  for (i = 0; i < count; ++i)
    found += memcmp(bytes + i * sizeof(double), expected + i, sizeof(double)) != 0;
  return found;
}
