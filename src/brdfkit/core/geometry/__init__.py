"""Directions, integrals over them and multilinear interpolation."""
