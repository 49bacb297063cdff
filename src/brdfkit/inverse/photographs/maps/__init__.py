"""Defines the searched numbers of a texel (a pixel of the maps), its radiance, and the maps."""
