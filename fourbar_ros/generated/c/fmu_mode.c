      if (state->mode < state->drive.mode || state->mode > state->drive.mode) {
        state->mode = state->drive.mode;
        NAME_set_mode(&state->parameters, state->mode);
        state->constants_are_old = 1;
      }
