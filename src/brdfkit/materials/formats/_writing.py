"""Functions that several file formats share: for writing, and for notes on Cornell's files."""

from collections.abc import Iterable, Sequence
from typing import IO

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import to_angles
from brdfkit.materials.measured import Measured
from brdfkit.model.samples import Samples

LARGEST_RATIO = 5  # the brightest sample is suspicious if it exceeds all others by more than this


def require_measured(obj: object, name: str, anisotropic: bool = False) -> Measured:
    """Return `obj`; raise `BrdfkitError` unless it is a `Measured` that the format `name` can hold.

    `anisotropic` says whether the format can hold an anisotropic material.
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


def make_channel_error(obj: Measured, name: str, holds: str, suffix: str = ".npz") -> BrdfkitError:
    """Return the error on a `Measured` whose channels the format `name` cannot hold.

    `holds` says which channels it can hold. The error proposes another format by its `suffix`.
    """
    return BrdfkitError(
        f"the format {name} holds {holds}, and {obj.name} has the channels "
        f"{' '.join(obj.channels)[:80]}; choose another suffix, such as {suffix}."
    )


def compute_angles(samples: Samples) -> FloatArray:
    """Return the angles theta_i, phi_i, theta_o, phi_o (4, n) [rad] of the samples' directions."""
    return np.stack([*to_angles(samples.wi), *to_angles(samples.wo)])


def write_rows(
    stream: IO[bytes],
    header: Iterable[str],
    columns: Sequence[FloatArray],
    delimiter: str = " ",
) -> None:
    """Write the lines of `header`, then the numbers in `columns` (n,) as rows, with all digits."""
    lines = "".join(f"{line}\n" for line in header)
    # The name of a file may have characters that UTF-8 cannot encode: write "?" in their place
    stream.write(lines.encode(errors="replace"))
    np.savetxt(stream, np.stack(columns, axis=1), "%.17g", delimiter)


def note_suspicious_sample(samples: Samples) -> dict[str, str]:
    """Return a note on a sample that is suspiciously bright, or an empty dictionary.

    Such a sample lies at grazing mirror reflection, and is more than 5 times as bright as any
    other. Every file of Cornell's instrument has one.
    """
    samples = samples.at(samples.valid)
    brightest = samples.values.max(axis=1)
    top = int(np.argmax(brightest))
    theta_i, phi_i, theta_s, phi_s = np.degrees(compute_angles(samples))[:, top]
    others = np.delete(brightest, top)
    near_grazing = theta_i > 79.5 and theta_s > 78.5 and abs(abs(phi_s - phi_i) - 180) < 0.5
    if not near_grazing or not others.size or brightest[top] <= LARGEST_RATIO * others.max():
        return {}
    return {
        "suspicious": f"the sample at theta_i {theta_i:.0f}°, theta_s {theta_s:.0f}° in the "
        f"mirror's azimuth is {brightest[top] / others.max():.1f} times the next largest"
    }


def note_missing_views(samples: Samples) -> dict[str, str]:
    """Return a note on views that are missing in a file of Cornell's, or an empty dictionary.

    The instrument measured rings of views: for each theta_i and theta_s, all azimuths up to that of
    the mirror direction. A file that is cut short ends within a ring.
    """
    theta_i, phi_i, theta_s, phi_s = np.round(np.degrees(compute_angles(samples)), 1)
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
