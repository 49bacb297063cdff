"""Puts what a page says into its template, with its style and its script, which alone may run."""

from base64 import b64encode
from functools import cache
from hashlib import sha256
from importlib import resources
from pathlib import Path

from brdfkit.core.files import write_safely
from brdfkit.core.names import to_printable


def write_page(template, path, **said):
    """Write the page of a `template`, a file of `templates/`, to `path`, whole or not at all."""
    text = fill_template(template, **said)
    with write_safely(path) as beside:
        Path(beside).write_text(text, encoding="utf-8", newline="\n")


def fill_template(template, **said):
    """The page as text; all that is `said` is escaped."""
    return _make_environment().get_template(template).render(**said)


@cache
def _make_environment():
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    found = Environment(
        loader=PackageLoader(__package__),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=_clean,
    )
    found.globals |= {
        "source": lambda name: Markup(read_template(name)),
        "policy": make_policy,
    }
    return found


def _clean(value):
    """A text without control characters, which HTML forbids; markup and others as they are."""
    plain = isinstance(value, str) and not hasattr(value, "__html__")
    return to_printable(value, keep="\n") if plain else value


def make_policy(style, *scripts):
    """The content security policy: nothing from elsewhere, and of this page's own only its files.

    `style`, `scripts`: names of files of `templates/`, each in an element of its own.
    """
    hash_of_style, *hashes = (_hash_template(name) for name in (style, *scripts))
    return (
        f"default-src 'none'; img-src data:; style-src {hash_of_style}; "
        f"script-src {' '.join(hashes)}; base-uri 'none'; form-action 'none'"
    )


def _hash_template(name):
    """What a browser must find in an element for it to be the file of this name."""
    digest = sha256(read_template(name).encode()).digest()
    return f"'sha256-{b64encode(digest).decode()}'"


@cache
def read_template(name):
    """A file of `templates/` as it stands in its element."""
    return "\n" + (resources.files(__package__) / "templates" / name).read_text(encoding="utf-8")
