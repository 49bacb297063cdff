"""One file is one target of `export`; it defines `TARGET`, and is found by being here."""

from functools import cache
from typing import Any

from brdfkit.core.discovery import plugin_files
from brdfkit.core.errors import no_such_error
from brdfkit.exporting.target import Target


@cache
def list_targets() -> dict[str, Target]:
    """Return all targets by name."""
    modules: Any = plugin_files.import_modules(__name__, __path__)
    return {module.TARGET.name: module.TARGET for module in modules}


def find_target(name: str) -> Target:
    """Return the target with this name; raise `BrdfkitError` if there is none."""
    known = list_targets()
    if name not in known:
        raise no_such_error("target", name, known)
    return known[name]
