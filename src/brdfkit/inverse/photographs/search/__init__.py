"""Fits the maps to the photographs: starts, steps, smoothness, and the correction by rendering."""
