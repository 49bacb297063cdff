"""The indices of what is known by name: `index.toml` in `data/measured` and `data/environments`.

The wheel copies both folders into the package; in a checkout they lie at the top.
"""

import tomllib
from pathlib import Path

MEASURED, ENVIRONMENTS = "measured", "environments"


def entries(kind=MEASURED):
    """The content of an index, a dictionary by name; "collections" holds those of others."""
    with (folder(kind) / "index.toml").open("rb") as stream:
        return tomllib.load(stream)


def folder(kind=MEASURED):
    """The folder of an index: in the installed package, or at the top of a checkout."""
    package = Path(__file__).resolve().parents[1]
    installed, checkout = (place / "data" / kind for place in (package, package.parents[1]))
    return installed if installed.is_dir() else checkout
