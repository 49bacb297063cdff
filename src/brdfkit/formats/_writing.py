"""What the writers of formats share."""

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.geometry.directions import to_angles
from brdfkit.measured import Measured


def measured(obj, name, anisotropic=False):
    """`obj`, where it is a `Measured` that a format `name` can hold.

    `anisotropic`: whether the format can say so of a material.
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


def angles(samples):
    """theta_i, phi_i, theta_o, phi_o [rad] of `samples`, (4, n)."""
    return np.stack([*to_angles(samples.wi), *to_angles(samples.wo)])


def write_rows(stream, header, columns, delimiter=" "):
    """Text in UTF-8: the lines of `header`, then a row per number of the `columns`, every digit.

    A surrogate, which Python makes of a byte of a file's name that is no UTF-8, becomes "?".
    """
    lines = "".join(f"{line}\n" for line in header)
    stream.write(lines.encode(errors="replace"))
    np.savetxt(stream, np.stack(columns, axis=1), "%.17g", delimiter)
