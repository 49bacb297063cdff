"""Describes the provenance of a report: its data, versions, and the command that repeats it."""

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from brdfkit.core.files import compute_sha256
from brdfkit.core.version import find_versions
from brdfkit.fitting.settings import FitSettings
from brdfkit.materials.loading import locate_material
from brdfkit.materials.measured import Measured
from brdfkit.regression import Fit
from brdfkit.regression.solvers import AlbedoAtMost
from brdfkit.regression.solvers.settings import to_plain_data, to_solver
from brdfkit.reporting.pictures.defaults import SCENE


def describe_provenance(
    material: Measured,
    file: str | Path | None,
    spp: int,
    size: int,
    seed: int,
    scene: str | Path,
    environment: str | Path | None,
) -> dict[str, str]:
    """Return the provenance of a report, as a dictionary from headings to texts.

    The texts name the measured file with checksums, the settings of the pictures, and the versions
    of the software. `file`: the material's file as the user named it, or None; `spp`: samples per
    pixel; `size`: side of the pictures [pixels].
    """
    provenance = {"file": str(file) if file else f"{material.name}, from memory"}
    if file:
        provenance["SHA-256 of the file"] = compute_sha256(locate_material(file)[0])
    provenance["SHA-256 of its data"] = material.checksum
    settings = f"{size}×{size} pixels, {spp} samples per pixel, seed {seed}"
    provenance["pictures"] = f"{describe_scene(scene, environment)}; {settings}"
    versions = (f"{name} {number}" for name, number in find_versions().items())
    provenance["made with"] = ", ".join(versions)
    return provenance


def describe_scene(scene: str | Path, environment: str | Path | None) -> str:
    """Return a text that names the scene and the lighting of a report's pictures."""
    shown = f"the mesh {Path(scene).name}" if Path(scene).suffix else f"the scene {scene}"
    light = f"lit by {Path(environment).name}" if environment else "in its own light"
    return f"{shown}, {light}"


def make_command(
    material: Measured,
    file: str | Path | None,
    fits: Sequence[Fit],
    output: str | Path,
    spp: int,
    size: int,
    seed: int,
    scene: str | Path,
    environment: str | Path | None,
) -> tuple[str, list[str]]:
    """Return the shell command that makes a report again, for its page.

    Return also the names of those settings of the fits for which the command has no option. The
    arguments are those of the report; `file` is None for a material from memory.
    """
    words = ["brdfkit", "report", str(file or "FILE")]
    for fit in fits:
        words += ["-m", fit.model.label()]
    words += ["--loss", fits[0].loss_name]
    defaults = {**vars(FitSettings()), "seed": seed, "anisotropic": material.anisotropic}
    missing = set() if all(fit.loss_name == fits[0].loss_name for fit in fits) else {"loss"}
    for name in dict.fromkeys(name for fit in fits for name in fit.settings):
        value = fits[0].settings.get(name)
        option = _to_command_option(name, value)
        if any(fit.settings.get(name) != value for fit in fits):
            missing.add(name)
        elif (value or None) != (defaults.get(name) or None):
            words += option
            missing |= set() if option else {name}
    if scene != SCENE:
        words += ["--scene", str(scene)]
    if environment:
        words += ["--envmap", str(environment)]
    words += ["--spp", str(spp), "--size", str(size), "--seed", str(seed)]
    return shlex.join([*words, "-o", Path(output).name]), sorted(missing)


def _to_command_option(name: str, value: Any) -> list[str]:
    """Return the option of `brdfkit report` for a setting of a fit, as words; [] if none."""
    if name == "robust":
        return ["--robust", str(value)]
    if name == "max_angle":
        return ["--max-angle", f"{value:g}"]
    if (
        name == "solver"
        and isinstance(value, dict)
        and value == to_plain_data(to_solver(value["name"]))
    ):
        return ["--solver", value["name"]]
    if name == "constraints" and len(value or ()) == 1 and isinstance(value[0], dict):
        limit: Any = value[0].get("limit")
        if value[0] == to_plain_data(AlbedoAtMost(limit)):
            return ["--albedo-at-most", f"{limit:g}"]
    return []
