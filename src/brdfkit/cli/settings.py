"""The options that set parameters of models and settings of a fit, such as --set and --fixed.

Most of them take words NAME=VALUE, which `parse_settings` reads.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from typing import Any

import click

from brdfkit.core.errors import BrdfkitError

Command = Callable[..., Any]

FIT_OPTIONS: dict[str, dict[str, Any]] = {  # options of a fit, except -m: name → attributes
    "--loss": {
        "default": "cbrt",
        "metavar": "LOSS",
        "show_default": True,
        "help": "The error to minimise: cosine, log, cbrt, plain, lafortune, relative, kurt or "
        "picture. In Python, print(brdfkit.losses.named) explains them.",
    },
    "--robust": {
        "metavar": "WEIGHTS",
        "help": "Weight function that reduces the influence of outliers: andrews, bisquare, "
        "cauchy, fair, huber, logistic, talwar or welsch.",
    },
    "--solver": {
        "metavar": "SOLVER",
        "help": "The optimiser: levenberg_marquardt, slsqp, trust_region or "
        "differential_evolution. Default: levenberg_marquardt, with constraints slsqp.",
    },
    "--albedo-at-most": {
        "type": float,
        "metavar": "LIMIT",
        "help": "Constrain the albedo of the models to at most this share of the light, at "
        "incidence of 0°, 30°, 60°, 75°, 85° and 89°.",
    },
    "--max-angle": {
        "default": 80.0,
        "show_default": True,
        "metavar": "DEGREES",
        "help": "Use only samples with theta_i and theta_o below this angle [degrees].",
    },
    "--extrapolate": {
        "type": click.Choice(["guarded", "free"]),
        "default": "guarded",
        "show_default": True,
        "help": "Beyond the measured angles: guarded by a completed table of the material, or "
        "free, by the samples alone.",
    },
    "--fixed": {
        "multiple": True,
        "metavar": "NAME=VALUE",
        "help": "Keep a shape parameter at a value, as in f0=0.04; repeat it for more.",
    },
    "--bound": {
        "multiple": True,
        "metavar": "NAME=LOW,HIGH",
        "help": "Search a shape parameter in a range, as in alpha_u=0.01,0.5; repeat it for more.",
    },
    "--anisotropic/--isotropic": {
        "default": None,
        "help": "Fit alpha_v and similar parameters, or set them equal to alpha_u. "
        "Default: as the measurement is.",
    },
}


def parse_settings(
    words: Iterable[str], option: str, *forms: str, free: bool = False
) -> dict[str, Any]:
    """Read words NAME=VALUE behind an `option` into a dictionary; a value is a number or a tuple.

    `forms`, such as VALUE or LOW,HIGH, say how many numbers a value may have. With `free`, a value
    may also be true, false, a word, or any number of numbers.
    """
    values: dict[str, Any] = {}
    forms = forms or ("VALUE",)
    counts = [form.count(",") + 1 for form in forms]
    for word in words:
        name, _, text = word.partition("=")
        try:
            numbers = tuple(map(float, text.split(",")))
        except ValueError:
            numbers = ()
        if name and text and free and not numbers:
            values[name] = {"true": True, "false": False}.get(text, text)
        elif name and (len(numbers) in counts or (free and numbers)):
            values[name] = numbers[0] if len(numbers) == 1 else numbers
        else:
            should = " or ".join(f"{name or 'NAME'}={form}" for form in forms)
            decimals = len(numbers) == 2 and "." not in text and 1 in counts
            hint = f" Decimals take a point: {word.replace(',', '.')}." if decimals else ""
            raise BrdfkitError(
                f"{option} {word!r} should read {should}; repeat {option} for more.{hint}"
            )
    return values


def values_option(command: Command) -> Command:
    """Add --set, which sets parameters of models or renderers; the command gets `values`."""
    return click.option(
        "-p",
        "--set",
        "values",
        multiple=True,
        metavar="PARAMETER=VALUE",
        help="Set a parameter of the models, or of a volume's renderer, to a number or R,G,B; "
        "repeat it for more.",
    )(command)


def fit_options(
    default: str, others: str = "FILE.py with one, or best"
) -> Callable[[Command], Command]:
    """Return a decorator that adds -m and FIT_OPTIONS to a command that fits.

    The command gets `names`, the models, and `how`, the settings of `brdfkit.fit`. The texts
    `default` and `others` say in the help which models are the default, and what else -m takes.
    """
    help_text = f"A model, {others}; repeat it for more. Default: {default}."

    def add_options(command: Command) -> Command:
        @functools.wraps(command)
        def call_with_settings(
            *args: Any,
            names: tuple[str, ...],
            albedo_at_most: float | None,
            fixed: tuple[str, ...],
            bound: tuple[str, ...],
            **kwargs: Any,
        ) -> Any:
            from brdfkit.regression.solvers import AlbedoAtMost

            _refuse_joined_models(names)
            how = {
                name: kwargs.pop(name)
                for name in (
                    *("loss", "robust", "solver"),
                    *("max_angle", "extrapolate", "anisotropic"),
                )
            }
            how["fixed"] = parse_settings(fixed, "--fixed")
            how["bounds"] = parse_settings(bound, "--bound", "LOW,HIGH")
            how["constraints"] = () if albedo_at_most is None else AlbedoAtMost(albedo_at_most)
            return command(*args, names=names, how=how, **kwargs)

        for option, attributes in reversed(FIT_OPTIONS.items()):
            call_with_settings = click.option(option, **attributes)(call_with_settings)
        model = click.option(
            "-m", "--model", "names", multiple=True, metavar="MODEL", help=help_text
        )
        return model(call_with_settings)

    return add_options


def _refuse_joined_models(names: Iterable[str]) -> None:
    """Raise `BrdfkitError` where one -m names several models, as in ggx,ward."""
    from brdfkit.model import labels

    for name in names:
        parts = name.split(",")
        if len(parts) > 1 and all(map(labels.is_label, parts)):
            raise BrdfkitError(f"{name} are several models; repeat -m: -m {' -m '.join(parts)}.")
