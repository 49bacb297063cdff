"""The subject of the checks of a plugin that is no material: its instance and its file."""

from dataclasses import dataclass
from functools import cached_property

from brdfkit.checks.registry import check_of
from brdfkit.core.discovery import plugin_files
from brdfkit.core.discovery.plugin_files import KINDS, MODELS
from brdfkit.core.errors import no_such
from brdfkit.model import labels


@dataclass(frozen=True, eq=False)
class PluginSubject:
    """A plugin of `kind`; `entries`: its dictionary for `mitsuba.load_dict`."""

    kind: str
    entries: dict

    @property
    def name(self):
        """Its name in the report, the type of the plugin."""
        return str(self.entries["type"])

    @property
    def source(self):
        """The file of the plugin."""
        return plugin_files.find_plugins(self.kind)[self.name]

    @property
    def module(self):
        """The file of the plugin, as a module."""
        return _module(self.name)

    @cached_property
    def plugin(self):
        """The instance that Mitsuba makes of it, in the current variant."""
        import mitsuba as mi

        return mi.load_dict(self.entries, parallel=False)


def is_no_model(name):
    """Whether `name` is that of a plugin which is no `Model`, but may be another BSDF."""
    kind = plugin_files.find_kind(name)
    return kind is not None and (
        kind != MODELS or labels.model_in(plugin_files.find_plugins(MODELS)[name]) is None
    )


def require_declared(name, parameters):
    """Raise `BrdfkitError` for one of the `parameters` that a plugin's file does not declare."""
    declared = getattr(_module(name), "PARAMETERS", None)
    for parameter in parameters if declared is not None else ():
        if parameter not in declared:
            raise no_such("parameter", parameter, declared, where=name)


def example(name, **values):
    """The dictionary of a plugin by its name, as its file's `example` returns it, with `values`."""
    module = _module(name)
    entries = module.example() if hasattr(module, "example") else {"type": name}
    return {**entries, **values}


def _module(name):
    return plugin_files.import_plugin(plugin_files.find_plugins(plugin_files.find_kind(name))[name])


@check_of(*(kind for kind in KINDS if kind != MODELS))
def loads(subject):
    """Mitsuba makes an instance of the right class, which can be printed."""
    import mitsuba as mi

    base, _ = KINDS[subject.kind]
    found = type(subject.plugin).__name__
    if not isinstance(subject.plugin, getattr(mi, base)):
        return False, f"{found} is no mitsuba.{base}"
    return bool(str(subject.plugin)), found
