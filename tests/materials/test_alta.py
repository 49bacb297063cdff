"""ALTA text: what coordinates, values and intervals mean, against ALTA's own formulas."""

import math

import numpy as np
import pytest
from small_files import alta, place, spectrum

from brdfkit.core.colours import RGB
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.loading import load, save


def rotated(w, angle, axis):
    """`w` turned about the axis y or z, right-handed."""
    (x, y, z), c, s = w, math.cos(angle), math.sin(angle)
    return (c * x + s * z, y, c * z - s * x) if axis == "y" else (c * x - s * y, s * x + c * y, z)


def half_to_cartesian(theta_h, phi_h, theta_d, phi_d):
    """View and light, as in ALTA's params.h: the difference vector is the view's."""
    h = math.sin(theta_h) * math.cos(phi_h), math.sin(theta_h) * math.sin(phi_h), math.cos(theta_h)
    d = math.sin(theta_d) * math.cos(phi_d), math.sin(theta_d) * math.sin(phi_d), math.cos(theta_d)
    view = rotated(rotated(d, theta_h, "y"), phi_h, "z")
    cosine = sum(a * b for a, b in zip(view, h, strict=True))
    return view, tuple(2 * cosine * b - a for a, b in zip(view, h, strict=True))


def spherical(theta, phi):
    return math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)


# parametrisation: coordinates, and (view, light) by the formulas of ALTA's params.cpp
CASES = {
    "SPHERICAL_TL_PL_TV_PV": ((0.4, 0.3, 0.9, -2.0), (spherical(0.9, -2.0), spherical(0.4, 0.3))),
    "ISOTROPIC_TV_TL_DPHI": ((0.4, 0.9, 2.0), (spherical(0.4, 0), spherical(0.9, 2.0))),
    "ISOTROPIC_TL_TV_PROJ_DPHI": (
        (0.4, 0.9 * math.cos(2), 0.9 * math.sin(2)),
        (spherical(0.9, 2.0), spherical(0.4, 0)),
    ),
    "RUSIN_TH_TD_PD": ((0.3, 0.5, 2.0), half_to_cartesian(0.3, 0, 0.5, 2.0)),
    "RUSIN_TH_PH_TD_PD": ((0.3, 1.0, 0.5, 2.0), half_to_cartesian(0.3, 1.0, 0.5, 2.0)),
}


@pytest.mark.quick
@pytest.mark.parametrize("name", CASES)
def test_parametrisations(tmp_path, name):
    coordinates, (view, light) = CASES[name]
    path = place(tmp_path, "alta", alta(name, rows=[(*coordinates, 0.5)]))
    samples = load(path).samples
    np.testing.assert_allclose(samples.wo[0], view, atol=1e-12)
    np.testing.assert_allclose(samples.wi[0], light, atol=1e-12)
    assert samples.values == 0.5


@pytest.mark.quick
def test_file(tmp_path):
    material = load(place(tmp_path, "alta"))
    assert material.channels == ("Y",)
    assert material.info["SAMPLE"] == "A paint"
    assert not material.anisotropic
    np.testing.assert_array_equal(material.values[:, 0], [3, 0.25, 0.125])
    wi, wo = material.samples.wi[0], material.samples.wo[0]
    np.testing.assert_allclose(wo, wi * [-1, -1, 1], atol=1e-12)  # x < 0: across from the light


@pytest.mark.quick
def test_cosine_is_divided_out_except_at_the_horizon(tmp_path):
    rows = [(0.5, 1.0, 0.0, 0.3), (0.5, 0.0, math.pi / 2, 1e-4)]
    data = alta(out="INV_STERADIAN_COSINE_FACTOR", rows=rows)
    material = load(place(tmp_path, "alta", data))
    assert material.values[0] == pytest.approx(0.3 / math.cos(1.0))
    np.testing.assert_array_equal(material.samples.valid, [True, False])
    assert "divided" in material.info["cosine"]
    assert material.info["masked"].startswith("1 rows")


@pytest.mark.quick
def test_values_that_are_not_said_to_be_anything_are_noted(tmp_path):
    assert "not stated" in load(place(tmp_path, "alta", alta(out=None))).info["PARAM_OUT"]


@pytest.mark.quick
@pytest.mark.parametrize(
    ("vs", "ends", "error"), [("1", (0.02,), 0.02), ("2", (0.2, 0.3), 0.05), ("0", (), None)]
)
def test_intervals_are_standard_errors(tmp_path, vs, ends, error):
    rows = [(0.5, 0.5, 0.0, 0.25, *ends)]
    material = load(place(tmp_path, "alta", alta(rows=rows, vs=vs)))
    if error is None:
        assert material.standard_error is None
    else:
        np.testing.assert_allclose(material.standard_error, [[error]])


@pytest.mark.quick
def test_three_values_are_rgb_with_an_interval_each(tmp_path):
    data = alta(rows=[(0.5, 0.5, 0.0, 1, 2, 3, 0.1, 0.2, 0.3, 0.4)])
    data = data.replace(b"#DIM 9 1", b"#DIM 3 3").replace(b"#VS 0", b"#VS 1 2 1")
    material = load(place(tmp_path, "alta", data))
    assert material.channels == RGB
    np.testing.assert_allclose(material.values, [[1, 2, 3]])
    np.testing.assert_allclose(material.standard_error, [[0.1, 0.05, 0.4]])


@pytest.mark.quick
def test_anisotropic_where_the_light_goes_around(tmp_path):
    rows = [(0.5, phi, 0.5, 3.0, 0.25) for phi in (0.0, 1.0)]
    path = place(tmp_path, "alta", alta("SPHERICAL_TL_PL_TV_PV", rows=rows))
    assert load(path).anisotropic
    path = place(tmp_path, "alta", alta("SPHERICAL_TL_PL_TV_PV", rows=rows[:1]))
    assert not load(path).anisotropic


TRAPS = {
    "cut short": (alta()[:-7], "line 9 has 3 columns where 4"),
    "no rows": (alta()[: alta().index(b"\n0.5")], "no rows"),
    "no DIM": (alta().replace(b"#DIM 3 1", b"#dim"), "has no line such as '#DIM 3 1'"),
    "DIM of PARAM_IN": (alta().replace(b"#DIM 3", b"#DIM 4"), "DIM says 4 .* where 3 belong"),
    "two values": (alta().replace(b"#DIM 3 1", b"#DIM 3 2"), "2 values where .* 1 or 3"),
    "no PARAM_IN": (alta().replace(b"#PARAM_IN", b"#IN"), "PARAM_IN is None"),
    "one direction": (alta("COS_TH"), "PARAM_IN is COS_TH, which does not give both directions"),
    "energy": (alta(out="ENERGY"), "PARAM_OUT is ENERGY, which is no BRDF"),
    "binary": (alta() + b"#FORMAT binary\n", "binary form"),
    "interval": (alta().replace(b"#VS 0", b"#VS 3"), "VS is '3' where 0, 1 or 2"),
    "degrees": (alta(rows=[(30, 0, 0, 1)]), "line 7 has the angle 30 .* radians"),
    "text": (alta().replace(b"0.125", b"dark"), "line 9 has 'dark'"),
    "all at the horizon": (
        alta(out="INV_STERADIAN_COSINE_FACTOR", rows=[(0.5, 1.5707963, 0, 1)]),
        "no row is a valid",
    ),
}


@pytest.mark.quick
@pytest.mark.parametrize("trap", TRAPS)
def test_traps(tmp_path, trap):
    data, match = TRAPS[trap]
    with pytest.raises(BrdfkitError, match=rf"paint\.dat: .*{match}"):
        load(place(tmp_path, "alta", data))


@pytest.mark.parametrize("anisotropic", [False, True])
def test_round_trip(tmp_path, anisotropic):
    material = spectrum(anisotropic).rgb
    save(material, tmp_path / "paint.dat")
    back, valid = load(tmp_path / "paint.dat"), material.samples.valid
    assert back.anisotropic == anisotropic
    np.testing.assert_array_equal(back.values, material.values[valid])
    np.testing.assert_array_equal(back.standard_error, material.standard_error[valid])
    before, after = material.samples.at(valid), back.samples
    for a, b in ((before.wi, after.wi), (before.wo, after.wo)):
        np.testing.assert_allclose(a[:, 2], b[:, 2], atol=1e-15)
    cosines = [np.sum(s.wi * s.wo, axis=1) for s in (before, after)]
    np.testing.assert_allclose(*cosines, atol=1e-15)
    if anisotropic:
        np.testing.assert_allclose(before.wi, after.wi, atol=1e-15)
