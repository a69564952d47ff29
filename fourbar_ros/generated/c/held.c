typedef struct {
  Moving it;
} Place;

/* Where a state of the input is. */
static void place_at(Place *at, double mode)
{
  (void)mode;
  at->it.phase = 0;
}

static int state_of_input(const Place *at, double *to)
{
  memcpy(to, at->it.state, sizeof at->it.state);
  return 0;
}

static int move(Place *at, double left, int *is_good)
{
  return part_of_step(&at->it, &left, is_good);
}

