"""Distance fields as JSON: a node is an object with its kind, its parameters and its children."""

import json
from dataclasses import MISSING, fields
from os import PathLike
from os.path import isfile
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.core.files import contents, write_safely
from brdfkit.distance_fields.boxes import plain
from brdfkit.distance_fields.parameters import kind


def to_json(node):
    """The text of a node."""
    return json.dumps(_to_data(node))


def from_json(text: str, where: str = "the field") -> Any:
    """The field of which `to_json` made this text.

    Parameters
    ----------
    text : str
        JSON.
    where : str, default "the field"
        What errors call it.

    Returns
    -------
    Node
        The field.

    Raises
    ------
    BrdfkitError
        Where it is no JSON, or has nodes or parameters that there are not.

    Examples
    --------
    >>> from_json('{"kind": "sphere", "radius": 2}')
    sphere(2)
    """
    try:
        data = json.loads(text)
    except (ValueError, TypeError, RecursionError) as error:
        raise BrdfkitError(f"{where}: is no JSON ({error}); check the file.") from error
    return _to_node(data, where)


def save(node, path):
    """Write a node to the file `path`, as JSON; `BrdfkitError` where it is of the user's Python."""
    _require_known(node, path)
    with write_safely(path) as beside:
        beside.write_text(to_json(node), encoding="utf-8")


def _require_known(node, path):
    """Raise `BrdfkitError` for a kind of node that brdfkit does not have, or a function."""
    if not type(node).__module__.startswith("brdfkit.") or node.kind == "function":
        raise BrdfkitError(
            f"{path}: the field holds {node!r:.60}, which is Python of yours, and no file can hold "
            "that. Save a grid of the field, field.to_grid(128, bounds=(low, high)).save(path), or "
            "a mesh, field.to_mesh(128, bounds=(low, high)).write(path)."
        )
    for child in node.children:
        _require_known(child, path)


def load(path: str | PathLike[str]) -> Any:
    """The field in a file that `save` wrote.

    Parameters
    ----------
    path : file
        JSON, compressed or not.

    Returns
    -------
    Node
        The field.

    Raises
    ------
    BrdfkitError
        Where the file cannot be read, or has nodes or parameters that there are not.

    Examples
    --------
    >>> scene = load("scene.json")
    """
    try:
        return from_json(contents(path).decode(), str(path))
    except UnicodeDecodeError as error:
        raise BrdfkitError(f"{path}: is no text; a distance field is JSON.") from error


def is_field(path: str | PathLike[str]) -> bool:
    """Whether there is a file that begins as those that `save` wrote."""
    if not isfile(path):
        return False
    with open(path, "rb") as file:
        return file.read(100).lstrip().startswith(b'{"kind"')


def _to_data(value):
    if hasattr(value, "kind"):
        own = {f.name: _to_data(getattr(value, f.name)) for f in _stored(value)}
        return {"kind": value.kind} | own
    if isinstance(value, tuple):
        return [_to_data(v) for v in value]
    if value is None:  # the copies of an endless repetition
        return None
    if dr.is_tensor_v(value) or isinstance(value, np.ndarray):
        return np.asarray(dr.detach(value), float).tolist()
    return plain(value) if dr.is_array_v(value) else value


def _to_node(data, where):
    if not isinstance(data, dict) or "kind" not in data:
        raise BrdfkitError(f'{where}: {str(data)[:40]!r} should be an object with a "kind".')
    cls = kind(data["kind"], where)
    known = {f.name: f for f in _stored(cls)}
    given = {name: value for name, value in data.items() if name != "kind"}
    for name in given:
        if name not in known:
            raise no_such(f"parameter of {data['kind']}", name, known, where)
    for name, field in known.items():
        if name not in given and field.default is MISSING:
            raise BrdfkitError(f"{where}: {data['kind']} needs {name}; add it.")
    if "child" in given:
        given["child"] = _to_node(given["child"], where)
    if "children" in given:
        if not isinstance(given["children"], list):
            raise BrdfkitError(f"{where}: children of {data['kind']} should be a list.")
        given["children"] = tuple(_to_node(child, where) for child in given["children"])
    try:
        return cls(**given)
    except BrdfkitError as error:
        raise BrdfkitError(f"{where}: {error}") from error


def _stored(node):
    return [f for f in fields(node) if f.init]
