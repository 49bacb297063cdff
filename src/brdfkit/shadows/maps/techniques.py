"""Finds the projections, filters and partitions of shadow maps by name, and their settings.

A technique is a file in `projections/`, `filters/` or `partitions/`. It may declare its settings in
a dictionary `SETTINGS`, from names to `Setting`s. The file's function or class receives the values
as keyword arguments. Users give them as keyword arguments of `LightShadow`, or as parameters of the
integrator `shadow_map`; so techniques in which a name means the same share the `Setting`.
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

# For each kind of technique: the folder of its files, and the function or class in each file
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
    """Return the settings of the technique `name`, by their names; `kind` is such as "filter".

    Raises `BrdfkitError` if there is no technique of that name.
    """
    if name not in FILES[kind]:
        raise no_such_error(kind, name, FILES[kind])
    return getattr(FILES[kind][name], "SETTINGS", {})


def find_map_renderer(filter: str) -> Callable[..., Any]:
    """Return the function that renders the maps of a filter, which is given by name.

    It is the function `render_map` in the filter's file, or else `render_depths`.
    """
    renderer: Callable[..., Any] = getattr(FILES["filter"][filter], "render_map", render_depths)
    return renderer


def list_settings() -> dict[str, Setting]:
    """Return the settings of all techniques, by their names.

    The meaning of each setting begins with the names of the techniques that have it.
    """
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
    """Return, by kind, the functions or classes of techniques, with their settings bound.

    names : the name of a technique for each kind, such as "filter" → "variance".
    values : values of settings, by the setting's name; other settings have their defaults.

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
