"""The public names: their number, the form of their arguments, and their documentation."""

import inspect
import math
from dataclasses import is_dataclass

import pytest
from docstring_parser import DocstringStyle, parse

import brdfkit as bk
from brdfkit.core.colours import RGB

pytestmark = pytest.mark.quick

SUBNAMESPACES = {
    "environments": "EnvironmentAudit audit convert",
    "losses": "Loss Picture named",
    "photographs": "Capture Pinhole Svbrdf svbrdf",
    "rendering": "Film SamplerComparison compare_samplers render_orbit",
    "solvers": "AlbedoAtMost DifferentialEvolution End LevenbergMarquardt Objective SLSQP Solver "
    "TrustRegion WeightsAtMost",
    "uncertainty": "Bootstrap Prediction PredictionError Profile bootstrap predict "
    "prediction_error profile",
    "volumes": "TransferFunction Volume load",
}
TOP = {name: getattr(bk, name) for name in bk.__all__ if not name.startswith("_")}
PUBLIC = TOP | {
    f"{space}.{name}": getattr(getattr(bk, space), name)
    for space, names in SUBNAMESPACES.items()
    for name in names.split()
}
FUNCTIONS = {name: thing for name, thing in PUBLIC.items() if inspect.isfunction(thing)}
CLASSES = {
    name: thing
    for name, thing in PUBLIC.items()
    if isinstance(thing, type) and not issubclass(thing, BaseException)
}
# Constructors and methods that people call with arguments of their own
METHODS = {
    f"{cls.__name__}.{method}": getattr(cls, method)
    for cls, names in {
        bk.Fit: ["residuals"],
        bk.Measured: [
            "from_angles",
            "from_frame",
            "from_samples",
            "from_table",
            "mend",
            "subtract",
            "resampled",
        ],
        bk.Model: ["changed"],
        bk.Plan: ["save"],
        bk.Gallery: ["write"],
        bk.Refinement: ["put_into"],
        bk.Rendering: ["write"],
        bk.photographs.Svbrdf: ["relight", "write"],
        bk.Sweep: ["to_csv", "to_html", "to_parquet"],
        bk.volumes.TransferFunction: ["from_colormap", "from_opacity", "load", "save"],
        bk.volumes.Volume: ["scene_dict"],
    }.items()
    for method in names
}
CALLED = FUNCTIONS | METHODS

# What the room of distance fields offers
ROOM = {f"distance_fields.{name}": thing for name, thing in vars(bk.distance_fields).items()}
FIELDS = {n: thing for n, thing in ROOM.items() if is_dataclass(thing)}
TRACED = {n: thing for n, thing in ROOM.items() if inspect.isfunction(thing)}
LISTED = CALLED | TRACED


# Everything that a user calls: functions, methods and constructors
METHODS_OF_ALL = {
    f"{name}.{method}": getattr(cls, method)
    for name, cls in CLASSES.items()
    for method in [*(m for m in vars(cls) if not m.startswith("_")), "__init__"]
    if callable(getattr(cls, method))
}
# Verbs of brdfkit; of formulas and of distance fields, arguments are as the formula has them
VERBS = {**FUNCTIONS, "shadows.compare": bk.shadows.compare}
WIDEST = 60


def test_there_are_53_names():
    kinds = {
        "functions": sum(map(inspect.isfunction, TOP.values())),
        "types": sum(isinstance(thing, type) for thing in TOP.values()),
        "subnamespaces": sum(map(inspect.ismodule, TOP.values())),
    }
    assert kinds == {"functions": 27, "types": 16, "subnamespaces": 10}
    assert len(TOP) == 53


def test_a_subnamespace_offers_what_is_listed():
    lazy = set(SUBNAMESPACES) - {"photographs", "rendering"}
    for space in lazy:
        assert sorted(dir(getattr(bk, space))) == sorted(SUBNAMESPACES[space].split())


@pytest.mark.parametrize("name", CALLED | METHODS_OF_ALL | TRACED)
def test_a_parameter_fits_into_a_line_of_help(name):
    signature = inspect.signature((CALLED | METHODS_OF_ALL | TRACED)[name])
    wide = [text for text in map(str, signature.parameters.values()) if len(text) > WIDEST]
    assert not wide


@pytest.mark.parametrize("name", VERBS)
def test_at_most_two_arguments_are_positional(name):
    by_place = [
        n
        for n, p in arguments(VERBS[name]).items()
        if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)
    ]
    if name == "evaluate":  # a BRDF takes a pair of directions, as its method `eval` does
        assert by_place.pop(1) == "wi"
    if name == "export":  # the target and the file are one thing: where to
        assert by_place.pop(1) == "target"
    assert len(by_place) <= 2


@pytest.mark.parametrize("name", VERBS)
def test_the_seed_and_the_progress_come_last(name):
    names = list(arguments(VERBS[name]))
    last = [n for n in ("seed", "progress") if n in names]
    assert names[len(names) - len(last) :] == last


@pytest.mark.parametrize("name", VERBS)
def test_one_thing_has_one_word(name):
    old = "brdf count data envmap obj output rows samples smoothing thing things until"
    new = set(arguments(VERBS[name])) - ({"data"} if name == "reproduce" else set())
    assert not new & set(old.split())


def documented(thing):
    return parse(inspect.getdoc(thing), DocstringStyle.NUMPYDOC)


def arguments(function):
    """Name → parameter of a function, without self and cls."""
    found = inspect.signature(function).parameters
    return {n: p for n, p in found.items() if n not in ("self", "cls")}


@pytest.mark.parametrize("name", LISTED)
def test_every_argument_and_the_result_are_annotated(name):
    signature = inspect.signature(LISTED[name])
    bare = [n for n, p in arguments(LISTED[name]).items() if p.annotation is p.empty]
    assert not bare
    assert signature.return_annotation is not signature.empty


@pytest.mark.parametrize("name", LISTED)
def test_every_argument_is_listed_once_with_its_type_and_meaning(name):
    listed = documented(LISTED[name]).params
    names = [n.strip().lstrip("*") for entry in listed for n in entry.arg_name.split(",")]
    assert names == list(arguments(LISTED[name]))
    for entry in listed:
        assert entry.type_name, entry.arg_name
        assert entry.description.endswith("."), entry.arg_name


@pytest.mark.parametrize("name", LISTED)
def test_a_default_is_told(name):
    for entry in documented(LISTED[name]).params:
        for argument in entry.arg_name.split(","):
            parameter = arguments(LISTED[name])[argument.strip().lstrip("*")]
            if parameter.default is parameter.empty or parameter.kind is parameter.VAR_KEYWORD:
                continue
            assert entry.is_optional, argument
            if parameter.default is not None:
                assert eval(entry.default, {"pi": math.pi, "RGB": RGB}) == parameter.default


@pytest.mark.parametrize("name", CALLED)
def test_results_errors_and_an_example_are_told(name):
    found = documented(CALLED[name])
    if inspect.signature(CALLED[name]).return_annotation not in (None, "None"):
        assert found.returns
        assert found.returns.type_name
    assert found.examples
    if arguments(CALLED[name]):
        assert [entry.type_name for entry in found.raises] == ["BrdfkitError"]


@pytest.mark.parametrize("name", TRACED)
def test_a_function_of_a_room_has_an_example(name):
    assert documented(TRACED[name]).examples


# What the author of a solver reads: a protocol, and an object that only brdfkit makes
OF_SOLVERS = {"solvers.Objective", "solvers.Solver"}


@pytest.mark.parametrize("name", sorted((CLASSES | FIELDS).keys() - OF_SOLVERS))
def test_a_class_lists_its_attributes_or_arguments(name):
    cls = (CLASSES | FIELDS)[name]
    listed = {
        n.strip().lstrip("*") for entry in documented(cls).params for n in entry.arg_name.split(",")
    }
    fields = getattr(cls, "__dataclass_fields__", {"values", "wavelengths"})
    assert listed == {n for n in fields if not n.startswith("_")}
