"""Writes a model with its values as XML of Mitsuba, to be put into a scene."""

from __future__ import annotations

from typing import Any
from xml.sax.saxutils import quoteattr

from brdfkit.model import Model

HEAD = "<!-- {label}: import brdfkit in Python before mitsuba.load_file, so that it is known. -->"


def write_xml(model: Model) -> str:
    """Return the element of a model for a scene of Mitsuba, with its values in linear sRGB."""
    entries = model.rgb.scene_dict()
    lines = [f"<bsdf type={quoteattr(entries.pop('type'))}>"]
    lines += [f"    {_write_entry(name, value)}" for name, value in entries.items()]
    # Two hyphens would end a comment
    head = HEAD.format(label=model.label().replace("--", "- -"))
    return "\n".join([head, *lines, "</bsdf>", ""])


def _write_entry(name: str, value: Any) -> str:
    """Return the element of a parameter or an option."""
    if isinstance(value, dict):
        return _write_element("rgb", name, ", ".join(map(repr, value["value"])))
    if isinstance(value, bool):
        return _write_element("boolean", name, str(value).lower())
    kinds = {int: "integer", float: "float", str: "string"}
    return _write_element(kinds[type(value)], name, str(value))


def _write_element(kind: str, name: str, value: str) -> str:
    """Return an element with a name and a value."""
    return f"<{kind} name={quoteattr(name)} value={quoteattr(value)}/>"
