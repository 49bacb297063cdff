"""Defines the numbers that describe a texel, the radiance that they cause, and maps of them."""
