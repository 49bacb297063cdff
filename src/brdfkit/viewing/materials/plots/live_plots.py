"""`LivePlots`: the plots of a page, each computed anew when what it shows has changed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing.application import Message
from brdfkit.viewing.controls import State
from brdfkit.viewing.materials.curves import Curve, list_curves
from brdfkit.viewing.materials.plots import albedo, lobe, polar, scatter, selection, slices
from brdfkit.viewing.materials.plots.settings import PREFIX, PlotSettings
from brdfkit.viewing.recent import Recent

KEPT = 24  # results of single curves, at most
ARRANGED = "channel", "cosine"  # settings that no evaluation needs, but every arrangement

Content = dict[str, Any]
Evaluated = list[tuple[Curve, dict[str, Any]]]


@dataclass(frozen=True)
class Plot:
    """A kind of plot.

    `evaluate`: from a material and settings to its arrays. `uses`: names of the settings that it
    takes. `arrange`: from curves with their arrays, and all settings, to what the page draws.
    `describe`: from curves and that content to words. `quick`: whether it is also computed while
    a slider moves.
    """

    evaluate: Callable[[Any, PlotSettings], dict[str, Any]]
    uses: tuple[str, ...]
    arrange: Callable[[Evaluated, PlotSettings], Content]
    describe: Callable[[list[Curve], Content], str]
    quick: bool = True


PLOTS = {
    "polar": Plot(
        polar.compute_lobe,
        ("theta_i", "phi_i", "phi_o", "sampler"),
        polar.arrange_lobes,
        polar.describe_lobes,
    ),
    "slices": Plot(
        slices.compute_slice, ("phi_d", "phi_i"), slices.arrange_slices, slices.describe_slices
    ),
    "albedo": Plot(
        albedo.compute_albedo_curve,
        (),
        albedo.arrange_albedos,
        albedo.describe_albedos,
        quick=False,
    ),
    "samples": Plot(scatter.draw_samples, (), scatter.arrange_samples, scatter.describe_samples),
    "lobe": Plot(
        lobe.compute_solid_lobe,
        ("theta_i", "phi_i"),
        lobe.arrange_solid_lobes,
        lobe.describe_solid_lobes,
    ),
    "selection": Plot(
        selection.select_pairs,
        ("selection",),
        selection.arrange_selection,
        selection.describe_selection,
    ),
}


class LivePlots:
    """The plots of a page; `states` are the `MaterialState` of the page."""

    def __init__(self, states: Any) -> None:
        self.states = states
        self.sent: dict[str, Any] = {}  # by plot, the key of what the page has
        self.evaluated: Recent[Any, dict[str, Any]] = Recent(KEPT)

    def forget(self) -> None:
        """Send all plots anew, as to a page that was loaded again."""
        self.sent.clear()

    def find_stale(self, state: State, moving: bool = False) -> list[str]:
        """Return the open plots that show another state; while something moves, the quick ones."""
        open_ones = [name for name in PLOTS if is_open(name, state)]
        if not open_ones:
            return []
        curves = list_curves(self.states, state)
        return [
            name
            for name in open_ones
            if (PLOTS[name].quick or not moving)
            and self.sent.get(name) != make_key(PLOTS[name], curves, state)
        ]

    def draw(self, state: State, moving: bool = False) -> list[Message]:
        """Return the message of the next stale plot; while something moves, of all quick ones."""
        stale = self.find_stale(state, moving)
        return [self._draw(name, state) for name in (stale if moving else stale[:1])]

    def _draw(self, name: str, state: State) -> Message:
        """Return the message "plot" of one plot; an error of a material becomes its text."""
        plot, settings = PLOTS[name], PlotSettings.from_state(state)
        curves = list_curves(self.states, state)
        self.sent[name] = make_key(plot, curves, state)
        common = {
            "type": "plot",
            "plot": name,
            "curves": [
                {"name": c.name, "colour": c.colour, "measured": c.is_measured, "twin": c.twin}
                for c in curves
            ],
        }
        try:
            evaluated = [(c, self._evaluate(name, c.material, settings)) for c in curves]
            content = plot.arrange(evaluated, settings)
        except BrdfkitError as error:
            return {**common, "text": str(error), "failed": True}, []
        text = plot.describe(curves, content)
        packed, data = pack_arrays(content)
        return {**common, **packed, "text": text}, [data]

    def _evaluate(self, name: str, material: Any, settings: PlotSettings) -> dict[str, Any]:
        """Return the arrays of a material in a plot, which are kept for a while."""
        plot = PLOTS[name]
        used = tuple(getattr(settings, setting) for setting in plot.uses)
        if name == "selection":  # whose values are those of a channel
            used = (*used, settings.channel)
        key = name, used, material
        return self.evaluated.get(key, lambda: plot.evaluate(material, settings))


def is_open(name: str, state: State) -> bool:
    """Return whether a plot is shown in a state; a selection is as long as there is one."""
    return bool(state[f"{PREFIX}selection" if name == "selection" else f"{PREFIX}show.{name}"])


def make_key(plot: Plot, curves: list[Curve], state: State) -> Any:
    """Return what a plot of a state depends on."""
    settings = [state[PREFIX + name] for name in (*plot.uses, *ARRANGED)]
    return settings, [(c.name, c.colour, c.material) for c in curves]


def pack_arrays(content: Any) -> tuple[Any, bytes]:
    """Return content in which each array is {"at", "shape"}, and the bytes of all as float32."""
    numbers: list[Any] = []
    size = 0

    def pack(value: Any) -> Any:
        nonlocal size
        if isinstance(value, np.ndarray):
            place = {"at": size, "shape": list(value.shape)}
            numbers.append(np.ascontiguousarray(value, "<f4").ravel())
            size += value.size
            return place
        if isinstance(value, dict):
            return {name: pack(inner) for name, inner in value.items()}
        if isinstance(value, list):
            return [pack(inner) for inner in value]
        return value

    packed = pack(content)
    return packed, np.concatenate([np.zeros(0, "<f4"), *numbers]).tobytes()
