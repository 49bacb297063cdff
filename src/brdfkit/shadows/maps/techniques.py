"""The projections, filters and partitions of shadow maps by name, with the settings they declare.

A file of `projections/`, `filters/` or `partitions/` may have `SETTINGS`, name → `Setting` of
`brdfkit.mitsuba_bridge.properties.declarations`. The file's function or class takes them as keyword
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

# Kind of technique → the folder of its files, and the function or class that each file defines
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
    """Return name → `Setting` of the technique `name` of a kind, such as "filter".

    Raises `BrdfkitError` if there is no technique of that name.
    """
    if name not in FILES[kind]:
        raise no_such_error(kind, name, FILES[kind])
    return getattr(FILES[kind][name], "SETTINGS", {})


def find_map_renderer(filter: str) -> Callable[..., Any]:
    """Return the function that renders the maps of a filter.

    It is `render_map` of the filter's file, or `render_depths` if the file has none.
    """
    renderer: Callable[..., Any] = getattr(FILES["filter"][filter], "render_map", render_depths)
    return renderer


def list_settings() -> dict[str, Setting]:
    """Return name → `Setting` of all techniques; each meaning begins with the techniques' names."""
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
    """Return kind → the function or class of the named technique, with its settings bound.

    names : kind → name of a technique, such as "filter" → "variance".
    values : setting → value, for settings other than their defaults.

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
