"""Moments of the depths near a place of a shadow map, and the bounds they set on its visibility."""
