"""A case of the conformance set, from `data/conformance/`."""

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import nrrd
import numpy as np
import OpenEXR

FOLDER = Path(__file__).parents[2] / "data/conformance"
INDEX = json.loads((FOLDER / "cases.json").read_text(encoding="utf-8"))
NAMES = [name for name, told in INDEX.items() if isinstance(told, dict)]
PIXELS, BEHIND = INDEX["pixels"], INDEX["background"]
DISTANCE = 5.0  # of the eye from the middle of the cube


@dataclass(frozen=True)
class Case:
    """One case; `told` is its entry in `cases.json`."""

    name: str

    @property
    def told(self):
        return INDEX[self.name]

    @property
    def transfer(self):
        return self.told["transfer"]

    @property
    def renderer(self):
        return self.told["renderer"]

    @cached_property
    def voxels(self):
        """(nz, ny, nx), in the cube from -1 to 1."""
        return nrrd.read(str(FOLDER / f"{self.name}.nrrd"), index_order="C")[0]

    @cached_property
    def exact(self):
        """RGB and opacity (height, width, 4)."""
        return OpenEXR.File(str(FOLDER / f"{self.name}.exr")).channels()["RGBA"].pixels

    @property
    def spacing(self):
        """Of voxels along x, y, z."""
        return 2 / np.array(self.voxels.shape[::-1])

    @property
    def values(self):
        """Of the control points (n,)."""
        return np.array(self.transfer["values"], float)

    @property
    def rgba(self):
        """At them (n, 4); of a function of gradient magnitudes, at its upper end."""
        rgba = np.array(self.transfer["rgba"], float)
        return rgba if rgba.ndim == 2 else rgba[-1]

    @property
    def eye(self):
        """(towards, right, up): unit vectors."""
        towards = np.array(self.told["towards"]) / np.linalg.norm(self.told["towards"])
        right = np.cross(towards, [0, 1, 0])
        right /= np.linalg.norm(right)
        return towards, right, np.cross(right, towards)

    @property
    def rays(self):
        """Origins (height · width, 3) and directions of the rays through the middles of pixels."""
        towards, right, up = self.eye
        x = self.told["half"] * ((2 * np.arange(PIXELS) + 1) / PIXELS - 1)
        origins = x[:, None] * right - x[:, None, None] * up - DISTANCE * towards
        return origins.reshape(-1, 3), np.broadcast_to(towards, (PIXELS**2, 3))

    def sampled(self, n=2000):
        """Values (k,), steps twice, with RGB (k, 3) and σ_t (k,): the function on many points."""
        steps = self.values[1:][np.diff(self.values) == 0]
        even = np.linspace(self.values[0], self.values[-1], n)
        v = np.sort(np.concatenate([even, self.values, np.nextafter(steps, -np.inf)]))
        v = np.unique(v)
        rgba = np.stack([np.interp(v, self.values, column) for column in self.rgba.T], axis=-1)
        if "opacity_unit_distance" in self.transfer:
            return v, rgba[:, :3], -np.log1p(-rgba[:, 3]) / self.transfer["opacity_unit_distance"]
        return v, rgba[:, :3], rgba[:, 3] * self.transfer["extinction"]
