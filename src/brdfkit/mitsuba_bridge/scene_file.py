"""Loads scene files of Mitsuba, as they are or with a material in place of one of their BSDFs."""

import re
from collections.abc import Callable, Sequence
from html import unescape
from os import PathLike
from pathlib import Path
from typing import Any

from brdfkit.core.array_types import MitsubaObject
from brdfkit.core.errors import BrdfkitError, find_nearest_name
from brdfkit.core.files import require_file
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.mitsuba_bridge.properties.radiance_rows import require_intact_rows

SUFFIX = ".xml"
RADIANCE_FILE = re.compile(r"""["']([^"'\n]+\.(?:hdr|rgbe))["']""", re.IGNORECASE)
DEFAULT_ID = "material"  # id of the BSDF that a material replaces if the user names none


def load_scene_file(path: str | PathLike[str], **how: Any) -> MitsubaObject:
    """Load the `mitsuba.Scene` in a file; `how` are arguments of `mitsuba.load_file`.

    Raises `BrdfkitError` for a file that is missing or that Mitsuba cannot load, and for a scene
    without a sensor or an integrator.
    """
    import mitsuba as mi

    file = require_file(path)
    _require_intact_maps(file)

    def load(source: str, parallel: bool) -> MitsubaObject:
        return mi.load_file(source, parallel=parallel, **how)

    scene = load_by_mitsuba(load, str(file), file)
    if not scene.sensors():
        raise BrdfkitError(f"{path}: the scene has no sensor to see it with; add a <sensor>.")
    if scene.integrator() is None:
        raise BrdfkitError(f'{path}: the scene has no integrator; add <integrator type="path"/>.')
    return scene


def make_scene_builder(source: str | PathLike[str]) -> Callable[[Any, Any], MitsubaObject]:
    """Return a function (bsdf, size) that puts a material into the scene of a file.

    `source` is "FILE.xml#ID", with the id of the BSDF that the material replaces, or "FILE.xml",
    where the id is "material". The function returns a `mitsuba.Scene`, in the file's own size
    unless one is given. Raises `BrdfkitError` for a file that cannot be rendered, and for one
    without that id.
    """
    name, _, place = str(source).partition("#")
    path, place = require_file(name), place or DEFAULT_ID

    def build_scene(bsdf: MitsubaObject, size: tuple[int, int] | None) -> MitsubaObject:
        # optimize=True would merge equal BSDFs, which leaves one of their ids
        scene = load_scene_file(path, optimize=False)
        by_id: dict[str, list[MitsubaObject]] = {}
        for shape in scene.shapes():
            if shape.bsdf():
                by_id.setdefault(shape.bsdf().id(), []).append(shape)
        if place not in by_id:
            raise _make_missing_id_error(path, place, sorted(by_id))
        for shape in by_id[place]:
            shape.set_bsdf(bsdf)
        if size:
            _resize_film(scene.sensors()[0], size)
        return scene

    return build_scene


def _require_intact_maps(path: Path) -> None:
    """Raise `BrdfkitError` for a damaged Radiance file that a scene file refers to."""
    for name in RADIANCE_FILE.findall(path.read_text(encoding="utf-8", errors="replace")):
        file = path.parent / unescape(name)
        if file.is_file():
            require_intact_rows(file, f"{path}: {file}")


def _make_missing_id_error(path: Path, place: str, known: Sequence[str]) -> BrdfkitError:
    """Return the error where no shape has the BSDF that the material should replace."""
    near = find_nearest_name(place, known)
    guess = f"did you mean {path}#{near}? " if near else ""
    return BrdfkitError(
        f"{path}: no shape has a BSDF of the id {place!r}, for the material to replace; {guess}"
        f"name one as {path}#ID; there are {', '.join(known) or 'none'}."
    )


def _resize_film(sensor: MitsubaObject, size: tuple[int, int]) -> None:
    """Give the pictures of a sensor another (width, height) [pixels]."""
    import mitsuba as mi

    parameters = mi.traverse(sensor)
    parameters["film.size"] = list(size)
    parameters.update()
