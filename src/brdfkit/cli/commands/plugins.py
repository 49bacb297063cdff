"""`brdfkit plugins`: lists the plugins of every kind, or shows the page of one."""

from __future__ import annotations

import math
from collections.abc import Iterable

import click

from brdfkit.cli.console import Console
from brdfkit.cli.options import output_options


@click.command()
@click.argument("word", required=False, metavar="[KIND|NAME|FILE.py]")
@output_options
def plugins(word: str | None, console: Console) -> None:
    """List the plugins, or show the page of one.

    With a KIND, the command lists the plugins of that kind. FILE.py is a file with your own plugin.
    """
    from brdfkit.core.discovery.plugin_files import KINDS, find_plugin_kind, find_plugins
    from brdfkit.core.errors import no_such_error
    from brdfkit.mitsuba_bridge.registration.users_plugins import load_plugins

    if word and word.endswith(".py"):
        (word,) = load_plugins(word)
    if word is None:
        _print_plugins(KINDS, console)
    elif word in KINDS:
        _print_plugins([word], console)
    elif kind := find_plugin_kind(word):
        _print_plugin_page(kind, word, console)
    else:
        names = [name for kind in KINDS for name in find_plugins(kind)]
        raise no_such_error("plugin or kind of plugins", word, [*KINDS, *names])


def _print_plugins(kinds: Iterable[str], console: Console) -> None:
    """Print a table of the plugins of these kinds, with what each one is."""
    from brdfkit.core.discovery.plugin_files import find_plugins
    from brdfkit.core.discovery.plugin_pages import read_page

    sentences = {
        kind: {n: read_page(s).sentence for n, s in find_plugins(kind).items()} for kind in kinds
    }
    if console.as_json:
        console.print_json(sentences)
        return
    rows = [
        (kind, name, sentence)
        for kind, named in sentences.items()
        for name, sentence in named.items() or [("", "none yet")]
    ]
    console.print_table(["kind", "plugin", "what it is"], rows)
    console.output.print("One plugin's page: brdfkit plugins NAME")


def _print_plugin_page(kind: str, name: str, console: Console) -> None:
    """Print the page of help of a plugin, with its parameters."""
    from brdfkit.cli.commands.models import print_model, print_references
    from brdfkit.core.discovery.plugin_files import MODELS, find_plugins, import_plugin
    from brdfkit.core.discovery.plugin_pages import read_page
    from brdfkit.model.labels import find_model_in

    source = find_plugins(kind)[name]
    if kind == MODELS and (model := find_model_in(source)):
        print_model(model, console)
        return
    parameters = getattr(import_plugin(source), "PARAMETERS", {})
    if console.as_json:
        records = {
            n: {"default": p.default, "bounds": p.bounds, "meaning": p.meaning}
            for n, p in parameters.items()
        }
        console.print_json({name: {"kind": kind, "parameters": records}})
        return
    console.output.print(str(read_page(source)))
    if parameters:
        rows = []
        for n, p in parameters.items():
            low, high = ("" if math.isinf(v) else f"{v:g}" for v in p.bounds or (math.inf,) * 2)
            rows.append(
                (n, "" if p.default in (None, "") else f"{p.default}", low, high, p.meaning)
            )
        console.print_table(["parameter", ">default", ">from", ">to", "meaning"], rows)
    console.output.print(f'Mitsuba: {{"type": "{name}", ...}}')
    print_references(read_page(source), console)
