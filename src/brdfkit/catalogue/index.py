"""The index of known materials, `data/measured/index.toml`: brdfkit's own and public collections.

The wheel copies its folder into the package; in a checkout it lies at the top.
"""

import tomllib
from pathlib import Path


def entries():
    """The content of the index, a dictionary by name of the material; "collections" holds those."""
    with (folder() / "index.toml").open("rb") as stream:
        return tomllib.load(stream)


def folder():
    """The folder of the index: in the installed package, or at the top of a checkout."""
    package = Path(__file__).resolve().parents[1]
    installed, checkout = package / "data" / "measured", package.parents[1] / "data" / "measured"
    return installed if installed.is_dir() else checkout
