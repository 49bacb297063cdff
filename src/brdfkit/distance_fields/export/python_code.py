"""A distance field as the Python expression that makes it, for its `repr`."""

from dataclasses import fields
from typing import Any

import drjit as dr
import numpy as np

OPERATORS = {"union": " | ", "intersection": " & ", "difference": " - "}


def to_python(node: Any) -> str:
    """Return a node as a Python expression, such as ``sphere(1) | box(2).translate((1, 0, 0))``.

    The values of a grid are abbreviated to their number.
    """
    if node.kind in OPERATORS:
        first, *others = node.children
        blend = "" if node.is_sharp else f".k({_format_value(node.blend)})"
        operands = [_format_operand(first), *(_format_operand(c) + blend for c in others)]
        return OPERATORS[node.kind].join(operands)
    names = [f.name for f in fields(node) if f.name != "child" and not f.name.startswith("_")]
    call = f"{node.kind}({', '.join(_format_value(getattr(node, name)) for name in names)})"
    return f"{_format_operand(node.child)}.{call}" if hasattr(node, "child") else call


def _format_operand(node: Any) -> str:
    """Return a node as a Python expression, in brackets if it is a combination."""
    return f"({node})" if node.kind in OPERATORS else repr(node)


def _format_value(value: Any) -> str:
    """Return the value of a parameter as a Python expression."""
    if value is None or isinstance(value, int | str):
        return repr(value)
    if isinstance(value, tuple):
        return f"({', '.join(_format_value(v) for v in value)})"
    if len(np.shape(value)) == 3:
        return f"<{'×'.join(map(str, value.shape))} values>"
    return f"{np.ravel(dr.detach(value))[0]:g}" if dr.is_array_v(value) else f"{value:g}"
