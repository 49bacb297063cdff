"""Searches for the parameters of a scene: starting points, derivatives and steps."""
