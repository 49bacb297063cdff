"""Finds the plugin files and makes them known to Mitsuba. No list names them: a file in
`plugins/bsdfs/` is a plugin, and its name is the plugin's type.

A file of brdfkit's holds either a `Model` (see `brdfkit.model`), or a function `define(mi)` that
returns a `mi.BSDF` class for the current variant; a file of the user's holds a `Model`.
"""

import importlib
import importlib.util
import sys
from functools import cache
from pathlib import Path

from brdfkit.errors import BrdfkitError

_user_files: dict[str, Path] = {}
_registered: set[tuple[str, str]] = set()


def models():
    """The models there are, by name: ``{"abc": ABC, ...}``, brdfkit's and those that were loaded.

    >>> sorted(models())[0]
    'abc'
    """
    found = {name: model_in(path) for name, path in plugin_files().items()}
    return {name: model for name, model in found.items() if model is not None}


def model(label):
    """The model of a label: its name, with options ``"lafortune:lobe_count=2"``, or a sum of
    labels, ``"ggx+ward"``: one diffuse term and the other terms of each. Its class means it too.

    `BrdfkitError` lists the models there are.
    """
    label = _label(label)
    parts = label.removeprefix("mixture:models=")
    if "+" in parts or parts != label:
        return model("mixture").configured(models=parts)
    name, _, settings = label.partition(":")
    found = model_in(plugin_files()[name]) if name in plugin_files() else None
    if found is None:
        known = ", ".join(models())
        raise BrdfkitError(f"There is no model {name!r}; there are {known}.")
    options = {}
    for setting in filter(None, settings.split(",")):
        key, equals, value = setting.partition("=")
        if not equals:
            raise BrdfkitError(f"{label}: {setting!r} should read OPTION=VALUE.")
        options[key] = value
    return found.configured(**options)


def _label(model):
    """The label of what stands for a model: of a class too, if it comes back by that label."""
    if isinstance(model, type) and hasattr(model, "label"):
        require_file(model)
        return model.label()
    if not isinstance(model, str):
        raise BrdfkitError(
            f"A {type(model).__name__} names no model; give one of {', '.join(models())}."
        )
    return model


def require_file(model):
    """An error where the class lies in no file, by which Mitsuba and a saved fit find it."""
    if model.type_name() not in plugin_files():
        raise BrdfkitError(
            f"{model.__name__} is in no file of models; write it into one and load that, as by "
            'brdfkit.load_models("my_model.py").'
        )


def is_label(word):
    """Whether a word can only be meant as a model: "ggx", "ggx+ward", "koenderink:order=4"."""
    return all(part.partition(":")[0] in models() for part in word.split("+"))


def model_with_values(label, values):
    """The model of that label with these values; a pickled model comes back through it."""
    return model(label)(**values)


def load_models(path):
    """Make the models of a file or folder of yours known, beside brdfkit's; returns them.

    >>> load_models("my_models/")    # doctest: +SKIP
    {'velvet': <class 'brdfkit.user_plugins.velvet.Velvet'>}
    """
    path = Path(path).absolute()
    files = sorted(path.glob("[!_]*.py")) if path.is_dir() else [path]
    if not path.exists() or not files:
        raise BrdfkitError(f"{path} is no Python file and no folder with any.")
    loaded = {}
    for file in files:
        _require_free(file)
        found = model_in(file)
        if found is None:
            raise BrdfkitError(f"{file} defines no class derived from brdfkit.Model.")
        loaded[file.stem] = found
    _user_files.update({file.stem: file for file in files})
    if "mitsuba" in sys.modules and sys.modules["mitsuba"].variant() is not None:
        register_in_mitsuba()
    return loaded


def _require_free(file):
    """An error where the name of a user's file is taken: Mitsuba would go on with the other."""
    import mitsuba as mi

    name = file.stem
    built_in = Path(mi.__file__).with_name("plugins").iterdir()
    if name in _shipped_files():
        owner = "brdfkit has a plugin"
    elif name in {f.stem for f in built_in}:
        owner = "Mitsuba has a plugin"
    elif _user_files.get(name, file) != file:
        owner = f"{_user_files[name]} is loaded as"
    else:
        return
    raise BrdfkitError(f"{file}: {owner} {name!r}; rename the file.")


def plugin_files():
    """Name → file of every BSDF plugin, brdfkit's and those that were loaded."""
    return {**_shipped_files(), **_user_files}


@cache
def _shipped_files():
    from brdfkit import plugins

    files = [f for folder in plugins.__path__ for f in Path(folder, "bsdfs").glob("*.py")]
    return {file.stem: file for file in sorted(files)}


def model_in(path):
    """The `Model` class that a file defines, None if it defines none."""
    from brdfkit.model.model import Model

    module = _module(path)
    own = [
        value
        for value in vars(module).values()
        if isinstance(value, type) and issubclass(value, Model)
        if value.__module__ == module.__name__
    ]
    if len(own) > 1:
        names = ", ".join(c.__name__ for c in own)
        raise BrdfkitError(f"{path} defines {len(own)} models ({names}); a file holds one.")
    return own[0] if own else None


def _module(path):
    if _shipped_files().get(path.stem) == path:
        return importlib.import_module(f"brdfkit.plugins.bsdfs.{path.stem}")
    if not path.is_file():
        raise BrdfkitError(f"{path} is not a Python file.")
    return _executed(path, path.stat().st_mtime_ns)


@cache
def _executed(path, _changed):
    """The module of a user's file, anew when the file has changed."""
    name = f"brdfkit.user_plugins.{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None:
        raise BrdfkitError(f"{path} is not a Python file.")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        raise BrdfkitError(f"{path} cannot be imported: {str(error).rstrip('.')}.") from error
    return module


def register_in_mitsuba():
    """Register every plugin in the current Mitsuba variant; each is built when first used."""
    import mitsuba as mi

    variant = mi.variant()
    for name in plugin_files():
        if (variant, name) not in _registered:
            _registered.add((variant, name))
            mi.register_bsdf(name, lambda props, name=name: _plugin(name, props))


def _plugin(name, props):
    import mitsuba as mi

    path = plugin_files()[name]
    source = model_in(path)
    if source is None:
        return _defined(_module(path), mi.variant())(props)
    options = {option: props[option] for option in source.options if option in props}
    return _defined(source.configured(**options), mi.variant())(props)


@cache
def _defined(source, _variant):
    """The class of `mi.BSDF` of a `Model`, or of a module that defines it itself."""
    import mitsuba as mi

    from brdfkit.host import bsdf

    return bsdf.define(mi, source) if isinstance(source, type) else source.define(mi)
