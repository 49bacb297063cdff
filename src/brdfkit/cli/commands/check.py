"""`brdfkit check`: checks that materials and plugins do what a renderer and a fit need."""

import click

from brdfkit.cli.options import output_options, values_option
from brdfkit.cli.settings import parse_settings


@click.command()
@click.argument("things", nargs=-1, required=True, metavar="NAME|FILE.py|FIT|FILE...")
@values_option
@output_options
def check(things, values, console):
    """Check materials, models and plugins.

    A material (a model, a fit or a measured file) should sample, conserve energy and
    differentiate; a plugin of another kind should do what its kind needs: `brdfkit plugins` lists
    them. The exit status is 1 where a check fails.
    """
    from brdfkit.checks import check as check_thing

    reports = []
    for name, thing in [(name, _find_subject(name, values)) for name in things]:
        with console.progress(f"check {name}") as progress:
            reports.append(check_thing(thing, progress=progress))
    _print_reports(reports, console)
    click.get_current_context().exit(0 if all(reports) else 1)


def _find_subject(name, settings):
    """The material of a name, or the dictionary of a plugin that is no model, with `settings`."""
    from brdfkit.checks.plugin_subject import is_no_model, make_example, require_declared
    from brdfkit.cli.arguments import material
    from brdfkit.mitsuba_bridge.registration.users_plugins import load_plugins

    if name.endswith(".py"):
        (name,) = load_plugins(name)
    if is_no_model(name):
        values = parse_settings(settings, "--set", "VALUE", "R,G,B")
        require_declared(name, values)
        return make_example(name, **values)
    return material(name, settings) if settings else name


def _print_reports(reports, console):
    if console.as_json:
        console.json([_record(report) for report in reports])
        return
    for report in reports:
        console.out.print(str(report))


def _record(report):
    """A `Report` for JSON."""
    findings = [
        {"check": f.check, "passed": bool(f.passed), "figure": f.figure} for f in report.findings
    ]
    return {"name": report.name, "passed": bool(report), "findings": findings}
