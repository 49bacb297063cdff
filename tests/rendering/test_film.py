"""Films: a camera that goes around a volume, frames of one exposure, files that repeat."""

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image, ImageSequence

from brdfkit import BrdfkitError, ToneMapping
from brdfkit.cli import main
from brdfkit.rendering import Film, render_orbit
from brdfkit.volumes import TransferFunction, Volume

pytestmark = pytest.mark.usefixtures("module_in_llvm")
GREY = TransferFunction.from_colormap("gray", (0, 1), opacity=[(0, 1), (1, 1)])
LOOK = {"transfer": GREY, "renderer": "maximum_intensity", "size": 24, "spp": 2, "elevation": 0}


def rod():
    """A rod along x through the middle, its one end brighter: as wide as can be from the front."""
    values = np.full((9, 9, 9), 0.1)
    values[4, 4] = np.linspace(0.5, 1, 9)
    return Volume(values)


def test_a_turn_sees_all_sides_from_one_distance():
    """The opposite frame is mirrored: the rod's bright end is left, not right, and as far out."""
    front, right, back, left = render_orbit(rod(), frames=4, azimuth=0, **LOOK).frames
    seen = [np.flatnonzero(f[..., 0].max(axis=0) > 0.08) for f in (front, right, back, left)]
    across = [np.ptp(columns) for columns in seen]
    assert min(across[0], across[2]) > 3 * max(across[1], across[3])
    assert abs(seen[0].min() - (23 - seen[2].max())) <= 1
    assert front[..., 0].max(axis=0).argmax() > 14
    assert back[..., 0].max(axis=0).argmax() < 9


def test_progress_counts_all_frames():
    told = []
    found = render_orbit(rod(), frames=3, progress=lambda *given: told.append(given), **LOOK)
    assert told == [(k + 1, 6) for k in range(6)]
    assert (len(found.frames), found.requested, found.spp) == (3, 3, 2)


@pytest.mark.parametrize(("at", "kept"), [(1, 1), (3, 1), (4, 2)])
def test_ctrl_c_keeps_the_frames_that_are_finished(at, kept):
    """Two passes a frame; of the first one even a pass is kept."""

    def stop(done, total):
        if done == at:
            raise KeyboardInterrupt

    found = render_orbit(rod(), frames=3, progress=stop, **LOOK)
    assert (len(found.frames), found.requested) == (kept, 3)


def ramps(count=5):
    """Frames of a smooth ramp, each brighter than the one before."""
    ramp = np.linspace(0, 1, 64)[None, :, None] * np.ones((16, 1, 3))
    return [np.float32(0.2 * (k + 1) * ramp) for k in range(count)]


@pytest.mark.parametrize("suffix", [".gif", ".png", ".webp"])
def test_files_repeat_and_have_one_exposure(tmp_path, suffix):
    path = tmp_path / f"turn{suffix}"
    Film(ramps(), 5, 1, 0.0, ToneMapping("reinhard")).write(path)
    with Image.open(path) as film:
        assert film.n_frames == 5
        assert film.info["loop"] == 0
        frames = [np.array(f.convert("RGB"), float) for f in ImageSequence.Iterator(film)]
    means = [f.mean() for f in frames]
    assert (np.diff(means) > 5).all()  # brighter from frame to frame, as they are
    blurred = frames[-1][..., 0].reshape(16, 16, 4).mean(axis=(0, 2))
    assert (np.diff(blurred) > 0).all()  # no bands


@pytest.mark.parametrize(("how", "message"), [({"frames": 1}, "frames"), ({"seconds": 0}, "sec")])
def test_what_is_no_film_is_said(how, message):
    with pytest.raises(BrdfkitError, match=message):
        render_orbit("sphere", **how)


def test_the_command_makes_a_film(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = "render sphere --orbit 3 --size 16 --spp 2 --renderer maximum_intensity"
    made = CliRunner().invoke(main, words.split())
    assert made.exit_code == 0, made.output
    assert "3 frames of 16×16 pixels, 2 spp" in made.output
    with Image.open("sphere.gif") as film:
        assert film.n_frames == 3
    refused = CliRunner().invoke(main, [*words.split(), "-o", "turn.jpg"])
    assert refused.exit_code == 2
    assert "films are written as .gif, .png, .webp" in refused.output
