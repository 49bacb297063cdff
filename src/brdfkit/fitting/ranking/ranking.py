"""`rank`: models by how well they predict what they were not fitted to, and by how they look."""

import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.fitting.ranking.appearance import Appearance
from brdfkit.fitting.ranking.cross_validation import cross_validate
from brdfkit.fitting.ranking.held_out import HeldOut
from brdfkit.fitting.ranking.ranked import rows_of
from brdfkit.fitting.ranking.result import Ranking
from brdfkit.images.ball import draw_pixels
from brdfkit.materials.measured.selection import select_samples
from brdfkit.materials.resolve import MaterialLike, to_measured
from brdfkit.model import Model, labels
from brdfkit.regression import Loss, Picture, as_loss
from brdfkit.regression.light import Light

# The sums that are ranked by default: the best of docs/leaderboard.md with few and with more
# parameters
SUMS = "ggx+ggx", "abc+ggx", "abc+student_t"


def rank(
    data: MaterialLike,
    models: str | Path | type[Model] | Iterable[str | Path | type[Model]] | None = None,
    loss: str | Loss | Picture | Callable[..., Any] = "cbrt",
    *,
    folds: int = 5,
    anisotropic: bool | None = None,
    max_angle: float = 80.0,
    seed: int = 0,
    progress: Callable[[int, int], object] | None = None,
) -> Ranking:
    """Rank models by how well each predicts a measured material where it was not fitted, and by
    how it looks.

    The directions are cut into blocks and these into folds. Every model is fitted to all folds but
    one and held to that one, each in its turn. A model that is no worse than the best, within twice
    the standard error of their difference block by block, is tied with it. And a picture of a ball
    of each fit is compared to that of the measurement.

    Models that no other beats in both error, by more than the noise, and picture are the Pareto
    set. Of those of it whose pictures are within 0.5 dB of the best, and of these of those that are
    tied for the least error, the one with the fewest parameters is recommended. A model that
    reflects more light at 85° than falls on it, or has a colour there that is no mixture of the
    material's own with grey, is not, unless all of the set do.

    Large measurements are judged by a part of their samples. A model that cannot be fitted does not
    stop the others; Ctrl-C ends with the models that are finished.

    Parameters
    ----------
    data : Measured, str or Path
        The measured material, or the name or path of one.
    models : str, Path, class or several, optional
        The models, as for `fit`. By default all, and the two-lobe sums that fit best most often.
    loss : str, Loss, Picture or callable, default "cbrt"
        By which error, as for `fit`. Under a `Picture` regions of the ball are held out, too; this
        takes several times as long, and leaves out the models that may be negative.
    folds : int, default 5
        How many, at least 2.
    anisotropic : bool, optional
        Whether ``alpha_v`` and its like are searched, too, as for `fit`.
    max_angle : float, default 80
        Samples with an angle to the normal at or beyond it [degrees, above 0 to 90] are left out.
    seed : int, default 0
        Seed of the folds, the part and the starts; equal seeds give equal rankings.
    progress : callable, optional
        Called with (fits done, fits in all).

    Returns
    -------
    Ranking
        The models, the best first, with the recommended one; prints as a table with sentences.

    Raises
    ------
    BrdfkitError
        For an unknown model or loss, where `data` was not measured or no sample is left, for fewer
        blocks of directions than folds, and where no model can be fitted.

    Examples
    --------
    >>> print(rank("paint.binary", ["ward", "ggx", "ggx+ggx"]))    # doctest: +SKIP
    """
    began = time.perf_counter()
    data, classes = to_measured(data), _find_classes(models)
    folds, seed = to_whole_number("folds", folds, 2), to_whole_number("seed", seed, 0)
    chosen = as_loss(loss)
    anisotropic = data.anisotropic if anisotropic is None else anisotropic
    samples, pixels, rng = select_samples(data, max_angle), None, np.random.default_rng(seed)
    if isinstance(chosen, Picture):
        pixels = draw_pixels(chosen.lights, data.rgb.eval, max_angle, seed)
    held_out = HeldOut.draw(samples, chosen, data.anisotropic, folds, rng, pixels)
    appearance = Appearance(data, samples, max_angle, seed + 1)
    light = Light.of(data.rgb.albedo, data.anisotropic)
    how = appearance, light, anisotropic, seed

    report, fits = progress or (lambda done, total: None), folds + 1
    found: dict[str, Any] = {}
    try:
        for number, (label, model) in enumerate(classes.items()):

            def step(done: int, before: int = number * fits) -> None:
                report(before + done, len(classes) * fits)

            try:
                found[label] = cross_validate(model, held_out, *how, step)
            except BrdfkitError as error:
                found[label] = error
    except KeyboardInterrupt:
        if not found:
            raise
    if all(isinstance(one, BrdfkitError) for one in found.values()):
        raise next(iter(found.values()))
    rows = rows_of(found, held_out.sum_by_block(np.ones(len(held_out.blocks))))
    return Ranking(data.name, chosen.name, rows, len(classes), time.perf_counter() - began)


def candidates() -> list[str]:
    """The labels of the models that are ranked where none is named."""
    return [*(name for name in labels.models() if name != "mixture"), *SUMS]


def _find_classes(models: Any) -> dict[str, type[Model]]:
    """The classes of models by their labels; one that is named twice counts once."""
    if models is None:
        models = candidates()
    several = isinstance(models, Iterable) and not isinstance(models, str)
    found = [labels.model(labels.read_files(m)) for m in (models if several else [models])]
    if not found:
        raise BrdfkitError("There is no model to rank; name at least one.")
    return {model.label(): model for model in found}
