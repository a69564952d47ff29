static double clamped(double place, double first, double last)
{
  return place < first ? first : place > last ? last : place;
}

