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


SUSPICIOUS = 5  # times the next largest value


def note_lone_point(samples):
    """A note, by its key, if one sample at grazing mirror reflection stands out; otherwise none.

    It is more than 5 times as bright as any other. Every file of Cornell's instrument has one.
    """
    samples = samples.at(samples.valid)
    brightest = samples.values.max(axis=1)
    top = int(np.argmax(brightest))
    theta_i, phi_i, theta_s, phi_s = np.degrees(sample_angles(samples))[:, top]
    others = np.delete(brightest, top)
    near_grazing = theta_i > 79.5 and theta_s > 78.5 and abs(abs(phi_s - phi_i) - 180) < 0.5
    if not near_grazing or not others.size or brightest[top] <= SUSPICIOUS * others.max():
        return {}
    return {
        "suspicious": f"the sample at theta_i {theta_i:.0f}°, theta_s {theta_s:.0f}° in the "
        f"mirror's azimuth is {brightest[top] / others.max():.1f} times the next largest"
    }


def note_short_rings(samples):
    """A note, by its key, if rings of views leave out the mirror's azimuth; otherwise none.

    A ring is the samples with one theta_i and one theta_s. Cornell's instrument measured every ring
    up to Δφ = 180°. Its files are sorted so that a file that is cut short ends within a ring.
    """
    theta_i, phi_i, theta_s, phi_s = np.round(np.degrees(sample_angles(samples)), 1)
    mirror = np.abs(np.mod(phi_s - phi_i, 360) - 180) < 0.5
    tilted = theta_s > 0.5
    rings = set(zip(theta_i[tilted], theta_s[tilted], strict=True))
    whole = set(zip(theta_i[mirror & tilted], theta_s[mirror & tilted], strict=True))
    short = len(rings - whole)
    if not short:
        return {}
    return {
        "incomplete": f"{short} of {len(rings)} rings of views stop short of the mirror's azimuth: "
        "the file is cut short, or was not measured in Cornell's pattern"
    }
