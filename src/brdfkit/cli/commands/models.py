"""`brdfkit models`: lists the models, or shows the page of one."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import click

from brdfkit.cli.console import Console
from brdfkit.cli.options import output_options


@click.command()
@click.argument("name", required=False, metavar="[NAME|FILE.py]")
@output_options
def models(name: str | None, console: Console) -> None:
    """List the models, or show the page of one.

    FILE.py is a file with your own model.
    """
    from brdfkit.model import labels

    if name is None:
        _print_models(labels.models(), console)
    else:
        print_model(labels.model(labels.load_files_in_label(name)), console)


def _print_models(models: Mapping[str, Any], console: Console) -> None:
    """Print a table of the models, with what each one is and its parameters."""
    from brdfkit.core.discovery.plugin_pages import read_page

    if console.as_json:
        console.print_json({name: _describe_parameters(model) for name, model in models.items()})
        return
    rows = [(name, read_page(m).sentence, ", ".join(m.parameters)) for name, m in models.items()]
    console.print_table(["model", "what it is", "parameters"], rows)
    console.output.print("One model's page: brdfkit models NAME")


def print_model(model: Any, console: Console) -> None:
    """Print the page of help of a model, with its parameters and options."""
    from brdfkit.core.discovery.plugin_pages import read_page

    if console.as_json:
        console.print_json({model.type_name(): _describe_parameters(model)})
        return
    console.output.print(str(read_page(model)))
    rows = []
    for name, p in model.parameters.items():
        low, high = ("" if math.isinf(v) else f"{v:g}" for v in p.bounds)
        default = p.follows or f"{p.default:g}"
        per_channel = " (per channel)" if p.linear else ""
        rows.append((name, default, low, high, p.meaning + per_channel))
    console.print_table(["parameter", ">default", ">from", ">to", "meaning"], rows)
    if model.options:
        choices = [
            (n, str(o.default), format_choices(o), o.meaning) for n, o in model.options.items()
        ]
        console.print_table(["option", "default", "choices", "meaning"], choices)
        with_another = make_example_label(model, next(iter(model.options)))
        console.output.print(f"With another choice: brdfkit fit FILE -m {with_another}")
    console.output.print(
        f'Mitsuba: {{"type": "{model.type_name()}", ...}}; every parameter may be a texture.'
    )
    print_references(read_page(model), console)


def print_references(page: Any, console: Console) -> None:
    """Print the works that a plugin's page of help cites."""
    for n, work in enumerate(page.references):
        console.output.print(f"\n{work}" if n == 0 else str(work))


def _describe_parameters(model: Any) -> dict[str, dict[str, Any]]:
    """Return the parameters of a model by name, as dictionaries for --json."""
    return {
        name: {
            "default": p.default,
            "bounds": p.bounds,
            "follows": p.follows,
            "linear": p.linear,
            "meaning": p.meaning,
        }
        for name, p in model.parameters.items()
    }


def format_choices(option: Any) -> str:
    """Return the choices of a model's option in words."""
    if option.choices is None:
        return "any"
    if isinstance(option.default, int):
        return f"{min(option.choices)} to {max(option.choices)}"
    return ", ".join(map(str, option.choices))


def make_example_label(model: Any, option: str) -> str:
    """Return a label of a model in which an option differs from its default."""
    declared = model.options[option]
    if declared.choices is None:
        return str(declared.default)
    after = declared.choices.index(declared.default) + 1
    other = declared.choices[after % len(declared.choices)]
    return f"{model.type_name()}:{option}={other}"
