/* A source with one law. */
static Regime regime_at(double speed, double own, double slope, double near, double command)
{
  Regime found = {{0.0, 0.0, 0.0, 0.0, 0.0, 0.0}, {0.0, 0.0}, 0, 0, 0.0};
  (void)own; (void)slope; (void)near;
  law(speed, command, found.piece);
  return found;
}

static double to_kink(const Regime *regime, double speed, double own, double slope,
                      double speed_after, double own_after, double h)
{
  (void)regime; (void)speed; (void)own; (void)slope; (void)speed_after; (void)own_after; (void)h;
  return 1.0;
}
