  if (from->place[0] > 0.0) {
    at->it.phase = (int)from->place[0] - 1;
    memcpy(state, from->place + 1, sizeof at->it.state);
    at->mode = from->mode;
    at->rising = from->place[6];
    at->turns = from->place[7];
  } else {
    at->it.known[0] = NAN;
  }
