"""Opens the measured materials and fits that are dropped on a page."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.loading import load
from brdfkit.viewing.materials.application import MaterialApplication
from brdfkit.viewing.session import Session

# Beginnings of the names of settings that another material takes over
KEPT = "light.", "shape", "camera.", "view.", "tone.", "plots.", "compare"
BONDS = ".linked", ".tied"  # ends of the names of settings that the shown model keeps


def open_material(session: Session, path: Path) -> MaterialApplication:
    """Return the view of a dropped file, a measured material or a fit.

    Of a material that the session shows so far, the models stay beside the new one, in the same
    light, and seen in the same way.
    """
    before, material = session.application, load(path)
    if not isinstance(before, MaterialApplication):
        return MaterialApplication(material, file=path.name)
    models = before.states.list_models(session.state)
    after = MaterialApplication(material, models, file=path.name)
    for name, value in session.state.items():
        if name.startswith(KEPT) or name.endswith(BONDS):
            with suppress(BrdfkitError):  # a map or a mesh that was dropped is not known any more
                after.first = after.change(after.first, {name: value})
    return after
