"""Directions, integrals over them and multilinear lookup; nothing here knows what a BRDF is."""
