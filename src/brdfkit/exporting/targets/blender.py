"""Blender: a program that builds the material of nodes, which Cycles and EEVEE draw.

Nodes have no coloured Fresnel reflectance at grazing angles, so each highlight is the sum

    k₀ + (k₉₀ - k₀) s = g + W [b + (1 - b) s],   s = (1 - V·H)⁵

of a Glossy with the colour g and a Metallic with the grey weight W and the base colour b ≤ 1. It is
exact where max(k₉₀ - k₀) ≤ min(k₉₀) over the channels, and k₉₀ ≥ k₀.
"""

import importlib.util
import shutil
import subprocess
import sys
import warnings
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from brdfkit.core.files import require_writable
from brdfkit.exporting.filling import write_bytes, write_template
from brdfkit.exporting.ggx_sum import GgxLobe, GgxSum, to_ggx_sum
from brdfkit.exporting.target import Held, Target, hold_nearest_sum
from brdfkit.model import Model

BLEND = ".blend"
LARGEST_RATIO = 10.0  # of the widths of a Metallic
LARGEST_WEIGHT = 15.0  # a Metallic for each 1; with more than 64 nodes Cycles draws black
LEAST_WEIGHT = 1e-5  # Cycles leaves out what is darker


def hold(model: Model) -> Held | None:
    """Return the nearest sum of which every highlight has the two nodes."""
    content = to_ggx_sum(model)
    if content is None:
        return None
    lobes, changes = [], []
    for lobe in content.lobes:
        grey = _limit_rise(lobe)
        if grey != lobe:
            changes.append("highlights at grazing angles became greyer, or darker")
        round_ = _limit_ratio(grey)
        if round_ != grey:
            changes.append(f"anisotropy is limited to {LARGEST_RATIO:g}")
        lobes.append(round_)
    nearest = GgxSum(content.diffuse, tuple(lobes))
    return hold_nearest_sum(model, nearest, tuple(dict.fromkeys(changes)))


def _limit_rise(lobe: GgxLobe) -> GgxLobe:
    """Return a highlight whose reflectance rises to grazing angles as nodes can have it."""
    f0 = np.array(lobe.f0)
    f90 = np.maximum(lobe.f90, f0)
    rise = np.minimum(f90 - f0, min(f90.min(), LARGEST_WEIGHT))
    if np.allclose(f0 + rise, lobe.f90, rtol=1e-12, atol=0):
        return lobe
    red, green, blue = (f0 + rise).tolist()
    return replace(lobe, f90=(red, green, blue))


def _limit_ratio(lobe: GgxLobe) -> GgxLobe:
    """Return a highlight that is no more anisotropic than a Metallic, if it needs one."""
    low, high = sorted((lobe.alpha_u, lobe.alpha_v))
    if lobe.f0 == lobe.f90 or high <= LARGEST_RATIO * low:
        return lobe
    middle, root = np.sqrt(low * high), np.sqrt(LARGEST_RATIO)
    widths = (middle / root, middle * root)
    low, high = map(float, widths if lobe.alpha_u < lobe.alpha_v else widths[::-1])
    return replace(lobe, alpha_u=low, alpha_v=high)


def write(held: Held, path: Path, comment: list[str]) -> list[Path]:
    """Write the program, and where Blender is at hand, the .blend that it makes."""
    blender = _find_blender()
    if blender:  # if there is another .blend of this name, nothing is written
        require_writable(path.with_suffix(BLEND))
    write_template(
        "blender.py.jinja",
        path,
        name=path.stem,
        diffuse=held.content.diffuse,
        lobes=[_to_nodes(lobe) for lobe in held.content.lobes],
        is_anisotropic=held.content.is_anisotropic,
        comment=comment,
    )
    return [path, *_save_blend(path, blender)]


def _find_blender() -> list[str]:
    """Return the start of a command line that runs a program in Blender, or [] without Blender."""
    spec = importlib.util.find_spec("bpy")
    if spec and spec.origin:  # otherwise a folder has this name
        return [sys.executable]
    blender = shutil.which("blender")
    return [blender, "--background", "--python"] if blender else []


def _save_blend(program: Path, blender: list[str]) -> list[Path]:
    """Run the program in Blender, if it is at hand; return the .blend that it saved beside itself.

    The program alone is enough, so a failure is only a warning.
    """
    if not blender:
        return []
    with TemporaryDirectory(prefix="brdfkit-") as folder:
        made = Path(folder, "material.blend")
        words = [*blender, str(program), "--", str(made)]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        if made.is_file():
            return [write_bytes(program.with_suffix(BLEND), made.read_bytes())]
    reason = "".join((done.stderr.strip() or done.stdout.strip()).splitlines()[-1:])
    warnings.warn(
        f"{program} is written, but Blender made no .blend of it ({reason}); run it in Blender's "
        "text editor.",
        stacklevel=2,
    )
    return []


def _to_nodes(lobe: GgxLobe) -> dict[str, Any]:
    """Return the widths of a highlight, the colour of its Glossy, and its Metallic."""
    f0, f90 = np.array(lobe.f0), np.array(lobe.f90)
    weight = (f90 - f0).max()
    weight = weight if weight > LEAST_WEIGHT else 0.0
    base = 1 - (f90 - f0) / weight if weight else np.ones(3)
    glossy = np.maximum(f90 - weight, 0)
    widths = lobe.alpha_u, lobe.alpha_v
    return {"widths": widths, "glossy": glossy, "weight": weight, "base": base}


TARGET = Target(
    name="blender",
    title="Blender: a program that builds the nodes",
    suffix=".py",
    holds={
        "diffuse": "Lambert",
        "highlights": "GGX, any number; grey at grazing angles",
        "anisotropy": "to 1 : 10",
        "else": "nothing",
    },
    hold=hold,
    write=write,
)
