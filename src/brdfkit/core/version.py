"""The version of brdfkit, of which the package's metadata is made; and of what it computes with."""

from functools import cache

__version__ = "0.1.0"

LIBRARIES = "mitsuba", "drjit", "numpy", "scipy"


@cache
def find_versions():
    """The versions of brdfkit and of the libraries on which its numbers depend, by name."""
    from importlib import metadata  # only here: `--help` should be instant

    return {"brdfkit": __version__, **{name: metadata.version(name) for name in LIBRARIES}}
