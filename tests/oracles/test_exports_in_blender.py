"""Blender draws what `export` said it would: values of six fits, a rotated brush, and a ball."""

import os

import blender
import numpy as np
import pytest
from six_fits import SIX_FITS, make_fit

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles

pytestmark = [pytest.mark.oracles, pytest.mark.usefixtures("blenders_python")]


@pytest.fixture(scope="module")
def blenders_python():
    """Blender's Python, or the tests are skipped."""
    return blender.find_python()


@pytest.mark.parametrize("turn", [0.0, 0.7], ids=["straight", "turned"])
@pytest.mark.parametrize("name", SIX_FITS)
@pytest.mark.parametrize("target", ["blender", "osl"])
def test_values_are_those_that_were_told(target, name, turn, tmp_path):
    suffix = {"blender": ".py", "osl": ".osl"}[target]
    done = bk.export(make_fit(name), target, tmp_path / f"größe 1{suffix}", accept_loss=True)
    random = np.random.default_rng(1)
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
