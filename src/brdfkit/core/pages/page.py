"""Fills templates of HTML pages, which contain their style and scripts; no other script may run."""

from base64 import b64encode
from functools import cache
from hashlib import sha256
from importlib import resources
from os import PathLike
from pathlib import Path
from typing import Any

from brdfkit.core.files import write_safely
from brdfkit.core.names import to_printable


def write_page(template: str, path: str | PathLike[str], **content: Any) -> None:
    """Write the page of a `template`, a file of `templates/`, to `path`; `content` is escaped."""
    text = _make_environment().get_template(template).render(**content)
    with write_safely(path) as beside:
        Path(beside).write_text(text, encoding="utf-8", newline="\n")


@cache
def _make_environment() -> Any:
    """Return the environment of jinja2 that fills the templates and escapes their content."""
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        loader=PackageLoader(__package__),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=_remove_control_characters,
    )
    environment.globals |= {
        "source": lambda name: Markup(read_template(name)),
        "policy": make_security_policy,
    }
    return environment


def _remove_control_characters(value: Any) -> Any:
    """Remove the control characters, which HTML forbids, from a text; other values stay."""
    plain = isinstance(value, str) and not hasattr(value, "__html__")
    return to_printable(value, keep="\n") if plain else value


def make_security_policy(style: str, *scripts: str) -> str:
    """Return a content security policy that allows only the style and the scripts of this page.

    `style` and `scripts` are files of `templates/`; each fills an element of its own in the page.
    """
    hash_of_style, *hashes = (_hash_template(name) for name in (style, *scripts))
    return (
        f"default-src 'none'; img-src data:; style-src {hash_of_style}; "
        f"script-src {' '.join(hashes)}; base-uri 'none'; form-action 'none'"
    )


def _hash_template(name: str) -> str:
    """Return the SHA-256 of a style or script, a file of `templates/`, for a security policy."""
    digest = sha256(read_template(name).encode()).digest()
    return f"'sha256-{b64encode(digest).decode()}'"


@cache
def read_template(name: str) -> str:
    """Read a file of `templates/`, after the line break with which its element in a page begins."""
    return "\n" + (resources.files(__package__) / "templates" / name).read_text(encoding="utf-8")
