"""The printed tables, `printed.toml`, and the thesis's models by the labels of ours."""

import tomllib
from functools import cache
from pathlib import Path

# The seven nonlinear models, by their names in the thesis
SEVEN = {
    "Ashikhmin-Shirley": "ashikhmin_shirley",
    "Blinn-Phong": "blinn_phong",
    "Cook-Torrance": "cook_torrance",
    "Lafortune": "lafortune",
    "Oren-Nayar": "oren_nayar",
    "Ward": "ward",
    "Ward-Dür": "ward_duer",
}
KOENDERINK = "Koenderink (order 8)"


@cache
def printed(table):
    """A table by its name, as ``"table_9_1"``."""
    text = Path(__file__).with_name("printed.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)[table]
