"""Tables as people make them, of a known material: a right fit, or a sentence that says why not."""

import io
import re

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles

TRUTH = {"diffuse_reflectance": 0.3, "specular_reflectance": 0.6, "alpha_u": 0.25, "f0": 0.5}
ANGLES = ["theta_i", "theta_o", "delta_phi"]
MIRRORED = "mirror_azimuth=True (--mirror-azimuth) mends"
WITH_COSINE = "the values seem to be the BRDF times cos theta_o"
IN_PLANE = "measured in the plane of incidence only"


def table(theta_i=(0, 15, 30, 45, 60), theta_o=range(0, 81, 10), delta_phi=range(0, 360, 30)):
    """The material on a grid of angles [degrees]."""
    grid = np.meshgrid(theta_i, theta_o, delta_phi, indexing="ij")
    frame = pd.DataFrame(dict(zip(ANGLES, (angle.ravel() for angle in grid), strict=True)))
    i, o, phi = np.radians(frame.to_numpy(float).T)
    model = bk.models()["ggx"](**TRUTH)
    return frame.assign(BRDF=model.eval(from_angles(i, 0 * i), from_angles(o, phi)).mean(axis=1))


def mirrored(frame):
    return frame.assign(delta_phi=(frame["delta_phi"] + 180) % 360)


def with_cosine(frame):
    return frame.assign(BRDF=frame["BRDF"] * np.cos(np.radians(frame["theta_o"])))


def in_radians(frame, unit=""):
    angles = {name + unit: np.radians(frame[name]) for name in ANGLES}
    return pd.DataFrame(angles).assign(BRDF=frame["BRDF"])


def in_rows(frame):
    """A row for each wavelength, those of one direction far from each other."""
    return pd.concat([frame.assign(wavelength=nm) for nm in (450, 550, 650)])


def noisy(frame):
    random = np.random.default_rng(0).standard_normal(len(frame))
    return frame.assign(BRDF=frame["BRDF"] * (1 + 0.05 * random))


def with_holes(frame):
    empty, missing = np.random.default_rng(0).random((2, len(frame))) < 0.2
    return frame.assign(BRDF=frame["BRDF"].mask(empty))[~missing]


IN_ONE_PLANE = table((10, 30, 50), range(-80, 81, 10), [180])
GLOSS = pd.concat([table([theta], [theta], [180]) for theta in (20, 60, 85)])
ONE_INCIDENCE = "at one angle of incidence"
# The table, whether its fit is right, and what is said of it
READ = {
    "azimuth mirrored": (mirrored(table()), False, MIRRORED),
    "azimuth mirrored, in the plane": (mirrored(IN_ONE_PLANE), False, MIRRORED),
    "times cosine": (with_cosine(table()), False, f"{WITH_COSINE}, because exchanging"),
    "times cosine, one incidence": (
        with_cosine(table([45], range(-80, 81, 5), [180])),
        False,
        f"{WITH_COSINE}, because they fall",
    ),
    "degrees": (table(), True, ""),
    "radians with a unit": (in_radians(table(), " [rad]"), True, ""),
    "wavelengths in rows": (in_rows(table()), True, ""),
    "in the plane, signed": (IN_ONE_PLANE, True, IN_PLANE),
    "sixteen rows": (table([30, 60], [0, 20, 40, 60], [0, 180]), True, IN_PLANE),
    "noise": (noisy(table()), True, ""),
    "holes": (with_holes(table()), True, ""),
    "0 where nothing was measured": (
        with_holes(table()).fillna(0),
        False,
        "% of the samples are exactly 0",
    ),
    "one incidence": (table([45]), True, ONE_INCIDENCE),
    "light along the normal": (table([0]), True, ONE_INCIDENCE),
    "gloss meter": (GLOSS, False, "2 numbers were measured for 4 that are sought"),
}


def save(frame, folder):
    path = folder / "mine.csv"
    frame.to_csv(path, index=False)
    return path


def fit(path, **mends):
    """The fit of the true model to a file, and whether it is right."""
    found = bk.fit(bk.load(path, **mends), "ggx", starts=12)
    wi, wo = from_angles(0.7, 0.0), from_angles(np.linspace(-1.2, 1.2, 9), 0.0)
    true, fitted = (
        model.eval(np.broadcast_to(wi, wo.shape), wo).mean(axis=1)
        for model in (bk.models()["ggx"](**TRUTH), found.model)
    )
    return found, bool((np.abs(fitted / true - 1) < 0.05).all())


@pytest.mark.parametrize("case", READ)
def test_a_right_fit_or_a_sentence_that_says_why_not(case, tmp_path):
    frame, is_right, said = READ[case]
    path = save(frame, tmp_path)
    found, right = fit(path)
    assert right == is_right
    doubts = [note for note in found.notes if re.search("mends|measured|exactly 0", note)]
    beyond = "extrapolates|the fit follows|this fit reaches"  # notes on unmeasured directions
    doubts = [note for note in doubts if not re.search(beyond, note)]
    if not said:
        assert not doubts
    assert said in "; ".join(doubts)
    if "sought" not in said:  # of the model, not of the data
        assert all(doubt in bk.audit(path).findings() for doubt in doubts)


@pytest.mark.parametrize("changes", [[mirrored], [with_cosine], [mirrored, with_cosine]])
def test_what_is_said_to_mend_a_table_mends_it(changes, tmp_path):
    frame = table()
    for change in changes:
        frame = change(frame)
    path = save(frame, tmp_path)
    notes = " ".join(fit(path)[0].notes)
    mends = dict.fromkeys(re.findall(r"(\w+)=True", notes), True)
    assert len(mends) == len(changes)
    found, right = fit(path, **mends)
    assert right
    assert "mends" not in " ".join(found.notes)

    # the same on the command line, and once only
    options = re.findall(r"\((--[\w-]+)\)", notes)
    mended = str(tmp_path / "mended.csv")
    run = CliRunner().invoke(main, ["convert", str(path), mended, *options])
    assert run.exit_code == 0, run.output
    np.testing.assert_allclose(bk.load(mended).values, bk.load(path, **mends).values)
    with pytest.raises(BrdfkitError, match="was converted already"):
        bk.load(mended, **mends)


REFUSED = {
    "radians without a unit": (
        in_radians(table()),
        r"might be degrees or radians; state the unit in the",
    ),
    "in the plane without azimuth": (IN_ONE_PLANE.drop(columns="delta_phi"), "180 throughout"),
    "percent": (table().rename(columns={"BRDF": "BRDF [%]"}), "1/sr for values .* convert"),
    "micrometres": (in_rows(table()).eval("wavelength = wavelength / 1000"), "give nanometres"),
    "an angle that is empty": (table().assign(theta_o=np.nan), "theta_o is nan in line 2"),
    "wavelengths and R, G, B": (
        in_rows(table()).assign(R=1, G=1, B=1).drop(columns="BRDF"),
        "values of R, G, B beside a column wavelength; keep one column of values, BRDF",
    ),
    "other directions at other wavelengths": (
        table([30], [20, 40], [180]).assign(wavelength=[450, 550]),
        "no pair of directions has values in all of its 2 channels, 450nm to 550nm",
    ),
}


@pytest.mark.quick
@pytest.mark.parametrize("case", REFUSED)
def test_a_table_that_is_refused_says_why(case, tmp_path):
    frame, said = REFUSED[case]
    with pytest.raises(BrdfkitError, match=f"mine.csv: .*{said}"):
        bk.load(save(frame, tmp_path))


@pytest.mark.quick
def test_decimal_commas_between_commas_are_told(tmp_path):
    path = tmp_path / "mine.csv"
    text = "theta_i,theta_o,delta_phi,BRDF\n30,0,10,5,180,0,0,25\n"
    for row in (text, text.replace("30,0,10,5,180,0", "30,10,180"), text.replace("25", "25,,,")):
        path.write_text(row)
        with pytest.raises(
            BrdfkitError, match=r"line 2 has . columns where 4 belong, probably bec"
        ):
            bk.load(path)
    path.write_text(text.replace("180,0,0,25", "x"))
    with pytest.raises(BrdfkitError, match="cut short"):
        bk.load(path)


@pytest.mark.quick
def test_rows_of_channels_are_those_of_columns(tmp_path):
    """In any order, with directions that are rounded, errors, a hole and a repeated row."""
    text = """theta_i,theta_o,delta_phi,channel,CCBRDF,CCBRDF_error
30,60,180,G,0.2,0.02
30,60,180,Red,0.1,0.01
30,60.001,180,b,0.3,0.03
30,0,0,R,1,0.1
30,0,90,G,2,0.1
30,0,180,B,n/a,0.1
30,60,180,B,0.4,0.04
"""
    (tmp_path / "mine.csv").write_text(text)
    found = bk.load(tmp_path / "mine.csv")
    twin = bk.Measured.from_frame(pd.read_csv(io.StringIO(text)))
    for data in (found, twin):
        assert data.channels == ("R", "G", "B")
        np.testing.assert_array_equal(data.samples.valid, [True, False, False])
        np.testing.assert_allclose(data.values[0], [0.2, 0.4, 0.6])
        np.testing.assert_allclose(data.values[1], [1, 2, np.nan])
        np.testing.assert_allclose(data.values[2], [np.nan, np.nan, 0.8])
        np.testing.assert_allclose(data.standard_error[0], [0.02, 0.04, 0.06])
    assert found.info["channels"] == "3, a row each, at 3 pairs of directions"
    for wrong, other, said in (
        ("b,", "X,", "line 4 is not R, G or B"),
        ("G,", "R,", "no row"),
    ):
        (tmp_path / "mine.csv").write_text(text.replace(wrong, other))
        with pytest.raises(BrdfkitError, match=said):
            bk.load(tmp_path / "mine.csv")


@pytest.mark.quick
def test_rows_of_wavelengths_are_those_of_columns():
    """Shuffled; the order of the directions is then another."""
    wide, names = table((15, 45), range(10, 81, 10)).drop(columns="BRDF"), ["450nm", "1064.5nm"]
    wide[names] = np.random.default_rng(1).random((len(wide), 2))
    rows = wide.melt(ANGLES, names, "λ [nm]", "BRDF").sample(frac=1, random_state=2)
    rows["λ [nm]"] = rows["λ [nm]"].str.removesuffix("nm").astype(float)
    found, twin = bk.Measured.from_frame(rows), bk.Measured.from_frame(wide)
    assert found.channels == twin.channels
    there, here = (
        np.unique(np.hstack([data.samples.wi, data.samples.wo, data.values]), axis=0)
        for data in (found, twin)
    )
    np.testing.assert_array_equal(there, here)


@pytest.mark.quick
def test_what_states_its_convention_is_not_mended():
    for option in ("mirror_azimuth", "divide_by_cos"):
        with pytest.raises(BrdfkitError, match=rf"^plaster: is a table, .* leave out {option} \("):
            bk.load("plaster", **{option: True})
        lookup = bk.Measured.from_samples([[0, 0, 1]], [[0, 0, 1]], [1.0], lookup=np.multiply)
        with pytest.raises(BrdfkitError, match="has a format that states its directions"):
            lookup.mend(**{option: True})
        flag = "--" + option.replace("_", "-")
        for words, said in (
            (["info", "studio", flag], "studio is an environment map"),
            (["info", flag], "name a FILE"),
            (["fit", "plaster", "car_paint", "-m", "lambert", flag], "mends one FILE"),
            (["convert", "lambert", "x.csv", flag], "lambert was not measured"),
        ):
            run = CliRunner().invoke(main, words)
            assert run.exit_code == 2
            assert said in run.output


@pytest.mark.quick
def test_a_grazing_view_does_not_tell_its_brdf():
    wo = from_angles(np.radians([0, 60, 89.99]), 0.0)
    wi = np.broadcast_to([0, 0, 1.0], wo.shape)
    data = bk.Measured.from_samples(wi, wo, [1, 1, 1], standard_error=[1, 1, 1])
    mended = data.mend(divide_by_cos=True)
    np.testing.assert_array_equal(mended.samples.valid, [True, True, False])
    np.testing.assert_allclose(mended.values[:2, 0], [1, 2])
    np.testing.assert_allclose(mended.standard_error[:2, 0], [1, 2])
    assert mended.info["cosine"].endswith("are divided by it")
    assert data.mend() is data


@pytest.mark.quick
def test_many_models_say_what_is_doubtful_once(tmp_path):
    path = str(save(mirrored(table()), tmp_path))
    run = CliRunner().invoke(main, ["fit", path, "-m", "ward", "-m", "lambert"])
    assert run.output.count("--mirror-azimuth") == 1
    assert run.output.startswith("! the values are")


@pytest.mark.parametrize("noise", [0.0, 0.03])
@pytest.mark.parametrize("alpha", [0.05, 0.12, 0.25])
def test_a_mirrored_azimuth_is_told_on_a_grid_of_large_steps(alpha, noise):
    """Also where the highlight is hardly brighter than the white ground."""
    angles = np.meshgrid([15, 30, 45, 60, 75], range(0, 76, 5), range(0, 331, 30), indexing="ij")
    theta_i, theta_o, phi = (np.radians(a.ravel()) for a in angles)
    wi, wo = from_angles(theta_i, 0.0), from_angles(theta_o, phi)
    model = bk.models()["ggx"](diffuse_reflectance=0.5, alpha_u=alpha, alpha_v=alpha, f0=0.05)
    values = model.eval(wi, wo) * np.random.default_rng(0).normal(1, noise, (len(wi), 1))
    for turn, told in (([1, 1, 1], False), ([-1, -1, 1], True)):
        notes = bk.fit(bk.Measured.from_samples(wi, wo * turn, values), "ggx").notes
        assert any("--mirror-azimuth" in note for note in notes) == told


@pytest.mark.quick
def test_directions_without_all_wavelengths_are_counted():
    rows = pd.DataFrame(
        [(30, theta, 0, nm, 0.1) for theta in range(0, 60, 10) for nm in (450, 550, 650)],
        columns=["theta_i", "theta_o", "delta_phi", "wavelength", "brdf"],
    ).drop(index=[4, 5])
    found = bk.Measured.from_frame(rows, unit="deg")
    assert found.info["without all wavelengths"] == "1 of 6 pairs of directions, masked"
