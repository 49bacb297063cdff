"""The version of brdfkit, which the package's metadata reads here, and of its libraries."""

from functools import cache

__version__ = "0.1.0"

LIBRARIES = "mitsuba", "drjit", "numpy", "scipy"


@cache
def find_versions() -> dict[str, str]:
    """Return the versions of brdfkit and of the libraries that its numbers depend on, by name."""
    from importlib import metadata  # imported here to keep `--help` fast

    return {"brdfkit": __version__, **{name: metadata.version(name) for name in LIBRARIES}}
