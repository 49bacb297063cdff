"""Reads photographs of a flat sample, with the places of cameras and lights."""
