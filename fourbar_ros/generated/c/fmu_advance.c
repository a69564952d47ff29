  if (step > 0.0) {
    State *state = STATE;
    state->drive_status = (double)NAME_advance(&state->drive, step GIVEN_TORQUE);
    state->has_moved = state->results_are_old = 1;
  }
