"""UTIA BRDF database: `.bin`, anisotropic, over the angles of light and view.

[Filip & Vávra 2014]. The file has little-endian float64 only: the planes R, G, B, each 288 × 288. A
row is a direction of light (theta_i, phi_i), a column one of view (theta_v, phi_v). theta takes 0°,
15°, ..., 75°, and phi, which runs faster, 0°, 7.5°, ..., 352.5°. The values are interpolated
linearly in the four angles, and extrapolated linearly above 75°. Order and lookup are those of J.
Filip's own program, as published in github.com/belcour/alta (sources/plugins/data_io/utia.cpp) and
github.com/asztr/UTIA-brdf.

The unit is not documented. These programs take the stored numbers as they are, and so does this
reader. Other programs convert them: github.com/jdupuy/dj_brdf clamps negative numbers, divides by
140, undoes sRGB's gamma and multiplies by 100; A. Fichet's utia.py only undoes the gamma.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.geometry.directions import from_angles, to_angles
from brdfkit.core.geometry.multilinear import find_periodic_bracket, list_corners
from brdfkit.materials.formats._writing import require_measured

NAME = "UTIA"
SUFFIXES = (".bin",)

SHAPE = (6, 48, 6, 48)  # theta_i, phi_i, theta_v, phi_v
THETA, PHI = np.radians(15) * np.arange(6), np.radians(7.5) * np.arange(48)
SIZE = 3 * 8 * 288 * 288  # bytes


def sniff(head):
    """Always False: the file has no header; its suffix and its size decide."""
    return False


def read(source):
    """The 82,944 samples as `Measured`, with R, G, B as they are stored, also negative ones.

    Raises `BrdfkitError` for a file of another size or with values that are not finite.
    """
    if len(source.data) != SIZE:
        raise source.error(
            f"has {len(source.data):,} bytes where {SIZE:,} belong, 3 × 288 × 288 doubles; "
            "fetch the file again or rename it, if it is of another format"
        )
    raw = np.frombuffer(source.data, "<f8").reshape(3, -1).T
    finite = np.isfinite(raw).all(axis=1)
    if not finite.all():
        raise source.error(
            f"{(~finite).sum():,} samples are not finite; a UTIA file holds none, so fetch it again"
        )
    info = {
        "format": NAME,
        "unit": "as stored, which UTIA does not document as sr⁻¹",
    }
    wi, wo = directions()
    return source.build_from_directions(
        wi, wo, raw, info=info, anisotropic=True, lookup=Lookup(raw.reshape(*SHAPE, 3))
    )


def write(obj, stream):
    """Write a `Measured`, in linear sRGB; achromatic values are written to each plane.

    Unless it was measured in exactly the format's directions, it is interpolated.
    """
    obj = require_measured(obj, NAME, anisotropic=True).rgb
    wi, wo = directions()
    samples = obj.samples
    own = samples.wi.shape == wi.shape and samples.valid.all()
    if own and np.allclose([samples.wi, samples.wo], [wi, wo], atol=1e-6):
        values = samples.values
    else:
        values = obj.eval(wi, wo)
    values = np.broadcast_to(values, (len(wi), 3))
    stream.write(np.ascontiguousarray(values.T, "<f8").tobytes())


def directions():
    """(wi, wo) of the samples, each (82944, 3), in the order of the file."""
    theta_i, phi_i, theta_v, phi_v = np.meshgrid(THETA, PHI, THETA, PHI, indexing="ij")
    wi, wo = from_angles(theta_i, phi_i), from_angles(theta_v, phi_v)
    return wi.reshape(-1, 3), wo.reshape(-1, 3)


@dataclass(frozen=True, eq=False)
class Lookup:
    """The lookup in `values` (theta_i, phi_i, theta_v, phi_v, channels), linear in each angle."""

    values: np.ndarray

    def __call__(self, wi, wo):
        axes = [part for w in (wi, wo) for part in _bracket(*to_angles(w))]
        result = 0.0
        for cells, share in list_corners(axes):
            result = result + share[..., None] * self.values[cells]
        return result


def _bracket(theta, phi):
    """The brackets (`geometry.multilinear`) of theta and of phi among the stored angles."""
    theta = theta / THETA[1]
    i = np.minimum(theta.astype(int), len(THETA) - 2)
    # Beyond 75° the share exceeds 1: linear extrapolation
    return (i, i + 1, theta - i), find_periodic_bracket(phi / PHI[1], len(PHI))
