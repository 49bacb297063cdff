"""Writes the files of an `Svbrdf`: maps as OpenEXR, a Mitsuba scene, and an HTML report."""

from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.files import make_folder, require_writable, write_safely
from brdfkit.core.jit.threads import use_two_threads
from brdfkit.inverse.photographs.maps.scene import format_scene_xml
from brdfkit.inverse.photographs.maps.shape_parameters import ANGLE
from brdfkit.inverse.photographs.result.report import write_report
from brdfkit.model import Model

MISFIT, SCENE, REPORT = "misfit.exr", "sample.xml", "report.html"
LIGHTS, MASK, OBJECT_SCENE = "lights.exr", "mask.png", "object.xml"  # files of objects only
ERROR = "_error"  # suffix of the names of maps that hold standard errors
OTHERS = MISFIT, SCENE, REPORT, LIGHTS, MASK, OBJECT_SCENE


def make_output_folder(model: type[Model], folder: str | Path) -> None:
    """Make a folder for the files of a result, before a long search for its maps begins.

    Raises `BrdfkitError` unless every file that `write_files` may write can be written there;
    `model` is the class whose maps will be searched.
    """
    make_folder(folder)
    maps = *model.parameters, "normal", ANGLE
    names = *(f"{name}{end}.exr" for name in maps for end in ("", ERROR)), *OTHERS
    for name in names:
        require_writable(Path(folder) / name)


def write_files(svbrdf: Any, folder: str | Path) -> list[Path]:
    """Write all files of an `Svbrdf` to a folder, and return their paths."""
    folder = Path(folder)
    make_folder(folder)
    files = {name: f"{name}.exr" for name in svbrdf.maps}
    written = []
    for name, values in svbrdf.maps.items():
        # Components of normals lie between -1 and 1, but colours between 0 and 1
        pixels = (values + 1) / 2 if name == "normal" else values
        written += write_or_remove_map(folder / files[name], pixels)
        written += write_or_remove_map(folder / f"{name}{ERROR}.exr", svbrdf.uncertainty.get(name))
    written += write_or_remove_map(folder / MISFIT, svbrdf.misfit)
    scene = folder / SCENE
    with write_safely(scene) as beside:
        Path(beside).write_text(format_scene_xml(svbrdf, files), encoding="utf-8")
    report = folder / REPORT
    write_report(svbrdf, report)
    return [*written, scene, report]


def write_or_remove_map(path: Path, values: FloatArray | None) -> list[Path]:
    """Write a map and return its path in a list, or remove the file if there is no map.

    A file that an earlier result wrote would not belong to the maps beside it.
    """
    if values is None:
        path.unlink(missing_ok=True)
        return []
    import mitsuba as mi

    pixels = np.ascontiguousarray(np.atleast_3d(values), np.float32)
    with write_safely(path) as beside, use_two_threads():
        try:
            mi.Bitmap(pixels).write(str(beside))
        except RuntimeError as error:  # raised by Mitsuba, such as for a full disk
            raise OSError(str(error).splitlines()[0]) from error
    return [path]
