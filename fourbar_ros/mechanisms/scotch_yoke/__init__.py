"""The Scotch yoke."""
