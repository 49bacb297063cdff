"""The state of a view of a material: its first values, its checks, and what a scene shows of it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.materials.measured import Measured
from brdfkit.materials.resolve import Material, MaterialLike, to_material
from brdfkit.model import Model, labels
from brdfkit.regression import Fit
from brdfkit.viewing.controls import Control, State, default_state
from brdfkit.viewing.materials.block_errors import BlockErrors
from brdfkit.viewing.materials.explorer_controls import make_explorer_controls
from brdfkit.viewing.materials.fit_settings import (
    BOUNDS,
    FIXED,
    UNBOUNDED,
    check_bounds,
    check_fixed,
)
from brdfkit.viewing.materials.kept_fits import KeptFits
from brdfkit.viewing.materials.material_scene import Look, SceneKind, make_studio_camera, place_lamp
from brdfkit.viewing.materials.mends import PREFIX as MEND
from brdfkit.viewing.materials.mends import (
    MendedFile,
    Mends,
    find_mends,
    leave_file,
    make_mend_controls,
    name_file,
    refuse_mend,
)
from brdfkit.viewing.materials.parameter_checks import check_values
from brdfkit.viewing.materials.parameter_controls import make_controls
from brdfkit.viewing.materials.parameter_state import (
    PREFIX,
    to_model,
    to_state,
)
from brdfkit.viewing.materials.picture_controls import FILE, MEASURED, MODEL
from brdfkit.viewing.materials.pins import (
    NONE,
    check_pins,
    find_pin,
    forget_missing_pins,
    label_pin,
    make_model,
    name_pin,
)
from brdfkit.viewing.materials.plot_controls import make_plot_controls
from brdfkit.viewing.materials.scenery import Scenery
from brdfkit.viewing.recent import Recent

DEFAULT_MODEL = "ggx"  # beside a measured material without another one


class MaterialState:
    """Makes and checks the states of a view of one material and models.

    Attributes
    ----------
    measured : Material or None
        The material left of the wipe, as it is mended; None where a model is shown alone.
    kept : dict of Mends to KeptFits
        The fits to the material, by what mends it.
    scenery : Scenery
        The environment maps and the meshes of the user.
    """

    def __init__(self, material: MaterialLike, models: Iterable[MaterialLike]) -> None:
        given = [_find_model(thing) for thing in models]
        shown = to_material(material)
        self.measured: Material | None = shown
        if isinstance(shown, Fit | Model) and not given:
            self.measured, given = None, [shown]
        if not given:
            given = [labels.model(DEFAULT_MODEL)()]
        self.scenery = Scenery()
        self._own_controls: Recent[Any, dict[str, Control]] = Recent(2)  # by what they offer
        self.mended = MendedFile(self.measured)
        self.mends: Mends = ()  # of `measured`
        self.name = shown.name
        self.kept: defaultdict[Mends, KeptFits] = defaultdict(KeptFits)
        self._errors: BlockErrors | None = None
        self.models: dict[str, Model] = {}  # with the values that were given
        for thing in given:
            label = find_label(thing)
            self.models[label] = thing.rgb
            if isinstance(thing, Fit):
                self.keep_fit(label, thing)
        self.given = tuple(self.models)  # the labels
        self.label = next(iter(self.models))  # of the model that is shown first

    @property
    def fits(self) -> dict[str, Fit]:
        """The last fit of each model to the material as it is mended, by its label."""
        return self.kept[self.mends].latest

    def keep_fit(self, label: str, fit: Fit) -> None:
        """Make a fit the one of its model."""
        self.kept[self.mends].keep(label, fit)

    def share_fits(self, other: MaterialState) -> None:
        """Keep the fits with another view, unless the file of the material has changed since."""
        own, known = self.mended.file, other.mended.file
        if isinstance(own, Measured) and own.checksum == known.checksum:
            self.kept = other.kept

    def mend(self, state: State) -> bool:
        """Make the material that of a state, with the fits to it; return whether it is another."""
        mends = find_mends(state)
        if mends == self.mends:
            return False
        self.mends, self.measured = mends, self.mended.find(mends)
        return True

    @property
    def errors(self) -> BlockErrors:
        """The errors of models beside the material, which was measured."""
        measured: Any = self.measured
        if self._errors is None or self._errors.measured is not measured:
            self._errors = BlockErrors(measured)
        return self._errors

    def make_kind(self, state: State, size: tuple[int, int], moving: bool) -> SceneKind:
        """Return what of a state needs kernels of its own."""
        shape = self.scenery.find_shape(state["shape"])
        return SceneKind(shape, state["light.environment"], size, moving)

    @property
    def is_fittable(self) -> bool:
        """Whether models can be fitted to the material."""
        return isinstance(self.measured, Measured)

    def list_models(self, state: State) -> list[Model]:
        """Return the model that a state shows, with its values, and the others with their first."""
        shown = state["model"]
        others = [model for label, model in self.models.items() if label != shown]
        return [self.to_model(state), *others]

    def find_model(self, label: str) -> Model:
        """Return the model of a label with its first values: those of its fit, or given ones."""
        if label in self.fits:
            return self.fits[label].rgb
        if label not in self.models:
            self.models[label] = labels.model(label)().rgb
        return self.models[label]

    def find_class(self, state: State) -> type[Model]:
        """Return the class of the model of a state."""
        return type(self.find_model(state["model"]))

    def to_model(self, state: State) -> Model:
        """Return the model of a state, with its values."""
        return to_model(self.find_class(state), state)

    def list_controls(
        self, model: Model, label: str = "", pins: Sequence[Any] = ()
    ) -> dict[str, Control]:
        """Return all controls by name, those of a model with its values among them."""
        own = self._list_own_controls(label or find_label(model), pins, self.mends)
        return own | {control.name: control for control in make_controls(model)}

    def _list_own_controls(
        self, label: str, pins: Sequence[Any], mends: Mends
    ) -> dict[str, Control]:
        """Return the controls by name, without those of a model's values."""
        names = [label, *(known for known in self.models if known != label)]
        choices = [(name_pin(pin), label_pin(pin)) for pin in pins]
        measured = [(MEASURED, self.name)] if self.measured is not None else []
        if mends:
            measured = [(shown, name_file(self.name, shown)) for shown in (MEASURED, FILE)]
        kind = type(self.find_model(label))
        anisotropic = kind.is_anisotropic() or getattr(self.measured, "anisotropic", False)
        own = tuple(self.scenery.maps), tuple(self.scenery.meshes)
        given = tuple(measured), tuple(names), label, tuple(choices), *own

        def make() -> dict[str, Control]:
            mending, plots = make_mend_controls(self.mended.file), make_plot_controls(anisotropic)
            return {c.name: c for c in [*mending, *make_explorer_controls(*given), *plots]}

        return self._own_controls.get((given, anisotropic), make)

    def first(self) -> State:
        """Return the state with which a view begins."""
        model = self.find_model(self.label)
        state = default_state(self.list_controls(model, self.label).values()) | NONE
        return state | ({FIXED: []} if self.measured is not None else {})

    def change(self, state: State, changes: Mapping[str, Any]) -> State:
        """Return the state after `changes`; raise `BrdfkitError` if one is not possible."""
        new = dict(state)
        label = self.check_label(changes["model"]) if "model" in changes else state["model"]
        if label != state["model"]:
            new = {name: v for name, v in state.items() if not name.startswith(PREFIX)}
            new |= to_state(self.find_model(label)) | {"model": label}
            new |= {name: none for name, none in UNBOUNDED.items() if name in new}
        if "pins" in changes:
            new["pins"] = check_pins(self, changes["pins"])
        mends = find_mends(new | dict(changes))
        # A slider of the model moves often, and needs none of the others
        is_own = any(not name.startswith(PREFIX) for name in changes)
        controls = self._list_own_controls(label, new["pins"], mends) if is_own else {}
        values: State = {}
        for name, value in changes.items():
            if name not in new and name.startswith(MEND):
                raise refuse_mend(self.mended.file, name)
            if name not in new:
                raise no_such_error("setting", name, new)
            if name.startswith(PREFIX):
                values[name] = value
            elif name == FIXED:
                new[name] = check_fixed(self.find_class(new), value)
            elif name == BOUNDS:
                new[name] = check_bounds(self.find_class(new), value)
            elif name not in ("model", "pins"):
                new[name] = controls[name].check(value)
        return forget_missing_pins(leave_file(check_values(self.find_model(label), new, values)))

    def check_label(self, label: Any) -> str:
        """Return the usual label of a known model; raise `BrdfkitError` for another text.

        No file is loaded, because a page must not run code.
        """
        if not isinstance(label, str) or len(label) > 200:
            raise BrdfkitError("The model should be a name such as ggx, or a sum such as ggx+ward.")
        return find_label(labels.model(label.replace(" ", ""))())

    def exceeds_controls(self, base: Model, state: State) -> bool:
        """Return whether a weight of a state is beyond the end of its slider."""
        controls = make_controls(base)
        return any(
            not control.low <= state[control.name] <= control.high
            for control in controls
            if control.kind == "slider"
        )

    def find_side(self, state: State, shown: str) -> tuple[str, Any]:
        """Return what is left or right of the wipe, and a key, "" for the file as it is."""
        if shown == MODEL:
            return state["model"], self.to_model(state)
        pin = find_pin(state["pins"], shown)
        if pin is not None:
            return f"{shown} {pin['model']}", make_model(self, pin)
        mends = () if shown == FILE else find_mends(state)
        return " ".join(mends), self.mended.find(mends)

    def name_side(self, state: State, shown: str) -> str:
        """Return the name of what is left or right of the wipe."""
        pin = find_pin(state["pins"], shown)
        if pin:
            return label_pin(pin)
        if shown == MODEL:
            return str(state["model"])
        return name_file(self.name, shown) if find_mends(state) else self.name

    def describe_side(self, state: State, side: str) -> dict[str, Any]:
        """Return the name of what a side shows, and the settings with which it is another one."""
        shown = state[side]
        own = {MODEL: ["model"], MEASURED: [name for name in state if name.startswith(MEND)]}
        names = side, "shape", "light.environment", *own.get(shown, ())
        needs = {name: state[name] for name in names}
        return {"name": self.name_side(state, shown), "needs": needs}


def make_look(state: State) -> Look:
    """Return the camera and the light of a state."""
    angles = {"azimuth": state["view.azimuth"], "elevation": state["view.elevation"]}
    lamp = place_lamp(state["light.lamp_azimuth"], state["light.lamp_elevation"])
    return Look(replace(make_studio_camera(), **angles), state["light.turn"], lamp)


def find_label(model: Model | Fit) -> str:
    """Return the label of a model, such as "ggx+ward"."""
    return type(model.rgb).label().removeprefix("mixture:models=")


def _find_model(thing: MaterialLike) -> Fit | Model:
    """Return the model with values, or the fit, that a label or a file describes."""
    if isinstance(thing, type) and issubclass(thing, Model):
        return labels.model(thing)()
    found = to_material(thing)
    if not isinstance(found, Fit | Model):
        raise BrdfkitError(f"{found.name} is no model; name the measured material first.")
    return found
