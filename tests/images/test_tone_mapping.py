"""Tone mapping: identities of the curves, colours by luminance, and pictures by them."""

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.images.tone_mapping import CURVES, ToneMapping

pytestmark = pytest.mark.quick
LIGHT = np.linspace(0, 20, 2001)


@pytest.mark.parametrize("curve", CURVES)
@pytest.mark.parametrize("exposure", [0.25, 4.0])
def test_curves_rise_from_black(curve, exposure):
    shown = ToneMapping(curve, exposure)(LIGHT)
    assert shown[0] == pytest.approx(0, abs=1e-12)
    assert (np.diff(shown) >= 0).all()
    assert shown.max() <= 1
    np.testing.assert_array_equal(shown, ToneMapping(curve)(exposure * LIGHT))
    assert (ToneMapping(curve, exposure=0)(LIGHT) == shown[0]).all()


def test_range():
    shown = ToneMapping("range", low=0.5, high=4.5)([0.2, 0.5, 1.5, 4.5, 9.0])
    np.testing.assert_allclose(shown, [0, 0, 0.25, 1, 1])


@pytest.mark.parametrize("e", [0.3, 1.0, 8.0])
def test_reinhard(e):
    """A half at 1 / ε, the slope ε at 0, and its inverse."""
    tone = ToneMapping("reinhard", exposure=e)
    assert tone([1 / e])[0] == pytest.approx(0.5, abs=1e-12)
    assert tone([1e-9])[0] / 1e-9 == pytest.approx(e, rel=1e-6)
    shown = tone(LIGHT)
    np.testing.assert_allclose(shown / (e * (1 - shown)), LIGHT, atol=1e-9)
    assert shown.max() < 1


def test_logarithmic():
    """The brightest is white, and a third of it as the paper has it."""
    tone = ToneMapping("logarithmic")
    assert tone(LIGHT)[-1] == pytest.approx(1, abs=1e-12)
    assert tone([3.0], brightest=9.0)[0] == pytest.approx(
        np.log10(4) / np.log10(10) * np.log(10) / np.log(2 + 8 * (1 / 3) ** 0.2344652536)
    )
    assert not tone(np.zeros(4)).any()


def test_filmic_as_colour_hdri_has_it():
    light = [[0.48046875, 0.35156256, 0.23632812], [4.40625388, 2.15625895, 1.34375372]]
    shown = [[0.4507954, 0.3619673, 0.2617269], [0.9725554, 0.8557374, 0.7465713]]
    np.testing.assert_allclose(ToneMapping("filmic")(light), shown, atol=1e-7)


@pytest.mark.parametrize("curve", CURVES)
def test_by_luminance_colours_stay(curve):
    """Until a channel is full; a grey is as by channels."""
    light = np.array([[0.1, 0.2, 0.05], [0.3, 0.3, 0.3], [0.0, 0.0, 0.0]])
    tone = ToneMapping(curve, by="luminance")
    shown = tone(light, brightest=2.0)
    np.testing.assert_allclose(shown[0] / shown[0, 1], light[0] / light[0, 1], rtol=1e-12)
    np.testing.assert_allclose(shown[1], ToneMapping(curve)(light[1], brightest=2.0))
    assert not shown[2].any()


def test_what_is_no_number_stays_visible():
    for by in ("channel", "luminance"):
        shown = ToneMapping("logarithmic", by=by)(
            [[np.nan] * 3, [np.inf] * 3, [2.0] * 3, [-1.0] * 3]
        )
        assert np.isnan(shown[:2]).all()
        np.testing.assert_allclose(shown[2:], [[1.0] * 3, [0.0] * 3])


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"curve": "reinhart"}, "did you mean reinhard"),
        ({"by": "hue"}, "channel, luminance"),
        ({"exposure": -1}, "exposure = -1 should be a number, at least 0"),
        ({"exposure": np.nan}, "exposure = nan"),
        ({"low": 2}, "low = 2 should be below high = 1"),
    ],
)
def test_what_is_no_tone_mapping(wrong, said):
    with pytest.raises(bk.BrdfkitError, match=said):
        ToneMapping(**wrong)
