"""Finds what is odd about photographs of an object by comparing them with Lambert's law."""
