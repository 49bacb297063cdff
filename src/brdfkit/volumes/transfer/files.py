"""Files of transfer functions: brdfkit's JSON, Slicer's presets, and the shipped presets.

The JSON has the fields of `TransferFunction`. A function over values alone has ``"points"``, rows
(value, R, G, B, A). A function over gradient magnitudes as well has ``"values"``, ``"gradients"``
and ``"rgba"``; or, shorter to write by hand, ``"points"`` with a ``"gradient_ramp"``, rows
(gradient magnitude, factor); or ``"boundaries"``, rows (value, steepest gradient, R, G, B, A), with
their ``"thickness"`` and ``"range"``, the two values of `from_boundaries`.
"""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.core.files import read_bytes, write_safely
from brdfkit.core.names import to_printable
from brdfkit.volumes.transfer import slicer_presets

KIND = "brdfkit transfer function"
WORDS = "colour", "value_unit", "length_unit", "name"  # fields that are text
ALLOWED = {"kind", "extinction", "points", "gradient_ramp", "values", "gradients", "rgba", *WORDS}
ALLOWED |= {"boundaries", "thickness", "range"}


def list_presets() -> dict[str, Path]:
    """Return the files of the presets that come with brdfkit, by name."""
    folder = Path(__file__).with_name("presets")
    return {path.stem: path for path in sorted(folder.glob("*.json"))}


def load(cls: Any, path: str | os.PathLike[str]) -> Any:
    """Load the transfer function, of the class `cls`, of a file or of a preset's name."""
    text = os.fspath(path)
    file, _, part = text.partition("#")
    if text in list_presets():
        return _read_json(cls, list_presets()[text])
    if file.lower().endswith(".xml"):
        return slicer_presets.read_preset(cls, Path(file), part)
    if not Path(text).suffix and not Path(text).exists():
        raise no_such("transfer function", text, list_presets())
    return _read_json(cls, Path(text))


def save(function: Any, path: str | os.PathLike[str]) -> None:
    """Write a transfer function to a .json file."""
    if Path(path).suffix.lower() != ".json":
        raise BrdfkitError(f"{path}: transfer functions are written as .json; choose that suffix.")
    with write_safely(path) as beside:
        beside.write_text(to_json(function), encoding="utf-8")


def to_json(function: Any) -> str:
    """Return the text of a transfer function's file."""
    words = {word: getattr(function, word) for word in WORDS}
    record = {"kind": KIND, **words, "extinction": function.extinction}
    if function.gradients is None:
        record["points"] = np.column_stack([function.values, function.rgba]).tolist()
    else:
        fields = "values", "gradients", "rgba"
        record |= {field: getattr(function, field).tolist() for field in fields}
    lines = [f"  {json.dumps(key)}: {_format_rows(value)}" for key, value in record.items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _format_rows(value: Any) -> str:
    """Return JSON with a line for each row of an array, for people who edit it."""
    if not (isinstance(value, list) and isinstance(value[0], list)):
        return json.dumps(value, ensure_ascii=False)
    return "[\n    " + ",\n    ".join(json.dumps(row) for row in value) + "\n  ]"


def _read_json(cls: Any, path: Path) -> Any:
    """Read the transfer function, of the class `cls`, in a .json file."""
    return from_json(cls, read_bytes(path), path)


def from_json(cls: Any, text: str | bytes, where: str | Path) -> Any:
    """Parse the transfer function, of the class `cls`, in a `text`; errors call it `where`."""
    try:
        record = json.loads(text)
    except ValueError as error:
        raise BrdfkitError(f"{where}: is no JSON ({error}); mend it.") from error
    if not isinstance(record, dict) or record.get("kind") != KIND:
        raise BrdfkitError(f'{where}: is no transfer function; its "kind" should be "{KIND}".')
    unknown = sorted(set(record) - ALLOWED)
    if unknown:
        raise no_such("field", unknown[0], sorted(ALLOWED), str(where))
    try:
        return _from_record(cls, record)
    except BrdfkitError as error:
        raise BrdfkitError(f"{where}: {error}") from error


def _from_record(cls: Any, record: dict[str, Any]) -> Any:
    """Return the transfer function, of the class `cls`, with the fields of a JSON object."""
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
