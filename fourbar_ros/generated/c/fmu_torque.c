    if (references[i] == TORQUE) {
      state->torque = from[i];
      if (!state->has_moved) NAME_start(&state->drive, state->torque);
      state->results_are_old = 1;
      continue;
    }
