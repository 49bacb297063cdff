"""A distance field as the Python that makes it: ``sphere(1) | box(2).translate((1, 0, 0))``."""

from dataclasses import fields

import drjit as dr
import numpy as np

SIGNS = {"union": " | ", "intersection": " & ", "difference": " - "}


def written(node):
    """The Python of a node; grids are written as their number of values."""
    if node.kind in SIGNS:
        return _combination(node)
    if not hasattr(node, "child"):
        return f"{node.kind}({_arguments(node)})"
    return f"{_operand(node.child)}.{node.kind}({_arguments(node)})"


def _combination(node):
    first, *others = node.children
    blend = "" if node.is_sharp else f".k({_value(node.blend)})"
    return SIGNS[node.kind].join([_operand(first), *(_operand(c) + blend for c in others)])


def _operand(node):
    """A node as a part of another."""
    return f"({node})" if node.kind in SIGNS else repr(node)


def _arguments(node):
    given = [
        _value(getattr(node, f.name))
        for f in fields(node)
        if f.name not in ("child", "children") and not f.name.startswith("_")
    ]
    return ", ".join(given)


def _value(value):
    if value is None or isinstance(value, int | str):
        return repr(value)
    if isinstance(value, tuple):
        return f"({', '.join(_value(v) for v in value)})"
    if len(np.shape(value)) == 3:
        return f"<{'×'.join(map(str, value.shape))} values>"
    return f"{np.ravel(dr.detach(value))[0]:g}" if dr.is_array_v(value) else f"{value:g}"
