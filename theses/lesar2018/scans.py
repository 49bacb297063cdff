"""Loads the volumes of the pictures: an MRI scan, a frog of labels, and a made phantom."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from brdfkit.theses.lesar2018 import MRI

from brdfkit import volumes
from brdfkit.volumes import TransferFunction, Volume

FROG = "volumes/frog_tissues.vti"
PHANTOM = 96  # voxels along an edge
DENSE = 40.0  # optical depth of the cube's edge at the opacity A = 1
SKELETON = 13  # the label of the frog's skeleton
# The head's transfer function: share of the range of values, R, G, B, A
HEAD = (
    (0.0, 0.5, 0.25, 0.2, 0.0),
    (0.12, 0.6, 0.3, 0.24, 0.0),
    (0.3, 0.78, 0.5, 0.42, 0.25),
    (0.6, 0.85, 0.68, 0.58, 0.7),
    (0.8, 0.92, 0.86, 0.8, 1.0),
    (1.0, 0.95, 0.92, 0.88, 1.0),
)


@dataclass(frozen=True)
class Scan:
    """A volume within the cube from -1 to 1, with what its pictures need.

    density : values for which the largest and a level mean something.
    coloured : values that have colours, labels or the densities themselves.
    function : the colours of `coloured`.
    level : the level of the surface.
    window : the densities that are black and white.
    eye : the direction of the camera.
    up : the direction that is up in pictures.
    """

    name: str
    density: Volume
    coloured: Volume
    function: TransferFunction
    level: float
    window: tuple[float, float]
    eye: Any
    up: Any


def find_scans(sources, fewer=1):
    """Return the scans whose files exist, and the phantom, with edges `fewer` times as short."""
    found = []
    if sources.find_beside(MRI):
        found.append(load_head(sources.find_beside(MRI), fewer))
    if sources.find_beside(FROG):
        found.append(load_frog(sources.find_beside(FROG), 2 * fewer))
    return [*found, make_phantom(fewer)]


def load_head(path, fewer):
    """Return an MRI scan of a head without its skull."""
    head = fit_into_cube(volumes.load(path, downsample=fewer))
    function = TransferFunction([row[0] for row in HEAD], [row[1:] for row in HEAD])
    function = function.scaled_to(*head.range)
    return Scan(
        "MRI", head, head, set_optical_depth(function), 110, (150, 255), (1.3, 1.6, 0.9), (0, 0, 1)
    )


def load_frog(path, fewer):
    """Return tissues of a frog by labels, and made densities: 1 in the skeleton, else less."""
    labels = fit_into_cube(volumes.load(path, downsample=fewer, labels=True))
    n = int(labels.range[1]) + 1
    a = np.array([0, *[0.3] * (n - 1)])
    a[SKELETON] = 1
    density = Volume(a[labels.values], labels.to_world, labels.name)
    rgb = np.random.default_rng(4).uniform(0.2, 0.95, (n, 3))
    rgb[SKELETON] = 0.9, 0.87, 0.8
    function = set_optical_depth(TransferFunction(np.arange(n), np.column_stack([rgb, a])))
    return Scan("frog", density, labels, function, 0.15, (0, 1), (0.4, -0.5, 2), (1, 0, 0))


def make_phantom(fewer):
    """Return Shepp and Logan's phantom, without its skull and the octant nearest to the camera."""
    found = volumes.load("shepp_logan", size=2 * PHANTOM // fewer)
    values = np.where(found.values > 0.9, 0, found.values)
    n = PHANTOM // fewer
    values[n:, :n, :n] = 0
    volume = Volume(values, found.to_world, "phantom").resized(2)
    colours = {  # value: RGB, A
        0.0: (0.2, 0.3, 0.8, 0),
        0.1: (0.2, 0.4, 0.9, 0.2),
        0.2: (0.35, 0.7, 0.85, 0.1),
        0.3: (0.95, 0.6, 0.2, 0.7),
        0.4: (0.95, 0.25, 0.2, 1),
    }
    function = set_optical_depth(TransferFunction(list(colours), list(colours.values())))
    return Scan("phantom", volume, volume, function, 0.1, (0, 0.4), (-0.9, -2.0, 1.1), (0, 0, 1))


def fit_into_cube(volume):
    """Return the volume moved and shrunk into the cube from -1 to 1."""
    low, high = volume.bounds
    fit = np.diag([*[2 / (high - low).max()] * 3, 1.0])
    fit[:3, 3] = -fit[0, 0] * (low + high) / 2
    return Volume(volume.values, fit @ volume.to_world, volume.name, volume.labels)


def set_optical_depth(function, depth=DENSE):
    """Return a transfer function with an extinction that gives the cube's edge an optical depth."""
    return replace(function, extinction=depth / 2)
