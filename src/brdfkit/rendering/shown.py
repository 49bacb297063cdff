"""What `render` shows: materials in a scene, a scene file, or a distance field.

Each kind is a class of plain data, which loads its Mitsuba scenes; so the workers of a cluster can
load them, too. Scenes must be freed before another thread renders: kernels of Mitsuba call the
BSDFs of all scenes in the process, and would call one that is being freed.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Self

from brdfkit.core.array_types import AnyArray, BoolArray, MitsubaObject
from brdfkit.core.locate import split_file_and_part
from brdfkit.core.memory import require_memory
from brdfkit.distance_fields import Node
from brdfkit.lighting.environments.map_files import find_map
from brdfkit.materials.resolve import Material
from brdfkit.mitsuba_bridge.scene_file import load_scene_file
from brdfkit.rendering.evidence import find_picture_evidence
from brdfkit.rendering.scene_input.field import SPP as FIELD_SPP
from brdfkit.rendering.scene_input.field import load_field_scene
from brdfkit.rendering.scene_input.loading import find_scene_suffix, load_scenes
from brdfkit.rendering.tracing import count_pixels

SPP = 256  # default number of samples per pixel


@dataclass(frozen=True, eq=False)
class Loaded:
    """Mitsuba scenes by the names of their pictures, and what belongs to the pictures.

    `pixels`: their number in a picture. `spp`: the default number of samples per pixel. `mask`: the
    pixels that show the material, or None. `evidence`: what `find_picture_evidence` tells of them.
    """

    scenes: dict[str, MitsubaObject]
    pixels: int
    spp: int
    mask: BoolArray | None = None
    evidence: dict[str, AnyArray] = field(default_factory=dict)

    def without_scenes(self) -> Loaded:
        """Return the same with None in place of each scene."""
        return replace(self, scenes=dict.fromkeys(self.scenes))


@dataclass(frozen=True, eq=False)
class ShownMaterials:
    """Materials by name, each in the same scene; the other arguments are those of `load_scenes`."""

    materials: dict[str, Material]
    scene: Any
    size: tuple[int, int] | None
    environment: str | Path | None

    @property
    def files(self) -> list[Path]:
        """The user's files of the scene and its environment map."""
        has_file = not callable(self.scene) and find_scene_suffix(self.scene)
        scene = [split_file_and_part(self.scene)[0]] if has_file else []
        light = [] if self.environment is None else [Path(self.environment)]
        return scene + [file for file in light if find_map(file) == file]

    def with_absolute_paths(self) -> Self:
        """Return the same with the absolute paths of its files, for a process in another folder."""
        scene, light = self.scene, self.environment
        for file in self.files:
            if light is not None and Path(light) == file:
                light = file.absolute()
            else:
                scene = str(scene).replace(str(file), str(file.absolute()), 1)
        return replace(self, scene=scene, environment=light)

    def pick(self, name: str) -> Self:
        """Return the same with one of the materials only."""
        return replace(self, materials={name: self.materials[name]})

    def load(self) -> Loaded:
        """Load a scene for each material; raise `BrdfkitError` where that is impossible."""
        described = {name: material.scene_dict() for name, material in self.materials.items()}
        scenes, mask = load_scenes(described, self.scene, self.size, self.environment)
        first = next(iter(scenes.values()))
        require_memory(first.sensors()[0].film().size(), len(scenes))
        evidence = find_picture_evidence(self.materials, first, mask)
        return Loaded(scenes, count_pixels(first), SPP, mask, evidence)


@dataclass(frozen=True, eq=False)
class ShownFile:
    """A Mitsuba scene file, `path`, with its own camera and integrator."""

    path: Path

    @property
    def files(self) -> list[Path]:
        """The scene file."""
        return [self.path]

    def with_absolute_paths(self) -> Self:
        """Return the same with the absolute path, for a process in another folder."""
        return replace(self, path=self.path.absolute())

    def pick(self, name: str) -> Self:
        """Return this itself, as there is only one picture."""
        return self

    def load(self) -> Loaded:
        """Load the scene; raise `BrdfkitError` where that is impossible."""
        scene = load_scene_file(self.path)
        require_memory(scene.sensors()[0].film().size(), 1, self.path)
        spp = scene.sensors()[0].sampler().sample_count()
        return Loaded({self.path.stem: scene}, count_pixels(scene), spp)


@dataclass(frozen=True, eq=False)
class ShownField:
    """A distance field, the graph of its `node`, in a picture of `size` (width, height)."""

    node: Node
    size: tuple[int, int]
    files: tuple[Path, ...] = ()

    def with_absolute_paths(self) -> Self:
        """Return this itself, as it has no files."""
        return self

    def pick(self, name: str) -> Self:
        """Return this itself, as there is only one picture."""
        return self

    def load(self) -> Loaded:
        """Load the scene; raise `BrdfkitError` where that is impossible."""
        require_memory(self.size, 1)
        scene = load_field_scene(self.node, self.size)
        return Loaded({"field": scene}, count_pixels(scene), FIELD_SPP)


Shown = ShownMaterials | ShownFile | ShownField
