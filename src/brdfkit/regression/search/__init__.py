"""Searches the parameters with the least error, from many starts."""
