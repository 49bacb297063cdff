"""Reads the thesis's printed tables, and names its BRDF models by brdfkit's labels."""

import tomllib
from functools import cache
from pathlib import Path

# The names of the seven nonlinear models in the thesis → brdfkit's labels
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
def read_printed_table(table):
    """Return a printed table of the thesis by its name, such as ``"table_9_1"``."""
    text = Path(__file__).with_name("printed.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)[table]
