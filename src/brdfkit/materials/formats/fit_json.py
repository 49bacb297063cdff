"""The format of saved fits, `.json`: the model, its values, and how they were found."""

import json
from dataclasses import fields
from typing import IO, Any, get_args, get_origin, get_type_hints

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.version import __version__
from brdfkit.materials.formats._source import Source
from brdfkit.model import labels
from brdfkit.regression.albedo import Albedo
from brdfkit.regression.certainty import Certainty
from brdfkit.regression.result import Fit

NAME = "brdfkit fit"
SUFFIXES = (".json",)
VERSION_KEY = "brdfkit"
TYPES = get_type_hints(Fit)
FIELDS = [f.name for f in fields(Fit) if f.name not in ("model", "certainty", "albedo")]
# Attributes of a `Fit` that files written by earlier versions of brdfkit lack
LATER_FIELDS = ("checksum", "versions", "effective_samples", "unrepresented")
# Errors that reading a damaged file raises: for an entry of another type, for a missing entry, for
# a huge number, or for deep nesting
DAMAGED = ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError


def sniff(head: bytes) -> bool:
    """Return whether a file that begins with `head` is a saved fit: JSON with brdfkit's version."""
    return head.lstrip().startswith(b"{") and f'"{VERSION_KEY}"'.encode() in head[:200]


def read(source: Source) -> Fit:
    """Read a `Fit` from a file that `write` wrote.

    Raises `BrdfkitError` for any other or a damaged file, for a file of a later version, and for a
    fit of a model that is not loaded.
    """
    try:
        record = json.loads(source.data)
        version = _convert_to_type(str, record[VERSION_KEY])
        label, values = _convert_to_type(str, record["model"]), dict(record["parameters"])
        entries = record["fit"]
        stored = [name for name in FIELDS if name in entries or name not in LATER_FIELDS]
        details = {name: _convert_to_type(TYPES[name], entries[name]) for name in stored}
        details["settings"] = _parse_bounds_in_settings(details["settings"])
        details["certainty"] = _parse_certainty(entries.get("certainty"))
        details["albedo"] = _parse_albedo(entries.get("albedo"))
    except DAMAGED:
        if source.data.lstrip().startswith(b'{"kind"'):
            raise source.error("is a distance field; load it by brdfkit.distance_fields") from None
        raise source.error("is no fit that brdfkit saved, or is damaged; fit it again") from None
    if _is_newer_version(version):
        raise source.error(
            f"was saved by brdfkit {version[:20]}, and this is {__version__}: update brdfkit"
        )
    try:
        return Fit(model=labels.model(label)(**values), **details)
    except (BrdfkitError, TypeError, OverflowError) as error:
        if not labels.is_label(label):
            raise source.error(
                f"is a fit of {label[:80]!r}, a model of somebody's own; load its file first, "
                'brdfkit.load_plugins("FILE.py"), or name it before the fit'
            ) from None
        reason = str(error)[:200].rstrip(".")
        raise source.error(f"cannot be restored ({reason}); fit it again") from None


def write(fit: object, stream: IO[bytes]) -> None:
    """Write a `Fit` to a binary stream as JSON."""
    if not isinstance(fit, Fit):
        raise BrdfkitError(
            f"the format {NAME} holds a fit, not a {type(fit).__name__}; choose another suffix."
        )
    values = {name: getattr(fit, name) for name in FIELDS}
    record = {
        VERSION_KEY: __version__,
        "model": fit.model.label(),
        "parameters": fit.model.arguments,
        "fit": values
        | {"certainty": _certainty_to_record(fit.certainty)}
        | {"albedo": fit.albedo and vars(fit.albedo)},
    }
    stream.write(json.dumps(record, indent=2).encode() + b"\n")


def _certainty_to_record(certainty: Certainty | None) -> dict[str, Any] | None:
    """Convert a `Certainty`, the uncertainty of a fit, to a dictionary for JSON.

    Each row of the symmetric covariance becomes a text with its numbers up to the diagonal.
    """
    if certainty is None:
        return None
    rows = certainty.covariance
    lower = [" ".join(map(repr, row[: k + 1])) for k, row in enumerate(rows)]
    return {**vars(certainty), "covariance": lower}


def _parse_certainty(record: dict[str, Any] | None) -> Certainty | None:
    """Convert a dictionary from JSON back to a `Certainty`, the uncertainty of a fit.

    It is None in fits of earlier versions. Raises `ValueError` and others for a damaged one.
    """
    if record is None:
        return None
    names = _convert_to_type(tuple[str, ...], record["names"])
    lower = [tuple(map(float, row.split())) for row in record["covariance"]]
    if [len(row) for row in lower] != [*range(1, len(names) + 1)]:
        raise ValueError
    size = range(len(names))
    rows = tuple(tuple(lower[max(i, j)][min(i, j)] for j in size) for i in size)
    freedom = tuple(map(float, record["freedom"]))
    if len(freedom) != len(names):
        raise ValueError
    sentences = (
        _convert_to_type(tuple[str, ...], record[name]) for name in ("undetermined", "trades")
    )
    counts = (_convert_to_type(int, record[name]) for name in ("numbers", "parameters"))
    return Certainty(names, rows, freedom, *sentences, *counts)


def _parse_albedo(record: dict[str, Any] | None) -> Albedo | None:
    """Convert a dictionary from JSON to an `Albedo`, the albedos of a fit and its measurement.

    It is None in fits of earlier versions. Raises `ValueError` and others for a damaged one.
    """
    if record is None:
        return None
    angles, fit, measured = (
        _convert_to_type(tuple, record[n]) for n in ("theta_i", "fit", "measured")
    )
    rows: list[Any] = [None if row is None else tuple(map(float, row)) for row in (*fit, *measured)]
    lengths = {len(row) for row in rows if row is not None}
    if not len(angles) == len(fit) == len(measured) or len(lengths) != 1:
        raise ValueError
    if None in fit or 0 in lengths:
        raise ValueError
    peak = record.get("peak")
    if peak is not None:
        peak = tuple(map(float, _convert_to_type(tuple, peak)))
        if len(peak) != 2:
            raise ValueError
    return Albedo(tuple(map(float, angles)), tuple(rows[: len(fit)]), tuple(rows[len(fit) :]), peak)


def _parse_bounds_in_settings(settings: dict[str, Any]) -> dict[str, Any]:
    """Convert the bounds in a fit's settings from JSON lists to pairs of floats."""
    if bounds := settings.get("bounds"):
        settings |= {"bounds": {n: tuple(map(float, pair)) for n, pair in bounds.items()}}
    return settings


def _is_newer_version(version: str) -> bool:
    """Return whether a version of brdfkit, such as 1.2.3, is later than the one that runs."""
    numbers = ([int(part) for part in v.split(".")[:2]] for v in (version, __version__))
    try:
        theirs, ours = numbers
    except ValueError:  # a development version, which contains words, cannot be compared
        return False
    return theirs > ours


def _convert_to_type(kind: Any, value: Any) -> Any:
    """Convert a value from JSON to the type `kind` of a `Fit`'s attribute.

    Lists become tuples, and whole numbers floats. Raises `TypeError` for a value of another type.
    """
    origin, parts = get_origin(kind) or kind, get_args(kind)
    if isinstance(value, list) and origin is tuple:
        if parts[1:] == (...,) and not all(isinstance(part, parts[0]) for part in value):
            raise TypeError
        return tuple(value)
    if origin in (int, float) and isinstance(value, int):
        # Convert to a float first, which raises OverflowError for a number that is too large
        return origin(float(value))
    if not isinstance(value, origin):
        raise TypeError
    return value
