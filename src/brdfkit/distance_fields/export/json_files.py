"""Distance fields as JSON: a node is an object with its kind, its parameters and its children."""

import json
from dataclasses import MISSING, Field, fields
from os import PathLike
from os.path import isfile
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.files import read_bytes, write_safely
from brdfkit.distance_fields.boxes import to_floats
from brdfkit.distance_fields.parameters import find_node_class


def to_json(node: Any) -> str:
    """Return a node as JSON text."""
    return json.dumps(_node_to_data(node))


def from_json(text: str, where: str = "the field") -> Any:
    """Read a field from the JSON text that `to_json` made.

    Parameters
    ----------
    text : str
        The JSON text.
    where : str, default "the field"
        The name of the text in error messages.

    Returns
    -------
    Node
        The field.

    Raises
    ------
    BrdfkitError
        If the text is no JSON, or has unknown nodes or parameters.

    Examples
    --------
    >>> from_json('{"kind": "sphere", "radius": 2}')
    sphere(2)
    """
    try:
        data = json.loads(text)
    except (ValueError, TypeError, RecursionError) as error:
        raise BrdfkitError(f"{where}: this is not JSON ({error}); check the file.") from error
    return _data_to_node(data, where)


def save(node: Any, path: str | PathLike[str]) -> None:
    """Write a node to a JSON file; raise `BrdfkitError` if it contains user-defined Python."""
    _refuse_user_defined_nodes(node, path)
    with write_safely(path) as beside:
        beside.write_text(to_json(node), encoding="utf-8")


def _refuse_user_defined_nodes(node: Any, path: str | PathLike[str]) -> None:
    """Raise `BrdfkitError` if a field contains user-defined nodes, which no file can store."""
    if not type(node).__module__.startswith("brdfkit.") or node.kind == "function":
        raise BrdfkitError(
            f"{path}: the field contains {node!r:.60}, which is Python of your own and cannot be "
            "saved. Save a grid, field.to_grid(128, bounds=(low, high)).save(path), or a mesh, "
            "field.to_mesh(128, bounds=(low, high)).write(path)."
        )
    for child in node.children:
        _refuse_user_defined_nodes(child, path)


def load(path: str | PathLike[str]) -> Any:
    """Load a field from a file that its method `save` wrote.

    Parameters
    ----------
    path : file
        A JSON file, compressed or not.

    Returns
    -------
    Node
        The field.

    Raises
    ------
    BrdfkitError
        If the file cannot be read, or has unknown nodes or parameters.

    Examples
    --------
    >>> scene = load("scene.json")
    """
    try:
        return from_json(read_bytes(path).decode(), str(path))
    except UnicodeDecodeError as error:
        raise BrdfkitError(f"{path}: this is not a text file; give the JSON of a field.") from error


def is_field_file(path: str | PathLike[str]) -> bool:
    """Return whether a path is a file that begins as the files do that `save` writes."""
    if not isfile(path):
        return False
    with open(path, "rb") as file:
        return file.read(100).lstrip().startswith(b'{"kind"')


def _node_to_data(value: Any) -> Any:
    """Return a node or a parameter as dictionaries, lists and numbers, which JSON can store."""
    if hasattr(value, "kind"):
        own = {f.name: _node_to_data(getattr(value, f.name)) for f in _list_saved_fields(value)}
        return {"kind": value.kind} | own
    if isinstance(value, tuple):
        return [_node_to_data(v) for v in value]
    if value is None:  # so the parameter `copies` says that a repetition is infinite
        return None
    if dr.is_tensor_v(value) or isinstance(value, np.ndarray):
        return np.asarray(dr.detach(value), float).tolist()
    return to_floats(value) if dr.is_array_v(value) else value


def _data_to_node(data: Any, where: str) -> Any:
    """Return the node that `_node_to_data` converted; `where` begins the errors."""
    if not isinstance(data, dict) or "kind" not in data:
        raise BrdfkitError(f'{where}: {str(data)[:40]!r} should be an object with a "kind".')
    cls = find_node_class(data["kind"], where)
    known = {f.name: f for f in _list_saved_fields(cls)}
    arguments = {name: value for name, value in data.items() if name != "kind"}
    for name in arguments:
        if name not in known:
            raise no_such_error(f"parameter of {data['kind']}", name, known, where)
    for name, field in known.items():
        if name not in arguments and field.default is MISSING:
            raise BrdfkitError(f"{where}: {data['kind']} needs {name}; add it.")
    if "child" in arguments:
        arguments["child"] = _data_to_node(arguments["child"], where)
    if "children" in arguments:
        if not isinstance(arguments["children"], list):
            raise BrdfkitError(f"{where}: children of {data['kind']} should be a list.")
        arguments["children"] = tuple(
            _data_to_node(child, where) for child in arguments["children"]
        )
    try:
        return cls(**arguments)
    except BrdfkitError as error:
        raise BrdfkitError(f"{where}: {error}") from error


def _list_saved_fields(node: Any) -> list[Field[Any]]:
    """Return the dataclass fields of a node, or of a class of nodes, that a file stores."""
    return [f for f in fields(node) if f.init]
