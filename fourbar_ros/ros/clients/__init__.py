"""Programs that talk to a running node."""
