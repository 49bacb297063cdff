"""Defines the numbers of each texel, the radiance that follows from them, and maps of them."""
