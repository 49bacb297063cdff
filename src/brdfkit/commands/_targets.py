"""What a word on the command line means beyond what it means in Python; and where results go."""

from contextlib import contextmanager, suppress
from pathlib import Path

from brdfkit import materials
from brdfkit.errors import BrdfkitError
from brdfkit.files import make_folder, require_writable, write_safely
from brdfkit.model import labels
from brdfkit.rendering.montage import picture_suffix

FIGURES = ".png", ".pdf", ".svg"


def material(name, settings=()):
    """What can be rendered: a model by name with `settings`, a saved fit, a measured file."""
    if not settings:
        return materials.material(name)
    label = labels.read_files(name)
    if not labels.is_label(label):
        raise BrdfkitError(f"{name} is no model: parameters can be set for models only.")
    return labels.model(label)(**values(label, settings))


def values(name, settings):
    """Parameter values of a model, of ``PARAMETER=VALUE`` settings."""
    found = numbers(settings)
    for parameter in found:
        labels.model(name).parameter(parameter)
    return found


def numbers(settings):
    """Values by name of ``PARAMETER=VALUE`` settings, VALUE a number or r,g,b."""
    parsed = {}
    for setting in settings:
        parameter, equals, text = setting.partition("=")
        try:
            parts = [float(part) for part in text.split(",")]
        except ValueError:
            parts = []
        if not equals or len(parts) not in (1, 3):
            raise BrdfkitError(f"{setting!r} should read {parameter}=VALUE or {parameter}=R,G,B.")
        parsed[parameter] = parts[0] if len(parts) == 1 else parts
    return parsed


@contextmanager
def results(path):
    """Makes the folder `path`, unless None; it is gone again where nothing was written to it."""
    if path is None:
        yield
        return
    made = [p for p in (path, *path.parents) if not p.exists()]
    try:
        make_folder(path)
        yield
    finally:
        for p in made:
            with suppress(OSError):  # rmdir takes empty folders only
                p.rmdir()


def picture_file(name):
    """The path of a picture, once it is sure that it can be written: rendering takes long."""
    path = Path(name)
    picture_suffix(path)
    require_writable(path)
    require_writable(path.with_suffix(".png"))
    return path


def figure_file(name):
    """The path of a matplotlib figure, once it is sure that it can be written."""
    path = Path(name)
    if path.suffix.lower() not in FIGURES:
        raise BrdfkitError(f"{path}: this picture is written as {', '.join(FIGURES)}; name one.")
    require_writable(path)
    return path


def write_figure(figure, path):
    """Write a matplotlib `Figure` to `path`, whole or not at all."""
    with write_safely(path) as beside:
        figure.savefig(beside, dpi=130)


def other_file(path, source):
    """`path`, once it is sure that it can be written and is not the file that `source` names."""
    require_writable(path)
    for read in (source, source.rpartition("#")[0]):
        if read and path.exists() and Path(read).exists() and path.samefile(read):
            raise BrdfkitError(f"{path} is the file to read; name another to write.")
    return path


def fit_file(output, fit):
    """The file of a `Fit` in the folder `output`; a label's colon is not for every file system."""
    return Path(output) / f"{fit.name.replace(':', '-')}.json"
