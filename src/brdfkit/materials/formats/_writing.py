"""Functions that the writers of formats share: what they accept, angles, rows of text."""

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import to_angles
from brdfkit.materials.measured import Measured


def require_measured(obj, name, anisotropic=False):
    """`obj`, if it is a `Measured` that the format `name` can hold; otherwise a `BrdfkitError`.

    `anisotropic`: whether the format can hold an anisotropic material.
    """
    if not isinstance(obj, Measured):
        raise BrdfkitError(
            f"the format {name} holds a measured material, not a {type(obj).__name__}; "
            "choose another suffix."
        )
    if obj.anisotropic and not anisotropic:
        raise BrdfkitError(
            f"the format {name} holds isotropic materials, and {obj.name} is anisotropic; "
            "choose another suffix, such as .npz."
        )
    return obj


def sample_angles(samples):
    """theta_i, phi_i, theta_o, phi_o (4, n) [rad] of `Samples`."""
    return np.stack([*to_angles(samples.wi), *to_angles(samples.wo)])


def write_rows(stream, header, columns, delimiter=" "):
    """Write text in UTF-8: the lines of `header`, then rows of the numbers in `columns`, with all
    their digits.

    Python reads a byte of a file's name that is no UTF-8 as a surrogate; it is written as "?".
    """
    lines = "".join(f"{line}\n" for line in header)
    stream.write(lines.encode(errors="replace"))
    np.savetxt(stream, np.stack(columns, axis=1), "%.17g", delimiter)
