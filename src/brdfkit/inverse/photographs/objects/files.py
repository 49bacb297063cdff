"""Writes the files of an `ObjectMaps`: maps as OpenEXR, a mask, a Mitsuba scene, and a report."""

from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import BoolArray
from brdfkit.core.files import make_folder, write_safely
from brdfkit.inverse.photographs.objects.report import write_report
from brdfkit.inverse.photographs.objects.scene import format_object_xml, pad_maps
from brdfkit.inverse.photographs.result.files import (
    ERROR,
    LIGHTS,
    MASK,
    OBJECT_SCENE,
    REPORT,
    write_or_remove_map,
)


def write_files(maps: Any, folder: str | Path) -> list[Path]:
    """Write all files of an `ObjectMaps` to a folder, and return their paths."""
    folder = Path(folder)
    make_folder(folder)
    files = {name: f"{name}.exr" for name in maps.maps}
    written = []
    for name, values in pad_maps(maps).items():
        # Components of normals lie between -1 and 1, but colours between 0 and 1
        pixels = (values + 1) / 2 if name == "normal" else values
        written += write_or_remove_map(folder / files[name], pixels)
        written += write_or_remove_map(folder / f"{name}{ERROR}.exr", maps.uncertainty.get(name))
    written += write_or_remove_map(folder / LIGHTS, maps.lights)
    _write_mask(folder / MASK, maps.mask)
    scene, report = folder / OBJECT_SCENE, folder / REPORT
    with write_safely(scene) as beside:
        Path(beside).write_text(format_object_xml(maps, files, MASK), encoding="utf-8")
    write_report(maps, report)
    return [*written, folder / MASK, scene, report]


def _write_mask(path: Path, mask: BoolArray) -> None:
    """Write a mask as a PNG file, white where the object is."""
    from PIL import Image

    with write_safely(path) as beside:
        Image.fromarray(np.where(mask, 255, 0).astype(np.uint8)).save(beside)
