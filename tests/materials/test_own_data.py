"""Samples of a user's own: angles, DataFrames and CSV say the same directions and values."""

import io
import itertools
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from brdfkit.core.colours import RGB
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.loading import load, save
from brdfkit.materials.measured import Measured

HALF, ROOT = 0.5, np.sqrt(0.75)  # sin and cos of 30°
LEFT, RIGHT, BACK = (HALF, 0, ROOT), (-HALF, 0, ROOT), (0, HALF, ROOT)  # 30° from the normal
UP = (0, 0, 1)

# -- conventions, against directions by hand ------------------------------------------------

CONVENTIONS = {
    "mirror": ({"theta_i": 30, "phi_i": 0, "theta_o": 30, "phi_o": 180}, LEFT, RIGHT),
    "towards the light": ({"theta_i": 30, "phi_i": 0, "theta_o": 30, "phi_o": 0}, LEFT, LEFT),
    "the light's side": ({"theta_i": 30, "phi_i": 0, "theta_o": -30, "phi_o": 180}, LEFT, LEFT),
    "a signed axis": ({"theta_i": -30, "phi_i": 0, "theta_o": 30, "phi_o": 0}, RIGHT, LEFT),
    "azimuth of the light": ({"theta_i": 30, "phi_i": 90, "theta_o": 0, "phi_o": 9}, BACK, UP),
    "a full turn": ({"theta_i": 30, "phi_i": -360, "theta_o": 30, "phi_o": 360}, LEFT, LEFT),
    "relative, mirror": ({"theta_i": 30, "theta_o": 30, "delta_phi": 180}, LEFT, RIGHT),
    "relative, across": ({"theta_i": 30, "theta_o": 30, "delta_phi": 90}, LEFT, BACK),
    "half, mirror": ({"theta_h": 0, "theta_d": 30, "phi_d": 0}, LEFT, RIGHT),
    "half, towards the light": ({"theta_h": 30, "theta_d": 0, "phi_d": 7}, LEFT, LEFT),
    "half, in the plane": ({"theta_h": 15, "theta_d": 15, "phi_d": 0}, LEFT, UP),
    "half, exchanged": ({"theta_h": 15, "theta_d": 15, "phi_d": 180}, UP, LEFT),
    "half, turned": ({"theta_h": 30, "phi_h": 90, "theta_d": 0, "phi_d": 0}, BACK, BACK),
    "vectors": (
        {"wi_x": 0, "wi_y": HALF, "wi_z": ROOT, "wo_x": 0, "wo_y": 0, "wo_z": 1},
        BACK,
        UP,
    ),
}


@pytest.mark.quick
@pytest.mark.parametrize("case", CONVENTIONS)
def test_conventions(case):
    columns, wi, wo = CONVENTIONS[case]
    data = Measured.from_frame({**columns, "BRDF": 0.25}, unit="degrees")
    np.testing.assert_allclose(data.samples.wi, [wi], atol=1e-15)
    np.testing.assert_allclose(data.samples.wo, [wo], atol=1e-15)
    assert data.channels == ("Y",)
    if "wi_x" not in columns:
        in_radians = {f"{name} [rad]": np.radians(angle) for name, angle in columns.items()}
        same = Measured.from_frame({**in_radians, "BRDF": 0.25}).samples
        np.testing.assert_allclose(same.wi, [wi], atol=1e-15)
    if "phi_i" in columns:
        same = Measured.from_angles(*columns.values(), 0.25, unit="degrees")
        assert same.checksum == data.checksum


@pytest.mark.quick
def test_a_grid_of_angles_is_its_samples_one_by_one():
    theta_i, theta_o, phi = [10, 60], [0, 30, 75], [0, 90, 135, 180]
    values = np.random.default_rng(0).random((2, 3, 4, 3))
    axes = np.array(theta_i)[:, None, None], np.array(theta_o)[:, None], phi
    grid = Measured.from_angles(axes[0], 0, *axes[1:], values, standard_error=values / 9)
    rows = np.array(list(itertools.product(theta_i, [0], theta_o, phi)))
    flat = Measured.from_angles(*rows.T, values.reshape(-1, 3))
    assert grid.checksum == flat.checksum
    assert (grid.channels, grid.anisotropic) == (RGB, False)
    np.testing.assert_array_equal(grid.standard_error, values.reshape(-1, 3) / 9)


@pytest.mark.quick
def test_a_light_that_turns_is_of_an_anisotropic_material_unless_it_is_said():
    turned = {"theta_i": [0, 40, 40], "phi_i": [5, 0, 90], "theta_o": 50, "phi_o": 180, "BRDF": 1}
    assert Measured.from_frame(turned).anisotropic
    assert not Measured.from_frame(turned, anisotropic=False).anisotropic
    assert Measured.from_angles(40, [0, 90], 50, 180, [1, 1]).anisotropic
    still = {**turned, "phi_i": [5, 0, 0]}  # along the normal there is no azimuth
    assert not Measured.from_frame(still).anisotropic


# -- the same table in many forms -----------------------------------------------------------

FRAME = pd.DataFrame(
    {
        "theta_i": [30.0, 30.0, 60.5, 60.5],
        "phi_i": 0.0,
        "theta_o": [30.0, -10.25, 60.5, 5.0],
        "phi_o": 180.0,
        "450": [3.0, 0.25, 1e-7, -0.5],
        "550.5nm": [1 / 3, np.pi, 0.1, 7e9],
        "450_error": [0.1, 0.2, 0.3, 0.4],
        "550.5nm_error": 0.0,
    }
)
TWIN = Measured.from_frame(FRAME, name="mine")


def saved(folder, text, name="mine.csv", encoding="utf-8"):
    path = Path(folder) / name
    path.write_bytes(text.encode(encoding))
    return path


def by_savetxt(names, **how):
    stream = io.StringIO()
    np.savetxt(stream, FRAME, header=names, **how)
    return stream.getvalue()


def headed(*names):
    """The table as pandas writes it, with other names."""
    return FRAME.set_axis(names, axis=1).to_csv(index=False)


ANGLES, VALUES = list(FRAME.columns[:4]), list(FRAME.columns[4:])
GREEK = (
    "θ_i (°)",
    "φi [deg]",
    "Theta r",
    "PHI-R",
    "BRDF_450nm",
    "550.5",
    "450nm error",
    "550.5_error",
)
TEXTS = {
    "pandas": (FRAME.to_csv(), "mine.csv", "utf-8"),
    "tabs": (FRAME.to_csv(sep="\t"), "mine.tsv", "utf-8"),
    "tabs, another suffix": (FRAME.to_csv(sep="\t"), "mine.txt", "utf-8"),
    "semicolons": (FRAME.to_csv(sep=";", decimal=","), "mine.csv", "utf-8-sig"),
    "blanks": (FRAME.to_csv(sep=" ", index=False), "mine.dat", "utf-8"),
    "quoted": (FRAME.to_csv(quoting=1), "mine.csv", "utf-8"),
    "numpy": (by_savetxt(" ".join(FRAME.columns)), "mine.txt", "utf-8"),
    "numpy, commas": (by_savetxt(",".join(FRAME.columns), delimiter=","), "mine.csv", "utf-8"),
    "greek": (headed(*GREEK), "mine.csv", "utf-8"),
    "other order": (FRAME[FRAME.columns[[4, 2, 3, 5, 1, 0, 7, 6]]].to_csv(), "mine.csv", "utf-8"),
    "utf-16": (FRAME.to_csv(sep="\t"), "mine.txt", "utf-16"),
    "quoted decimal commas": (FRAME.to_csv(decimal=",", quoting=1), "mine.csv", "utf-8"),
    "a title": ("My paint, 2 mm\nof June\n" + FRAME.to_csv(), "mine.csv", "utf-8"),
    "units below": (
        FRAME.to_csv(index=False).replace("\n", "\n" + "Deg," * 4 + "1/sr,1/sr,1/sr,\n", 1),
        "mine.csv",
        "utf-8",
    ),
    "latin-1": (FRAME.rename(columns={"phi_i": "phi_i [°]"}).to_csv(), "mine.csv", "latin-1"),
}


@pytest.mark.quick
@pytest.mark.parametrize("written", TEXTS)
def test_a_table_is_the_same_in_every_form(tmp_path, written):
    found = load(saved(tmp_path, *TEXTS[written]))
    assert found.checksum == TWIN.checksum
    assert found.channels == ("450nm", "550.5nm")
    assert found.anisotropic is False
    np.testing.assert_array_equal(found.standard_error, TWIN.standard_error)


@pytest.mark.quick
def test_arrays_a_frame_and_a_dictionary_are_the_same():
    numbers = FRAME.set_axis([*ANGLES, 450, 550.5, *VALUES[2:]], axis=1)
    angles = [FRAME[name] for name in ANGLES]
    values, errors = FRAME.to_numpy()[:, 4:6], FRAME.to_numpy()[:, 6:]
    channels = ("450nm", "550.5nm")
    for same in (
        Measured.from_frame(numbers),
        Measured.from_frame({name: FRAME[name].tolist() for name in FRAME}),
        Measured.from_angles(*angles, values, channels=channels, standard_error=errors),
    ):
        assert same.checksum == TWIN.checksum
        np.testing.assert_array_equal(same.standard_error, TWIN.standard_error)


@pytest.mark.quick
def test_what_is_not_a_number_was_not_measured(tmp_path):
    holes = FRAME.copy()
    holes.iloc[1, 4], holes.iloc[2, 7] = np.nan, np.inf
    for found in (Measured.from_frame(holes), load(saved(tmp_path, holes.to_csv()))):
        np.testing.assert_array_equal(found.samples.valid, [True, False, False, True])
        assert found.info["not finite"] == "2 of 4 rows, masked"
    half = {"theta_h": [0, 70], "theta_d": 50, "phi_d": 0, "BRDF": 1}  # wi of the second: 120°
    found = Measured.from_frame(half)
    assert found.info["at or below the horizon"] == "1 of 2 rows, masked"
    np.testing.assert_array_equal(found.samples.valid, [True, False])


@pytest.mark.quick
def test_what_is_masked_was_not_measured():
    column = np.ma.array([1.0, -999.0], mask=[False, True])
    angles = {"theta_i": 30, "theta_o": [10, 20], "delta_phi": 180}
    found = Measured.from_frame({**angles, "BRDF": column})
    np.testing.assert_array_equal(found.samples.valid, [True, False])
    whole = Measured.from_frame({**angles, "BRDF": np.ma.array([1, 2])})
    np.testing.assert_array_equal(whole.values, [[1], [2]])


@pytest.mark.quick
@pytest.mark.parametrize(
    ("theta_i", "phi_i", "turned"),
    [
        ([30, 30], [0, 360], False),
        ([30, 30], [-180, 180], False),
        ([30, 0, 50], [20, 90, 20], False),  # an azimuth of the normal itself means nothing
        ([30, 50], [0, 90], True),
        ([30, 50], [0, 180], True),
        ([0, 50, 50], [0, 10, 11], True),
    ],
)
def test_a_surface_turns_where_the_azimuth_of_the_light_varies(theta_i, phi_i, turned):
    i, o = np.radians([theta_i, phi_i]), np.radians([40.0, 70.0])
    by_angles = {"theta_i": theta_i, "phi_i": phi_i, "theta_o": 40, "phi_o": 70, "BRDF": 1}
    w = np.stack([np.sin(i[0]) * np.cos(i[1]), np.sin(i[0]) * np.sin(i[1]), np.cos(i[0])])
    v = np.sin(o[0]) * np.cos(o[1]), np.sin(o[0]) * np.sin(o[1]), np.cos(o[0])
    vectors = {f"wi_{axis}": x for axis, x in zip("xyz", w, strict=True)}
    vectors |= {f"wo_{axis}": x for axis, x in zip("xyz", v, strict=True)} | {"BRDF": 1}
    assert Measured.from_frame(by_angles).anisotropic is turned
    assert Measured.from_frame(vectors).anisotropic is turned


@pytest.mark.quick
def test_notes_in_a_file_and_those_that_are_none(tmp_path):
    text = "# anisotropic: Yes\n# format: other\n# lamp: blue\n" + FRAME.to_csv()
    found = load(saved(tmp_path, text))
    assert found.anisotropic
    assert found.info == {"format": "CSV", "lamp": "blue"}
    for info in (3, ["a"]):
        with pytest.raises(BrdfkitError, match=r"^mine: info = .* should be notes by their names"):
            Measured.from_frame(FRAME, name="mine", info=info)


@pytest.mark.quick
def test_thousands_in_quotes_are_not_taken_for_decimals(tmp_path):
    text = FRAME.to_csv(index=False) + '10,0,10.5,180,"1,000",1,1,1\n'
    with pytest.raises(BrdfkitError, match=r"has a comma and line . a point in a number"):
        load(saved(tmp_path, text))


@pytest.mark.quick
def test_a_cosine_is_divided_out_where_a_name_says_so(tmp_path):
    angles = {"theta_i": 20, "phi_i": 0, "theta_o": [0, 60, 90], "phi_o": 180}
    text = pd.DataFrame(
        {**angles, **{f"CCBRDF_{c}": [1.0, 1.0, 1.0] for c in RGB}, **dict.fromkeys(ERRORS, 0.1)}
    ).to_csv()
    found = load(saved(tmp_path, text))
    np.testing.assert_allclose(found.values[:2], [[1] * 3, [2] * 3], rtol=1e-15)
    np.testing.assert_allclose(found.standard_error[:2], [[0.1] * 3, [0.2] * 3], rtol=1e-15)
    np.testing.assert_array_equal(found.samples.valid, [True, True, False])
    assert "divided" in found.info["cosine"]
    assert Measured.from_frame({**angles, "BSDF [1/sr]": 1}).values.tolist() == [[1], [1], [1]]


ERRORS = [f"{channel}_error" for channel in RGB]

# -- writing --------------------------------------------------------------------------------

floats = st.floats(allow_nan=False, allow_infinity=False)
nice = st.integers(0, 89_999).map(lambda n: n / 1000)
azimuth = st.integers(-179_999, 180_000).map(lambda n: n / 1000)
channels = st.sampled_from([("Y",), RGB, ("450nm",), ("400.5nm", "500nm", "650nm", "1064nm")])


@given(
    angles=st.lists(st.tuples(nice, azimuth, nice, azimuth), min_size=1, max_size=6),
    channels=channels,
    numbers=st.lists(floats, min_size=24, max_size=24),
    errors=st.booleans(),
    anisotropic=st.booleans(),
    suffix=st.sampled_from([".csv", ".tsv", ".csv.gz"]),
)
@settings(deadline=None, max_examples=40)
def test_round_trip_to_the_bit(angles, channels, numbers, errors, anisotropic, suffix):
    values = np.array(numbers)[: len(angles) * len(channels)].reshape(len(angles), -1)
    rest = {"anisotropic": anisotropic, "standard_error": np.abs(values) if errors else None}
    info = {"instrument": "a goniometer: of ours", "θ": "2° steps"}
    data = Measured.from_angles(
        *np.array(angles).T, values, unit="degrees", channels=channels, info=info, **rest
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"mine{suffix}"
        save(data, path)
        back = load(path)
    assert back.checksum == data.checksum
    assert (back.channels, back.anisotropic) == (data.channels, anisotropic)
    np.testing.assert_array_equal(back.standard_error, data.standard_error)
    assert info.items() <= back.info.items()


@pytest.mark.quick
def test_directions_that_are_no_round_angles_come_back_too(tmp_path):
    w = np.random.default_rng(0).normal(size=(2, 5000, 3))
    w[..., 2] = np.abs(w[..., 2])
    data = Measured.from_samples(*w, w[0, :, :1] ** 2)
    save(data, tmp_path / "mine.csv")
    back = load(tmp_path / "mine.csv")
    np.testing.assert_array_equal(back.values, data.values)
    for name in ("wi", "wo"):
        there, here = getattr(data.samples, name), getattr(back.samples, name)
        assert np.linalg.norm(there - here, axis=1).max() < 3e-15
    frame = Measured.from_frame(pd.read_csv(tmp_path / "mine.csv", comment="#"))
    assert frame.checksum == back.checksum


@pytest.mark.quick
def test_a_table_becomes_its_cells(tmp_path):
    values = np.random.default_rng(0).random((3, 4, 8, 3))
    values[0, 0, 0] = np.nan
    table = Measured.from_table(values)
    save(table, tmp_path / "mine.csv")
    back, cells = load(tmp_path / "mine.csv"), table.samples.at(table.samples.valid)
    np.testing.assert_array_equal(back.values, cells.values)
    np.testing.assert_allclose(back.samples.wi, cells.wi, atol=3e-15)


# -- what is wrong is said ------------------------------------------------------------------

GOOD = {"theta_i": 30, "phi_i": 0, "theta_o": [10, 30, 50], "phi_o": 180, "BRDF": [1, 9, 2]}
VECTORS = dict.fromkeys(["theta_i", "phi_i", "theta_o", "phi_o"])
VECTORS |= {"wi_x": 0, "wi_y": 0, "wi_z": 1, "wo_x": 0.6, "wo_y": 0}
WRONG = [
    ({"theta_0": 3}, "the column 'theta_0' is unknown; did you mean theta_"),
    ({"R_eror": 3}, "the column 'R_eror' is unknown; did you mean R_error"),
    ({"temperature": 21}, "the column 'temperature' is unknown; rename it or leave it out"),
    ({50: 21}, "the column '50' is unknown"),
    ({"Theta_I [deg]": 3}, r"the column 'Theta_I \[deg\]' comes twice; keep one"),
    ({"CCBRDF": 1}, "the column 'CCBRDF' comes twice"),
    ({"BRDF": None, "BRDF [%]": 1}, "has the unit '%', where .* 1/sr for values"),
    ({"theta_i": None, "theta_i (mrad)": 1}, "has the unit 'mrad', where deg or rad belongs"),
    ({"phi_o": None}, "lacks the columns phi_o; add them, or delta_phi"),
    ({"theta_o": None}, "lacks the columns theta_o; add them"),
    ({"delta_phi": 180}, "has delta_phi beside theta_i, phi_i, theta_o, phi_o, which give both"),
    ({"BRDF": None}, "has no column of values; name it BRDF"),
    ({"R": 1}, "has values of BRDF, R, where R, G, B belong"),
    (
        {"BRDF": None, "CCBRDF_R": 1, "G": 1, "B": 1},
        "has columns CCBRDF, the BRDF times cos theta_o, beside",
    ),
    ({"CCBRDF_error": 1}, "has columns CCBRDF, the BRDF times cos theta_o, beside"),
    (
        {"BRDF": None, "CCBRDF": 1, "BRDF_error": 1},
        "has columns CCBRDF, the BRDF times cos theta_o, beside",
    ),
    ({"BRDF": None, 550: 1, "550": 2}, "the column '550' comes twice"),
    ({"BRDF": np.array(["2026-06-01"] * 3, "datetime64[D]")}, "'BRDF' should hold numbers alone"),
    ({"BRDF": np.array([1, 2, 3], "timedelta64[s]")}, "'BRDF' should hold numbers alone"),
    ({"BRDF": [1, 2j, 3]}, "the column 'BRDF' should hold numbers alone"),
    ({"theta_i": 0.5, "theta_o": [0.2, 1, 1.5]}, "no theta is above 1.5, so that they might be"),
    ({"R_error": 1}, "has standard errors of R for the values of BRDF; give those of all"),
    ({"BRDF_error": [1, 2, -1]}, "a standard error is -1 in row 2; it should be at least 0"),
    ({"theta_o": [10, 20]}, "the column 'theta_o' has 2 rows where 'BRDF' has 3"),
    ({"theta_o": [[10], [20], [30]]}, "the column 'theta_o' has 2 axes where one belongs"),
    ({"BRDF": ["0,1", "9", "2"]}, "the column 'BRDF' should hold numbers alone"),
    ({"theta_o": [10, 30, np.nan]}, "theta_o is nan in row 2; give a number"),
    ({"theta_o": [10, 30, 100.5]}, "theta_o is 100.5° in row 2, which is below the horizon"),
    ({"theta_i": -91}, "theta_i is -91° in row 0, which is below the horizon"),
    ({"phi_o": [0, 361, 0]}, "phi_o is 361° in row 1, more than a full turn"),
    ({"theta_i": None, "theta_i [rad]": 30}, "theta_i is 30 rad in row 0, which is too large"),
    (
        {"theta_i": 0.5, "theta_o": [0.2, 1, 1.5], "phi_o": 3.1416},
        r"no theta is above 1.5, .* say unit='deg",
    ),
    ({name: [] for name in GOOD}, "has columns, but no rows"),
    (
        {**dict.fromkeys(GOOD), **VECTORS, "BRDF": 1, "wo_z": [0.8, 8]},
        "wo has the length 8.022 in row 1",
    ),
    (
        {**dict.fromkeys(GOOD), **VECTORS, "BRDF": 1, "wo_z": [0.8, -0.8]},
        "wo_z is -0.8 in row 1, .* below",
    ),
]


@pytest.mark.quick
@pytest.mark.parametrize(("changes", "said"), WRONG)
def test_a_frame_that_is_wrong(changes, said):
    frame = {name: column for name, column in (GOOD | changes).items() if column is not None}
    with pytest.raises(BrdfkitError, match=f"^mine: .*{said}.*[.]$"):
        Measured.from_frame(frame, name="mine")


@pytest.mark.quick
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((0.5, 0, [0.2, 1.1], 3.1416, [1, 2]), "no theta is above 1.1, .* say unit='degrees'"),
        ((30, 0, [10, 95], 180, [1, 2]), "theta_o is 95° in row 1, which is below the horizon"),
        ((30, 0, [10, np.inf], 180, [1, 2]), "theta_o is inf in row 1"),
        ((30, 0, [10, 20], 180, [1, 2, 3]), r"values \(3,\) should have the shape of the angles"),
        (([1, 2, 3], 0, [10, 20], 180, [1, 2]), r"theta_i \(3,\), .* theta_o \(2,\), .* together"),
        ((30, 0, ["a"], 180, [1]), "theta_o should hold numbers alone"),
        ((30, 0, [10, 20], 180, np.ones((2, 5))), r"values \(2, 5\) have 5 columns; say what"),
    ],
)
def test_angles_that_are_wrong(arguments, said):
    with pytest.raises(BrdfkitError, match=f"^mine: .*{said}.*[.]$"):
        Measured.from_angles(*arguments, name="mine")


@pytest.mark.quick
def test_units_and_frames_that_are_none():
    with pytest.raises(BrdfkitError, match=r"^unit = 'grad' should be 'degrees' or 'radians'\.$"):
        Measured.from_angles(30, 0, 30, 180, 1, unit="grad")
    with pytest.raises(BrdfkitError, match=r"^mine: a list was given; give a DataFrame"):
        Measured.from_frame([1, 2], name="mine")


@pytest.mark.quick
def test_a_table_of_arrow():
    found = Measured.from_frame(pyarrow.Table.from_pandas(FRAME, preserve_index=False))
    np.testing.assert_array_equal(found.samples.values, Measured.from_frame(FRAME).samples.values)


@pytest.mark.quick
def test_columns_that_come_twice():
    twice = pd.concat([FRAME, FRAME[["phi_o"]]], axis=1)
    with pytest.raises(BrdfkitError, match=r"^mine: the column 'phi_o' comes twice; keep one\.$"):
        Measured.from_frame(twice, name="mine")


@pytest.mark.quick
def test_radians_without_a_word_in_a_file(tmp_path):
    radians = FRAME.assign(**{name: np.radians(FRAME[name]) for name in ANGLES})
    path = saved(tmp_path, radians.to_csv())
    with pytest.raises(BrdfkitError, match=r"mine\.csv: .* columns' names, as theta_i \[deg\] or"):
        load(path)
    words = {name: f"{name} [rad]" for name in ANGLES}
    found = load(saved(tmp_path, radians.rename(columns=words).to_csv()))
    np.testing.assert_allclose(found.samples.wo, TWIN.samples.wo, atol=1e-15)
