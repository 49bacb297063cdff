"""Finds where rays meet a distance field, and the normal there."""
