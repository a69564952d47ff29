"""Scenes: parameters, topics, and the mechanism they describe."""
