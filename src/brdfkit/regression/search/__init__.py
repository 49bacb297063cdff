"""Searches for the parameters of a model with the least loss, from many start points."""
