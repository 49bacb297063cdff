"""The distribution of microfacet normals that a table suggests, to sample the table by.

A facet model has f = D · F G / (4 cosθ_i cosθ_o). So f cosθ_i cosθ_o, less the diffuse floor that
is there at every theta_h, is about D; over the cells of one theta_h its root mean square is taken,
between the mean, which starves a peak at grazing angles, and the maximum, which starves the rest.
"""

from dataclasses import dataclass

import numpy as np

# Cosine samples: never fewer, since the normals miss what is not specular
LEAST_DIFFUSE, MOST_DIFFUSE = 0.25, 0.9
# At the horizon tables hold artefacts
LEAST_COSINE = 0.02


@dataclass(frozen=True, eq=False)
class Normals:
    """A distribution over the theta_h cells of a table, even within a cell.

    `masses`: (n_theta_h,), not normalised; `cosines`: (n_theta_h + 1,), cosθ_h at the cells'
    edges; `diffuse`: albedo of the floor; `diffuse_share`: share of the samples that should
    follow the cosine instead.
    """

    masses: np.ndarray
    cosines: np.ndarray
    diffuse: float
    diffuse_share: float

    @property
    def density(self):
        """Density of the normals per solid angle [sr⁻¹] in each cell."""
        return self.masses / self.masses.sum() / _solid_angles(self.cosines)


def normals_of(table):
    """The `Normals` of a `brdfkit.table.Table`."""
    wi, wo = table.directions()
    seen = (wi[..., 2] > LEAST_COSINE) & (wo[..., 2] > LEAST_COSINE)
    known = seen.any(axis=(1, 2))
    brightness = np.maximum(table.filled, 0).mean(axis=-1)
    floor = _mean(brightness, seen, axis=(1, 2))[known].min()

    facets = np.maximum(brightness - floor, 0) * wi[..., 2] * wo[..., 2]
    by_theta_d = _mean(facets, seen, axis=2)
    D = np.sqrt(_mean(by_theta_d**2, seen.any(axis=2), axis=1))
    D[~known] = D[known][-1]

    theta_h = table.centres[0]
    edges = (np.arange(len(theta_h) + 1) / len(theta_h)) ** 2 * np.pi / 2
    cosines = np.cos(edges)
    masses = D * np.cos(theta_h) * _solid_angles(cosines)
    diffuse, specular = np.pi * floor, 4 * masses.sum()
    share = np.clip(diffuse / max(diffuse + specular, 1e-12), LEAST_DIFFUSE, MOST_DIFFUSE)
    # Every cell keeps a little: the density must not vanish where the table does not
    masses += 1e-3 * max(masses.sum(), 1e-12) * -np.diff(cosines)
    return Normals(masses, cosines, float(diffuse), float(share))


def _mean(values, mask, axis):
    return (values * mask).sum(axis=axis) / np.maximum(mask.sum(axis=axis), 1)


def _solid_angles(cosines):
    return -np.diff(cosines) * 2 * np.pi
