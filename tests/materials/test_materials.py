"""Whatever takes a material takes all of them, and says what to give in place of anything else."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.core import catalogue

UP = np.array([[0.0, 0.0, 1.0]])
WARD = bk.models()["ward"]

TAKERS = {
    "albedo": lambda thing: bk.albedo(thing, UP[0]),
    "audit": lambda thing: bk.audit(thing),
    "convert": lambda thing: bk.convert(thing, "never.npz"),
    "plot": lambda thing: bk.plot([WARD(), thing]),
    "render": lambda thing: bk.render([WARD(), thing], spp=1, size=4),
    "evaluate": lambda thing: bk.evaluate(thing, UP, UP),
    "compare": lambda thing: bk.compare(bk.load("dusty_gold"), [WARD(), thing]),
    "compare to": lambda thing: bk.compare(thing, WARD()),
    "check": lambda thing: bk.check(thing, only=["reciprocity"]),
    "fit": lambda thing: bk.fit(thing, "lambert"),
}
# The others take only what was measured
OF_MODELS = TAKERS.keys() - {"audit", "compare to", "fit"}


@pytest.mark.quick
@pytest.mark.parametrize("taker", TAKERS)
@pytest.mark.parametrize(
    ("thing", "said"),
    [
        ("wrad", r"no file, model or material 'wrad'; did you mean ward\? There are abc, .*gold"),
        ("car_pant", r"did you mean car_paint\?"),
        ("ward+wrad", r"no file, model or material 'ward\+wrad'"),
        ("car_paint.astm", r"car_paint\.astm: there is no such file"),
        ("", "The path is empty"),
        (WARD, r"Ward is a model without values; call it: Ward\(\)|Ward.* is a model, where the"),
        (UP, r"^array\(\[\[0\., 0\., 1\.\]\]\) \(ndarray\) is no material"),
        (None, r"^None \(NoneType\) is no material"),
    ],
    ids=str,
)
def test_what_is_no_material_is_refused(taker, thing, said, llvm_variant):
    with pytest.raises(bk.BrdfkitError, match=said):
        TAKERS[taker](thing)


@pytest.mark.parametrize("taker", TAKERS)
def test_a_name_stands_for_its_material(taker, llvm_variant, tmp_path, monkeypatch):
    """That of a model, of a material that comes with brdfkit, or a path, as on the command line."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(catalogue.find_material_file("red_plastic"), "mine.binary.xz")
    for name in ("red_plastic", Path("mine.binary.xz"), *(["ward"] if taker in OF_MODELS else [])):
        TAKERS[taker](name)


@pytest.mark.quick
def test_nothing_to_compare_is_said():
    with pytest.raises(bk.BrdfkitError, match="at least one"):
        bk.compare(bk.load("dusty_gold"), [])


@pytest.mark.quick
@pytest.mark.parametrize("max_angle", [-3, 0, 90.1, 300, float("nan")])
def test_angles_that_are_none_are_refused(max_angle):
    with pytest.raises(bk.BrdfkitError, match=f"max_angle = {max_angle}"):
        bk.compare(bk.load("dusty_gold"), WARD(), max_angle=max_angle)


@pytest.mark.quick
@pytest.mark.parametrize("directions", [np.empty((0, 3)), []])
def test_no_directions_have_no_values(directions):
    for thing, channels in ((bk.load("dusty_gold"), 3), (WARD(), 1)):
        assert bk.evaluate(thing, directions, directions).shape == (0, channels)


@pytest.mark.quick
def test_weights_have_as_many_channels():
    assert bk.evaluate(WARD(diffuse_reflectance=[0.1, 0.2, 0.3]), UP, UP).shape == (1, 3)
    for weight in ([0.1, 0.2], [0.1] * 4, []):
        with pytest.raises(
            bk.BrdfkitError, match=r"ward: specular_reflectance = \[.*three for R, G"
        ):
            WARD(specular_reflectance=weight)


@pytest.mark.quick
def test_load_proposes_the_nearest_material():
    with pytest.raises(bk.BrdfkitError, match="'car_pant'; did you mean car_paint"):
        bk.load("car_pant")
