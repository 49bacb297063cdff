"""Measures materials in Blender, where its Python is at hand, by `oracles/blender_values.py`.

The environment variable BRDFKIT_BPY_PYTHON names a Python (3.11) with the wheels bpy and NumPy.
"""

import functools
import importlib.util
import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

PROGRAM = Path(__file__).parents[1] / "oracles/blender_values.py"


@functools.cache
def find_python():
    """Return the path of Blender's Python; without one, skip the test and say what to do."""
    python = os.environ.get("BRDFKIT_BPY_PYTHON")
    if python or importlib.util.find_spec("bpy"):
        return python or sys.executable
    return pytest.skip("BRDFKIT_BPY_PYTHON names no Python with Blender's wheel bpy")


def measure(material, wi, wo, turn=0.0):
    """Return the BRDF (n, 3) in sr⁻¹ of a .py or .osl file at directions to light and camera.

    `turn` is the angle [rad] from the surface's x axis to u of the UV map.
    """
    return _run(material, wi=wi, wo=wo, turn=turn)["values"]


def draw_ball(material, side, view, samples=1, **light):
    """Return a linear picture (side, side, 3) of a ball, `view` being the direction to the camera.

    The light is `sun=` (3,), the direction to a sun of irradiance 1, or `environment=` (h, w, 3),
    radiances over the polar angle from +z and the azimuth from +x to +y.
    """
    return _run(material, side=side, view=view, samples=samples, **light)["picture"]


def _run(material, **request):
    with TemporaryDirectory() as folder:
        files = [f"{folder}/{name}.npz" for name in ("request", "result")]
        np.savez(files[0], **request)
        program = [find_python(), str(PROGRAM), str(material), *files]
        done = subprocess.run(program, capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stdout[-1000:] + done.stderr[-3000:]
        with np.load(files[1]) as result:
            return dict(result)
