"""Where a report comes from: file, checksums, versions, and the command that repeats it."""

import shlex
from pathlib import Path

from brdfkit.core.files import sha256
from brdfkit.core.version import find_versions
from brdfkit.fitting.fit import SETTINGS
from brdfkit.materials.loading import locate
from brdfkit.regression.solvers import AlbedoAtMost
from brdfkit.regression.solvers.settings import to_plain, to_solver
from brdfkit.reporting.pictures.defaults import SCENE


def facts(material, file, spp, size, seed, scene, environment):
    """What was read and how, by heading; `file`: as the user named it, or None."""
    found = {"file": str(file) if file else f"{material.name}, from memory"}
    if file:
        found["SHA-256 of the file"] = sha256(locate(file)[0])
    found["SHA-256 of its data"] = material.checksum
    how = f"{size}×{size} pixels, {spp} samples per pixel, seed {seed}"
    found["pictures"] = f"{scene_in_words(scene, environment)}; {how}"
    found["made with"] = ", ".join(f"{name} {number}" for name, number in find_versions().items())
    return found


def scene_in_words(scene, environment):
    """What the pictures show, and by which light."""
    shown = f"the mesh {Path(scene).name}" if Path(scene).suffix else f"the scene {scene}"
    return (
        f"{shown}, lit by {Path(environment).name}" if environment else f"{shown}, in its own light"
    )


def command(material, file, fits, output, spp, size, seed, scene, environment):
    """The command that makes the report again, as one would type it, and the names of the settings
    of the fits that it cannot tell."""
    words = ["brdfkit", "report", str(file or "FILE")]
    for fit in fits:
        words += ["-m", fit.model.label()]
    words += ["--loss", fits[0].loss_name]
    usual = {**SETTINGS, "seed": seed, "anisotropic": material.anisotropic}
    untold = set() if all(fit.loss_name == fits[0].loss_name for fit in fits) else {"loss"}
    common = fits[0].settings
    for name in dict.fromkeys(name for fit in fits for name in fit.settings):
        value = common.get(name)
        option = _option(name, value)
        if any(fit.settings.get(name) != value for fit in fits):
            untold.add(name)
        elif (value or None) != (usual.get(name) or None):
            words += option
            untold |= set() if option else {name}
    words += ["--scene", str(scene)] * (scene != SCENE) + ["--envmap", str(environment)] * bool(
        environment
    )
    words += ["--spp", str(spp), "--size", str(size), "--seed", str(seed)]
    return shlex.join([*words, "-o", Path(output).name]), sorted(untold)


def _option(name, value):
    """The option of `brdfkit report` for a setting of a fit, in words; none where it has none."""
    if name == "robust":
        return ["--robust", str(value)]
    if name == "max_angle":
        return ["--max-angle", f"{value:g}"]
    if name == "solver" and isinstance(value, dict) and value == to_plain(to_solver(value["name"])):
        return ["--solver", value["name"]]
    if name == "constraints" and len(value or ()) == 1 and isinstance(value[0], dict):
        limit = value[0].get("limit")
        if value[0] == to_plain(AlbedoAtMost(limit)):
            return ["--albedo-at-most", f"{limit:g}"]
    return []
