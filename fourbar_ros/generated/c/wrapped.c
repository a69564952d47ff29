/* A place in the first period, its rest as Python's %. */
static double wrapped(double place, double first, double period)
{
  double rest = fmod(place - first, period);
  if (rest < 0.0) rest = rest + period;
  return first + (rest == 0.0 ? 0.0 : rest);
}

