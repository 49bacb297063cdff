"""The techniques of shadow maps by name, with the settings that their files declare.

A file of `projections/`, `filters/` or `partitions/` may have `SETTINGS`, name → `Setting` of
`brdfkit.mitsuba_bridge.properties.declarations`. Its function or class takes them as keyword
arguments; they are also keyword arguments of `LightShadow`, and parameters of the integrator
`shadow_map`. Files in which a name means the same share the `Setting`.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from brdfkit.core.discovery import plugin_files
from brdfkit.core.errors import no_such_error
from brdfkit.mitsuba_bridge.properties.declarations import Setting, read_settings
from brdfkit.shadows.maps import filters, partitions, projections
from brdfkit.shadows.maps.depth_pass import render_depths

# Kind → the folder of its files, and the function or class that a file has
MAKERS = {
    "projection": (projections, "make_projection"),
    "filter": (filters, "Lookup"),
    "partition": (partitions, "make_partition"),
}
FILES = {
    kind: {
        file.__name__.rpartition(".")[2]: file
        for file in plugin_files.import_modules(folder.__name__, folder.__path__)
    }
    for kind, (folder, _) in MAKERS.items()
}


def find_settings(kind: str, name: str) -> dict[str, Setting]:
    """Return name → `Setting` of a file of a kind; raise `BrdfkitError` if there is none."""
    if name not in FILES[kind]:
        raise no_such_error(kind, name, FILES[kind])
    return getattr(FILES[kind][name], "SETTINGS", {})


def find_renderer(filter: str) -> Callable[..., Any]:
    """Return the function that renders a filter's maps: its `render_map`, or `render_depths`."""
    renderer: Callable[..., Any] = getattr(FILES["filter"][filter], "render_map", render_depths)
    return renderer


def list_settings() -> dict[str, Setting]:
    """Return name → `Setting` of all files; its meaning begins with the names of its files."""
    owners: dict[str, tuple[Setting, list[str]]] = {}
    for kind, files in FILES.items():
        for file in files:
            for name, setting in find_settings(kind, file).items():
                owners.setdefault(name, (setting, []))[1].append(file)
    return {
        name: replace(setting, meaning=f"{', '.join(files)}: {setting.meaning}")
        for name, (setting, files) in owners.items()
    }


def make_techniques(names: Mapping[str, str], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return kind → the function or class of its file in `names` (kind → name), with its settings.

    values : name → value of the settings that are not to be at their defaults.

    Raises `BrdfkitError` for unknown names, and for values that a setting does not allow.
    """
    settings = {kind: find_settings(kind, name) for kind, name in names.items()}
    known = [name for its in settings.values() for name in its]
    for name in values:
        if name not in known:
            raise no_such_error("setting", name, known, " + ".join(names.values()))
    return {
        kind: partial(
            getattr(FILES[kind][name], MAKERS[kind][1]),
            **read_settings(settings[kind], values.get, name),
        )
        for kind, name in names.items()
    }
