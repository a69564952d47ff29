/* libm's pow, which Python calls; a compiler that sees it makes x * x of it, of other bits. */
static double power(double base, double exponent)
{
  double (*volatile of_libm)(double, double) = pow;
  return of_libm(base, exponent);
}
