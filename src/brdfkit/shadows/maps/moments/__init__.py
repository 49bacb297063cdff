"""Moments of the depths about a place of a map, and the share of light that they bound."""
