"""Computes the albedo of a measurement at several angles of incidence, in two ways.

The first way integrates the interpolated BRDF. The second one interpolates linearly between the
samples.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.geometry.directions import from_angles, to_angles
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.albedos import compute_directional_albedo
from brdfkit.model.samples import Samples

DEGREES = np.arange(0, 90, 5)  # angles of incidence at which the albedo is computed [degrees]
AZIMUTHS = 8  # number of azimuths of incidence for an anisotropic material
# Smallest share of the unit disc, onto which views are projected, that samples of one incidence
# must cover for their albedo to be computed
LEAST_AREA = 0.75


@dataclass(frozen=True)
class Albedo:
    """The directional albedo of a measurement for several angles of incidence.

    `channels`: names of the channels; `theta_i`: angles of incidence [degrees], (n,); `values`:
    albedo as a mean over the azimuth of incidence, (n, channels); `measured_to`: largest measured
    angle of incidence [degrees], beyond which the albedo is extrapolated; `brightest`: albedo at
    the azimuth of incidence where it is largest, (n, channels).
    """

    channels: tuple[str, ...]
    theta_i: AnyArray
    values: FloatArray
    measured_to: float
    brightest: FloatArray


def compute_albedo(data: Measured, measured_to: float) -> Albedo:
    """Compute the albedo ∫ f cos θo dωo of a `Measured`, where f is its interpolated BRDF.

    `measured_to` is the largest measured angle of incidence [degrees].
    """
    azimuths = np.arange(AZIMUTHS) / AZIMUTHS * 2 * np.pi if data.anisotropic else (0.0,)
    values = np.array(
        [
            [compute_directional_albedo(data, from_angles(theta, phi)) for phi in azimuths]
            for theta in np.radians(DEGREES)
        ]
    )
    return Albedo(data.channels, DEGREES, values.mean(axis=1), measured_to, values.max(axis=1))


def compute_sample_albedo(data: Measured) -> Albedo | None:
    """Compute the albedo of scattered samples at each angle of incidence that has enough of them.

    Directions are projected onto the unit disc (sin θo cos φo, sin θo sin φo), where an area is
    cos θo dωo. There the BRDF is taken as linear between the samples, and as constant from the
    outermost samples to the horizon. The result is None for a table, for an anisotropic material,
    and for too few samples.
    """
    if data.is_table or data.anisotropic:
        return None
    samples = data.samples.at(data.samples.valid)
    degrees = np.degrees(to_angles(samples.wi)[0]).round(1)
    by_angle = {}
    for angle in np.unique(degrees):
        value = _integrate_over_disc(samples.at(degrees == angle))
        if value is not None:
            by_angle[float(angle)] = value
    if not by_angle:
        return None
    values = np.array(list(by_angle.values()))
    return Albedo(data.channels, np.array(list(by_angle)), values, max(by_angle), values)


def _integrate_over_disc(samples: Samples) -> FloatArray | None:
    """Return the albedo (channels,) of samples of one incidence, or None for too few samples.

    The BRDF is integrated over the unit disc onto which `_project_to_disc` projects the views.
    """
    from scipy.spatial import ConvexHull, Delaunay

    # Return None for samples that lie on a line of the disc, or cover too little of its area
    places, values = _project_to_disc(samples)
    if len(places) < 4 or np.linalg.matrix_rank(places - places[0], tol=1e-3) < 2:
        return None
    hull = ConvexHull(places)  # SciPy calls the area of a hull in the plane its volume
    if hull.volume < LEAST_AREA * np.pi:
        return None

    # Repeat the outermost samples on the rim of the disc, which stands for the horizon
    outermost = places[hull.vertices]
    rim = outermost / np.linalg.norm(outermost, axis=1, keepdims=True)
    places = np.concatenate([places, rim])
    values = np.concatenate([values, values[hull.vertices]])

    # Integrate over triangles, in which the BRDF is linear. They cover a polygon within the disc,
    # so scale the integral to the area of the disc
    corners = Delaunay(places).simplices
    (ax, ay), (bx, by) = (places[corners[:, k]].T - places[corners[:, 0]].T for k in (1, 2))
    area = np.abs(ax * by - ay * bx)
    return area @ values[corners].mean(axis=1) * np.pi / area.sum()


def _project_to_disc(samples: Samples) -> tuple[FloatArray, FloatArray]:
    """Return the views of samples as points (n, 2) of the unit disc, and the values (n, channels).

    The mirror image of each sample at the plane of incidence is added. Samples at the same point
    are averaged.
    """
    radius = np.sin(to_angles(samples.wo)[0])
    azimuth = to_angles(samples.wo)[1] - to_angles(samples.wi)[1]
    x, y = radius * np.cos(azimuth), radius * np.sin(azimuth)
    places = np.concatenate([np.stack([x, y], axis=1), np.stack([x, -y], axis=1)]).round(6)
    places, same = np.unique(places, axis=0, return_inverse=True)
    columns = np.concatenate([samples.values, samples.values]).T
    sums = [np.bincount(same, column) for column in columns]
    return places, np.stack(sums, axis=1) / np.bincount(same)[:, None]
