"""What is checked of a plugin that is no material: an instance of it in the current variant."""

from dataclasses import dataclass
from functools import cached_property

from brdfkit.checks.registry import checked
from brdfkit.plugins import discovery
from brdfkit.plugins.discovery import KINDS, MODELS


@dataclass(frozen=True, eq=False)
class PluginSubject:
    """A plugin of `kind`, by its dictionary for `mitsuba.load_dict`."""

    kind: str
    entries: dict

    @property
    def name(self):
        """What the report calls it."""
        return str(self.entries["type"])

    @property
    def source(self):
        """Its file."""
        return discovery.sources(self.kind)[self.name]

    @property
    def module(self):
        """Its file, as a module."""
        return discovery.module(self.source)

    @cached_property
    def plugin(self):
        """The instance that Mitsuba makes of it."""
        import mitsuba as mi

        return mi.load_dict(self.entries, parallel=False)


def example(name, **values):
    """The dictionary of a plugin by its name: what its file's `example` gives, with `values`."""
    module = discovery.module(discovery.sources(discovery.kind_of(name))[name])
    entries = module.example() if hasattr(module, "example") else {"type": name}
    return {**entries, **values}


@checked(*(kind for kind in KINDS if kind != MODELS))
def loads(subject):
    """Mitsuba makes an instance of its kind, which prints itself."""
    import mitsuba as mi

    base, _ = KINDS[subject.kind]
    right = isinstance(subject.plugin, getattr(mi, base))
    return right and bool(str(subject.plugin)), type(subject.plugin).__name__
