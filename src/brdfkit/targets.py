"""What a word on the command line means: a file, a model, or a material that brdfkit brings."""

from pathlib import Path

from brdfkit import catalogue, registry
from brdfkit.errors import BrdfkitError
from brdfkit.formats import load
from brdfkit.measured import Measured


def measured(name):
    """The measured material in a file, or the one of that name that brdfkit brings."""
    thing = load(name)
    if not isinstance(thing, Measured):
        raise BrdfkitError(f"{name} is a saved fit; name a measured file.")
    return thing


def material(name, settings=()):
    """What can be rendered: a model by name with `settings`, a saved fit, a measured file."""
    if name in registry.models() and not Path(name).exists():
        return registry.model_with_values(name, values(name, settings))
    if settings:
        raise BrdfkitError(f"{name} is no model: parameters can be set for models only.")
    try:
        return load(name)
    except BrdfkitError as error:
        if Path(name).suffix or Path(name).exists():
            raise
        models, materials = (", ".join(x) for x in (registry.models(), catalogue.materials()))
        raise BrdfkitError(
            f"{name} is no file, no model ({models}) and no material of brdfkit's ({materials})."
        ) from error


def to_check(name, settings=()):
    """The materials to check: the models of a FILE.py, or what `material` finds."""
    if not name.endswith(".py"):
        return [material(name, settings)]
    loaded = registry.load_models(name)
    return [model(**values(n, settings)) for n, model in loaded.items()]


def values(name, settings):
    """Parameter values of ``PARAMETER=VALUE`` settings, VALUE a number or r,g,b."""
    parsed = {}
    for setting in settings:
        parameter, equals, text = setting.partition("=")
        registry.model(name).parameter(parameter)
        try:
            numbers = [float(part) for part in text.split(",")]
        except ValueError:
            numbers = []
        if not equals or not numbers:
            raise BrdfkitError(f"{setting!r} should read {parameter}=VALUE or {parameter}=R,G,B.")
        parsed[parameter] = numbers[0] if len(numbers) == 1 else numbers
    return parsed
