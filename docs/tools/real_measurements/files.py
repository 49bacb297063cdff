"""One material as five files, by brdfkit's own writers: two grids and three lists of samples."""

import numpy as np

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles, from_half_difference

# Steps of the goniometer's grid [degrees]: both polar angles below 80°, and azimuths that close in
# on the mirror direction, by the square of their number
STEP_I, STEP_O, LAST, AZIMUTHS = 2.5, 1.25, 80, 72
CELLS, ROWS = 60_000, 20_000
# Kind → suffix; the first is the one to which all others are held
FILES = {
    "table": ".binary",
    "RGL grid": ".bsdf",
    "goniometer": ".astm",
    "cells": ".astm",
    "random": ".csv",
}


def read_again(kind, table, folder):
    """The `Measured` that is read from a file of a `kind`, written of a measured `table`."""
    samples = {
        "goniometer": goniometer_grid,
        "cells": lambda: some_cells(table),
        "random": random_pairs,
    }
    thing = table
    if kind in samples:
        wi, wo = samples[kind]()
        thing = bk.Measured.from_samples(wi, wo, table.eval(wi, wo), name=kind)
    file = folder / f"{kind.replace(' ', '_')}{FILES[kind]}"
    bk.save(thing, file)
    return bk.load(file)


def goniometer_grid():
    """Direction pairs (n, 3) of a grid over both polar angles and the azimuth between them."""
    theta_i, theta_o = (np.arange(0, LAST, step) for step in (STEP_I, STEP_O))
    phi = 180 * (1 - (np.arange(AZIMUTHS) / (AZIMUTHS - 1)) ** 2)
    angles = np.meshgrid(theta_i, theta_o, phi, indexing="ij")
    theta_i, theta_o, phi = (np.radians(a.ravel()) for a in angles)
    return from_angles(theta_i, 0 * phi), from_angles(theta_o, phi)


def some_cells(table):
    """The direction pairs (n, 3) of `CELLS` cells of a table, drawn evenly."""
    rows = np.flatnonzero(table.samples.within(90.0))
    rows = np.random.default_rng(0).choice(rows, min(CELLS, len(rows)), replace=False)
    return table.samples.wi[rows], table.samples.wo[rows]


def random_pairs():
    """`ROWS` direction pairs (n, 3), even in the half and difference angles."""
    angles = np.random.default_rng(0).random((3, 4 * ROWS)) * [[np.pi / 2], [np.pi / 2], [np.pi]]
    pair = from_half_difference(*angles)
    above = np.all([w[:, 2] > 0.01 for w in pair], axis=0)
    return [w[above][:ROWS] for w in pair]
