"""Opens the measured materials and fits that are dropped on a page."""

from __future__ import annotations

from pathlib import Path

from brdfkit.materials.loading import load
from brdfkit.model import Model
from brdfkit.viewing.materials.application import MaterialApplication
from brdfkit.viewing.session import Session


def open_material(session: Session, path: Path) -> MaterialApplication:
    """Return the view of a dropped file, a measured material or a fit.

    The models of a material that the session shows so far stay beside the new one.
    """
    before, material = session.application, load(path)
    models: list[Model] = []
    if isinstance(before, MaterialApplication):
        models = before.states.list_models(session.state)
    return MaterialApplication(material, models, file=path.name)
