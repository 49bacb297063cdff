"""Directions and integrals over them; nothing here knows what a BRDF is."""
