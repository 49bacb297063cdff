"""Points of a search as vectors z: coordinates of the shape parameters, then weights by channel."""

import math

import numpy as np


def join(u, weights):
    """The vectors (points, n) of coordinates `u` (points, shapes) and `weights` (points, channels,
    lobes)."""
    return np.concatenate([u, weights.reshape(len(u), math.prod(weights.shape[1:]))], axis=1)


def split(z, shapes, channels):
    """The coordinates and weights of vectors `z` (points, n), as `join` takes them."""
    lobes = (z.shape[1] - shapes) // channels
    return z[:, :shapes], z[:, shapes:].reshape(len(z), channels, lobes)


def limits(shapes, channels, least):
    """The bounds low and high (n,) of vectors; `least` (lobes,): the least weights."""
    count = channels * len(least)
    low = np.concatenate([np.zeros(shapes), np.tile(least, channels)])
    return low, np.concatenate([np.ones(shapes), np.full(count, np.inf)])


def of_channel(c, shapes, lobes):
    """The numbers in a vector of what one channel depends on: all shapes, and its own weights."""
    return np.r_[0:shapes, shapes + c * lobes : shapes + (c + 1) * lobes]
