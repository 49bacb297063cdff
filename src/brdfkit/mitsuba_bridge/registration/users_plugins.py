"""Implements `load_plugins`, which makes a user's plugins known, including BRDF models."""

from pathlib import Path

from brdfkit.core.discovery import plugin_files
from brdfkit.core.discovery.plugin_files import KINDS, MODELS
from brdfkit.core.errors import BrdfkitError, find_nearest_name
from brdfkit.model import labels


def load_plugins(path: str | Path) -> dict[str, str]:
    """Make your own plugins of any kind known, to Mitsuba in every variant and to brdfkit by name.

    A BRDF model is a plugin of the kind ``bsdfs``: afterwards it can be fitted, and `models` lists
    it.

    Parameters
    ----------
    path : str or Path
        A folder with the same layout as brdfkit's own, which contains ``emitters/``, ``phase/`` and
        the like; one of these folders; or a file in one of them. A file that defines a `Model` may
        lie anywhere, and so may a folder of such files. A file's name is the type of the plugin.
        Files whose names begin with an underscore are left out.

    Returns
    -------
    dict of str to str
        The kinds of the plugins that were loaded, by name.

    Raises
    ------
    BrdfkitError
        For a name that is taken, and for a file that cannot be imported, holds no plugin, or lies
        in no folder of a kind. Then none is loaded.

    Examples
    --------
    >>> load_plugins("my_plugins/")    # doctest: +SKIP
    {'softbox': 'emitters', 'velvet': 'bsdfs'}
    """
    files = {}
    if not str(path):
        raise BrdfkitError("The path is empty; name a folder of plugins, or a file.")
    for file in _find_plugin_files(Path(path).absolute()):
        plugin_files.require_free_name(file.stem, file)
        files[file] = _find_kind_of_file(file)
    for kind in KINDS:
        plugin_files.add_plugins(kind, {file.stem: file for file, k in files.items() if k == kind})
    return {file.stem: kind for file, kind in sorted(files.items())}


def _find_plugin_files(path: Path) -> list[Path]:
    """Return the plugin files at `path`: a file, or a folder with files or folders of kinds."""
    _refuse_misspelt_folder(path)
    folders = [path / kind for kind in KINDS if (path / kind).is_dir()]
    if not folders:
        return plugin_files.find_python_files(path)
    return sorted(file for f in (path, *folders) for file in f.glob("[!_]*.py"))


def _refuse_misspelt_folder(path: Path) -> None:
    """Raise `BrdfkitError` for a folder in `path` whose name is a misspelt kind of plugin."""
    for folder in sorted(path.iterdir()) if path.is_dir() else ():
        kind = find_nearest_name(folder.name.lower(), KINDS)
        if folder.is_dir() and folder.name not in KINDS and kind and any(folder.glob("*.py")):
            raise BrdfkitError(f"{folder} is no kind of plugin; rename it {kind}/.")


def _find_kind_of_file(file: Path) -> str:
    """Return the kind of a plugin file: its folder's name, or "bsdfs" if it defines a model.

    Raises `BrdfkitError` for a file that holds no plugin or lies in no folder of a kind.
    """
    module = plugin_files.import_plugin(file)
    if labels.find_model_in(file) is not None:
        return MODELS
    if file.parent.name not in KINDS:
        raise BrdfkitError(
            f"{file}: holds no Model, and its folder does not tell what kind of plugin it is; put "
            f"it into one of {', '.join(f'{kind}/' for kind in KINDS)}."
        )
    if not callable(getattr(module, "define", None)):
        raise BrdfkitError(f"{file}: has no function define(mi) that returns the plugin's class.")
    return file.parent.name
