"""docs/performance.md has the figures of its JSON, and its rows are measured by the benchmarks."""

import json

import performance_page
import pytest
from performance import rows, timing_process

FIGURES = json.loads(performance_page.FIGURES.read_text("utf-8"))
LISTED = {"fits": rows.FITS, "memory": rows.MEMORY, "processes": rows.PROCESSES}


@pytest.mark.quick
def test_the_page_has_the_figures():
    assert performance_page.PAGE.read_text("utf-8") == performance_page.make_page(FIGURES)


@pytest.mark.parametrize("section", LISTED)
def test_each_row_was_measured(section):
    for row in LISTED[section]:
        assert "seconds" in FIGURES[section][row.case]["now"], row.case


def test_each_row_has_a_program():
    cases = timing_process.find_cases()
    for row in (*rows.FITS, *rows.MEMORY):
        assert {row.case, row.beside} - {""} <= cases.keys()
