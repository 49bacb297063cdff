"""Notes on a fit: where each comes and where it does not, that all show them, and their page."""

import ast
import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.core.geometry.directions import from_angles
from brdfkit.fitting.lobe_notes import list_lobe_notes
from brdfkit.fitting.lobe_widths import compute_half_widths, find_half_angle_spacing
from brdfkit.materials.extrapolation import describe_file_extrapolation, note_fit_extrapolation
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.selection import select_samples
from brdfkit.reporting.parameters import describe_fit

ROOT = Path(__file__).resolve().parents[2]
GREY = (0.3, 0.3, 0.3)


def grid(step=5.0, largest=75.0):
    """Directions (n, 3) of a goniometer; the mirror's azimuth is 180°."""
    angles = np.arange(0, largest + 1, step)
    theta_i, theta_o, phi = np.meshgrid(angles, angles, np.arange(0, 181, 90))
    wi = from_angles(np.radians(theta_i.ravel()), 0.0)
    return wi, from_angles(np.radians(theta_o.ravel()), np.radians(phi.ravel()))


def measure(model, **where):
    wi, wo = grid(**where)
    return Measured.from_samples(wi, wo, np.broadcast_to(model.eval(wi, wo), (len(wi), 3)))


def model(label, **values):
    return bk.models()[label](**values)


def two(**values):
    """A sum of two GGX."""
    from brdfkit.model import labels

    return labels.model("ggx+ggx")(**values)


PAINT = model("ggx", diffuse_reflectance=GREY, specular_reflectance=GREY, alpha_u=0.2)
CASES = {  # the fit, the parameters at their bounds, and the note or None
    "a weight of 208": (
        model("ggx", specular_reflectance=208, f0=1e-3),
        (),
        "specular_reflectance = 208 makes its lobe alone reflect 20.50 of the light at 75°",
    ),
    "a diffuse term above 1": (
        model("ward", diffuse_reflectance=(0.2, 1.3, 0.2)),
        (),
        "diffuse_reflectance = 1.3 makes its lobe alone reflect 1.30 of the light at 5°",
    ),
    "heights of ABC are no reflectances": (model("abc", specular_reflectance=60), (), None),
    "no highlight": (
        model("ggx", specular_reflectance=0),
        ("specular_reflectance",),
        "the lobe of specular_reflectance is not used: its weight is 0",
    ),
    "no diffuse term": (model("ggx", diffuse_reflectance=0), ("diffuse_reflectance",), None),
    "an index of no surface": (
        model("abc", ior=9.9),
        (),
        "ior = 9.9 is the index of refraction of no surface",
    ),
    "an index of glass": (model("abc", ior=1.5), (), None),
    "an index of a lobe that is not used": (
        model("abc", ior=9.9, specular_reflectance=0),
        (),
        None,
    ),
    "as broad as can be": (
        model("ggx", alpha_u=1.0),
        ("alpha_u",),
        "alpha_u = 1 ended on its bound: such a lobe is as broad",
    ),
    "an exponent as small as can be": (
        model("phong", exponent=0.1),
        ("exponent",),
        "exponent = 0.1 ended on its bound: such a lobe is as broad",
    ),
    "broad along one axis": (model("ggx", alpha_u=0.05, alpha_v=1.0), ("alpha_v",), None),
    "on a user's bound": (model("ggx", alpha_u=0.5), ("alpha_u",), None),
    "as narrow as can be": (
        model("phong", exponent=1e4),
        ("exponent",),
        "exponent = 1e+04 makes a lobe of the half width",
    ),
    "at grazing angles alone": (
        model("ggx", f0=0.0),
        ("f0",),
        "f0 = 0 ended on its bound: such a lobe shines at grazing angles alone",
    ),
    "paint whose highlight does not rise": (
        model("ggx", f0=1.0, specular_reflectance=0.04),
        ("f0",),
        "f0 = 1 ended on its bound: the highlight does not rise",
    ),
    "a metal": (model("ggx", f0=1.0, specular_reflectance=0.8), ("f0",), None),
    "two lobes of metal at their bounds": (
        two(ggx_1_alpha_u=1.0, ggx_2_alpha_u=1.0),
        ("ggx_1_alpha_u", "ggx_2_alpha_u"),
        "ggx_1_alpha_u = 1 and ggx_2_alpha_u = 1 ended on their bounds: such a lobe is as broad",
    ),
    "narrower than the step": (
        model("ggx", alpha_u=0.01),
        (),
        "alpha_u = 0.01 makes a lobe of the half width 0.37°, where the half vectors of the "
        "samples are 2.5° apart",
    ),
    "narrower along y": (
        model("ggx", alpha_u=0.2, alpha_v=0.01),
        (),
        "alpha_v = 0.01 makes a lobe of the half width 0.37°",
    ),
    "a narrow lobe of two": (
        two(ggx_1_alpha_u=0.3, ggx_2_alpha_u=0.01),
        (),
        "ggx_2_alpha_u = 0.01 makes a lobe of the half width",
    ),
    "a sharp exponent": (model("phong", exponent=9e3), (), "exponent = 9e+03 makes a lobe"),
    "a red and a blue lobe": (
        two(
            ggx_1_specular_reflectance=(0.3, 0, 0),
            ggx_2_specular_reflectance=(0, 0, 0.3),
            diffuse_reflectance=GREY,
        ),
        (),
        "ggx_1_specular_reflectance and ggx_2_specular_reflectance have pure colours",
    ),
    "two lobes of one hue": (
        two(
            ggx_1_specular_reflectance=(0.01, 0, 0),
            ggx_2_specular_reflectance=(0.01, 0, 0),
            diffuse_reflectance=GREY,
        ),
        (),
        None,
    ),
    "a red rim": (
        model("ggx", diffuse_reflectance=(0.9, 0.1, 0.1), specular_reflectance=(0.3, 0.2, 0.2)),
        (),
        "its colour at 65° to 75° is R : G : B = ",
    ),
    "the truth": (PAINT, (), None),
    "signed weights": (model("koenderink"), (), None),
}


@pytest.mark.quick
@pytest.mark.parametrize("case", CASES)
def test_a_lobe_that_means_nothing_is_told(case):
    fitted, at_bounds, expected = CASES[case]
    data = measure(PAINT)
    weights = {n: np.broadcast_to(getattr(fitted, n), 3) for n in fitted.weights()}
    fitted = fitted.changed(**weights)
    notes = list_lobe_notes(data, select_samples(data, 80.0), fitted, at_bounds)
    if expected is None:
        assert notes == []
    else:
        assert [note for note in notes if note.startswith(expected)], notes


@pytest.mark.quick
def test_colours_of_lobes_are_those_of_a_red_and_blue_material():
    """Where the highlight itself is of one hue, the lobes say so rightly."""
    fitted = two(ggx_1_specular_reflectance=(1, 0, 0), ggx_2_specular_reflectance=(0, 0, 0.9))
    red = measure(model("ggx", diffuse_reflectance=0, specular_reflectance=(0.9, 0, 0)))
    notes = list_lobe_notes(red, select_samples(red, 80.0), fitted, ())
    assert not any("pure colours" in note for note in notes)


@pytest.mark.quick
def test_a_width_at_its_bound_is_told_once():
    """By the step of the samples, or where they are dense, as in a table, by the bound."""
    mirror = model("ggx", alpha_u=0.001)
    table = Measured.from_table(np.full((90, 4, 6, 1), 0.1), channels=("Y",))
    for data, expected in ((measure(PAINT), "of the half width"), (table, "ended on its bound")):
        notes = list_lobe_notes(data, select_samples(data, 80.0), mirror, ("alpha_u",))
        (note,) = (note for note in notes if "alpha_u" in note)
        assert expected in note


@pytest.mark.quick
def test_one_bright_sample_makes_no_rim():
    """Every file of Cornell's instrument has one at grazing mirror reflection."""
    data = measure(PAINT)
    values = data.values.copy()
    values[np.argmin(data.samples.wi[:, 2] + data.samples.wo[:, 2])] = 0, 0, 1e4
    bright = Measured.from_samples(*grid(), values)
    notes = list_lobe_notes(bright, select_samples(bright, 80.0), PAINT, ())
    assert not any("its colour" in note for note in notes)


@pytest.mark.quick
def test_widths_and_steps_are_those_of_formulas():
    """D of GGX falls to half where tan² θ_h = (√2 - 1) α²; G and F hardly change there."""
    diffuse, lobe = compute_half_widths(model("ggx", alpha_u=0.02))
    assert diffuse == np.inf
    assert lobe == pytest.approx(np.degrees(np.sqrt(np.sqrt(2) - 1) * 0.02), rel=0.04)
    for step in (5.0, 15.0):
        data = measure(PAINT, step=step)
        assert find_half_angle_spacing(select_samples(data, 80.0)) == pytest.approx(step / 2)
    table = Measured.from_table(np.full((90, 4, 6, 3), 0.1))
    assert find_half_angle_spacing(select_samples(table, 80.0)) < 0.1


def test_all_that_show_a_fit_show_its_notes(tmp_path):
    path = tmp_path / "paint.npz"
    bk.save(measure(PAINT, step=15.0, largest=60.0), path)
    found = bk.fit(path, "abc", fixed={"ior": 9.9}, starts=1)
    notes = [n for n in found.notes if "no surface" in n or "the fit extrapolates" in n]
    assert len(notes) == 2
    for note in notes:
        assert note in " ".join(str(found).split())
        assert note in describe_fit(found)["remarks"]
    found = bk.fit(path, "ward")
    done = CliRunner().invoke(main, ["fit", str(path), "-m", "ward", "--json"])
    assert json.loads(done.output)["fits"][0]["notes"] == list(found.notes)
    shown = CliRunner().invoke(main, ["fit", str(path), "-m", "ward"]).output
    assert found.notes
    assert all("".join(n.split()) in "".join(shown.split()) for n in found.notes)


@pytest.mark.quick
def test_the_note_on_azimuths_comes_with_pictures_too():
    """Pixels have no error at one azimuth, by which a least one could be told."""
    from brdfkit.model.samples import Table

    brushed = model("ggx", alpha_u=0.1, alpha_v=0.5)
    wi, wo = Table(np.full((6, 8, 4, 8, 1), np.nan)).directions()
    values = brushed.eval(wi.reshape(-1, 3), wo.reshape(-1, 3)).reshape(6, 8, 4, 8, 1)
    data = Measured.from_table(values, channels=("Y",))
    note = "the material changes as the surface turns, and the model as fitted does not"
    assert note in bk.fit(data, "lambert", loss="picture", starts=1).notes
    assert any(n.startswith(f"{note}: no") for n in bk.fit(data, "lambert").notes)


# Extrapolation


@pytest.mark.quick
def test_a_fit_extrapolates_where_little_was_measured():
    (note,) = note_fit_extrapolation(measure(PAINT, largest=45.0), 80.0)
    assert "% of the direction pairs below 80° lie beyond the measured angles, " in note
    assert "which reach 45°: there the fit extrapolates, and nothing tests it" in note
    # (1 - cos 45°)² of (1 - cos 80°)² within the angles, and a rim of up to 5° near samples
    assert 1 - (1 - np.cos(np.radians(50))) ** 2 / (1 - np.cos(np.radians(80))) ** 2 < 0.87
    assert 0.80 < float(note.partition("%")[0]) / 100 < 0.875
    assert note_fit_extrapolation(measure(PAINT, largest=80.0), 80.0) == []
    assert note_fit_extrapolation(measure(PAINT, largest=45.0), 45.0) == []


def test_a_table_of_few_samples_is_extrapolated():
    few = measure(PAINT, step=15.0, largest=45.0)
    table = few.tabulated
    (told,) = describe_file_extrapolation(few, table)
    share = bk.audit(few).coverage
    start = f"{share.beyond:.0%} of the table is extrapolated and {share.between:.0%} interpolated"
    assert told.startswith(start)
    most, now = few.values.max(), np.nanmax(table.table.values)
    assert told.endswith(f"; the maximum rises from {most:.4g} to {now:.4g} sr⁻¹")
    assert describe_file_extrapolation(few, few) == []
    assert describe_file_extrapolation(table, few) == []


# The page


NOTES = {  # the files that make notes, and in which of their functions or names; None: in all
    "fitting/notes.py": None,
    "fitting/guarded_search.py": ("guard_solution", "explain_unguarded_fit", "note_beyond"),
    "fitting/growth.py": None,
    "materials/auditing/highlight_sampling.py": ("warn_of_narrow_highlight",),
    "fitting/uncertainty/isotropic_limit.py": ("note_on_isotropic_model",),
    "fitting/lobe_notes.py": None,
    "fitting/lobe_widths.py": None,
    "fitting/lobe_colours.py": None,
    "materials/extrapolation.py": ("note_fit_extrapolation",),
    "regression/albedo.py": ("warnings",),
    "regression/search/albedo_search.py": ("_describe_correction",),
    "materials/auditing/data_findings.py": (
        "_warn_of_backward_highlight",
        "_warn_of_cosine_factor",
        "_warn_of_broken_reciprocity",
        "_warn_of_dark_horizon",
        "_warn_of_single_plane",
        "_warn_of_single_incidence",
        "_warn_of_zeros",
    ),
    "regression/certainty_notes.py": (
        "describe_undetermined_parameters",
        "_describe_trade_off",
        "describe_parameter_trade_offs",
    ),
    "regression/measurement_noise.py": ("regress_with_noise",),
    "regression/robust/search.py": ("note",),
    "regression/solvers/constraints.py": ("write_notes",),
    "regression/result.py": ("old",),
}


def phrases(tree, within=None):
    """The fixed words of all texts but docstrings, without phrases of one or two words; `within`:
    of functions with such a name, and of what is assigned to it."""
    nodes = list(ast.walk(tree))
    if within:
        named = [n for n in nodes if getattr(n, "name", "") in within]
        assigned = [n for n in nodes if isinstance(n, ast.Assign)]
        named += [n for n in assigned if getattr(n.targets[0], "id", "") in within]
        return {phrase for node in named for phrase in phrases(node)}
    docstrings = {id(n.value) for n in nodes if isinstance(n, ast.Expr)}
    texts = [n for n in nodes if isinstance(n, ast.Constant) and isinstance(n.value, str)]
    words = [" ".join(n.value.split()) for n in texts if id(n) not in docstrings]
    return {word for word in words if len(word.split()) > 2}


@pytest.mark.quick
@pytest.mark.parametrize("file", NOTES)
def test_every_note_is_on_their_page(file):
    """Otherwise: add it to docs/notes.md."""
    page = " ".join((ROOT / "docs" / "notes.md").read_text(encoding="utf-8").split())
    tree = ast.parse((ROOT / "src" / "brdfkit" / file).read_text(encoding="utf-8"))
    found = phrases(tree, NOTES[file])
    assert found
    assert [phrase for phrase in found if phrase not in page] == []


@pytest.mark.quick
def test_a_note_that_is_not_on_the_page_would_be_seen():
    tree = ast.parse(
        'def f(x):\n    """A docstring of words."""\n    return f"{x} is quite new to us"'
    )
    assert phrases(tree) == {"is quite new to us"}
