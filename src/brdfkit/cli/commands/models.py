"""`brdfkit models`: lists the models, or shows the page of one."""

import math

import click

from brdfkit.cli.options import output_options


@click.command()
@click.argument("name", required=False, metavar="[NAME|FILE.py]")
@output_options
def models(name, console):
    """List the models, or show one's page.

    FILE.py is a model of yours.
    """
    from brdfkit.model import labels

    if name is None:
        _print_list(labels.models(), console)
    else:
        print_model(labels.model(labels.load_files(name)), console)


def _print_list(models, console):
    from brdfkit.core.discovery.plugin_pages import read_page

    if console.as_json:
        console.json({name: _parameters(model) for name, model in models.items()})
        return
    rows = [(name, read_page(m).sentence, ", ".join(m.parameters)) for name, m in models.items()]
    console.table(["model", "what it is", "parameters"], rows)
    console.out.print("One model's page: brdfkit models NAME")


def print_model(model, console):
    """Print the page of a model, with its parameters and options."""
    from brdfkit.core.discovery.plugin_pages import read_page

    if console.as_json:
        console.json({model.type_name(): _parameters(model)})
        return
    console.out.print(str(read_page(model)))
    rows = []
    for name, p in model.parameters.items():
        low, high = ("" if math.isinf(v) else f"{v:g}" for v in p.bounds)
        default = p.follows or f"{p.default:g}"
        per_channel = " (per channel)" if p.linear else ""
        rows.append((name, default, low, high, p.meaning + per_channel))
    console.table(["parameter", ">default", ">from", ">to", "meaning"], rows)
    if model.options:
        rows = [(n, str(o.default), choices(o), o.meaning) for n, o in model.options.items()]
        console.table(["option", "default", "choices", "meaning"], rows)
        with_another = example(model, next(iter(model.options)))
        console.out.print(f"With another choice: brdfkit fit FILE -m {with_another}")
    console.out.print(
        f'Mitsuba: {{"type": "{model.type_name()}", ...}}; every parameter may be a texture.'
    )
    print_references(read_page(model), console)


def print_references(page, console):
    """Print the references of the works that a page cites."""
    for n, work in enumerate(page.references):
        console.out.print(f"\n{work}" if n == 0 else str(work))


def _parameters(model):
    """The parameters of a model by name, for JSON."""
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


def choices(option):
    """The choices of an option in words."""
    if option.choices is None:
        return "any"
    if isinstance(option.default, int):
        return f"{min(option.choices)} to {max(option.choices)}"
    return ", ".join(map(str, option.choices))


def example(model, option):
    """A label of a model with another choice than the option's default."""
    declared = model.options[option]
    if declared.choices is None:
        return declared.default
    after = declared.choices.index(declared.default) + 1
    other = declared.choices[after % len(declared.choices)]
    return f"{model.type_name()}:{option}={other}"
