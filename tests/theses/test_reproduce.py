"""Theses reproduced: the page of claims, what is said where data are missing, and some claims."""

from itertools import product
from pathlib import Path
from types import SimpleNamespace

import pytest
from brdfkit.theses.kurt2007 import NEEDS
from brdfkit.theses.kurt2007.appendix_3 import read_rows
from brdfkit.theses.kurt2007.printed import SEVEN, read_printed_table
from click.testing import CliRunner
from PIL import Image

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.theses import Claim, list_theses
from brdfkit.theses.claims import count_verdicts
from brdfkit.theses.drawing import draw_curves, make_figure
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Picture, Section, Table, write_page
from brdfkit.theses.replacing import replace_part
from brdfkit.theses.sources import find_sources

PAGES = Path(__file__).parents[2] / "docs" / "reproduce"
CLAIMS = [
    Claim("Water is wet.", "Table 1", "1.00", "0.99", "confirmed", "Tolerance 2 %."),
    Claim("a | b", "p. 7", "2", "3", "not confirmed"),
    Claim("It looks good.", "Figure 2", "no figure", "12 dB", "not stated"),
    Claim("1 + 1 = 2.", "eq. 1", "2", "2", "confirmed", arithmetic=True),
]


@pytest.mark.quick
def test_a_page_has_every_claim_table_and_figure(tmp_path):
    drawn = make_figure(3, 2)
    draw_curves(drawn.add_subplot(), {"one": [1, 2, 3], "two": [3, 2, 4]}, "curves", "E")
    table = Table(("model", "E"), [("ward", "0.1")], "By eq. 5.")
    section = Section("Table 1", "Some text.", CLAIMS, [table], [Picture("curves", drawn)])
    page, picture = write_page(tmp_path / "x.md", "A thesis", "By hand.", [section], ["part_2"])
    text = page.read_text(encoding="utf-8")
    counts = "3 claims: 1 confirmed, 1 not confirmed, 1 not stated"
    assert f"{counts}; and 1 checks of arithmetic: 1 confirmed." in text
    assert text.index("| Water") < text.index("## Checks of arithmetic") < text.index("| 1 + 1")
    assert "| Water is wet. | Table 1 | 1.00 | 0.99 | **confirmed** |" in text
    assert "| a ∣ b |" in text
    assert "| ward | 0.1 |" in text
    assert "**Not finished**: part_2." in text
    assert f"]({picture.name})" in text
    assert len(Image.open(picture).convert("RGB").getcolors(1000)) > 10
    assert sorted(tmp_path.iterdir()) == [page, picture]


@pytest.mark.quick
def test_a_verdict_is_one_of_four():
    assert count_verdicts(CLAIMS[:1] * 2) == "2 confirmed"
    with pytest.raises(ValueError, match="perhaps"):
        Claim("", "", "", "", "perhaps")


@pytest.mark.quick
def test_a_replaced_part_has_to_be_used():
    owner = SimpleNamespace(bound=abs, read=abs)
    with replace_part(owner, "read", lambda x: 7):
        assert owner.read(-1) == 7
    assert owner.read is abs
    bound = owner.bound
    with (
        pytest.raises(AssertionError, match=r"bound was replaced but never called"),
        replace_part(owner, "bound", lambda x: 7),
    ):
        assert bound(-1) == 1
    assert owner.bound is abs


@pytest.mark.quick
def test_a_claim_over_a_grid_names_the_settings_in_which_it_holds():
    """All cells, a block that lacks one value of a setting, a single cell, and none."""
    settings = list(product(("ball", "box", "tree"), ("512²", "1024²"), ("none", "5 × 5")))
    names = "scene", "map", "blur"

    def judge(holds):
        return judge_over_grid(names, {cell: holds(*cell) for cell in settings})

    assert judge(lambda scene, size, blur: True) == ("in 12 of 12 settings", "confirmed")
    found = judge(lambda scene, size, blur: scene != "tree" and blur == "none")
    assert found == (
        "in 4 of 12 settings",
        "holds where the scene is not tree and the blur is none",
    )
    assert count_verdicts([Claim("", "", "", *found)]) == "1 for some settings"
    ours, verdict = judge(lambda *cell: cell == settings[0])
    assert ours.startswith("in 1 of 12 settings, at most where the scene is ball and the map is")
    assert verdict == "not confirmed"
    assert judge(lambda *cell: False) == ("in 0 of 12 settings", "not confirmed")


@pytest.mark.quick
def test_the_theses_are_listed():
    assert "kurt2007" in list_theses()
    listed = CliRunner().invoke(main, ["reproduce"])
    assert listed.exit_code == 0
    assert "kurt2007" in listed.output


@pytest.mark.quick
@pytest.mark.parametrize(
    ("thesis", "parts"),
    [
        ("balint2019", ["check_values"]),
        ("ergun2008", ["check_values", "misprints", "depth_curves"]),
        ("ergun2015", ["convex_rays"]),
        ("lesar2018", ["phase_functions", "schlick", "isosurface_depth"]),
    ],
)
def test_committed_pages_have_the_verdicts_of_the_code(thesis, parts, llvm_variant):
    page = (PAGES / f"{thesis}.md").read_text(encoding="utf-8")
    rows = [line.strip("| ").split(" | ") for line in page.splitlines() if line.endswith("** |")]
    committed = {row[0]: row[-1].strip("*") for row in rows}
    found = bk.reproduce(thesis, parts=parts).claims
    assert {claim.says: committed.get(claim.says) for claim in found} == {
        claim.says: claim.verdict for claim in found
    }


@pytest.mark.quick
def test_missing_data_are_named_with_their_source(tmp_path, monkeypatch):
    monkeypatch.delenv("BRDFKIT_DATA", raising=False)
    with pytest.raises(bk.BrdfkitError, match="set BRDFKIT_DATA to one, or give --data"):
        bk.reproduce("kurt2007")
    with pytest.raises(bk.BrdfkitError, match=r"abrdf\.dat: is not there; fetch .* put it there"):
        bk.reproduce("kurt2007", data=tmp_path)
    with pytest.raises(bk.BrdfkitError, match="did you mean kurt2007"):
        bk.reproduce("kurt2008", data=tmp_path)
    with pytest.raises(bk.BrdfkitError, match="did you mean table_9_1"):
        bk.reproduce("kurt2007", data=tmp_path, parts=["table_91"])


@pytest.fixture
def empty_files(tmp_path):
    """A folder that has every measured file by its name."""
    for name in NEEDS:
        (tmp_path / "data" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "data" / name).touch()
    return tmp_path / "data"


@pytest.mark.quick
def test_without_the_appendix_its_claims_are_not_run(empty_files):
    found = bk.reproduce("kurt2007", data=empty_files, parts=["appendix_3"])
    assert [claim.verdict for claim in found.claims] == ["not run"]
    assert "curet_fits.csv" in found.claims[0].why


@pytest.mark.quick
def test_ctrl_c_keeps_what_is_finished(empty_files, tmp_path, monkeypatch):
    from brdfkit.theses.kurt2007 import figure_9_4

    def stop(sources, report):
        raise KeyboardInterrupt

    monkeypatch.setattr(figure_9_4, "check_claims", stop)
    parts = ["appendix_3", "figure_9_4"]
    found = bk.reproduce("kurt2007", path=tmp_path, data=empty_files, parts=parts)
    assert found.unfinished == ("figure_9_4",)
    assert "**Not finished**: figure_9_4." in (tmp_path / "kurt2007.md").read_text("utf-8")


def test_the_printed_tables_agree(measured_data):
    """The seven models of Table 9.2 have the errors of Appendix 3, where that is at hand."""
    table = read_printed_table("table_9_2")
    assert set(SEVEN) < set(table["errors"])
    assert all(len(row) == 5 for row in table["errors"].values())
    rows = read_rows(find_sources(measured_data, None, NEEDS))
    if rows is None:
        pytest.skip("the thesis's table of parameters is not beside the measurements")
    listed = {(row.model, row.number): row.error for row in rows}
    for name, label in SEVEN.items():
        found = [listed[label, number] for number in table["materials"].values()]
        assert found == table["errors"][name]


def test_two_parts_on_real_data(measured_data, tmp_path):
    """Table 9.2: 34 of 35 errors within 10 %; the progress ends at its end.

    The committed page has the same verdicts.
    """
    seen = []
    found = bk.reproduce(
        "kurt2007",
        path=tmp_path,
        data=measured_data,
        parts=["table_9_2", "energy", "misprints"],
        progress=lambda done, total: seen.append(done / total),
    )
    verdicts = {claim.says: claim.verdict for claim in found.claims}
    assert verdicts["The errors of the seven nonlinear models, but for a factor per material."] == (
        "confirmed"
    )
    ward = "Ward's model is physically plausible for k_d + k_s ≤ 1 and α not too large."
    assert verdicts[ward] == "holds where the view is below 89.7°"  # above it has no bound
    assert verdicts["Blinn-Phong with (n + 2)/2π is physically plausible."] == "not confirmed"
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(1)
    assert "0.0190 /" in (tmp_path / "kurt2007.md").read_text(encoding="utf-8")
    committed = (PAGES / "kurt2007.md").read_text(encoding="utf-8")
    rows = [line.strip("| ").split(" | ") for line in committed.splitlines() if "** |" in line]
    assert verdicts.items() <= {row[0]: row[-1].strip("*") for row in rows}.items()
