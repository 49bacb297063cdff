"""The albedo of a material over the angle of incidence: as it is looked up, and of its samples."""

from dataclasses import dataclass

import numpy as np

from brdfkit.geometry.directions import from_angles, to_angles

DEGREES = np.arange(0, 90, 5)  # of incidence
# Points of the half vector: its polar angle, spaced as a table's, and its azimuth
N_THETA, N_PHI = 180, 72
AZIMUTHS = 8  # of incidence, over which the albedo of an anisotropic material is averaged
MOST_OF = 0.75  # of the disc of directions, for an albedo of samples


@dataclass(frozen=True)
class Albedo:
    """Reflected over incident light, of `channels`, at angles of incidence.

    `theta_i`: degrees (n,); `values`: (n, channels), over all azimuths; `measured_to`: the largest
    angle of incidence [degrees] that was measured, behind it the values are extrapolated;
    `brightest`: (n, channels), from the azimuth of incidence that reflects most.
    """

    channels: tuple[str, ...]
    theta_i: np.ndarray
    values: np.ndarray
    measured_to: float
    brightest: np.ndarray


def albedo(data, measured_to):
    """The `Albedo` of a `Measured`, ∫ f cos θo dωo, measured to θi = `measured_to` [degrees].

    The integral runs over the half vector, dωo = 4 (wi·h) dωh, on the axes of a table: few points
    are enough there, where `brdfkit.albedo`, for anything, refines for seconds. It is divided by
    that of f = 1/π, so that a Lambertian surface has its reflectance exactly.
    """
    azimuths = np.arange(AZIMUTHS) / AZIMUTHS * 2 * np.pi if data.anisotropic else (0.0,)
    values = np.array(
        [
            [_albedo(data, from_angles(theta, phi)) for phi in azimuths]
            for theta in np.radians(DEGREES)
        ]
    )
    return Albedo(data.channels, DEGREES, values.mean(axis=1), measured_to, values.max(axis=1))


def _albedo(data, wi):
    wo, weight = _quadrature(wi)
    values = data.eval(np.broadcast_to(wi, wo.shape), wo)
    return weight @ values * np.pi / weight.sum()


def _quadrature(wi):
    """Directions (n, 3) above the surface and their weights cos θo dωo."""
    x = (np.arange(N_THETA) + 0.5) / N_THETA
    theta, phi = x**2 * np.pi / 2, (np.arange(N_PHI) + 0.5) / N_PHI * 2 * np.pi
    h = from_angles(*np.meshgrid(theta, phi, indexing="ij")).reshape(-1, 3)
    d_omega = np.repeat(x * np.sin(theta), N_PHI)
    cosine = h @ wi
    wo = 2 * cosine[:, None] * h - wi
    above = (cosine > 0) & (wo[:, 2] > 0)
    return wo[above], (cosine * d_omega * wo[:, 2])[above]


def albedo_of_samples(data):
    """The `Albedo` of scattered samples alone, at the angles of incidence that have enough of them.

    In the disc of directions (sin θo cos φo, sin θo sin φo), where an area is cos θo dωo, the BRDF
    is linear between the samples, and from the outermost constant to the horizon. None for a
    table, for an anisotropic material, and where there are too few.
    """
    if data.is_table or data.anisotropic:
        return None
    samples = data.samples.at(data.samples.valid)
    degrees = np.degrees(to_angles(samples.wi)[0]).round(1)
    found = {}
    for angle in np.unique(degrees):
        value = _of_disc(samples.at(degrees == angle))
        if value is not None:
            found[float(angle)] = value
    if not found:
        return None
    values = np.array(list(found.values()))
    return Albedo(data.channels, np.array(list(found)), values, max(found), values)


def _of_disc(samples):
    """∫ f over the unit disc, from samples of one angle of incidence, or None."""
    from scipy.spatial import ConvexHull, Delaunay

    places, values = _on_disc(samples)
    if len(places) < 4 or np.linalg.matrix_rank(places - places[0], tol=1e-3) < 2:
        return None
    hull = ConvexHull(places)  # its volume is an area
    if hull.volume < MOST_OF * np.pi:
        return None
    outermost = places[hull.vertices]
    rim = outermost / np.linalg.norm(outermost, axis=1, keepdims=True)
    places = np.concatenate([places, rim])
    values = np.concatenate([values, values[hull.vertices]])
    corners = Delaunay(places).simplices
    (ax, ay), (bx, by) = (places[corners[:, k]].T - places[corners[:, 0]].T for k in (1, 2))
    area = np.abs(ax * by - ay * bx)
    return area @ values[corners].mean(axis=1) * np.pi / area.sum()


def _on_disc(samples):
    """Places (n, 2) and values of samples and of their mirror images, the same place once."""
    radius = np.sin(to_angles(samples.wo)[0])
    azimuth = to_angles(samples.wo)[1] - to_angles(samples.wi)[1]
    x, y = radius * np.cos(azimuth), radius * np.sin(azimuth)
    places = np.concatenate([np.stack([x, y], axis=1), np.stack([x, -y], axis=1)]).round(6)
    places, same = np.unique(places, axis=0, return_inverse=True)
    columns = np.concatenate([samples.values, samples.values]).T
    sums = [np.bincount(same, column) for column in columns]
    return places, np.stack(sums, axis=1) / np.bincount(same)[:, None]
