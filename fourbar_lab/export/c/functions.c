// --- exact_sum
/* Correctly rounded sum of lengths (Shewchuk 1997), as Python's math.fsum of finite terms: the sum
   is kept as parts that do not overlap, their total rounded once, half to even. Below 2^-50 of the
   sizes of the terms it is the rounding of decimals: zero. */
static double exact_sum(int count, const double *terms)
{
  double parts[MOST_TERMS], sum, low = 0.0, size = 0.0;
  int i, j, used = 0;
  for (i = 0; i < count; ++i) {
    double x = terms[i];
    int kept = 0;
    size += fabs(x);
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
  return fabs(sum) <= 8.881784197001252e-16 * size ? 0.0 : sum;
}
// --- hypot
/* Length of a vector as Python's math.hypot gives it, to the last bit: libm's hypot differs from
   it in 4 of 1000 pairs. Scaled by a power of two, squared without loss (Dekker's product, by
   Veltkamp's split), added to 1 with compensation, and the root corrected once (Borges,
   arXiv 1904.09481). */
static double rest_of_square(double x, double square)
{
  const double split = 134217729.0 * x, high = split - (split - x), low = x - high;
  const double cross = 2.0 * high * low, first = high * high - square;
  return first + cross + low * low;
}

static double length_of_scaled(double x, double y)      /* the larger in [0.5, 1) */
{
  const double xx = x * x, yy = y * y, one = 1.0 + xx, two = one + yy;
  const double rests = rest_of_square(x, xx) + rest_of_square(y, yy);
  const double lost = (1.0 - one + xx) + (one - two + yy);
  const double root = sqrt(two - 1.0 + (rests + lost)), square = root * root;
  const double three = two - square, more = lost + (two - three - square);
  const double less = rests - rest_of_square(root, square);
  return root + (three - 1.0 + (less + more)) / (2.0 * root);
}

static double hypot_of(double x, double y)
{
  uint64_t bits;
  double largest, scale, unit = 1.0;
  int exponent;
  x = fabs(x);
  y = fabs(y);
  largest = y > x ? y : x;
  memcpy(&bits, &largest, sizeof bits);
  bits >>= 52;
  if (bits - 1u < 2043u) {              /* a normal number; the other is less, or no number */
    const uint64_t down = (2045u - bits) << 52, up = (bits + 1u) << 52;
    memcpy(&scale, &down, sizeof scale);
    memcpy(&unit, &up, sizeof unit);
    return unit * length_of_scaled(x * scale, y * scale);
  }
  if (x > DBL_MAX || y > DBL_MAX) return HUGE_VAL;
  if (!(x <= DBL_MAX && y <= DBL_MAX)) return x + y;               /* not a number */
  if (!(largest > 0.0)) return 0.0;
  (void)frexp(largest, &exponent);
  if (exponent < -1023) {                                          /* 1 / scale overflows */
    unit = DBL_MIN;
    (void)frexp(largest / unit, &exponent);
  }
  scale = ldexp(1.0, -exponent);
  return unit * (length_of_scaled(x / unit * scale, y / unit * scale) / scale);
}
// --- power
/* libm's pow, which Python calls; a compiler that sees it makes x * x of it, of other bits. */
static double power(double base, double exponent)
{
  double (*volatile of_libm)(double, double) = pow;
  return of_libm(base, exponent);
}
// --- power_of_two
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
// --- wrapped
/* A place in the first period, where it stays, else its rest as Python's %. */
static double wrapped(double place, double first, double period)
{
  double rest = fmod(place - first, period);
  if (place - first >= 0.0 && place - first < period) return place;
  if (rest < 0.0) rest = rest + period;
  return first + (rest == 0.0 ? 0.0 : rest);
}

// --- table
/* A force over a place, of cubic pieces: fourbar_ros.mechanisms.force_table. */
static double cubic(const double *piece, double place)
{
  const double t = place - piece[4];
  return ((piece[0] * t + piece[1]) * t + piece[2]) * t + piece[3];
}

/* How many of some places, in order, are not above one: at most as many halvings as they have
   binary digits. */
static int piece_at(double place, const double *places, int count)
{
  int low = 0, high = count;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (place < places[middle]) high = middle;
    else low = middle + 1;
  }
  return low;
}

