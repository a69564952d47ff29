"""Planar mechanisms, a folder a kind."""
