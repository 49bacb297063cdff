"""Fits maps to photographs: starting values, steps, smoothness, and corrections by rendering."""
