"""One rigid body in the plane."""
