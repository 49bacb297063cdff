"""Writes one material as five kinds of files: two grids and three lists of samples."""

import numpy as np

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles, from_half_difference

# Steps of the goniometer's grid over the incident and outgoing polar angles [degrees], and its end
STEP_I, STEP_O, LAST = 2.5, 1.25, 80
# Number of azimuths of the goniometer's grid, which become denser towards the mirror direction
AZIMUTHS = 72
# Numbers of samples in the files "cells" and "random"
CELLS, ROWS = 60_000, 20_000
# Suffixes by kind of file; the fits of the first one are the reference for the others
FILES = {
    "table": ".binary",
    "RGL grid": ".bsdf",
    "goniometer": ".astm",
    "cells": ".astm",
    "random": ".csv",
}


def save_and_load(kind, table, folder):
    """Write a measured `table` to a file of a `kind`, and return the material read from it."""
    samples = {
        "goniometer": make_goniometer_grid,
        "cells": lambda: draw_cells(table),
        "random": draw_random_pairs,
    }
    thing = table
    if kind in samples:
        wi, wo = samples[kind]()
        thing = bk.Measured.from_samples(wi, wo, table.eval(wi, wo), name=kind)
    file = folder / f"{kind.replace(' ', '_')}{FILES[kind]}"
    bk.save(thing, file)
    return bk.load(file)


def make_goniometer_grid():
    """Return pairs of directions (n, 3) on a grid of polar angles and the azimuth between."""
    theta_i, theta_o = (np.arange(0, LAST, step) for step in (STEP_I, STEP_O))
    phi = 180 * (1 - (np.arange(AZIMUTHS) / (AZIMUTHS - 1)) ** 2)
    angles = np.meshgrid(theta_i, theta_o, phi, indexing="ij")
    theta_i, theta_o, phi = (np.radians(a.ravel()) for a in angles)
    return from_angles(theta_i, 0 * phi), from_angles(theta_o, phi)


def draw_cells(table):
    """Return the pairs of directions (n, 3) of `CELLS` cells of a table, drawn uniformly."""
    rows = np.flatnonzero(table.samples.within(90.0))
    rows = np.random.default_rng(0).choice(rows, min(CELLS, len(rows)), replace=False)
    return table.samples.wi[rows], table.samples.wo[rows]


def draw_random_pairs():
    """Return `ROWS` pairs of directions (n, 3), uniform in the half and difference angles."""
    angles = np.random.default_rng(0).random((3, 4 * ROWS)) * [[np.pi / 2], [np.pi / 2], [np.pi]]
    pair = from_half_difference(*angles)
    above = np.all([w[:, 2] > 0.01 for w in pair], axis=0)
    return [w[above][:ROWS] for w in pair]
