"""Measures materials in Radiance, whose programs are on the PATH or in the wheel pyradiance."""

import functools
import importlib.util
import os
import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

SUN = np.radians(0.05)  # size of the suns
RADIANCE = 1 / (2 * np.pi * (1 - np.cos(SUN / 2)))  # of a sun of irradiance 1
# Direct light alone, at its middle, and none left out
OPTIONS = ["-h", "-V+", "-ab", "0", "-dj", "0", "-dt", "0", "-lr", "0", "-ss", "0", "-st", "1"]


@functools.cache
def find_programs():
    """Return the environment in which Radiance runs; without it, skip the test and say why."""
    found = importlib.util.find_spec("pyradiance")
    if found:
        home = Path(found.origin).parent
        path = f"{home / 'bin'}{os.pathsep}{os.environ['PATH']}"
        return {**os.environ, "PATH": path, "RAYPATH": f".:{home / 'lib'}"}
    if shutil.which("rcontrib"):
        return dict(os.environ)
    return pytest.skip("neither the wheel pyradiance nor Radiance's rcontrib is installed")


def measure(material, wi, wo, up=(0, 1, 0)):
    """Return the BRDF (n, 3) in sr⁻¹ of a file of tensor trees, lit by a sun for each pair.

    `up` is the vector that turns the brush of the material about the normal z.
    """
    names = [f"sun{number}" for number in range(len(wi))]
    scene = [f'void BSDF m 6 0 "{material.name}" {_join(up)} . 0 0']
    scene += ["m polygon p 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0"]
    for name, w in zip(names, wi, strict=True):
        scene += [f"void light {name} 0 0 3 {_join([RADIANCE] * 3)}"]
        scene += [f"{name} source of_{name} 0 0 4 {_join(w)} {np.degrees(SUN)}"]
    rays = [_join([*w / 2, *-w]) for w in wo]
    with TemporaryDirectory() as folder:
        files = [Path(folder, name) for name in ("scene.rad", "suns", "scene.oct")]
        files[0].write_text("\n".join(scene))
        files[1].write_text("\n".join(names))
        files[2].write_bytes(_run("oconv", str(files[0]), cwd=material.parent))
        words = "rcontrib", *OPTIONS, "-M", str(files[1]), str(files[2])
        text = _run(*words, cwd=material.parent, input="\n".join(rays).encode())
    numbers = np.array(text.split(), float).reshape(len(wo), len(wi), 3)
    return np.diagonal(numbers).T / wi[:, 2:]


def _join(numbers):
    return " ".join(f"{number:.9g}" for number in numbers)


def _run(*words, **options):
    done = subprocess.run(
        words, capture_output=True, env=find_programs(), timeout=300, check=False, **options
    )
    assert done.returncode == 0, done.stderr.decode()[-2000:]
    return done.stdout
