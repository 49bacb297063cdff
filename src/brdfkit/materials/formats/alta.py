"""The text format of ALTA, `.dat`: a header of lines ``#KEY value``, then one row per sample.

[Belcour et al. 2014] published ALTA. Its files `sources/core/data_storage.cpp` and `params.cpp`
(github.com/belcour/alta) read these keys:

- ``DIM``: the numbers of coordinates and of values in a row;
- ``PARAM_IN``: the kind of coordinates, in whose names L is the light and V the view;
- ``PARAM_OUT``: the kind of values. INV_STERADIAN_COSINE_FACTOR stands for the BRDF times cos
  theta_v: known files become reciprocal if they are divided by it, but not by cos theta_l;
- ``VS``: the kind of confidence interval of each value. 0 stands for none, 1 for one column behind
  the values with half the width, 2 for two columns with the ends. A single number belongs to the
  first value; the others have 0. Half the width is read as the standard error, because files do not
  state the confidence level.

A file with three coordinates is isotropic; one with four is anisotropic if the second coordinate,
an azimuth, varies.
"""

import re
from collections.abc import Callable, Sequence
from typing import IO

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.colours import RGB
from brdfkit.core.geometry.directions import from_angles, from_half_difference
from brdfkit.materials.formats._source import SPHERICAL, Source
from brdfkit.materials.formats._writing import compute_angles, require_measured, write_rows
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.conventions import DIVIDED, compute_view_cosines

NAME = "ALTA"
SUFFIXES = (".dat",)

CHANNELS = {1: ("Y",), 3: RGB}
COSINE = "INV_STERADIAN_COSINE_FACTOR"
PLAIN = ("INV_STERADIAN", "RGB_COLOR")
UNSTATED = "UNKNOWN_OUTPUT"


QUARTER, FULL = np.pi / 2, 2 * np.pi
Directions = tuple[FloatArray, FloatArray]  # unit vectors to light and view, both (n, 3)


def _make_directions_from_projection(
    theta_l: FloatArray, x: FloatArray, y: FloatArray
) -> Directions:
    return from_angles(theta_l, 0), from_angles(np.hypot(x, y), np.arctan2(y, x))


def _make_directions_from_angles(
    theta_l: FloatArray, phi_l: FloatArray, theta_v: FloatArray, phi_v: FloatArray | float
) -> Directions:
    return from_angles(theta_l, phi_l), from_angles(theta_v, phi_v)


def _make_directions_from_half_difference(
    theta_h: FloatArray, phi_h: FloatArray | float, theta_d: FloatArray, phi_d: FloatArray
) -> Directions:
    view, light = from_half_difference(theta_h, theta_d, phi_d, phi_h)
    return light, view


# For each kind of coordinates, by its name in the file: the coordinates' largest absolute values
# [rad], and the function that converts them to directions
PARAM_IN: dict[str, tuple[tuple[float, ...], Callable[..., Directions]]] = {
    "SPHERICAL_TL_PL_TV_PV": (SPHERICAL, _make_directions_from_angles),
    "ISOTROPIC_TL_TV_PROJ_DPHI": ((QUARTER,) * 3, _make_directions_from_projection),
    "ISOTROPIC_TV_TL_DPHI": (
        (QUARTER, QUARTER, FULL),
        lambda theta_v, theta_l, phi: _make_directions_from_angles(theta_l, phi, theta_v, 0),
    ),
    "RUSIN_TH_PH_TD_PD": (SPHERICAL, _make_directions_from_half_difference),
    "RUSIN_TH_TD_PD": (
        (QUARTER, QUARTER, FULL),
        lambda theta_h, theta_d, phi_d: _make_directions_from_half_difference(
            theta_h, 0, theta_d, phi_d
        ),
    ),
}


def sniff(head: bytes) -> bool:
    """Return whether a file that begins with `head` is ALTA's, by a line such as ``#DIM 3 1``."""
    return re.search(rb"^#DIM\s+\d", head, re.MULTILINE) is not None


def read(source: Source) -> Measured:
    """Read an ALTA file as a `Measured` with one channel Y, or with R, G, B.

    Raises `BrdfkitError` for a binary file, a missing key, coordinates that do not give both
    directions, values that are no BRDF, or a row with another number of columns.
    """
    header: dict[str, str] = {}
    for comment in source.comments:
        key, _, text = comment.partition(" ")
        header.setdefault(key, text.strip().strip('"'))
    coordinates, channels = _read_dimensions(source, header)
    intervals = _read_intervals(source, header.get("VS", "0"), len(channels))
    limits, to_directions = PARAM_IN[header["PARAM_IN"]]

    # Split each row into coordinates, values and the columns of the confidence intervals
    data = source.parse_rows(source.lines, coordinates + len(channels) + sum(intervals))
    where, values, ends = np.split(data, [coordinates, coordinates + len(channels)], axis=1)
    source.require_radians([n for n, _ in source.lines], where, limits)
    # Convert to directions, BRDF values and standard errors
    wi, wo = to_directions(*where.T)
    factor, valid, notes = _find_value_factor(source, header, wo)
    # Ignore overflow here: values that are not finite are masked later
    with np.errstate(over="ignore", invalid="ignore"):
        values = values / factor
        errors = _compute_half_widths(ends / factor, intervals)
    return source.make_measured_from_directions(
        wi,
        wo,
        values,
        valid,
        channels,
        info={"format": NAME, **header, **notes},
        anisotropic=coordinates == 4 and np.ptp(where[:, 1]) > 0,
        standard_error=errors,
    )


def write(obj: object, stream: IO[bytes]) -> None:
    """Write the valid samples of a `Measured` to an ALTA file, in linear sRGB or achromatic."""
    data = require_measured(obj, NAME, anisotropic=True).rgb
    samples, valid = data.samples.at(data.samples.valid), data.samples.valid
    theta_l, phi_l, theta_v, phi_v = where = compute_angles(samples)
    name = "SPHERICAL_TL_PL_TV_PV"
    if not data.anisotropic:
        phi = phi_v - phi_l
        name = "ISOTROPIC_TL_TV_PROJ_DPHI"
        where = np.stack([theta_l, theta_v * np.cos(phi), theta_v * np.sin(phi)])
    channels = len(data.channels)
    columns, interval = [*where, *samples.values.T], "0"
    errors = None if data.standard_error is None else data.standard_error[valid]
    # Leave out standard errors if any is not finite, because `read` would mask the samples with it
    if errors is not None and np.isfinite(errors).all():
        columns += [*errors.T]
        interval = " ".join(["1"] * channels)
    header = [
        f"SAMPLE {' '.join(data.name.split())}",
        f"DIM {len(where)} {channels}",
        f"VS {interval}",
        f"PARAM_IN {name}",
        f"PARAM_OUT {'INV_STERADIAN' if channels == 1 else 'RGB_COLOR'}",
    ]
    write_rows(stream, [f"#{line}" for line in header], columns)


def _read_dimensions(source: Source, header: dict[str, str]) -> tuple[int, tuple[str, ...]]:
    """Return the number of coordinates, and the names of the channels, that a header states."""
    if header.get("FORMAT") == "binary":
        raise source.error("is ALTA's binary form; save it as text with ALTA's data2data")
    dimensions = header.get("DIM", "").split()
    if len(dimensions) != 2 or not all(re.fullmatch("[0-9]{1,4}", d) for d in dimensions):
        raise source.error("has no line such as '#DIM 3 1', coordinates and values; add it")
    coordinates, values = map(int, dimensions)
    name = header.get("PARAM_IN")
    if name not in PARAM_IN:
        raise source.error(
            f"PARAM_IN is {str(name)[:40]}, which does not give both directions or is not read; "
            f"convert it to one of {', '.join(PARAM_IN)}"
        )
    belong = len(PARAM_IN[name][0])
    if coordinates != belong or values not in CHANNELS:
        raise source.error(
            f"DIM says {coordinates} coordinates and {values} values where {belong} belong to "
            f"{name}, and 1 or 3 values; mend the line"
        )
    return coordinates, CHANNELS[values]


def _read_intervals(source: Source, text: str, channels: int) -> list[int]:
    """Return the number of interval columns of each channel, 0 to 2, from the header's key VS.

    `text` is the value of the key.
    """
    kinds = text.split()
    if len(kinds) > channels or not all(kind in ("0", "1", "2") for kind in kinds):
        raise source.error(f"VS is {text[:40]!r} where 0, 1 or 2 per value belong; mend the line")
    return [int(kind) for kind in kinds] + [0] * (channels - len(kinds))


def _compute_half_widths(columns: FloatArray, intervals: Sequence[int]) -> FloatArray | None:
    """Return half the width (n, channels) of each confidence interval, or None if any is missing.

    `intervals` has the number of `columns` of each channel: 1 with half the width, or 2 with the
    ends.
    """
    if not all(intervals):
        return None
    each = np.split(columns, np.cumsum(intervals)[:-1], axis=1)
    halves = [c[:, 0] if c.shape[1] == 1 else (c[:, 1] - c[:, 0]) / 2 for c in each]
    return np.abs(np.stack(halves, axis=1))


def _find_value_factor(
    source: Source, header: dict[str, str], wo: FloatArray
) -> tuple[FloatArray | float, BoolArray | bool, dict[str, str]]:
    """Return the factor (n, 1) by which to divide a file's values to get the BRDF.

    It is 1 or the cosine of the views `wo` (n, 3), as the header's key PARAM_OUT states. The second
    result is a mask (n,) of the rows where the division is possible; the third are notes.
    """
    stated = header.get("PARAM_OUT")
    if stated == COSINE:
        factor, low = compute_view_cosines(wo)
        notes = dict(DIVIDED)
        if low.any():
            notes["masked"] = f"{low.sum():,} rows with the view at the horizon"
        return factor, ~low, notes
    if stated in PLAIN:
        return 1, True, {}
    if stated is None or stated == UNSTATED:
        note = f"not stated; the values are taken for the BRDF: if they hold a cosine, add {COSINE}"
        return 1, True, {"PARAM_OUT": note}
    raise source.error(
        f"PARAM_OUT is {stated[:40]}, which is no BRDF in sr⁻¹ or RGB; convert the values"
    )
