"""The format of the UTIA BRDF database, `.bin`: anisotropic, over the angles of light and view.

[Filip & Vávra 2014] measured the database. A file has three tables of 288 × 288 little-endian
float64, for R, G and B. A row is a direction of light (theta_i, phi_i), a column a direction of
view (theta_v, phi_v). theta takes 0°, 15°, ..., 75°, and phi, which runs faster, 0°, 7.5°, ...,
352.5°. The values are interpolated linearly in the four angles, and extrapolated linearly above
75°. Order and interpolation follow J. Filip's own program, as published in github.com/belcour/alta
(sources/plugins/data_io/utia.cpp) and github.com/asztr/UTIA-brdf.

The unit is not documented. These programs use the stored numbers unchanged, and so does this
module. Other programs convert them: github.com/jdupuy/dj_brdf clamps negative numbers, divides by
140, undoes sRGB's gamma and multiplies by 100; A. Fichet's utia.py only undoes the gamma.
"""

from dataclasses import dataclass
from typing import IO, Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import from_angles, to_angles
from brdfkit.core.geometry.multilinear import find_periodic_bracket, list_corners
from brdfkit.materials.formats._source import Source
from brdfkit.materials.formats._writing import require_measured
from brdfkit.materials.measured import Measured

NAME = "UTIA"
SUFFIXES = (".bin",)

SHAPE = (6, 48, 6, 48)  # numbers of stored angles theta_i, phi_i, theta_v, phi_v
THETA, PHI = np.radians(15) * np.arange(6), np.radians(7.5) * np.arange(48)
SIZE = 3 * 8 * 288 * 288  # size of a file in bytes


def sniff(head: bytes) -> bool:
    """Return False: a UTIA file has no header, so it is recognised by its suffix alone."""
    return False


def read(source: Source) -> Measured:
    """Read a UTIA file as a `Measured` of 82,944 samples, with R, G, B as they are stored.

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
    info = {"format": NAME, "unit": "as stored, which UTIA does not document as sr⁻¹"}
    wi, wo = list_directions()
    lookup = Lookup(raw.reshape(*SHAPE, 3))
    return source.make_measured_from_directions(
        wi, wo, raw, info=info, anisotropic=True, lookup=lookup
    )


def write(obj: object, stream: IO[bytes]) -> None:
    """Write a `Measured` to a UTIA file in linear sRGB; an achromatic one has equal R, G and B.

    It is interpolated, unless it was measured in exactly the directions of the format.
    """
    data = require_measured(obj, NAME, anisotropic=True).rgb
    wi, wo = list_directions()
    samples = data.samples
    values = samples.values
    fits = samples.wi.shape == wi.shape and samples.valid.all()
    if not (fits and np.allclose([samples.wi, samples.wo], [wi, wo], atol=1e-6)):
        values = data.eval(wi, wo)
    values = np.broadcast_to(values, (len(wi), 3))
    stream.write(np.ascontiguousarray(values.T, "<f8").tobytes())


def list_directions() -> tuple[FloatArray, FloatArray]:
    """Return wi and wo of the format's directions, each (82944, 3), in the order of a file."""
    theta_i, phi_i, theta_v, phi_v = np.meshgrid(THETA, PHI, THETA, PHI, indexing="ij")
    wi, wo = from_angles(theta_i, phi_i), from_angles(theta_v, phi_v)
    return wi.reshape(-1, 3), wo.reshape(-1, 3)


@dataclass(frozen=True, eq=False)
class Lookup:
    """A BRDF function that interpolates the stored values linearly in each of the four angles.

    `values`: BRDF at the format's directions, (theta_i, phi_i, theta_v, phi_v, channels).
    """

    values: FloatArray

    def __call__(self, wi: FloatArray, wo: FloatArray) -> FloatArray:
        axes = [part for w in (wi, wo) for part in _find_angle_brackets(*to_angles(w))]
        result: Any = 0.0
        for cells, share in list_corners(axes):
            result = result + share[..., None] * self.values[cells]
        return result


def _find_angle_brackets(theta: FloatArray, phi: FloatArray) -> tuple[Any, Any]:
    """Return the stored angles between which theta and phi [rad] lie, and the weights of both.

    They are brackets as `brdfkit.core.geometry.multilinear` defines them.
    """
    theta = theta / THETA[1]
    i = np.minimum(theta.astype(int), len(THETA) - 2)
    # Beyond 75°, the last stored angle, the weight exceeds 1, which extrapolates linearly
    return (i, i + 1, theta - i), find_periodic_bracket(phi / PHI[1], len(PHI))
