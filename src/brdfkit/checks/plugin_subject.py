"""The subject of the checks of a plugin other than a material: its instance and its file."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import Any

from brdfkit.checks.registry import check_of
from brdfkit.core.array_types import MitsubaObject
from brdfkit.core.discovery import plugin_files
from brdfkit.core.discovery.plugin_files import KINDS, MODELS
from brdfkit.core.errors import no_such_error
from brdfkit.model import labels


@dataclass(frozen=True, eq=False)
class PluginSubject:
    """A plugin to check, of a `kind` such as "emitters", made by `mitsuba.load_dict(entries)`."""

    kind: str
    entries: dict

    @property
    def name(self) -> str:
        """The type of the plugin, which is its name in the report."""
        return str(self.entries["type"])

    @property
    def source(self) -> Path:
        """The path of the plugin's file."""
        return plugin_files.find_plugins(self.kind)[self.name]

    @property
    def module(self) -> ModuleType:
        """The module that was imported from the plugin's file."""
        return _find_module(self.name)

    @cached_property
    def plugin(self) -> MitsubaObject:
        """The instance of the plugin in the current variant of Mitsuba."""
        import mitsuba as mi

        return mi.load_dict(self.entries, parallel=False)


def is_no_model(name: str) -> bool:
    """Return whether a plugin with this name exists and is not a `Model`.

    It may be a BSDF of another kind, such as a measured one.
    """
    kind = plugin_files.find_plugin_kind(name)
    return kind is not None and (
        kind != MODELS or labels.find_model_in(plugin_files.find_plugins(MODELS)[name]) is None
    )


def require_declared(name: str, parameters: Iterable[str]) -> None:
    """Raise `BrdfkitError` if the plugin called `name` lacks one of the `parameters`."""
    declared = getattr(_find_module(name), "PARAMETERS", None)
    for parameter in parameters:
        if declared is not None and parameter not in declared:
            raise no_such_error("parameter", parameter, declared, where=name)


def make_example(name: str, **values: Any) -> dict[str, Any]:
    """Return the dictionary with which a plugin is checked, with `values` of some parameters.

    The function `example` in the plugin's file makes it; without this function it is
    {"type": name}.
    """
    module = _find_module(name)
    entries = module.example() if hasattr(module, "example") else {"type": name}
    return {**entries, **values}


def _find_module(name: str) -> ModuleType:
    """Return the module that is imported from the file of the plugin with this name."""
    kind = str(plugin_files.find_plugin_kind(name))
    return plugin_files.import_plugin(plugin_files.find_plugins(kind)[name])


@check_of(*(kind for kind in KINDS if kind != MODELS))
def check_loads(subject: PluginSubject) -> tuple[bool, str]:
    """Check that Mitsuba can make an instance of the plugin, of the right class, and print it."""
    import mitsuba as mi

    base, _ = KINDS[subject.kind]
    class_name = type(subject.plugin).__name__
    if not isinstance(subject.plugin, getattr(mi, base)):
        return False, f"{class_name} is no mitsuba.{base}"
    return bool(str(subject.plugin)), class_name
