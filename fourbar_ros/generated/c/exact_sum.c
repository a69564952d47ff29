/* Correctly rounded sum (Shewchuk 1997), as Python's math.fsum of finite terms: the sum is kept
   as parts that do not overlap, their total rounded once, half to even. */
static double exact_sum(int count, const double *terms)
{
  double parts[MOST_TERMS], sum, low = 0.0;
  int i, j, used = 0;
  for (i = 0; i < count; ++i) {
    double x = terms[i];
    int kept = 0;
    for (j = 0; j < used; ++j) {
      const double part = parts[j];
      const double large = fabs(x) < fabs(part) ? part : x;
      const double small = fabs(x) < fabs(part) ? x : part;
      const double total = large + small, rest = small - (total - large);
      if (rest > 0.0 || rest < 0.0) parts[kept++] = rest;
      x = total;
    }
    used = kept;
    if (x > 0.0 || x < 0.0) parts[used++] = x;
    else if (!(x <= 0.0)) return x;                     /* not a number */
  }
  if (used == 0) return 0.0;
  sum = parts[--used];
  while (used > 0) {                                    /* at most as often as there are terms */
    const double total = sum + parts[--used];
    low = parts[used] - (total - sum);
    sum = total;
    if (low > 0.0 || low < 0.0) break;
  }
  if (used > 0 && ((low < 0.0 && parts[used - 1] < 0.0)
                   || (low > 0.0 && parts[used - 1] > 0.0))) {
    const double twice = 2.0 * low, total = sum + twice, back = total - sum;
    if (!(back < twice || back > twice)) sum = total;   /* a tie that the rest decides */
  }
  return sum;
}
