"""Computes the squared loss E² of a model on samples or on pixels, and its derivatives."""
