"""`check`: the requirements on every material and every plugin; the tests hold all of them to it.

A check is a function `(subject) -> (passed, figure)` with the decorator `check_of(KIND)`, in a
file of this folder. The checks of a material get a `Subject`; they are in `physics.py`,
`sampling.py` and `derivatives.py`. The checks of another kind of plugin get a `PluginSubject`; they
are in the file of their kind.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterable
from dataclasses import dataclass

from brdfkit.checks.material_subject import Subject
from brdfkit.checks.plugin_subject import PluginSubject, example, is_no_model
from brdfkit.checks.registry import Finding, checks, describe
from brdfkit.core.discovery import plugin_files
from brdfkit.core.discovery.plugin_files import KINDS, MODELS
from brdfkit.core.documents import Cell, Document, Shown, Table
from brdfkit.core.documents.parts import BAD, GOOD
from brdfkit.core.errors import BrdfkitError, nearest, no_such
from brdfkit.core.jit import llvm
from brdfkit.core.jit.loops import is_interrupt
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.progress_bar import Progress
from brdfkit.materials.resolve import MaterialLike, to_material
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")


@dataclass(frozen=True, repr=False)
class Report(Shown):
    """What `check` found; true when everything passed; prints as a list.

    Attributes
    ----------
    name : str
        What was checked.
    findings : tuple of Finding
        Of each check its name (`check`), whether it `passed`, and the `figure` by which.
    """

    name: str
    findings: tuple[Finding, ...]

    def __bool__(self) -> bool:
        return all(finding.passed for finding in self.findings)

    def document(self) -> Document:
        """Each check, whether it passed, and the figure by which."""
        rows = tuple(
            (Cell("ok", GOOD) if f.passed else Cell("FAIL", BAD), f.check, f.figure)
            for f in self.findings
        )
        return Document(f"{self.name}: {'passed' if self else 'failed'}", (Table(rows),))


@in_turn
def check(
    material: MaterialLike,
    *,
    only: Iterable[str] | None = None,
    progress: Progress | None = None,
) -> Report:
    """Check that a material, or a plugin of another kind, is what a renderer and a fit need.

    Of a material: its sampling (χ² at five incidences to grazing, coverage, weight = eval / pdf),
    reciprocity, finiteness to the horizon, energy, derivatives, and that the Mitsuba plugin
    computes the formula. Of an emitter or a phase function: χ², weights, normalisation and means.
    Of an integrator: the reference that its file names. A plugin whose lines raise an error has
    failed. Everything runs in the current variant of Mitsuba; where none is set, in the best that
    works.

    Parameters
    ----------
    material : Model, Fit, Measured, str, Path or dict
        The material, or its name or path; or the name of a plugin of another kind, or its
        dictionary for `mitsuba.load_dict`.
    only : list of str, optional
        Names of the checks to run; by default all there are for its kind.
    progress : callable, optional
        Called with (checks done, checks in all).

    Returns
    -------
    Report
        True where everything passed; prints as a list.

    Raises
    ------
    BrdfkitError
        For an unknown check, for what is no material or plugin, and in a scalar variant of Mitsuba.

    Examples
    --------
    >>> print(check("ward"))    # doctest: +SKIP
    """
    if llvm.use_variant().startswith("scalar"):
        usable = llvm.loaded_version() >= llvm.OLDEST
        remedy = "set llvm_ad_rgb" if usable else llvm.describe_remedy()
        raise BrdfkitError(f"check needs an LLVM or CUDA variant of Mitsuba; {remedy}.")
    subject, kind, name = _subject(material)
    only = [only] if isinstance(only, str) else only
    names = list(checks[kind]) if only is None else list(only)
    for wanted in names:
        if wanted not in checks[kind]:
            raise no_such("check", wanted, checks[kind])
    if kind != MODELS and not _loads(subject):
        names = ["loads"]  # the others would say the same
    findings = []
    for wanted in names:
        findings.append(Finding(wanted, *_run(kind, wanted, subject)))
        if progress:
            progress(len(findings), len(names))
    return Report(name, tuple(findings))


def _subject(thing):
    """The subject of the checks of `thing`, its kind of plugin, and its name."""
    if isinstance(thing, str) and is_no_model(thing):
        thing = example(thing)
    name = thing.get("type") if isinstance(thing, dict) else None
    kind = plugin_files.find_kind(name) if isinstance(name, str) else None
    if kind not in (None, MODELS):
        return PluginSubject(kind, thing), kind, name
    found = _material(thing)
    if name and kind is None:  # a plugin of Mitsuba's, or none at all
        import mitsuba as mi

        load_by_mitsuba(mi.load_dict, found.scene_dict(), name)
    return Subject(found), MODELS, found.name


def _material(thing):
    """The material of `thing`; the error for an unknown name proposes plugins, too."""
    try:
        return to_material(thing)
    except BrdfkitError:
        others = [n for kind in KINDS if kind != MODELS for n in plugin_files.find_plugins(kind)]
        if isinstance(thing, str) and nearest(thing, others):
            raise no_such("plugin", thing, others) from None
        raise


def _loads(subject):
    """Whether Mitsuba makes an instance of a plugin."""
    try:
        return subject.plugin is not None
    except Exception:
        return False


def _run(kind, name, subject):
    """(passed, figure) of one check; it has failed where a plugin's own code raises an error."""
    try:
        return checks[kind][name](subject)
    except BrdfkitError:
        raise
    except Exception as error:
        if is_interrupt(error):
            raise KeyboardInterrupt from None
        if subject.source is None:
            raise
        return False, describe(error, subject.source)
