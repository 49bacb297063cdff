"""`MaterialApplication`: what a session shows of a material beside a model of it."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from brdfkit.core.array_types import AnyArray
from brdfkit.core.jit.threads import in_turn
from brdfkit.images.tone_mapping import ToneMapping
from brdfkit.materials.resolve import Material, MaterialLike
from brdfkit.viewing.application import Message
from brdfkit.viewing.controls import State, has_other_samples, to_changes
from brdfkit.viewing.materials import (
    fit_settings,
    fit_task,
    material_scripts,
    presets,
    saving,
)
from brdfkit.viewing.materials.beside import open_beside
from brdfkit.viewing.materials.fit_marks import describe_fit
from brdfkit.viewing.materials.idle_parameters import find_idle_parameters
from brdfkit.viewing.materials.live_light import LiveLights
from brdfkit.viewing.materials.live_material import LiveMaterial
from brdfkit.viewing.materials.material_answers import answer
from brdfkit.viewing.materials.material_scene import Look, SceneKind, find_lamp
from brdfkit.viewing.materials.material_state import (
    MaterialState,
    make_look,
)
from brdfkit.viewing.materials.mends import Mends, show_file
from brdfkit.viewing.materials.parameter_controls import list_panels
from brdfkit.viewing.materials.parameter_state import PREFIX
from brdfkit.viewing.materials.picture_controls import MODEL
from brdfkit.viewing.materials.picture_masks import PictureMasks
from brdfkit.viewing.materials.pins import COLOURS
from brdfkit.viewing.materials.plot_controls import PLOTS
from brdfkit.viewing.materials.plots.ball import place_ball
from brdfkit.viewing.materials.plots.live_plots import LivePlots
from brdfkit.viewing.recent import Recent
from brdfkit.viewing.session import Session
from brdfkit.viewing.tone_controls import develop, to_tone_mapping

PASSES_BEFORE = 3  # at rest, before the kernels for moves are made
STILLS = 2  # one at rest and one while something moves
MODELS = 4  # whose scenes are kept at most
# Before those of the parameters; where nothing can be fitted the second one alone
PANELS = (
    ("audit", "Audit of the file", True),
    ("fit", "Model and fit", True),
    (fit_settings.PANEL, "Fit settings", False),
)
MORE_PANELS = (
    ("picture", "Picture", True),
    ("light", "Light", True),
    ("tone", "Tone mapping", False),
)
DRAWN_ONLY = (
    "wipe",
    "compare",
    "show.",
    "tone.",
    "fit.",
    "plots.",
    "pins",
    "solo",
    "view.moving_scale",
)  # names that alter no samples


class MaterialApplication:
    """A view of a material and of models of it, left and right of the wipe.

    `material` is a measured one; or a model or a fit, which is then shown alone. `models` are
    labels, models with values or fits; the first is shown. `changes` are settings that differ from
    the first ones, of which the light and the shape may be files. `file` is the name of a file that
    was dropped, whose folder is unknown. Raises `BrdfkitError` if one of them is not possible.
    """

    def __init__(
        self,
        material: MaterialLike,
        models: Iterable[MaterialLike] = (),
        changes: Mapping[str, Any] | None = None,
        file: str = "",
    ) -> None:
        self.file = file
        self.given = material, tuple(models), to_changes(changes)
        self.states = MaterialState(*self.given[:2])
        self.lights = LiveLights(self.states.scenery.maps)
        self.plots = LivePlots(self.states)
        self.audits: dict[Mends, Message] = {}
        # By the model's label, or the mends of the measured one
        self.live: Recent[str, LiveMaterial] = Recent(MODELS)
        # Pictures without noise of what no slider changes, by what they show
        self.stills: Recent[tuple[SceneKind, Look, Material], AnyArray] = Recent(STILLS)
        self.masks = PictureMasks(self.states, self.live)
        changes = self.states.scenery.read_files(self.given[2])
        self.first = self.states.change(self.states.first(), changes)
        self.presets: dict[tuple[str, str], State] = {}  # values by model's label and material
        self.fitting: Callable[[], Any] = lambda: None  # returns the task of the last fit
        self.fit_turn = threading.Lock()  # of the fit that goes on
        self.base = self.states.to_model(self.first)  # whose values the controls begin with
        self.pins: list[Any] = self.first["pins"]  # among which the controls choose

    @property
    def name(self) -> str:
        """The name of the material."""
        return self.states.name

    @property
    def subject(self) -> str:
        """The material's name, and whether it was measured."""
        return f"the material {self.name}" if self.states.measured else f"the model {self.name}"

    def again(self) -> MaterialApplication:
        """Return another view of the same material, as for another page."""
        other = MaterialApplication(*self.given, self.file)
        other.states.share_fits(self.states)
        return other

    @in_turn
    def close(self) -> None:
        """Forget the scenes, because the page is gone."""
        self.live.clear()
        self.states.scenery.close()

    def first_state(self) -> State:
        """Return the state with which a view begins."""
        return self.first

    def describe(self) -> Message:
        """Return the message "open": the panels, the controls and what can be saved."""
        return {
            "title": self.name,
            "parts": ["light", "plots", *(["audit", "fit"] if self.states.is_fittable else [])],
            "pin_colours": COLOURS,
            "presets_of_models": presets.list_presets(),
            "copies": material_scripts.MORE
            if self.states.is_fittable
            else material_scripts.MORE[:1],
            "plots": [{"name": name, "label": label} for name, label, _ in PLOTS],
            "saves": [
                {"kind": kind, "label": label} for kind, label in saving.list_kinds(self).items()
            ],
        } | self._describe_controls(), []

    def _describe_controls(self) -> dict[str, Any]:
        """Return the panels and the controls, those of the shown model among them."""
        first = PANELS if self.states.is_fittable else PANELS[1:2]
        panels = [*first, *list_panels(type(self.base)), *MORE_PANELS]
        controls = self.states.list_controls(self.base, pins=self.pins)
        return {
            "panels": [
                {"name": name, "label": label, "open": is_open} for name, label, is_open in panels
            ],
            "controls": [c.to_json() for c in controls.values()],
            "shapes": [PREFIX + name for name in type(self.base).shapes(anisotropic=True)],
            "fit_all": fit_task.choose_labels(self.states),
        }

    def change(self, state: State, changes: Mapping[str, Any]) -> State:
        """Return the state after changes; raise `BrdfkitError` if one is not possible."""
        return self.states.change(state, show_file(state, changes))

    def sides(self, state: State) -> int:
        """Return the number of pictures: 2 if there is one right of the wipe."""
        return 2 if state["second"] else 1

    def describe_side(self, state: State, side: int) -> dict[str, Any]:
        """Return the name of the material at a side, and the settings that the page waits for."""
        return self.states.describe_side(state, "second" if side else "renderer")

    def needs_samples_anew(self, before: State, after: State) -> bool:
        """Return whether the samples of one state are not those of another."""
        return has_other_samples(before, after, DRAWN_ONLY)

    def wants_preview(
        self, state: State, sizes: tuple[tuple[int, int], tuple[int, int]], passes: int
    ) -> bool:
        """Return whether a picture without noise is made now: soon, or at once if that is quick.

        It makes the kernels for moves, which takes a second at first, after the light is filtered.
        """
        kinds = {self.states.make_kind(state, size, moving=True) for size in sizes}
        shown = [
            self.live.kept.get(self._find_side(state, side)[0]) for side in range(self.sides(state))
        ]
        ready = all(live and kinds <= live.scenes.kept.keys() for live in shown)
        light = self.lights.loaded.kept.get(state["light.environment"])
        return ready or (passes >= PASSES_BEFORE and light is not None and light.is_filtered)

    def render(
        self, state: State, side: int, size: tuple[int, int], moving: bool, seed: int
    ) -> AnyArray:
        """Render a pass: (height, width, 3), linear sRGB. Both sides share light and samples."""
        # First both sides, because they then have one kernel: it has the code of all materials
        sides = [self._find_live(state, other) for other in range(self.sides(state))]
        live, (_, shown) = sides[side], self._find_side(state, side)
        kind, look = self.states.make_kind(state, size, moving), make_look(state)
        live.show(shown)
        if moving and state["second" if side else "renderer"] != MODEL:  # no slider changes it
            still = kind, look, live.material
            return self.stills.get(still, lambda: live.render(kind, look))
        return live.render(kind, look, seed)

    def _find_live(self, state: State, side: int) -> LiveMaterial:
        """Return the scenes of the material at a side, with the values that they had last."""
        key, shown = self._find_side(state, side)
        return self.live.get(key, lambda: LiveMaterial(shown, self.lights))

    def find_mask(self, state: State, size: tuple[int, int]) -> AnyArray:
        """Return where a picture shows the shape (height, width)."""
        return self.masks.find_shape(state, size)

    def find_unmeasured(self, state: State, size: tuple[int, int]) -> AnyArray | None:
        """Return where a picture shows what was not measured (height, width), if it shall tell."""
        shall = state.get("show.unmeasured")  # which a model alone does not have
        return self.masks.find_unmeasured(state, size) if shall else None

    def _find_side(self, state: State, side: int) -> tuple[str, Any]:
        """Return a key of the material at a side, and the material."""
        return self.states.find_side(state, state["second" if side else "renderer"])

    def has_plot(self, state: State, moving: bool) -> bool:
        """Return whether a plot is open that shows another state."""
        return bool(self.plots.find_stale(state, moving))

    def draw_plots(self, state: State, moving: bool) -> list[Message]:
        """Return the next plots that show another state; only quick ones while something moves."""
        return self.plots.draw(state, moving)

    def tone_mapping(self, state: State) -> ToneMapping:
        """Return the tone mapping of a state."""
        return to_tone_mapping(state)

    def develop(
        self, state: State, pictures: dict[int, AnyArray], moving: bool
    ) -> dict[int, AnyArray]:
        """Return the pictures of all sides as sRGB in 8 bits, with one exposure."""
        return develop(state, pictures, moving)

    def overlay(self, state: State, size: tuple[int, int]) -> dict[str, Any]:
        """Return what is shown, and which parameters do nothing in the picture and why."""
        idle = find_idle_parameters(self.states.to_model(state))
        return {
            "idle": {PREFIX + name: reason for name, reason in idle.items()},
            "lamp": find_lamp(make_look(state), size),
        } | (
            {"ball": place_ball(make_look(state).camera, size)} if state["shape"] == "ball" else {}
        )

    def follow(self, before: State, after: State) -> list[Message]:
        """Return the controls if they are those of another model, or too short for its values.

        The pins, and the file as it says, are among the choices of the controls, too.
        """
        if not before:  # a page that was loaded, which has no plot yet
            self.plots.forget()
        mended = self.states.mend(after)
        model = self.states.to_model(after)
        same = not mended and type(model) is type(self.base) and before
        if same and not self.states.exceeds_controls(self.base, after):
            return [] if after["pins"] == self.pins else self.describe_pins(after)
        return self.describe_model(after)

    def describe_model(self, state: State) -> list[Message]:
        """Return the controls of a state's model, whose defaults are its values, and its fit."""
        self.base = self.states.to_model(state)
        return self.describe_pins(state)

    def describe_pins(self, state: State) -> list[Message]:
        """Return the controls, whose choices have the pins of a state, and the model's fit."""
        self.pins = state["pins"]
        controls = {"type": "controls", "state": state} | self._describe_controls()
        return [(controls, []), (describe_fit(self.states.fits.get(state["model"])), [])]

    def answer(self, session: Session, message: dict[str, Any], data: bytes) -> list[Message]:
        """Answer a message that is about the material."""
        return answer(self, session, message)

    @in_turn
    def forget_scenes(self) -> None:
        """Make the scenes anew, because a map or a mesh may have changed."""
        for kept in (self.live, self.lights.loaded, self.stills, self.masks.directions):
            kept.clear()

    def open_beside(self, session: Session, kind: str, path: Path) -> list[Message]:
        """Open a dropped file beside the material."""
        return open_beside(self, session, kind, path)
