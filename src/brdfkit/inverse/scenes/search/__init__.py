"""Searches the parameters of a scene: starts, steps and the look at the end."""
