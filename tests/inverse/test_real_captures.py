"""Real photographs of objects, found through BRDFKIT_CAPTURES; skipped where it is not set."""

import os
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import binary_erosion

from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.chrome_ball import find_light_directions
from brdfkit.inverse.photographs.capture.diagnosis.frame import find_axes, list_turns
from brdfkit.inverse.photographs.capture.diagnosis.lambert import Sample, fit_lambert
from brdfkit.inverse.photographs.capture.load_photographs import load_photographs
from brdfkit.inverse.photographs.capture.number_table import read_vectors
from brdfkit.inverse.photographs.capture.pictures.masks import read_mask
from brdfkit.inverse.photographs.capture.unknown_lights.estimate import estimate_lights

ROOT = Path(os.environ.get("BRDFKIT_CAPTURES", "unset"))
pytestmark = [
    pytest.mark.skipif(not ROOT.is_dir(), reason="BRDFKIT_CAPTURES names no folder"),
    pytest.mark.usefixtures("mi"),
]
BALL = ROOT / "neuralps" / "data" / "DiLiGenT" / "pmsData" / "ballPNG"
SERIES = ROOT / "RafaelMarinheiro+PhotometricStereo" / "images"
PSBOX = ROOT / "yxiong+PSBox" / "data"
OBJECTS = "cat", "buddha", "gray", "rock", "horse", "owl"


def angles(a, b):
    """Angles [degrees] between rows of two arrays."""
    cosine = (a * b).sum(axis=1) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))


def find_normals(capture):
    sample = Sample.take(capture)
    lights = sample.directions * sample.intensities[:, None]
    return fit_lambert(sample.values, sample.counted, lights).scaled_normals, sample.mask


def test_the_ball_of_diligent():
    capture = load_photographs(BALL)
    assert capture.values.shape == (96, 15791, 3)
    assert not capture.notes
    values, lights = capture.values.mean(axis=2), capture.lights
    scaled = fit_lambert(
        values,
        ~capture.lost.any(axis=2),
        lights.directions * lights.intensities.mean(axis=1)[:, None],
    ).scaled_normals
    assert np.median(angles(scaled, capture.normals)) < 3
    x, y, _ = capture.points.T / 71
    sphere = np.stack([x, y, np.sqrt(np.maximum(1 - x**2 - y**2, 0))], axis=1)
    assert np.median(angles(sphere, capture.normals)) < 1


@pytest.mark.parametrize("name", OBJECTS)
def test_series(name):
    capture = load_photographs(SERIES / name, "linear")
    assert not capture.notes
    normals, mask = find_normals(capture)
    for turn in list_turns():  # any other axes are found to be wrong, and corrected
        turned = normals @ np.pad(turn, (0, 1)).T + normals * [0, 0, 1]
        found = find_axes(turned, mask)
        assert found is None or (found[:2, :2] @ turn == np.eye(2)).all()


def test_the_chrome_ball_agrees_with_the_stated_lights():
    names = [SERIES / "chrome" / f"chrome.{k}.png" for k in range(12)]
    found = find_light_directions(names, read_mask(SERIES / "chrome" / "chrome.mask.png"))
    assert angles(found, read_vectors(SERIES / "lights.txt", 12).numbers).max() < 0.5


def test_psbox():
    with pytest.raises(BrdfkitError, match="look like linear"):
        load_photographs(PSBOX)
    capture = load_photographs(PSBOX / "Objects", "linear")
    assert ["no mask" in capture.notes[0], "states no intensities" in capture.notes[1]] == [1, 1]
    assert 0.4 < capture.mask.mean() < 0.5
    assert binary_erosion(capture.mask, iterations=20).any()


@pytest.mark.parametrize(
    ("name", "degrees"), [("buddha", 7), ("horse", 7), ("owl", 7), ("rock", 15)]
)
def test_lights_are_estimated(name, degrees):
    capture = load_photographs(SERIES / name, "linear")
    found = estimate_lights(capture, SERIES / name).lights
    assert np.median(angles(found.directions, capture.lights.directions)) < degrees


def test_photographs_without_lights():
    """Two objects were under the same lights, a grid of four by five equal ones."""
    folder = ROOT / "bchao1+photometric-stereo" / "data"
    cat, frog = (load_photographs(folder / name, "linear").lights for name in ("cat", "frog"))
    assert np.median(angles(cat.directions, frog.directions)) < 10
    assert cat.intensities.std() < 0.05
