"""The page of real measurements says what its figures say, and its figures come again."""

import json
from importlib import import_module

import pytest

import brdfkit as bk


@pytest.fixture(scope="module")
def make():
    """The program that makes the page."""
    return import_module("make_real_measurements")


@pytest.fixture(scope="module")
def results(make):
    """The figures that lie beside the page."""
    return json.loads(make.RESULTS.read_text(encoding="utf-8"))


@pytest.mark.quick
def test_the_page_is_what_its_figures_say(make, results, monkeypatch, tmp_path):
    """Otherwise: python docs/tools/make_real_measurements.py --only page"""
    text = make.page.PAGE.read_text(encoding="utf-8")
    assert all(line in text for line in make.page.write_verdict(results))
    monkeypatch.setattr(make.page, "PAGE", tmp_path / "again.md")
    make.page.write_page(results)
    again = make.page.PAGE.read_text(encoding="utf-8")
    head = "## In short"  # above it stand the versions
    assert again.partition(head)[2] == text.partition(head)[2]


@pytest.mark.quick
def test_wrong_light_is_said(make, results):
    rows = list(make.page.iterate_fits(results["files"]))
    assert len(rows) > 500
    for found, fit, model, loss in rows:
        where = found["name"], model, loss
        assert fit["said"] or not make.page.is_light_wrong(found, fit), where
        assert fit["gain said"] or fit["most"] <= make.page.GAIN, where


def test_a_table_and_its_rows_give_the_fit_of_the_page(make, results, tmp_path):
    """Random rows of a table, as .csv, and some of its cells, as .astm, by the default loss."""
    name, model, loss = "satin_plastic", "ggx", "cbrt"
    table = make.make_table_of(name, tmp_path)
    kinds = "table", "cells", "random"
    files = {kind: make.save_and_load(kind, table, tmp_path) for kind in kinds}
    rows = make.compare_files(files, model, loss, make.Part(files["table"]))
    for kind in kinds[1:]:
        count, same, _, farthest, *albedos = rows[kind]["beside"]
        assert same == count
        assert abs(farthest) <= 0.03
        assert albedos == pytest.approx([1, 1, 1], abs=0.02)
        kept = results["invariance"][name][model][loss][kind]["beside"]
        assert albedos == pytest.approx(kept[4:], abs=2e-3)
        assert farthest == pytest.approx(kept[3], abs=2e-3)


def test_a_cell_of_the_page_comes_again(make, results, measured_data):
    name, model = "curet/abrdf.dat#21", "ggx"
    data = bk.load(str(measured_data / name))
    found = import_module("real_measurements.errors").Judge(data)(bk.fit(data, model))
    kept = results["files"][name]["fits"][model]["cbrt"]
    for figure in ("albedo", "most", "psnr", "log error"):
        assert found[figure] == pytest.approx(kept[figure], rel=5e-3), figure
