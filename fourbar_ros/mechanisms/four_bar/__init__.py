"""The planar 4R linkage."""
