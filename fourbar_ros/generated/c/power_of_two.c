/* The power of two next above the largest of the sizes of some lengths. */
static double power_of_two(int count, const double *lengths)
{
  double largest = fabs(lengths[0]);
  int i, exponent;
  for (i = 1; i < count; ++i)
    if (fabs(lengths[i]) > largest) largest = fabs(lengths[i]);
  if (!(largest <= DBL_MAX)) return largest;
  (void)frexp(largest, &exponent);
  return ldexp(1.0, exponent);
}
