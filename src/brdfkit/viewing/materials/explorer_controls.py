"""The controls of a view of a material, besides those of a model's parameters."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from brdfkit.model import labels
from brdfkit.viewing.controls import Control
from brdfkit.viewing.materials.about import describe_label
from brdfkit.viewing.materials.fit_settings import make_fit_controls
from brdfkit.viewing.materials.picture_controls import make_light_controls, make_picture_controls
from brdfkit.viewing.tone_controls import make_tone_controls

NO_MODELS = ("mixture",)  # names that make no model by themselves


def make_explorer_controls(
    measured: Sequence[tuple[str, str]],
    models: Sequence[str],
    label: str,
    pins: Sequence[tuple[str, str]] = (),
    maps: Sequence[str] = (),
    meshes: Sequence[str] = (),
) -> list[Control]:
    """Return the controls of a view of a material.

    `measured` are names and labels of what shows it; none where a model is shown alone. `models`
    are the labels that were used so far, and come first in the menu; `label` is that of the model
    that is shown. `pins` are names and labels of pins. `maps` and
    `meshes` are the user's own environments and shapes.
    """
    return [
        *_make_fit_controls(models, label, bool(measured)),
        *make_picture_controls(measured, label, pins, meshes),
        *make_light_controls(maps),
        *make_tone_controls(),
    ]


def _make_fit_controls(models: Sequence[str], label: str, compared: bool) -> list[Control]:
    """Return the controls of the model and of its fit."""
    others = [name for name in labels.models() if name not in (*models, *NO_MODELS)]
    known = tuple((name, describe_label(name)) for name in (*models, *others))
    sums = "A model, or a sum such as ggx+ward: type to search."
    control = partial(Control, panel="fit")
    model = control("model", "Model", default=label, kind="text", choices=known, help=sums)
    return [model, *(make_fit_controls() if compared else [])]
