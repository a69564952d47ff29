/* A field at a flat position at 0, by its limits at rest and with rate and acceleration. */
static double limit_of(double at, double per_rate, double per_square, double per_acceleration,
                       double rate, double acceleration)
{
  if (rate < 0.0 || rate > 0.0) at = at + (per_rate + per_square * rate) * rate;
  if (acceleration < 0.0 || acceleration > 0.0) at = at + per_acceleration * acceleration;
  return at;
}
