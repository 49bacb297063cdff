"""Files of transfer functions: brdfkit's JSON, Slicer's presets, and the shipped presets.

The JSON has the fields of `TransferFunction`. A function of values alone has ``"points"``, rows
(value, R, G, B, A). A function of values and gradient magnitudes has ``"values"``, ``"gradients"``
and ``"rgba"``; or, shorter to write by hand, ``"points"`` with a ``"gradient_ramp"``, rows
(gradient magnitude, factor of A); or the arguments of `from_boundaries`: ``"boundaries"``, rows
(value, steepest gradient, R, G, B, A), ``"thickness"`` and ``"range"``.
"""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.files import read_bytes, write_safely
from brdfkit.core.names import to_printable
from brdfkit.volumes.transfer import slicer_presets

KIND = "brdfkit transfer function"  # the field "kind" of each file
WORDS = "colour", "value_unit", "length_unit", "name"  # the fields that contain text
ALLOWED = {"kind", "extinction", "points", "gradient_ramp", "values", "gradients", "rgba", *WORDS}
ALLOWED |= {"boundaries", "thickness", "range"}


def list_presets() -> dict[str, Path]:
    """Return the presets of transfer functions that come with brdfkit, as {name: file}."""
    folder = Path(__file__).with_name("presets")
    return {path.stem: path for path in sorted(folder.glob("*.json"))}


def load_transfer_function(cls: Any, path: str | os.PathLike[str]) -> Any:
    """Load a transfer function, of the class `cls`, from a file or by the name of a preset."""
    text, presets = os.fspath(path), list_presets()
    xml, _, name = text.partition("#")
    if text not in presets and xml.lower().endswith(".xml"):
        return slicer_presets.read_preset(cls, Path(xml), name)
    file = presets.get(text, Path(text))
    if not file.suffix and not file.exists():
        raise no_such_error("transfer function", text, presets)
    return parse_json(cls, read_bytes(file), file)


def save_transfer_function(function: Any, path: str | os.PathLike[str]) -> None:
    """Write a transfer function to a .json file."""
    if Path(path).suffix.lower() != ".json":
        raise BrdfkitError(f"{path}: transfer functions are written as .json; choose that suffix.")
    with write_safely(path) as beside:
        beside.write_text(format_json(function), encoding="utf-8")


def format_json(function: Any) -> str:
    """Return a transfer function as the text of brdfkit's JSON files."""
    words = {word: getattr(function, word) for word in WORDS}
    record = {"kind": KIND, **words, "extinction": function.extinction}
    if function.gradients is None:
        record["points"] = np.column_stack([function.values, function.rgba]).tolist()
    else:
        fields = "values", "gradients", "rgba"
        record |= {field: getattr(function, field).tolist() for field in fields}
    lines = [f"  {json.dumps(key)}: {_format_json_rows(value)}" for key, value in record.items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _format_json_rows(value: Any) -> str:
    """Format a value as JSON, an array with a line for each row, so that people can edit it."""
    if not (isinstance(value, list) and isinstance(value[0], list)):
        return json.dumps(value, ensure_ascii=False)
    return "[\n    " + ",\n    ".join(json.dumps(row) for row in value) + "\n  ]"


def parse_json(cls: Any, text: str | bytes, where: str | Path) -> Any:
    """Parse a transfer function, of the class `cls`, from brdfkit's JSON.

    Errors name `where`, the source of the text.
    """
    try:
        record = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise BrdfkitError(f"{where}: is no valid JSON ({error}); correct it.") from error
    if not isinstance(record, dict) or record.get("kind") != KIND:
        raise BrdfkitError(f'{where}: is no transfer function; its "kind" should be "{KIND}".')
    unknown = sorted(set(record) - ALLOWED)
    if unknown:
        raise no_such_error("field", unknown[0], sorted(ALLOWED), str(where))
    try:
        return _make_transfer_function(cls, record)
    except BrdfkitError as error:
        raise BrdfkitError(f"{where}: {error}") from error


def _make_transfer_function(cls: Any, record: dict[str, Any]) -> Any:
    """Make a transfer function, of the class `cls`, from the fields of a parsed JSON object."""
    settings: dict[str, Any] = {w: to_printable(record[w]) for w in WORDS if w in record}
    settings["extinction"] = record.get("extinction", 1.0)
    if "boundaries" in record:
        function = cls.from_boundaries(
            record["boundaries"],
            record.get("thickness"),
            values=record.get("range"),
            extinction=settings.pop("extinction"),
            colour=settings.pop("colour", "albedo"),
        )
        return replace(function, **settings)
    if "points" not in record:
        fields = "values", "rgba", "gradients"
        return cls(**{field: record.get(field) for field in fields}, **settings)
    try:
        points = np.array(record["points"], float)
    except (TypeError, ValueError, OverflowError):
        points = np.empty(0)
    if points.ndim != 2 or points.shape[1] != 5:
        raise BrdfkitError('"points" should be rows of five numbers: value, R, G, B, A.')
    function = cls(points[:, 0], points[:, 1:], **settings)
    ramp = record.get("gradient_ramp")
    return function if ramp is None else function.over_gradients(ramp)
