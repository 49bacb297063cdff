"""The index of known materials, `data/measured/index.toml`: brdfkit's own and public collections.

The wheel copies its folder into the package; in a checkout it lies at the top.
"""

import tomllib
from pathlib import Path


def entries():
    """The index as it is written, TOML's tables as dictionaries."""
    with (folder() / "index.toml").open("rb") as stream:
        return tomllib.load(stream)


def folder():
    """The folder of the index: within the installed package, else that of the checkout."""
    package = Path(__file__).resolve().parents[1]
    installed, checkout = package / "data" / "measured", package.parents[1] / "data" / "measured"
    return installed if installed.is_dir() else checkout
