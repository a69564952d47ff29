  if (reference == TORQUE) return &state->torque;
  if (reference == DRIVE_STATUS) return &state->drive_status;
  if (reference >= DRIVE) return (char *)&state->drive + (reference - DRIVE) * sizeof(double);
