"""Makes the `Refinement` from the end of a search: values, standard errors and notes."""

from dataclasses import replace

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.version import find_versions
from brdfkit.inverse.scenes.problem.parameters import Unknown
from brdfkit.inverse.scenes.problem.places import add_dependent_components
from brdfkit.inverse.scenes.problem.scene_parameters import read_model_values
from brdfkit.inverse.scenes.problem.unseen_parameters import describe_zero_weights
from brdfkit.inverse.scenes.problem.views import Views
from brdfkit.inverse.scenes.result.refinement import Refinement, Value
from brdfkit.inverse.scenes.result.residual_noise import ResidualNoise
from brdfkit.inverse.scenes.search.gauss_newton import Search, find_free_numbers, solve_step
from brdfkit.inverse.scenes.search.normal_equations import Residuals
from brdfkit.regression import Fit
from brdfkit.regression.certainty import Certainty, compute_certainty_from_derivatives


def make_refinement(
    views: Views,
    state: Search,
    seconds: float,
    x: FloatArray | None = None,
    notes: tuple[str, ...] = (),
    interrupted: bool = False,
) -> Refinement:
    """Return the `Refinement` of a search, and leave the scene with its values.

    `x` holds the coordinates to return, if they are not those of the search's end. `notes` precede
    the notes that are made here.
    """
    here, noise = state.residuals, ResidualNoise.measure(views, state.residuals)
    certainty = estimate_certainty(views, state, noise)
    x = here.x if x is None else x
    views.write_to_scene(x)
    parts = list(zip(views.unknowns, views.to_values(x), strict=True))
    values = {unknown.name: _to_result_value(unknown, part) for unknown, part in parts}
    directions = {
        u.name: (u.place, part) for u, part in parts if u.place and u.place.axis is not None
    }
    result = Refinement(
        values=values,
        loss=float(np.sqrt(max(here.error, 0))),
        noise=float(np.sqrt(here.compute_noise(views))),
        samples=2 * here.spp,
        steps=state.steps,
        cost=views.cost,
        seconds=seconds,
        message=_explain_end(state, interrupted),
        converged=state.converged and not interrupted,
        history=tuple((int(spp), float(error)) for spp, error in state.history),
        at_bounds=_find_unknowns_on_bounds(views, x),
        notes=(
            *notes,
            *certainty.undetermined,
            *certainty.trades,
            *describe_zero_weights(views, certainty.names),
            *_describe_lighting(views),
            *_describe_clipping(views),
            *_describe_rendering_noise(views, here),
            *_describe_residuals(state, noise),
        ),
        certainty=add_dependent_components(certainty, directions),
        fits={},
        names=tuple(target.name for target in views.targets),
        targets=tuple(np.where(t.unmasked[..., None], t.pixels, np.nan) for t in views.targets),
        pictures=tuple(views.split_pictures((here.a + here.b) / 2 + views.target_pixels)),
    )
    return replace(result, fits=_make_fits(views, result))


def _to_result_value(unknown: Unknown, numbers: FloatArray) -> Value:
    """Return the numbers of an unknown as an array for a tensor, else as a tuple or a float.

    The place of a lamp is a tuple (3,), a position or a unit direction.
    """
    if unknown.shape:
        return np.array(numbers).reshape(unknown.shape)
    if unknown.place:
        numbers = unknown.place.to_vector(numbers)
    return tuple(map(float, numbers)) if len(numbers) > 1 else float(numbers[0])


def estimate_certainty(views: Views, state: Search, noise: ResidualNoise) -> Certainty:
    """Return the covariance of the values, with blocks of pixels as independent samples.

    It is enlarged in two cases: by the correlations in `noise` if the residuals are more than
    noise, and by the next step if the search has not converged. Tensors have no standard errors.
    """
    here, equations = state.residuals, state.equations
    slopes = views.differentiate_values(here.x)
    nothing = Certainty((), (), (), (), (), 0, len(slopes))
    tensors = any(unknown.shape for unknown in views.unknowns)
    if tensors or equations is None or _has_too_few_blocks(state):
        return nothing
    free = find_free_numbers(views, here, equations) & ~views.is_on_bound(here.x)
    if not free.any():
        return nothing
    hessian, scores = equations.hessian[np.ix_(free, free)], equations.scores[free]
    unseen = equations.find_unseen_numbers(views, here.x)[free]
    hessian[unseen] = hessian[:, unseen] = scores[unseen] = 0
    scale = 1 / np.sqrt(np.where(np.diagonal(hessian) > 0, np.diagonal(hessian), 1))
    blocks = scores.shape[1]
    certainty = compute_certainty_from_derivatives(
        views.names,
        free,
        np.concatenate(views.to_values(here.x)),
        scores * scale[:, None],
        hessian * np.outer(scale, scale),
        scale * slopes[free],
        int(np.count_nonzero(views.weights)),
        max(1, blocks - len(slopes)),
    )
    covariance = certainty.make_covariance_matrix() * (1 if noise.is_noise else noise.area)
    if not state.converged:
        step = slopes * solve_step(views, here, equations, damping=0)
        by_name = dict(zip(views.names, step, strict=True))
        ahead = np.array([by_name[name] for name in certainty.names])
        covariance = covariance + np.outer(ahead, ahead)
    return replace(certainty, covariance=tuple(map(tuple, covariance.tolist())))


def _find_unknowns_on_bounds(views: Views, x: FloatArray) -> tuple[str, ...]:
    """Return the names of the unknowns with a number on a bound, except for tensors."""
    on_bound = views.split_by_unknown(views.is_on_bound(x))
    return tuple(
        unknown.name
        for unknown, part in zip(views.unknowns, on_bound, strict=True)
        if part.any() and not unknown.shape  # a tensor nearly always has texels on a bound
    )


def _has_too_few_blocks(state: Search) -> bool:
    """Return whether there are too few blocks of pixels to estimate standard errors."""
    equations = state.equations
    return equations is not None and equations.scores.shape[1] <= len(equations.scores)


def _explain_end(state: Search, interrupted: bool) -> str:
    """Return the reason why the search ended, as text."""
    if interrupted:
        return "interrupted: the best so far"
    if state.converged:
        return "no step gains more than the noise"
    if state.worse:
        return "the search ended worse than the scene's own values, which these are"
    if state.stuck:
        return "no step, however short, is a gain: other starts or more samples may find better"
    return f"stopped after {state.steps} steps: more of them may gain"


def _describe_lighting(views: Views) -> tuple[str, ...]:
    """Return a sentence on lamps that burn in no picture, if there are any."""
    unused = views.lighting.unused if views.lighting else ()
    several = "" if len(unused) > 1 else "s"
    return (f"{', '.join(unused)} burn{several} in no picture",) if unused else ()


def _describe_clipping(views: Views) -> tuple[str, ...]:
    """Return sentences on black pictures and clipped pixels of the given ones, if there are any."""
    black = [target.name for target in views.targets if target.is_black]
    full = [t.name for t in views.targets if not t.count and not t.is_black]
    clipped = np.mean([target.clipped for target in views.targets])
    notes = []
    for names, state in ((black, "black"), (full, "clipped")):
        if names:
            one, end = ("picture", "does") if len(names) == 1 else ("pictures", "do")
            notes.append(f"{one} {', '.join(names)}: {state} throughout, so {end} not count")
    if clipped:
        notes.append(
            f"{100 * clipped:.2g} % of the pixels are clipped, at the largest number of their "
            "picture; they and their neighbours do not count"
        )
    return tuple(notes)


def _describe_rendering_noise(views: Views, here: Residuals) -> tuple[str, ...]:
    """Return a sentence if the noise of rendering is larger than the residuals."""
    if here.compute_noise(views) < max(here.error, 0):
        return ()
    return ("rendering is noisier than the residuals; more samples would make errors smaller",)


def _describe_residuals(state: Search, noise: ResidualNoise) -> tuple[str, ...]:
    """Return a sentence if there are too few pixels, or the residuals are more than noise."""
    if _has_too_few_blocks(state):
        return ("the pictures have too few pixels for standard errors",)
    if noise.is_noise:
        return ()
    early = "" if state.converged else "the search is not at its end, or "
    grown = f"; standard errors are multiplied by {noise.area**0.5:.2g}"
    return (
        "the residuals are not noise, as those of neighbouring pixels agree (χ² per degree of "
        f"freedom at least {noise.chi2:.2g}, {noise.significance:.0f} standard errors above "
        f"chance): {early}the model cannot describe the material, or the camera, a light or a "
        f"shape is off{'' if state.equations is None else grown}",
    )


def _make_fits(views: Views, result: Refinement) -> dict[str, Fit]:
    """Return a `Fit` for each model whose parameters were searched, by the name of its BSDF."""
    fits = {}
    for owner in dict.fromkeys(unknown.owner for unknown in views.unknowns if unknown.model):
        own = [unknown for unknown in views.unknowns if unknown.owner == owner]
        model = own[0].model
        assert model is not None
        values = read_model_values(views.parameters, owner, model)
        if values is None:
            continue
        names = {unknown.name: unknown.parameter for unknown in own}
        values |= {names[name]: result.values[name] for name in names}
        fits[owner] = Fit(
            model=model(**values),
            data="pictures of the scene",
            loss_name="rendered",
            loss=result.loss,
            samples=int(views.counted.sum()),
            evaluations=result.steps,
            seconds=result.seconds,
            message=result.message,
            at_bounds=tuple(names[name] for name in result.at_bounds if name in names),
            notes=tuple(note.replace(f"{owner}.", "") for note in result.notes),
            certainty=_select_certainty_of_bsdf(result.certainty, owner),
            versions=dict(find_versions()),
        )
    return fits


def _select_certainty_of_bsdf(certainty: Certainty, owner: str) -> Certainty:
    """Return the part of a `Certainty` about the BSDF `owner`, with short parameter names."""
    rows = [row for row, name in enumerate(certainty.names) if name.startswith(f"{owner}.")]
    covariance = certainty.make_covariance_matrix()[np.ix_(rows, rows)]
    return replace(
        certainty,
        names=tuple(certainty.names[row].removeprefix(f"{owner}.") for row in rows),
        covariance=tuple(map(tuple, covariance.tolist())),
        freedom=tuple(certainty.freedom[row] for row in rows),
    )
