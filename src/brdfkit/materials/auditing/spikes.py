"""Finds spikes in a measurement: single values far above all their neighbours.

The products f cos θi cos θo are compared, because the BRDF f of a smooth surface rises towards the
horizon as 1 / (4 cos θi cos θo), which is no spike.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import to_angles
from brdfkit.materials.measured import Measured
from brdfkit.model.samples import Table
from brdfkit.model.samples.coordinates import compute_coordinates

# A spike exceeds its largest neighbour by at least this factor. Factors up to 3.4 occur in good
# measurements of paints, cloth and stone
LEAST_FACTOR = 4
NEIGHBOURS = 6  # number of neighbours with which a scattered sample is compared


@dataclass(frozen=True)
class Spike:
    """A suspicious sample, far above its neighbours.

    `theta_i`, `theta_o`: angles to the normal of light and view [degrees]; `delta_phi`: azimuth
    between them [degrees], 180 in the mirror direction; `value`: mean over the channels [sr⁻¹];
    `factor`: f cos θi cos θo of the sample, where f is its value, over the largest such product of
    its neighbours.
    """

    theta_i: float
    theta_o: float
    delta_phi: float
    value: float
    factor: float

    def __str__(self) -> str:
        return (
            f"θi {self.theta_i:.1f}°, θo {self.theta_o:.1f}°, Δφ {self.delta_phi:.0f}°: "
            f"{self.value:.4g} sr⁻¹, {self.factor:.1f} times its neighbours"
        )


def find_spikes(data: Measured) -> tuple[Spike, ...]:
    """Find the spikes of a `Measured`, and return them, the worst first.

    A spike is brighter than the median, and more than 4 times its largest neighbour. The neighbours
    of a table's cell share a side with it; the neighbours of a sample are the 6 samples with the
    nearest half and difference vectors.
    """
    # Find the largest neighbour of each value. It gets a lower bound, because otherwise every value
    # beside zeros would be a spike
    samples = data.samples
    brightness = np.where(samples.valid, samples.values.mean(axis=1), np.nan)
    projected = brightness * samples.wi[:, 2] * samples.wo[:, 2]
    if data.is_table:
        around = _find_largest_adjacent(data.table, projected)
    else:
        around = _find_largest_nearby(data, projected)
    around = np.maximum(around, 1e-3 * abs(np.nanmedian(projected)))

    # Sort the spikes by their ratio to the largest neighbour, the worst first
    stands_out = (projected > LEAST_FACTOR * around) & (brightness > np.nanmedian(brightness))
    worst = np.flatnonzero(stands_out)
    worst = worst[np.argsort(-projected[worst] / around[worst])]
    (theta_i, phi_i), (theta_o, phi_o) = to_angles(samples.wi[worst]), to_angles(samples.wo[worst])
    degrees = np.degrees([theta_i, theta_o, np.mod(phi_o - phi_i, 2 * np.pi)])
    columns = *degrees, brightness[worst], projected[worst] / around[worst]
    return tuple(Spike(*row) for row in np.transpose(columns).tolist())


def _find_largest_adjacent(table: Table, values: FloatArray) -> FloatArray:
    """Return for each cell the largest of `values` (n,) in the cells that share a side with it.

    The result (n,) is NaN where none of these cells has a value.
    """
    f = values.reshape(table.shape)
    around = np.full(f.shape, np.nan)
    for axis in range(f.ndim):
        here, there = np.moveaxis(around, axis, 0), np.moveaxis(f, axis, 0)
        np.fmax(here[1:], there[:-1], out=here[1:])
        np.fmax(here[:-1], there[1:], out=here[:-1])
        if axis not in (f.ndim - 3, f.ndim - 2):  # azimuths are periodic: both ends are neighbours
            np.fmax(here[0], there[-1], out=here[0])
            np.fmax(here[-1], there[0], out=here[-1])
    return around.reshape(-1)


def _find_largest_nearby(data: Measured, values: FloatArray) -> FloatArray:
    """Return for each sample the largest of `values` (n,) at the nearest valid samples.

    The result (n,) is NaN for samples that are not valid, and where there are too few samples.
    """
    from scipy.spatial import cKDTree

    samples, valid = data.samples, np.flatnonzero(data.samples.valid)
    here = compute_coordinates(samples.wi[valid], samples.wo[valid], data.anisotropic)
    around = np.full(len(values), np.nan)
    if len(valid) > NEIGHBOURS:
        _, nearest = cKDTree(here).query(here, k=NEIGHBOURS + 1)
        itself = nearest == np.arange(len(valid))[:, None]
        around[valid] = np.where(itself, -np.inf, values[valid][nearest]).max(axis=1)
    return around
