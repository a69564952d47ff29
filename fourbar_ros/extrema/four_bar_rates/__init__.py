"""Rate and acceleration of the output of a 4R at constant input rate."""
