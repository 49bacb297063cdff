"""`rank`: models ordered by how well they predict directions that they were not fitted to."""

import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.arguments import to_whole_number
from brdfkit.errors import BrdfkitError
from brdfkit.fitting import Loss, as_loss
from brdfkit.materials import MaterialLike, measured_material
from brdfkit.measured.selection import select_samples
from brdfkit.model import Model, labels
from brdfkit.ranking.cross_validation import cross_validate
from brdfkit.ranking.held_out import HeldOut
from brdfkit.ranking.result import Ranking, order

# The sums that are ranked by default: the best of docs/leaderboard.md with few and with more
# parameters
SUMS = "ggx+ggx", "abc+ggx", "abc+student_t"


def rank(
    data: MaterialLike,
    models: str | Path | type[Model] | Iterable[str | Path | type[Model]] | None = None,
    loss: str | Loss | Callable[..., Any] = "cbrt",
    *,
    folds: int = 5,
    anisotropic: bool | None = None,
    max_angle: float = 80.0,
    seed: int = 0,
    progress: Callable[[int, int], object] | None = None,
) -> Ranking:
    """Rank models by how well each predicts a measured material where it was not fitted.

    The directions are cut into blocks and these into folds. Every model is fitted to all folds but
    one and held to that one, each in its turn. A model that is no worse than the best, within twice
    the standard error of their difference block by block, is tied with it; of tied models the one
    with the fewest parameters is recommended. Large measurements are judged by a part of their
    samples. A model that cannot be fitted does not stop the others; Ctrl-C ends with the models
    that are finished.

    Parameters
    ----------
    data : Measured, str or Path
        The measured material, or the name or path of one.
    models : str, Path, class or several, optional
        The models, as for `fit`. By default all, and the two-lobe sums that fit best most often.
    loss : str, Loss or callable, default "cbrt"
        By which error, as for `fit`.
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
    data, classes = measured_material(data), _find_classes(models)
    folds, seed = to_whole_number("folds", folds, 2), to_whole_number("seed", seed, 0)
    chosen = as_loss(loss)
    if not isinstance(chosen, Loss):
        raise BrdfkitError(
            f"The loss {chosen.name} looks at pixels, which mix directions, so that none can be "
            "held out; choose another loss."
        )
    anisotropic = data.anisotropic if anisotropic is None else anisotropic
    samples = select_samples(data, max_angle)
    held_out = HeldOut.draw(samples, chosen, data.anisotropic, folds, np.random.default_rng(seed))

    report, fits = progress or (lambda done, total: None), folds + 1
    found: dict[str, Any] = {}
    try:
        for number, (label, model) in enumerate(classes.items()):

            def step(done: int, before: int = number * fits) -> None:
                report(before + done, len(classes) * fits)

            try:
                found[label] = cross_validate(model, held_out, anisotropic, seed, step)
            except BrdfkitError as error:
                found[label] = error
    except KeyboardInterrupt:
        if not found:
            raise
    if all(isinstance(one, BrdfkitError) for one in found.values()):
        raise next(iter(found.values()))
    rows = order(found, held_out.sum_by_block(np.ones(len(held_out.blocks))))
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
