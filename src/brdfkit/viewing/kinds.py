"""What a dropped file is, by its content, or else by its suffix."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from brdfkit.core.errors import BrdfkitError
from brdfkit.lighting.environments.map_files import HDR
from brdfkit.materials import formats as material_formats
from brdfkit.materials.formats import fit_json, utia
from brdfkit.rendering.scene_input import mesh_file
from brdfkit.volumes import formats as volume_formats

MATERIAL, FIT, VOLUME = "material", "fit", "volume"
ENVIRONMENT, MESH, TRANSFER, STATE = "environment", "mesh", "transfer", "state"
UNKNOWN = ""
MAP_STARTS = b"#?", b"v/1\x01", b"PF\n"  # of a .hdr of Radiance's, an .exr and a .pfm
RAW = ".raw", ".bin", ".dat", ".img", ".vol"  # suffixes of voxels without a header


def find_kind(path: Path) -> str:
    """Return the kind of a file; `UNKNOWN` for one that nothing reads.

    The content decides where a reader recognises it, otherwise the suffix. Raises `BrdfkitError`
    for JSON that is damaged.
    """
    suffix = path.suffix.lower()
    with path.open("rb") as stream:
        head = stream.read(material_formats.HEAD)
    if suffix == ".json":
        return _find_kind_of_json(path, head)
    if suffix in mesh_file.SUFFIXES:
        return MESH
    if head.startswith(MAP_STARTS):
        return ENVIRONMENT
    if volume_formats.is_recognised(path):
        return VOLUME
    if material_formats.is_recognised(path):
        return MATERIAL
    if volume_formats.has_volume_suffix(path):
        return VOLUME
    if material_formats.has_format(path) and (suffix not in RAW or _is_utia(path)):
        return MATERIAL
    if suffix in HDR:
        return ENVIRONMENT
    return VOLUME if suffix in RAW else UNKNOWN


def _is_utia(path: Path) -> bool:
    """Return whether a file has the size of UTIA's, which begin with no mark."""
    return path.suffix.lower() in utia.SUFFIXES and path.stat().st_size == utia.SIZE


def _find_kind_of_json(path: Path, head: bytes) -> str:
    """Return what a file of JSON is: a fit, a transfer function, or settings of a view."""
    if fit_json.sniff(head):
        return FIT
    content = read_json(path)
    if not isinstance(content, dict | list):
        raise BrdfkitError(
            f"{path.name}: is neither a fit nor settings, nor a transfer function: its JSON is "
            f"only {json.dumps(content):.40}."
        )
    return STATE if isinstance(content, dict) and "kind" not in content else TRANSFER


def read_json(path: Path) -> object:
    """Return the content of a file of JSON; raise `BrdfkitError` for any other."""
    try:
        return json.loads(path.read_bytes())
    except (ValueError, RecursionError) as error:
        raise BrdfkitError(f"{path.name}: is no JSON ({error}); drop another file.") from None


def unknown_file_error(files: Sequence[Path]) -> BrdfkitError:
    """Return the error for files of which none is of a known kind."""
    return BrdfkitError(
        f"{files[0].name}: is no file that the page opens: it opens {describe_kinds()}."
    )


def describe_kinds() -> str:
    """Return the kinds of files that a page opens, with their suffixes."""
    return (
        f"measured materials, which are {material_formats.describe_formats()}, volumes, which are "
        f"{volume_formats.describe_formats()}, environment maps (.hdr .exr), meshes "
        f"({' '.join(mesh_file.SUFFIXES)}), and transfer functions and settings (.json)"
    )
