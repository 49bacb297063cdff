"""Opens what is dropped beside a material: fits, environment maps and meshes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.loading import load
from brdfkit.regression import Fit
from brdfkit.viewing import kinds
from brdfkit.viewing.controls import State
from brdfkit.viewing.materials.material_state import find_label
from brdfkit.viewing.materials.parameter_state import to_state
from brdfkit.viewing.materials.scenery import LIGHT, SHAPE

if TYPE_CHECKING:
    from brdfkit.viewing.application import Message
    from brdfkit.viewing.session import Session

    Application = Any  # `MaterialApplication`, which imports this file


def open_beside(application: Application, session: Session, kind: str, path: Path) -> list[Message]:
    """Open a file of a kind beside the material; raise `BrdfkitError` if it has no use there."""
    if kind == kinds.FIT:
        return _open_fit(application, session, path)
    if kind == kinds.ENVIRONMENT:
        return _show(application, session, {LIGHT: application.states.scenery.add_map(path)})
    if kind == kinds.MESH:
        return _show(application, session, {SHAPE: application.states.scenery.keep_mesh(path)})
    raise BrdfkitError(
        f"{path.name}: is neither a fit nor settings, which are the JSON that a material takes; a "
        "transfer function is for a volume."
    )


def _show(application: Application, session: Session, changes: State) -> list[Message]:
    """Show a map or a mesh that was added to the scenery."""
    application.forget_scenes()
    session.change(changes)
    return [session.describe_state(), *application.describe_pins(session.state)]


def _open_fit(application: Application, session: Session, path: Path) -> list[Message]:
    """Show the model of a fit with its values."""
    fit = load(path)
    assert isinstance(fit, Fit)
    label = find_label(fit)
    application.states.keep_fit(label, fit)
    session.change({"model": label} | to_state(fit.rgb))
    return [session.describe_state(), *application.describe_model(session.state)]
