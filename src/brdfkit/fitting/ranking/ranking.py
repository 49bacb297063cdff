"""`rank`: ranks models by their errors in directions held out of the fit, and by pictures."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Iterable
from contextlib import closing
from typing import Any, TypeAlias

import numpy as np

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.cluster import count_cluster_slots, run_tasks
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.progress_bar import Progress
from brdfkit.fitting.ranking.appearance import Appearance
from brdfkit.fitting.ranking.cross_validation import Validated, cross_validate
from brdfkit.fitting.ranking.held_out import HeldOut
from brdfkit.fitting.ranking.ranked import rank_results
from brdfkit.fitting.ranking.result import Ranking
from brdfkit.fitting.settings import LossLike, ModelLike, require_material_first
from brdfkit.images.ball import draw_pixels
from brdfkit.materials.measured.selection import select_samples
from brdfkit.materials.resolve import MaterialLike, to_measured
from brdfkit.model import Model, labels
from brdfkit.regression import Picture, to_loss
from brdfkit.regression.albedo import TargetAlbedo

# Sums of two models that are ranked by default, because they fit best in docs/leaderboard.md
SUMS = "ggx+ggx", "abc+ggx", "abc+student_t"
# The arguments of `cross_validate` that all models share
How: TypeAlias = tuple[HeldOut, Appearance, TargetAlbedo, bool | None, int]


def rank(
    material: MaterialLike,
    models: ModelLike | Iterable[ModelLike] | None = None,
    *,
    loss: LossLike = "cbrt",
    folds: int = 5,
    anisotropic: bool | None = None,
    max_angle: float = 80.0,
    client: Any = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> Ranking:
    """Rank models by cross-validation on a measured material, and by pictures of their fits.

    The directions are divided into blocks, and these into folds. Every model is fitted to all folds
    but one and tested on that one, for each fold in turn. A model is tied with the best if the
    difference of their errors is at most twice its standard error, which is estimated from the
    blocks. Besides, a picture of a ball with each fit is compared to one with the measurement.

    The Pareto set contains the models that no other surpasses in both picture and error, by more
    than the noise. Of this set, the models are kept whose pictures are within 0.5 dB of the best,
    and of these the ones whose errors are tied for the least. The one with the fewest parameters is
    recommended. A model that reflects more light at 85° than arrives, or whose colour there is no
    mixture of the material's own colours with grey, is only recommended if there is no other.

    Of a large measurement a part of the samples is used. A model that cannot be fitted does not
    stop the others; Ctrl-C returns the models that are finished.

    Parameters
    ----------
    material : Measured, str or Path
        The measured material, or its name or path.
    models : str, Path, class or several, optional
        The models, as for `fit`. By default all, and the sums of two that fit best most often.
    loss : str, Loss, Picture or callable, default "cbrt"
        The error to minimise and to rank by, as for `fit`. Under a `Picture` regions of the ball
        are held out, too; this takes several times as long, and leaves out the models that may be
        negative.
    folds : int, default 5
        Number of folds, at least 2.
    anisotropic : bool, optional
        Whether ``alpha_v`` and similar parameters are searched, as for `fit`.
    max_angle : float, default 80
        Largest angle to the normal [degrees, above 0 to 90]; samples at or beyond it are left out.
    client : distributed.Client, optional
        A cluster that fits in place of this process, a task for each model. The files of your own
        models must have the same paths there.
    seed : int, default 0
        Seed of the folds, the drawn samples and the starts; equal seeds give equal rankings.
    progress : callable, optional
        Called with (fits done, fits in all).

    Returns
    -------
    Ranking
        The models, the best first, with the recommended one; prints as a table with sentences.

    Raises
    ------
    BrdfkitError
        For an unknown model or loss, where `material` was not measured or no sample is left, for
        fewer blocks of directions than folds, and where no model can be fitted.

    Examples
    --------
    >>> print(rank("paint.binary", ["ward", "ggx", "ggx+ggx"]))    # doctest: +SKIP
    """
    began = time.perf_counter()
    require_material_first("rank(material, models)", material)
    if client is not None:
        count_cluster_slots(client)
    data, classes = to_measured(material), _find_model_classes(models)
    folds, seed = to_whole_number("folds", folds, 2), to_whole_number("seed", seed, 0)
    chosen = to_loss(loss)
    anisotropic = data.anisotropic if anisotropic is None else anisotropic
    samples, pixels, rng = select_samples(data, max_angle), None, np.random.default_rng(seed)
    if isinstance(chosen, Picture):
        pixels = draw_pixels(chosen.lights, data.rgb.eval, max_angle, seed)
    held_out = HeldOut.divide(samples, chosen, data.anisotropic, folds, rng, pixels)
    appearance = Appearance(data, samples, max_angle, seed + 1)
    target = TargetAlbedo.from_measured(data.rgb.albedo, data.anisotropic)
    how = held_out, appearance, target, anisotropic, seed

    report, fits = progress or (lambda done, total: None), folds + 1
    results: dict[str, Any] = {}
    try:
        with closing(_validate(classes, how, client, fits, report)) as validated:
            for label, result in validated:
                results[label] = result
    except KeyboardInterrupt:
        if not results:
            raise
    if all(isinstance(one, BrdfkitError) for one in results.values()):
        raise next(iter(results.values()))
    ordered = {label: results[label] for label in classes if label in results}
    rows = rank_results(ordered, held_out.sum_by_block(np.ones(len(held_out.blocks))))
    return Ranking(data.name, chosen.name, rows, len(classes), time.perf_counter() - began)


def _validate(
    classes: dict[str, type[Model]],
    how: How,
    client: Any,
    fits: int,
    report: Progress,
) -> Generator[tuple[str, Any], None, None]:
    """Yield (label, `Validated` or the error) for every model, as they are finished.

    Each model takes `fits` fits, of which `report` is told. They run on the cluster of a `client`,
    if there is one.
    """
    total = len(classes) * fits
    if client is None:
        for number, (label, model) in enumerate(classes.items()):

            def report_fit(done: int, before: int = number * fits) -> None:
                """Report the finished fits of all models; `done` are those of this model."""
                report(before + done, total)

            yield label, _validate_model(how, model(), report_fit)
        return
    report(0, total)
    models = [model() for model in classes.values()]
    tasks = run_tasks(_validate_model, models, client, shared=how, describe=lambda m: m.name)
    with closing(tasks):
        for number, (task, result) in enumerate(tasks):
            if isinstance(result, Exception) and not isinstance(result, BrdfkitError):
                raise result
            yield task.name, result
            report((number + 1) * fits, total)


def _validate_model(
    how: How, model: Model, report: Callable[[int], object] = lambda done: None
) -> Validated | BrdfkitError:
    """Cross-validate the class of a model, or return the reason why it cannot be fitted."""
    try:
        return cross_validate(type(model), *how, report)
    except BrdfkitError as error:
        return error


def list_default_models() -> list[str]:
    """Return the labels of the models that `rank` compares by default."""
    return [*(name for name in labels.models() if name != "mixture"), *SUMS]


def _find_model_classes(models: Any) -> dict[str, type[Model]]:
    """Return the classes of models by label; a model that is named twice counts once."""
    if models is None:
        models = list_default_models()
    several = isinstance(models, Iterable) and not isinstance(models, str)
    classes = [
        labels.model(labels.load_files_in_label(m)) for m in (models if several else [models])
    ]
    if not classes:
        raise BrdfkitError("There is no model to rank; name at least one.")
    return {model.label(): model for model in classes}
