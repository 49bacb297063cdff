"""`Scenery`: the environment maps and the meshes of the user, besides those that brdfkit has."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from brdfkit.core.array_types import AnyArray
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.locate import split_file_and_part
from brdfkit.lighting.environments.map_files import load_radiance
from brdfkit.rendering.scene_input import mesh_file
from brdfkit.viewing.controls import State
from brdfkit.viewing.materials.material_scene import find_shape
from brdfkit.viewing.temporary_folders import explain_failures, make_folder

LIGHT, SHAPE = "light.environment", "shape"  # the settings that may be files
ENDINGS = "", "#y", "#z"  # of a mesh's name: the axis that points up is guessed, or known


class Scenery:
    """Maps and meshes by the names of their files, as the settings have them.

    Attributes
    ----------
    maps : dict of str to ndarray
        Environment maps (height, width, 3).
    meshes : dict of str to str
        What `find_shape` takes; a mesh has a name for each of `ENDINGS`.
    """

    def __init__(self) -> None:
        self.maps: dict[str, AnyArray] = {}
        self.meshes: dict[str, str] = {}
        self.folder: TemporaryDirectory[str] | None = None  # of the meshes of the page

    def add_map(self, path: Path) -> str:
        """Read an environment map, and return its name; raise `BrdfkitError` if it is none."""
        _, self.maps[path.name] = load_radiance(path)
        return path.name

    def add_mesh(self, path: Path) -> str:
        """Offer a mesh, and return its name; raise `BrdfkitError` if it cannot be shown."""
        find_shape(str(path))
        for ending in ENDINGS:
            self.meshes[path.name + ending] = f"{path.resolve()}{ending}"
        return path.name

    def keep_mesh(self, path: Path) -> str:
        """Offer a mesh whose file will be deleted, and return its name.

        Raises `BrdfkitError` for a file that is no mesh, and warns if the axis that points up is
        guessed.
        """
        _read(path)
        if self.folder is None:
            self.folder = make_folder()
        own = Path(self.folder.name) / path.name
        with explain_failures():
            shutil.copyfile(path, own)
        return self.add_mesh(own)

    def read_files(self, changes: Mapping[str, Any]) -> State:
        """Return changes with the names of their maps and meshes, after they were read."""
        read = dict(changes)
        for name, add in ((LIGHT, self.add_map), (SHAPE, self.add_mesh)):
            if not isinstance(read.get(name), str | Path):
                continue
            file, part = split_file_and_part(read[name])
            if Path(file).is_file() and (name == LIGHT or Path(file).suffix in mesh_file.SUFFIXES):
                read[name] = add(Path(file)) + (f"#{part}" if part else "")
        return read

    def find_shape(self, name: str) -> str:
        """Return what `find_shape` takes for the setting of a shape."""
        return self.meshes.get(name, name)

    def close(self) -> None:
        """Forget the meshes of the page, which is gone."""
        if self.folder is not None:
            self.folder.cleanup()
            self.folder = None


@in_turn
def _read(path: Path) -> None:
    """Read a mesh for its errors and warnings alone."""
    use_variant()
    mesh_file.read_mesh(path)
