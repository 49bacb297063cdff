"""The techniques of shadow maps by name, with the settings that their files declare.

A file of `projections/`, `filters/` or `partitions/` may have `SETTINGS`, name → `Setting` of
`brdfkit.mitsuba_bridge.properties.declarations`. Its function or class takes them as keyword
arguments; they are keyword arguments of `LightShadow`, too, and parameters of the integrator
`shadow_map`. Files in which a name means the same share the `Setting`.
"""

from dataclasses import replace
from functools import partial

from brdfkit.core.discovery import plugin_files
from brdfkit.core.errors import no_such
from brdfkit.mitsuba_bridge.properties.declarations import read
from brdfkit.shadows.maps import filters, partitions, projections
from brdfkit.shadows.maps.depth_pass import depth_pass

MADE_BY = {
    "projection": (projections, "projection"),
    "filter": (filters, "Lookup"),
    "partition": (partitions, "partition"),
}
FILES = {
    kind: {
        file.__name__.rpartition(".")[2]: file
        for file in plugin_files.import_modules(folder.__name__, folder.__path__)
    }
    for kind, (folder, _) in MADE_BY.items()
}


def settings_of(kind, name):
    """Name → `Setting` of the file `name` of a kind; `BrdfkitError` where there is no such file."""
    if name not in FILES[kind]:
        raise no_such(kind, name, FILES[kind])
    return getattr(FILES[kind][name], "SETTINGS", {})


def seen_by(filter):
    """What a filter's maps hold: its function `see`, or `depth_pass`."""
    return getattr(FILES["filter"][filter], "see", depth_pass)


def all_settings():
    """Name → `Setting` of all files; its meaning says which files have it."""
    owners = {}
    for kind, files in FILES.items():
        for file in files:
            for name, setting in settings_of(kind, file).items():
                owners.setdefault(name, (setting, []))[1].append(file)
    return {
        name: replace(setting, meaning=f"{', '.join(files)}: {setting.meaning}")
        for name, (setting, files) in owners.items()
    }


def techniques(names, given):
    """Kind → the function or class of its file in `names` (kind → name), set as `given`.

    given : name → value of the settings that are not to be at their defaults.

    Raises `BrdfkitError` for unknown names, and for values that a setting does not allow.
    """
    settings = {kind: settings_of(kind, name) for kind, name in names.items()}
    known = [name for its in settings.values() for name in its]
    for name in given:
        if name not in known:
            raise no_such("setting", name, known, " + ".join(names.values()))
    return {
        kind: partial(
            getattr(FILES[kind][name], MADE_BY[kind][1]), **read(settings[kind], given.get, name)
        )
        for kind, name in names.items()
    }
