"""ALTA's text, `.dat`: a header of lines ``#KEY value``, then a row of numbers per sample.

[Belcour et al. 2014]. The keys are those that `sources/core/data_storage.cpp` and `params.cpp` of
github.com/belcour/alta read:

- ``DIM``: how many coordinates and how many values a row has;
- ``PARAM_IN``: what the coordinates are, L the light and V the view;
- ``PARAM_OUT``: what the values are; INV_STERADIAN_COSINE_FACTOR is the BRDF times cos theta_v
  (divided by it, the real files are reciprocal; divided by cos theta_l, they are not);
- ``VS``: a number per value that tells of its interval: 0 for none, 1 for one column behind the
  values with half its width, 2 for two columns with its ends. A single number is that of the first
  value; the others have 0. Half the width is read as the standard error; files do not state the
  confidence level.

A file with three coordinates is isotropic; one with four is anisotropic if the second of them, an
azimuth, varies.
"""

import re

import numpy as np

from brdfkit.core.colours import RGB
from brdfkit.materials.formats._alta_coordinates import PARAM_IN
from brdfkit.materials.formats._writing import require_measured, sample_angles, write_rows
from brdfkit.materials.measured.conventions import DIVIDED, find_cosines

NAME = "ALTA"
SUFFIXES = (".dat",)

CHANNELS = {1: ("Y",), 3: RGB}
COSINE = "INV_STERADIAN_COSINE_FACTOR"
PLAIN = ("INV_STERADIAN", "RGB_COLOR")
UNSTATED = (None, "UNKNOWN_OUTPUT")


def sniff(head):
    """Whether a line of `head` gives the dimensions, as ``#DIM 3 1``."""
    return re.search(rb"^#DIM\s+\d", head, re.MULTILINE) is not None


def read(source):
    """The samples as `Measured`, of one channel Y or of R, G, B.

    Raises `BrdfkitError` for a binary file, a missing key, coordinates that do not give both
    directions, values that are no BRDF, or a row with other columns.
    """
    # The header
    header = {}
    for comment in source.comments:
        key, _, text = comment.partition(" ")
        header.setdefault(key, text.strip().strip('"'))
    coordinates, channels = _read_dimensions(source, header)
    intervals = _read_intervals(source, header.get("VS", "0"), len(channels))
    limits, directions = PARAM_IN[header["PARAM_IN"]]
    if not source.lines:
        raise source.error("has no rows behind its header; fetch the file again")

    # The rows: coordinates, values, intervals
    columns = coordinates + len(channels) + sum(intervals)
    data = np.array([source.parse_numbers(n, line.split(), columns) for n, line in source.lines])
    where, values, ends = np.split(data, [coordinates, coordinates + len(channels)], axis=1)
    source.require_radians([n for n, _ in source.lines], where, limits)
    # The BRDF and its standard errors
    wi, wo = directions(*where.T)
    factor, valid, notes = _find_factor(source, header, wo)
    with np.errstate(
        over="ignore", invalid="ignore"
    ):  # values that are not finite are masked later
        values = values / factor
        errors = _halve(ends / factor, intervals)
    return source.build_from_directions(
        wi,
        wo,
        values,
        valid,
        channels,
        info={"format": NAME, **header, **notes},
        anisotropic=coordinates == 4 and np.ptp(where[:, 1]) > 0,
        standard_error=errors,
    )


def write(obj, stream):
    """Write the valid samples of a `Measured`, in linear sRGB or achromatic, to the last digit."""
    obj = require_measured(obj, NAME, anisotropic=True).rgb
    samples, valid = obj.samples, obj.samples.valid
    theta_l, phi_l, theta_v, phi_v = where = sample_angles(samples.at(valid))
    name = "SPHERICAL_TL_PL_TV_PV"
    if not obj.anisotropic:
        phi = phi_v - phi_l
        name = "ISOTROPIC_TL_TV_PROJ_DPHI"
        where = theta_l, theta_v * np.cos(phi), theta_v * np.sin(phi)
    channels = len(obj.channels)
    columns, interval = [*where, *samples.values[valid].T], "0"
    errors = None if obj.standard_error is None else obj.standard_error[valid]
    if (
        errors is not None and np.isfinite(errors).all()
    ):  # otherwise a reader would mask the values, too
        columns += [*errors.T]
        interval = " ".join(["1"] * channels)
    header = [
        f"SAMPLE {' '.join(obj.name.split())}",
        f"DIM {len(where)} {channels}",
        f"VS {interval}",
        f"PARAM_IN {name}",
        f"PARAM_OUT {'INV_STERADIAN' if channels == 1 else 'RGB_COLOR'}",
    ]
    write_rows(stream, [f"#{line}" for line in header], columns)


def _read_dimensions(source, header):
    """The number of coordinates, and the channels."""
    if header.get("FORMAT") == "binary":
        raise source.error("is ALTA's binary form; save it as text with ALTA's data2data")
    dimensions = header.get("DIM", "").split()
    if len(dimensions) != 2 or not all(re.fullmatch("[0-9]{1,4}", d) for d in dimensions):
        raise source.error("has no line such as '#DIM 3 1', coordinates and values; add it")
    coordinates, values = map(int, dimensions)
    given = header.get("PARAM_IN")
    if given not in PARAM_IN:
        raise source.error(
            f"PARAM_IN is {str(given)[:40]}, which does not tell both directions or is not read; "
            f"convert it to one of {', '.join(PARAM_IN)}"
        )
    belong = len(PARAM_IN[given][0])
    if coordinates != belong or values not in CHANNELS:
        raise source.error(
            f"DIM says {coordinates} coordinates and {values} values where {belong} belong to "
            f"{given}, and 1 or 3 values; mend the line"
        )
    return coordinates, CHANNELS[values]


def _read_intervals(source, text, channels):
    """How many columns each channel has behind the values: 0, 1 or 2."""
    kinds = text.split()
    if len(kinds) > channels or not all(kind in ("0", "1", "2") for kind in kinds):
        raise source.error(f"VS is {text[:40]!r} where 0, 1 or 2 per value belong; mend the line")
    return [int(kind) for kind in kinds] + [0] * (channels - len(kinds))


def _halve(columns, intervals):
    """Half the width (n, channels) of each interval; None unless every channel has one."""
    if not all(intervals):
        return None
    each = np.split(columns, np.cumsum(intervals)[:-1], axis=1)
    halves = [c[:, 0] if c.shape[1] == 1 else (c[:, 1] - c[:, 0]) / 2 for c in each]
    return np.abs(np.stack(halves, axis=1))


def _find_factor(source, header, wo):
    """The factor (n, 1) of the BRDF in the file's values, the rows in which it can be divided out,
    and notes."""
    stated = header.get("PARAM_OUT")
    if stated == COSINE:
        factor, low = find_cosines(wo)
        notes = dict(DIVIDED)
        if low.any():
            notes["masked"] = f"{low.sum():,} rows with the view at the horizon"
        return factor, ~low, notes
    if stated in PLAIN:
        return 1, True, {}
    if stated in UNSTATED:
        note = f"not stated; the values are taken for the BRDF: if they hold a cosine, add {COSINE}"
        return 1, True, {"PARAM_OUT": note}
    raise source.error(
        f"PARAM_OUT is {stated[:40]}, which is no BRDF in sr⁻¹ or RGB; convert the values"
    )
