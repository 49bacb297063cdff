"""Finds models by their labels: a name, with options and sums.

    ward    koenderink:order=8    ggx+ggx    oren_nayar:form=full+ward

In a label that a user types, the path of a Python file may stand for the model that it defines;
`load_files_in_label` loads the file. Labels that are read from saved files never go through it,
because opening a file must not run code.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from brdfkit.core.discovery import plugin_files
from brdfkit.core.discovery.plugin_files import MODELS
from brdfkit.core.discovery.plugin_pages import read_page
from brdfkit.core.documents import Cell, Document, Shown, Table
from brdfkit.core.documents.parts import STRONG
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.model.model import Model


class Models(Shown, dict[str, type[Model]]):
    """A dictionary of model classes by name, which prints as a table."""

    def __missing__(self, name: str) -> type[Model]:
        raise no_such_error("model", name, self)

    def document(self) -> Document:
        """Return a table of the models: the name of each, and a sentence that describes it."""
        rows = tuple((Cell(name, kind=STRONG), read_page(m).sentence) for name, m in self.items())
        return Document(f"{len(self)} BRDF models", (Table(rows),))


def models() -> Models:
    """Return all known BRDF models: those of brdfkit, and your own that were loaded.

    Returns
    -------
    dict of str to type
        The classes of models by name, printed as a table. Calling a class with parameters makes a
        model with these values.

    Examples
    --------
    >>> models()["ward"](alpha_u=0.1)
    ward(diffuse_reflectance=0.4, specular_reflectance=0.2, alpha_u=0.1, alpha_v=0.1)
    """
    plugins = plugin_files.find_plugins(MODELS).items()
    classes = ((name, find_model_in(source)) for name, source in plugins)
    return Models((name, model) for name, model in classes if model is not None)


def model(label: str | type[Model]) -> type[Model]:
    """Return the model class that a label names.

    A label is a model's name ("ggx"), a name with options ("lafortune:lobe_count=2"), or a sum
    ("ggx+ward"), which has the diffuse term of its first model and the other terms of all its
    models. A class is returned unchanged. Raises `BrdfkitError` for an unknown name.
    """
    if isinstance(label, type) and issubclass(label, Model):
        label.make_known()
        # The plugin file may have changed since the class was read, so it is looked up again
        return model(label.label()) if label.is_in_plugin_file() else label
    if not isinstance(label, str):
        raise BrdfkitError(
            f"A {type(label).__name__} names no model; give a name such as 'ward', or a class, "
            "after the material."
        )
    parts = label.removeprefix("mixture:models=")
    if "+" in parts or parts != label:
        return model("mixture").configured(models=parts)
    name, _, settings = label.partition(":")
    named = _find_named_model(name)
    options = {}
    for setting in filter(None, settings.split(",")):
        key, equals, value = setting.partition("=")
        if not equals:
            raise BrdfkitError(f"{label}: {setting!r} should read OPTION=VALUE.")
        options[key] = value
    return named.configured(**options)


def is_label(word: str) -> bool:
    """Return whether a word is the label of a known model, such as "koenderink:order=4"."""
    return all(part.partition(":")[0] in models() for part in word.split("+"))


def load_files_in_label(label: Any) -> Any:
    """Load the Python files that a label names, and return the label with their models' names.

    A label that is neither a string nor a `Path` is returned unchanged.

    >>> load_files_in_label("my_models/felt.py+ggx")    # doctest: +SKIP
    'felt+ggx'
    """
    if not isinstance(label, str | Path):
        return label
    parts, label = [], str(label)
    for part in [label] if os.path.isfile(label) else label.split("+"):
        name, colon, options = part.partition(":")
        if name.endswith(".py"):
            load_model_file(name)
            name = Path(name).stem
        parts.append(name + colon + options)
    return "+".join(parts)


def load_model_file(path: str | Path) -> None:
    """Load a Python file that defines a model, and register the model under the file's name.

    Raises `BrdfkitError` for a file that cannot be imported, or defines no model or several, and
    for a name that another plugin has.
    """
    (file,) = plugin_files.find_python_files(path)
    plugin_files.require_free_name(file.stem, file)
    if find_model_in(file) is None:
        raise BrdfkitError(f"{file} defines no class derived from brdfkit.Model.")
    plugin_files.add_plugins(MODELS, {file.stem: file})


def find_model_in(source: Path | type) -> type[Model] | None:
    """Return the `Model` class that a plugin file defines, None if it defines none.

    A `source` that is a class is returned unchanged. Raises `BrdfkitError` for a file that defines
    several models.
    """
    if isinstance(source, type):
        return source
    module = plugin_files.import_plugin(source)
    own = [
        value
        for value in vars(module).values()
        if isinstance(value, type) and issubclass(value, Model)
        if value.__module__ == module.__name__
    ]
    if len(own) > 1:
        names = ", ".join(c.__name__ for c in own)
        raise BrdfkitError(f"{source} defines {len(own)} models ({names}); a file holds one.")
    return own[0] if own else None


def _find_named_model(name: str) -> type[Model]:
    """Return the model class with this name; raise `BrdfkitError` if there is none."""
    source = plugin_files.find_plugins(MODELS).get(name)
    named = source and find_model_in(source)
    if not named:
        raise no_such_error("model", name, models())
    return named
