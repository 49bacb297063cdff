"""Blender draws a turned brush and a ball as `export` said it would, and saves its own file."""

import os
import subprocess

import blender
import numpy as np
import pytest
from six_fits import make_fit

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles
from brdfkit.images.ball.normals import VIEW, find_normals, make_frames
from brdfkit.images.errors.colour_difference import ciede2000

pytestmark = [pytest.mark.oracles, pytest.mark.usefixtures("blenders_python")]


@pytest.fixture(scope="module")
def blenders_python():
    """Blender's Python, or the tests are skipped."""
    return blender.find_python()


@pytest.mark.parametrize("name", ["brushed", "coat"])
@pytest.mark.parametrize("target", ["blender", "osl"])
def test_a_turned_brush_is_drawn_turned(target, name, tmp_path):
    suffix = {"blender": ".py", "osl": ".osl"}[target]
    done = bk.export(make_fit(name), target, tmp_path / f"größe 1{suffix}", accept_loss=True)
    random, turn = np.random.default_rng(1), 0.7
    theta = np.arccos(random.uniform(np.cos(np.radians(85)), 1, (2, 50)))
    phi = random.uniform(0, 2 * np.pi, (2, 50))
    measured = blender.measure(done.paths[0], *from_angles(theta, phi + turn), turn)
    np.testing.assert_allclose(measured, done.drawn.eval(*from_angles(theta, phi)), rtol=1e-3)


def test_blender_saves_its_own_file(tmp_path, monkeypatch):
    program = tmp_path / "blender"
    program.write_text(f'#!/bin/sh\nshift 2\nexec "{blender.find_python()}" "$@"\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    done = bk.export(make_fit("coat"), "blender", tmp_path / "größe 1.py")
    assert [path.name for path in done.paths] == ["größe 1.py", "größe 1.blend"]
    assert done.paths[1].read_bytes()[:4] in (b"BLEN", b"(\xb5/\xfd")  # plain or by Zstandard


RUN = """
import bpy, runpy, sys
other = bpy.data.materials.new("metal")
for _ in range(2):
    runpy.run_path(sys.argv[1])
(made,) = (material for material in bpy.data.materials if "brdfkit" in material)
assert made != other
assert ("Tangent" in made.node_tree.nodes) == (sys.argv[2] == "brushed")
"""


@pytest.mark.parametrize("name", ["metal", "brushed"])
def test_a_second_run_changes_its_own_material_alone(name, tmp_path):
    program = bk.export(make_fit(name), "blender", tmp_path / "metal.py").paths[0]
    words = [blender.find_python(), "-c", RUN, str(program), name]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", ["metal", "brushed"])
def test_a_ball_is_the_same_in_blender(name, tmp_path):
    fit, side = make_fit(name), 64
    done = bk.export(fit, "osl", tmp_path / "a.osl")
    x, y = np.meshgrid(*[(np.arange(side) + 0.5) / side * 2 - 1] * 2)
    inside = np.hypot(x, y) < 0.97
    frames = make_frames(find_normals(x[inside], -y[inside]))
    truth, picture = 0, 0
    for sun in from_angles(np.array([0.4, 0.9, 1.3]), np.array([-2.1, -0.9, -1.6])):
        wi, wo = frames @ sun, frames @ VIEW
        truth += fit.eval(wi, wo) * np.maximum(wi[:, 2:], 0)
        picture += blender.draw_ball(done.paths[0], side, VIEW, sun=sun)[inside]
    white = np.percentile(truth, 99)
    assert ciede2000(truth / white, picture / white).mean() < 0.1


def test_a_blender_that_fails_is_a_warning(tmp_path, monkeypatch):
    program = tmp_path / "blender"
    program.write_text("#!/bin/sh\necho no display >&2\nexit 1\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    with pytest.warns(UserWarning, match=r"made no \.blend of it \(no display\)"):
        done = bk.export(make_fit("metal"), "blender", tmp_path / "a.py")
    assert [path.name for path in done.paths] == ["a.py"]
