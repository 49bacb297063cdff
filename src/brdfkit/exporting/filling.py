"""Fills the templates of exported files: texts in the languages of the targets."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Any

from brdfkit.core.files import write_safely


def write_template(template: str, path: Path, **content: Any) -> None:
    """Write the text of a `template`, a file of `templates/`, filled with `content`."""
    text = _make_environment().get_template(template).render(**content)
    write_text(path, text)


def write_text(path: Path, text: str) -> None:
    """Write a text, completely or not at all."""
    with write_safely(path) as beside:
        Path(beside).write_text(text, encoding="utf-8", newline="\n")


def write_bytes(path: Path, content: bytes) -> Path:
    """Write a file, completely or not at all; return its path."""
    with write_safely(path) as beside:
        beside.write_bytes(content)
    return path


@cache
def _make_environment() -> Any:
    """Return the environment of jinja2 that fills the templates."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader(__package__),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {
        "number": write_number,
        "numbers": write_numbers,
        "xml_comment": to_xml_comment,
    }
    return environment


def write_number(value: float) -> str:
    """Return a number with a decimal point, which C-like languages need, and nine digits.

    These are all digits of single precision, in which renderers compute.

    >>> write_number(1), write_number(0.1 + 0.2), write_number(1e-7)
    ('1.0', '0.3', '1e-07')
    """
    return repr(float(f"{value:.9g}"))


def write_numbers(values: Any) -> str:
    """Return numbers with commas between them.

    >>> write_numbers((1, 0.5))
    '1.0, 0.5'
    """
    return ", ".join(map(write_number, values))


def to_xml_comment(line: str) -> str:
    """Return a line for a comment in XML, in which two hyphens in a row are an error.

    >>> to_xml_comment("a ---> b")
    'a - - -> b'
    """
    return re.sub("-(?=-)", "- ", re.sub("[\ufffe\uffff]", "?", line))


def to_identifier(name: str) -> str:
    """Return a name of letters, digits and underscores for a shader, close to the given one.

    >>> to_identifier("roter Lack, 2")
    'roter_Lack_2'
    """
    plain = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
    return plain if plain[:1].isalpha() else f"material_{plain}".rstrip("_")
