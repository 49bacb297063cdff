"""`brdfkit check`: checks that materials and plugins do what a renderer and a fit need."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from brdfkit.cli.console import Console
from brdfkit.cli.options import output_options
from brdfkit.cli.settings import parse_settings, values_option

if TYPE_CHECKING:
    from brdfkit.checks import Report


@click.command()
@click.argument("things", nargs=-1, required=True, metavar="NAME|FILE.py|FIT|FILE...")
@values_option
@output_options
def check(things: tuple[str, ...], values: tuple[str, ...], console: Console) -> None:
    """Check materials, models and plugins.

    For a material (a model, a fit or a measured file), the checks are that its sampling agrees with
    its values, that it conserves energy and that it has derivatives. A plugin of another kind has
    the checks of its kind; `brdfkit plugins` lists them. The exit status is 1 if a check fails.
    """
    from brdfkit.checks import check as run_checks

    reports = []
    for name, subject in [(name, _find_subject(name, values)) for name in things]:
        with console.progress(f"check {name}") as progress:
            reports.append(run_checks(subject, progress=progress))
    if console.as_json:
        console.print_json([_make_report_record(report) for report in reports])
    else:
        for report in reports:
            console.output.print(str(report))
    click.get_current_context().exit(0 if all(reports) else 1)


def _find_subject(name: str, settings: Sequence[str]) -> Any:
    """Return the material to check, or the dictionary of a plugin that is no model.

    `settings` are words PARAMETER=VALUE.
    """
    from brdfkit.checks.plugin_subject import is_no_model, make_example, require_declared
    from brdfkit.cli.arguments import find_material
    from brdfkit.mitsuba_bridge.registration.users_plugins import load_plugins

    if name.endswith(".py"):
        (name,) = load_plugins(name)
    if is_no_model(name):
        values = parse_settings(settings, "--set", "VALUE", "R,G,B")
        require_declared(name, values)
        return make_example(name, **values)
    return find_material(name, settings) if settings else name


def _make_report_record(report: Report) -> dict[str, Any]:
    """Return a report of checks as a dictionary, for --json."""
    findings = [
        {"check": f.check, "passed": bool(f.passed), "figure": f.figure} for f in report.findings
    ]
    return {"name": report.name, "passed": bool(report), "findings": findings}
