"""What is a material, for all who take any: a measured one, a fit, or a model with values."""

from pathlib import Path

from brdfkit.errors import BrdfkitError
from brdfkit.measured import Measured
from brdfkit.model import labels

ATTRIBUTES = "name", "eval", "scene_dict"


def require_material(thing):
    """An error that says what to give, unless `thing` is a material."""
    if isinstance(thing, type) and hasattr(thing, "lobes"):
        name = thing.__name__
        raise BrdfkitError(f"{name} is a model without values; call it: {name}().")
    if isinstance(thing, str | Path):
        name = str(thing)
        made = f"models()[{name!r}]()" if labels.is_label(name) else f"load({name!r})"
        raise BrdfkitError(f"{name!r} is a name, no material; give brdfkit.{made}.")
    if not all(hasattr(thing, attribute) for attribute in ATTRIBUTES):
        raise BrdfkitError(
            f"A {type(thing).__name__} is no material; give a measured one, a fit or a model "
            "with values."
        )


def require_measured(thing):
    """An error that says what to give, unless `thing` is a measured material."""
    require_material(thing)
    if not isinstance(thing, Measured):
        raise BrdfkitError(f"{thing.name} was not measured; give a material that load() reads.")
