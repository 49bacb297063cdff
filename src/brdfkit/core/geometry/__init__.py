"""Direction vectors, integrals over directions, and multilinear interpolation."""
