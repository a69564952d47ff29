  to->mode = at->mode;
  to->place[0] = 1.0 + it->phase;
  memcpy(to->place + 1, it->state, sizeof it->state);
  to->place[6] = at->rising;
  to->place[7] = at->turns;
