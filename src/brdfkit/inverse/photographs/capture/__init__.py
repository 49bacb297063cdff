"""Reads photographs of a flat sample, with the positions of the cameras and lights."""
