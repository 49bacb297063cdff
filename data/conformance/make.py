"""Makes the files of this folder: voxels, exact pictures, and `cases.json`, which tells of them.

    python data/conformance/make.py          # all of them, in two minutes
    python data/conformance/make.py ball     # one

`cases.py` has the cases, `exact.py` the integrals. Twice the nodes change no pixel by more than
1e-9; the tests compare pixels to closed forms and to SciPy's adaptive integration.
"""

import json
import sys
from pathlib import Path

import exact
import nrrd
import numpy as np
import OpenEXR
from cases import CASES

FOLDER = Path(__file__).parent
PIXELS, DISTANCE, BEHIND = 48, 5.0, 0.25
COMMON = {"pixels": PIXELS, "background": BEHIND}


def picture(voxels, told, part=slice(None), nodes=exact.NODES):
    """RGB and the opacity 1 - T of the whole (height, width, 4), or of a part of the pixels."""
    grid = grid_of(voxels, told)
    origins, towards = eye(told)
    lines = [exact.Rays(o, towards) for o in origins[part]]
    return np.stack([RENDERERS[told["renderer"]](grid, line, told, nodes) for line in lines])


def grid_of(voxels, told):
    size = np.array(voxels.shape[::-1])
    return exact.Grid(voxels, np.full(3, -1.0), 2 / size, told["labels"])


def eye(told):
    """Origins (rows, columns, 3) of rays through the middles of pixels, and their direction."""
    towards = np.array(told["towards"]) / np.linalg.norm(told["towards"])
    right = np.cross(towards, [0, 1, 0])
    right /= np.linalg.norm(right)
    x = told["half"] * ((2 * np.arange(PIXELS) + 1) / PIXELS - 1)
    up = -x[:, None, None] * np.cross(right, towards)
    return up + x[:, None] * right - DISTANCE * towards, towards


def emission_absorption(grid, rays, told, nodes):
    transfer = told["transfer"]
    values, rgba = (np.array(transfer[key], float) for key in ("values", "rgba"))
    slope = None
    if "gradients" in transfer:
        slope = exact.Grid(magnitudes(grid), grid.low, grid.spacing)

    def optics(points):
        v = grid(points)
        if slope is None:
            found = interpolated(v, values, rgba)
        else:
            low, high = transfer["gradients"]
            share = np.clip((slope(points) - low) / (high - low), 0, 1)[..., None]
            found = (1 - share) * interpolated(v, values, rgba[0])
            found += share * interpolated(v, values, rgba[1])
        return extinction(found[..., 3], transfer), found[..., :3]

    radiance, t = exact.emission_absorption(grid, rays, optics, np.unique(values), BEHIND, nodes)
    return np.column_stack([radiance, 1 - t])


def maximum_intensity(grid, rays, told, nodes):
    largest = exact.largest(grid, rays)
    rgba = interpolated(largest, *(np.array(told["transfer"][k]) for k in ("values", "rgba")))
    return np.where(np.isnan(largest)[:, None], [BEHIND] * 3 + [0], rgba)


def isosurface(grid, rays, told, nodes):
    """Matte, lit from where it is seen: albedo · cos θ, by the saddle's own normal."""
    t = exact.first_above(grid, rays, told["level"])
    x, y, _ = (rays.o + t[:, None] * rays.d).T
    outwards = np.column_stack([y / 2, x / 2, np.ones_like(x)])
    cosine = np.abs(outwards @ rays.d) / np.linalg.norm(outwards, axis=1)
    return np.column_stack([cosine[:, None] * told["albedo"], np.ones_like(x)])


RENDERERS = {f.__name__: f for f in (emission_absorption, maximum_intensity, isosurface)}


def extinction(a, transfer):
    """σ_t of A, or of the opacity of a layer."""
    if "opacity_unit_distance" in transfer:
        return -np.log1p(-a) / transfer["opacity_unit_distance"]
    return transfer["extinction"] * a


def interpolated(x, values, rgba):
    return np.stack([np.interp(x, values, column) for column in rgba.T], axis=-1)


def magnitudes(grid):
    """‖∇V‖ at the centres of voxels, by central differences."""
    steps = grid.spacing[::-1]
    return np.linalg.norm(np.gradient(grid.voxels.astype(float), *steps), axis=0)


def write(name):
    """The files of a case; what `cases.json` says of it."""
    voxels, told = CASES[name]()
    spacing = 2 / np.array(voxels.shape[::-1])
    header = {
        "encoding": "gzip",
        "space dimension": 3,
        "space directions": np.diag(spacing),
        "space origin": spacing / 2 - 1,
    }
    nrrd.write(str(FOLDER / f"{name}.nrrd"), voxels, header, index_order="C")
    pixels = picture(voxels, told).astype(np.float32)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGBA": pixels}).write(str(FOLDER / f"{name}.exr"))
    return {"what": CASES[name].__doc__} | told


if __name__ == "__main__":
    index = FOLDER / "cases.json"
    told = json.loads(index.read_text()) if index.exists() else {}
    told |= COMMON | {name: write(name) for name in sys.argv[1:] or CASES}
    index.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
