"""Whatever takes a material takes all of them, and says what to give in place of anything else."""

import numpy as np
import pytest

import brdfkit as bk

UP = np.array([[0.0, 0.0, 1.0]])
WARD = bk.models()["ward"]

TAKERS = {
    "evaluate": lambda thing: bk.evaluate(thing, UP, UP),
    "compare": lambda thing: bk.compare(bk.load("dusty_gold"), [WARD(), thing]),
    "compare to": lambda thing: bk.compare(thing, WARD()),
    "check": lambda thing: bk.check(thing, only=["reciprocity"]),
    "fit": lambda thing: bk.fit("ward", thing),
}


@pytest.mark.quick
@pytest.mark.parametrize("taker", TAKERS)
@pytest.mark.parametrize(
    ("thing", "said"),
    [
        ("car_paint", r"'car_paint' is a name, .* brdfkit\.load\('car_paint'\)"),
        ("ward", r"'ward' is a name, .* brdfkit\.models\(\)\['ward'\]\(\)"),
        (WARD, r"Ward is a model without values; call it: Ward\(\)"),
        (UP, "A ndarray is no material"),
        (None, "A NoneType is no material"),
    ],
    ids=str,
)
def test_what_is_no_material_is_refused(taker, thing, said, llvm_variant):
    with pytest.raises(bk.BrdfkitError, match=said):
        TAKERS[taker](thing)


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
    with pytest.raises(bk.BrdfkitError, match="ward: the weights have 2 and 3 channels"):
        WARD(diffuse_reflectance=[0.1, 0.2], specular_reflectance=[0.1, 0.2, 0.3])
