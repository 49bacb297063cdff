"""Scripts and commands that repeat the picture of a view of a material, and its fit."""

from __future__ import annotations

import json
import os
import shlex
from typing import TYPE_CHECKING, Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.model import Model
from brdfkit.viewing.controls import State
from brdfkit.viewing.materials.fit_settings import find_repeated_arguments, to_fit_arguments
from brdfkit.viewing.materials.mends import PREFIX as MEND
from brdfkit.viewing.materials.mends import Mends, find_mends
from brdfkit.viewing.materials.mitsuba_xml import write_xml
from brdfkit.viewing.materials.parameter_state import PREFIX, to_state
from brdfkit.viewing.materials.picture_controls import FILE
from brdfkit.viewing.materials.pins import NONE, PIN

if TYPE_CHECKING:
    from brdfkit.viewing.session import Session

    Application = Any  # `MaterialApplication`, which imports this file

SAMPLES = 64  # per pixel at least


def write_script(application: Application, session: Session) -> str:
    """Return a Python script that makes the model and the session's picture.

    A model whose values are still those of its fit is fitted again.
    """
    states, state = application.states, session.state
    changes = {k: v for k, v in find_changes(application, state).items() if not _is_model(k)}
    given = "material"  # what the picture is made of
    if FILE in (state["renderer"], state["second"]):
        given = write_load(application, ())  # the state mends it, and both are shown
    else:
        changes = {k: v for k, v in changes.items() if not k.startswith(MEND)}
    lines = [f"{write_comment(application)}import brdfkit", ""]
    if states.measured is None:
        lines.append(f"material = {write_model(states.to_model(state))}")
        call = "material, state"
    else:
        load = write_load(application, find_mends(state))
        lines += [f"material = {load}"] if load != "material" else []
        lines += [f"model = {_write_fit(application, state)}", "print(model)"]
        lines.append("print(brdfkit.compare(material, model))")
        call = f"{given}, state, models=model"
    name = "material" if states.measured is None else "model"
    lines.append(f"# In a scene of Mitsuba: mitsuba.load_dict({name}.scene_dict())")
    lines += ["", "state = {", *(f"    {k!r}: {v!r}," for k, v in changes.items()), "}"]
    if not changes:
        lines[-2:] = ["state = {}"]
    size, spp = session.picture_size(), max(session.passes, SAMPLES)
    lines.append(f"picture = brdfkit.viewing.render_view({call}, size={size}, spp={spp})")
    return "\n".join([*lines, f"picture.write({application.name + '.png'!r})", ""])


def _write_fit(application: Application, state: State) -> str:
    """Return the expression of a state's model: its fit, or its values."""
    fit, label = application.states.fits.get(state["model"]), state["model"]
    values = to_state(application.states.to_model(state))
    if fit is not None and to_state(fit.rgb) == values:
        how = find_repeated_arguments(fit, application.states.measured.anisotropic)
        if how is not None:
            words = [f"{name}={value!r}" for name, value in how.items()]
            return f"brdfkit.fit(material, {label!r}, {', '.join(words)})"
    return write_model(application.states.to_model(state))


def write_model(model: Model) -> str:
    """Return the expression that makes a model with its values."""
    kind, words = type(model), [f"{n}={v!r}" for n, v in model.free_values.items()]
    options = ", ".join(f"{name}={value!r}" for name, value in kind.changed_options().items())
    configured = f".configured({options})" if options else ""
    return f"brdfkit.models()[{kind.type_name()!r}]{configured}({', '.join(words)})"


def write_command(application: Application, session: Session) -> str:
    """Return a command that makes the session's picture."""
    file, state = find_file(application), session.state
    if not file:
        raise BrdfkitError(
            f"{application.name} was made in Python, and no command can load it; copy Python."
        )
    changes = find_changes(application, state)
    width, height = session.picture_size()
    words = ["brdfkit", "view", file]
    words += [state["model"]] if application.states.measured is not None else []
    changes.pop("model", None)
    for name in find_mends(state):
        words.append(f"--{name.replace('_', '-')}")
        del changes[MEND + name]
    words += ["--state", json.dumps(changes), "--size", f"{width}x{height}"]
    words += ["--spp", str(max(session.passes, SAMPLES)), "-o", f"{application.name}.png"]
    return write_comment(application) + shlex.join(words)


def find_file(application: Application) -> str:
    """Return the name or the file of the material; "" if it was made in Python."""
    material = application.given[0]
    return application.file or (
        os.fspath(material) if isinstance(material, str | os.PathLike) else ""
    )


def write_load(application: Application, mends: Mends) -> str:
    """Return the expression of the measured material with mends."""
    file, options = find_file(application), ", ".join(f"{name}=True" for name in mends)
    if file:
        return f"brdfkit.load({', '.join(filter(None, [repr(file), options]))})"
    return f"material.mend({options})" if options else "material"


def write_comment(application: Application) -> str:
    """Return a comment for a file that the page sent, whose folder is unknown."""
    file = application.file
    return f"# Write the folder of {file} before its name; the page hides it\n" if file else ""


def write_fit_command(application: Application, session: Session) -> str:
    """Return a command that fits the model that is shown, with the settings of the page."""
    states, state = application.states, session.state
    file = find_file(application)
    if not (states.is_fittable and file):
        raise BrdfkitError(f"{application.name} is no file, so no command can fit it; copy Python.")
    how = to_fit_arguments(state, states.find_class(state))
    if not how.pop("use_standard_error", True):
        raise BrdfkitError("No command can leave standard errors aside; copy Python.")
    words = ["brdfkit", "fit", file, "-m", state["model"]]
    words += [f"--{name.replace('_', '-')}" for name in find_mends(state)]
    for name, values in (("--fixed", how.pop("fixed", {})), ("--bound", how.pop("bounds", {}))):
        for key, value in values.items():
            numbers = value if isinstance(value, tuple) else (value,)
            words += [name, f"{key}={','.join(map(repr, numbers))}"]
    if "anisotropic" in how:
        words.append("--anisotropic" if how.pop("anisotropic") else "--isotropic")
    for name, value in how.items():
        words += [f"--{name.replace('_', '-')}", str(value)]
    return write_comment(application) + shlex.join([*words, "-o", application.name])


def find_changes(application: Application, state: State) -> State:
    """Return what of a state differs from the first one of a view of its model."""
    first = application.states.first() | to_state(type(application.states.to_model(state))())
    sides = f"{state['renderer']} {state['second']}"
    unseen = () if PIN in sides else NONE  # the pins are not in the picture
    return {
        name: value
        for name, value in state.items()
        if first.get(name) != value and name not in unseen and not _is_beside(name)
    }


def _is_model(name: str) -> bool:
    """Return whether a setting is the model, or one of its values."""
    return name == "model" or name.startswith(PREFIX)


def write_element(application: Application, session: Session) -> str:
    """Return the model that is shown as XML of Mitsuba."""
    return write_xml(application.states.to_model(session.state))


KINDS = {  # of copies: a title, and the function that writes
    "python": ("The same from Python", write_script),
    "command": ("The same picture from a command", write_command),
    "xml": ("The model in a scene of Mitsuba", write_element),
    "fit": ("The fit from a command", write_fit_command),
}
# Besides Python and the command of the picture: kinds and labels
MORE = ("xml", "Copy model as Mitsuba XML"), ("fit", "Copy fit as command")


def _is_beside(name: str) -> bool:
    """Return whether a setting is about plots, which no picture shows."""
    return name.startswith("plots.")
