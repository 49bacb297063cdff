"""Options of the command line have the names of the arguments of the Python functions."""

import inspect

import pytest

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.rendering import render_orbit
from brdfkit.rendering.map_sampling import compare_samplers
from brdfkit.shadows.comparison import compare as compare_shadows

# Options that set several arguments together, or that say how results are written
OUTPUT = {"output", "force", "as_json", "quiet"}
MENDS = {"mirror_azimuth", "divide_by_cos"}
TONE = {"curve", "exposure", "by"}
OTHERS = {"bound": "bounds", "scheduler": "client"}  # options and the arguments that they make
COMMANDS = {
    "fit": (
        [bk.fit, bk.sweep, bk.render],
        {"files", "names", "albedo_at_most", "exportable", "rendered", "up"},
    ),
    "export": ([bk.export], {"thing", "values"}),
    "report": ([bk.fit, bk.report], {"files", "names", "albedo_at_most", "up"}),
    "render": (
        [bk.render, bk.render_volume, bk.preview, render_orbit, bk.volumes.load],
        {"things", "folders", "preview", "values", "up", "orbit"},
    ),
    "complete": ([bk.complete], {"file"}),
    "plan": (
        [bk.plan],
        {"max_theta_i", "max_theta_o", "separation", "step", "in_plane", "theta_i", "channels"},
    ),
    "convert": ([bk.environments.convert], {"thing", "values"}),
    "measure": (
        [bk.measure],
        {"geometry", "slope", "stretch", "thickness", "facet_alpha", "specimen"},
    ),
    "samplers": ([compare_samplers], set()),
    "shadows": ([compare_shadows], set()),
    "svbrdf": ([bk.photographs.svbrdf], {"folder"}),
    "refine": ([bk.refine], set()),
    "reproduce": ([bk.reproduce], set()),
}


@pytest.mark.parametrize("command", COMMANDS)
def test_options_have_the_names_of_arguments(command):
    """An option that a Python function has, too, is not called otherwise."""
    functions, own = COMMANDS[command]
    known = {name for f in functions for name in inspect.signature(f).parameters}
    names = {parameter.name for parameter in main.commands[command].params}
    assert {OTHERS.get(n, n) for n in names - own - OUTPUT - MENDS - TONE} <= known
