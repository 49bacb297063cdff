"""Fits, as brdfkit saves them: JSON with the model, its values and how they were found."""

import json
from dataclasses import fields
from typing import get_args, get_origin

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.version import __version__
from brdfkit.model import labels
from brdfkit.regression.certainty import Certainty
from brdfkit.regression.light import Albedo
from brdfkit.regression.result import Fit

NAME = "brdfkit fit"
SUFFIXES = (".json",)
KEY = "brdfkit"
FIELDS = [f for f in fields(Fit) if f.name not in ("model", "certainty", "albedo")]
# What fits of earlier versions lack
LATER = ("checksum", "versions", "effective_samples", "unrepresented")
# What is raised where an entry is of another kind, or missing, or too large for a float
DAMAGED = ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError


def sniff(head):
    """Whether `head` begins as JSON with brdfkit's version."""
    return head.lstrip().startswith(b"{") and f'"{KEY}"'.encode() in head[:200]


def read(source):
    """The `Fit` that `write` wrote."""
    try:
        record = json.loads(source.data)
        version = _to_type(str, record[KEY])
        label, values = _to_type(str, record["model"]), dict(record["parameters"])
        given = record["fit"]
        there = [f for f in FIELDS if f.name in given or f.name not in LATER]
        found = {f.name: _to_type(f.type, given[f.name]) for f in there}
        found["settings"] = _to_settings(found["settings"])
        found["certainty"] = _to_certainty(given.get("certainty"))
        found["albedo"] = _to_albedo(given.get("albedo"))
    except DAMAGED:
        if source.data.lstrip().startswith(b'{"kind"'):
            raise source.error("is a distance field; load it by brdfkit.distance_fields") from None
        raise source.error("is no fit that brdfkit saved, or is damaged; fit it again") from None
    if _is_newer(version):
        raise source.error(
            f"was saved by brdfkit {version[:20]}, and this is {__version__}: update brdfkit"
        )
    try:
        return Fit(model=labels.model(label)(**values), **found)
    except (BrdfkitError, TypeError, OverflowError) as error:
        if not labels.is_label(label):
            raise source.error(
                f"is a fit of {label[:80]!r}, a model of somebody's own; load its file first, "
                'brdfkit.load_models("FILE.py"), or name it before the fit'
            ) from None
        reason = str(error)[:200].rstrip(".")
        raise source.error(f"cannot be restored ({reason}); fit it again") from None


def write(fit, stream):
    """Write a `Fit` into a binary stream."""
    if not isinstance(fit, Fit):
        raise BrdfkitError(
            f"the format {NAME} holds a fit, not a {type(fit).__name__}; choose another suffix."
        )
    values = {f.name: getattr(fit, f.name) for f in FIELDS}
    record = {
        KEY: __version__,
        "model": fit.model.label(),
        "parameters": fit.model.arguments,
        "fit": values
        | {"certainty": _from_certainty(fit.certainty)}
        | {"albedo": fit.albedo and vars(fit.albedo)},
    }
    stream.write(json.dumps(record, indent=2).encode() + b"\n")


def _from_certainty(certainty):
    """A `Certainty` for JSON: of its symmetric covariance a text per row, up to the diagonal."""
    if certainty is None:
        return None
    rows = certainty.covariance
    lower = [" ".join(map(repr, row[: k + 1])) for k, row in enumerate(rows)]
    return {**vars(certainty), "covariance": lower}


def _to_certainty(record):
    """The `Certainty` of `_from_certainty`; fits of earlier versions have none."""
    if record is None:
        return None
    names = _to_type(tuple[str, ...], record["names"])
    lower = [tuple(map(float, row.split())) for row in record["covariance"]]
    if [len(row) for row in lower] != [*range(1, len(names) + 1)]:
        raise ValueError
    size = range(len(names))
    rows = tuple(tuple(lower[max(i, j)][min(i, j)] for j in size) for i in size)
    freedom = tuple(map(float, record["freedom"]))
    if len(freedom) != len(names):
        raise ValueError
    said = (_to_type(tuple[str, ...], record[name]) for name in ("undetermined", "trades"))
    counts = (_to_type(int, record[name]) for name in ("numbers", "parameters"))
    return Certainty(names, rows, freedom, *said, *counts)


def _to_albedo(record):
    """The `Albedo` of its attributes; fits of earlier versions have none."""
    if record is None:
        return None
    angles, fit, measured = (_to_type(tuple, record[n]) for n in ("theta_i", "fit", "measured"))
    rows = [None if row is None else tuple(map(float, row)) for row in (*fit, *measured)]
    lengths = {len(row) for row in rows if row is not None}
    if not len(angles) == len(fit) == len(measured) or len(lengths) != 1:
        raise ValueError
    if None in fit or 0 in lengths:
        raise ValueError
    peak = record.get("peak")
    if peak is not None:
        peak = tuple(map(float, _to_type(tuple, peak)))
        if len(peak) != 2:
            raise ValueError
    return Albedo(tuple(map(float, angles)), tuple(rows[: len(fit)]), tuple(rows[len(fit) :]), peak)


def _to_settings(settings):
    """The settings of a fit, whose bounds are pairs of numbers."""
    if bounds := settings.get("bounds"):
        settings |= {"bounds": {n: tuple(map(float, pair)) for n, pair in bounds.items()}}
    return settings


def _is_newer(version):
    """Whether a version, as 1.2.3, is a later one than this."""
    numbers = ([int(part) for part in v.split(".")[:2]] for v in (version, __version__))
    try:
        theirs, ours = numbers
    except ValueError:  # of a version between two
        return False
    return theirs > ours


def _to_type(kind, value):
    """A value of JSON as the type `kind`, which `Fit` declares, or a TypeError."""
    origin, of = get_origin(kind) or kind, get_args(kind)
    if isinstance(value, list) and origin is tuple:
        if of[1:] == (...,) and not all(isinstance(part, of[0]) for part in value):
            raise TypeError
        return tuple(value)
    if origin in (int, float) and isinstance(value, int):
        return origin(float(value))  # which a number too large for one is not
    if not isinstance(value, origin):
        raise TypeError
    return value
