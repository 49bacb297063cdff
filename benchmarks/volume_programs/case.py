"""Reads the cases of the conformance set of volumes from `data/conformance/`."""

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
DISTANCE = 5.0  # distance of the eye from the centre of the cube


@dataclass(frozen=True)
class Case:
    """A case of the conformance set; `entry`: its entry in `cases.json`."""

    name: str

    @property
    def entry(self):
        return INDEX[self.name]

    @property
    def transfer(self):
        return self.entry["transfer"]

    @property
    def renderer(self):
        return self.entry["renderer"]

    @cached_property
    def voxels(self):
        """The values of the voxels (nz, ny, nx), which fill the cube from -1 to 1."""
        return nrrd.read(str(FOLDER / f"{self.name}.nrrd"), index_order="C")[0]

    @cached_property
    def exact(self):
        """The exact picture, RGB and opacity (height, width, 4)."""
        return OpenEXR.File(str(FOLDER / f"{self.name}.exr")).channels()["RGBA"].pixels

    @property
    def spacing(self):
        """The edges of a voxel along x, y and z."""
        return 2 / np.array(self.voxels.shape[::-1])

    @property
    def values(self):
        """The values (n,) of the transfer function's control points."""
        return np.array(self.transfer["values"], float)

    @property
    def rgba(self):
        """RGB and opacity (n, 4) at the control points.

        For a function of gradient magnitudes, they are those at its upper end.
        """
        rgba = np.array(self.transfer["rgba"], float)
        return rgba if rgba.ndim == 2 else rgba[-1]

    @property
    def view_axes(self):
        """The unit vectors of the view: forward, to the right, and up."""
        towards = np.array(self.entry["towards"]) / np.linalg.norm(self.entry["towards"])
        right = np.cross(towards, [0, 1, 0])
        right /= np.linalg.norm(right)
        return towards, right, np.cross(right, towards)

    @property
    def rays(self):
        """The origins and directions (height · width, 3) of rays through the centres of pixels."""
        towards, right, up = self.view_axes
        x = self.entry["half"] * ((2 * np.arange(PIXELS) + 1) / PIXELS - 1)
        origins = x[:, None] * right - x[:, None, None] * up - DISTANCE * towards
        return origins.reshape(-1, 3), np.broadcast_to(towards, (PIXELS**2, 3))

    def sample_transfer(self, n=2000):
        """Return the transfer function at many values: values (k,), RGB (k, 3) and σ_t (k,).

        A value at which the function jumps is there twice; `n`: number of evenly spaced values.
        """
        steps = self.values[1:][np.diff(self.values) == 0]
        even = np.linspace(self.values[0], self.values[-1], n)
        v = np.sort(np.concatenate([even, self.values, np.nextafter(steps, -np.inf)]))
        v = np.unique(v)
        rgba = np.stack([np.interp(v, self.values, column) for column in self.rgba.T], axis=-1)
        if "opacity_unit_distance" in self.transfer:
            return v, rgba[:, :3], -np.log1p(-rgba[:, 3]) / self.transfer["opacity_unit_distance"]
        return v, rgba[:, :3], rgba[:, 3] * self.transfer["extinction"]
