"""What the end of a search says of the numbers: a `Refinement`."""

from dataclasses import replace

import numpy as np

from brdfkit.core.version import versions
from brdfkit.inverse.scenes.problem.scene_parameters import numbers_in
from brdfkit.inverse.scenes.problem.unseen_parameters import notes_on_weights
from brdfkit.inverse.scenes.result.refinement import Refinement
from brdfkit.inverse.scenes.result.residual_noise import Rest
from brdfkit.inverse.scenes.search.gauss_newton import free_of_bounds, step_in_bounds
from brdfkit.regression import Fit
from brdfkit.regression.certainty import Certainty, conclude


def conclude_search(views, found, seconds, interrupted=False, notes=(), second_look=None):
    """The `Refinement` of a `Search` on `Views`, after so many `seconds`; the scene is left at its
    end.

    `notes` come before those of its own, and before those those of a `SecondLook`.
    """
    here, rest = found.here, Rest.of(views, found.here)
    certainty = certify(views, found, rest)
    x = second_look.mean(views, here.x) if second_look else here.x
    views.put(x)
    values = {
        unknown.name: _value(unknown, part)
        for unknown, part in zip(views.unknowns, views.values(x), strict=True)
    }
    bounds = _on_bounds(views, x)
    left = float(np.sqrt(max(here.error, 0)))
    message = _message(found, interrupted)
    result = Refinement(
        values=values,
        loss=left,
        noise=float(np.sqrt(here.noise(views))),
        samples=2 * here.spp,
        steps=found.steps,
        cost=views.renders,
        seconds=seconds,
        message=message,
        converged=found.converged and not interrupted,
        history=tuple((int(spp), float(error)) for spp, error in found.history),
        at_bounds=bounds,
        notes=(
            *notes,
            *(second_look.notes() if second_look else ()),
            *certainty.undetermined,
            *certainty.trades,
            *notes_on_weights(views, certainty),
            *_notes_on_pictures(views),
            *_notes_on_noise(views, here),
            *_notes_on_rest(views, found, rest),
        ),
        certainty=certainty,
        fits={},
        reached=tuple(np.where(t.seen[..., None], t.pixels, np.nan) for t in views.targets),
        pictures=tuple(views.as_pictures((here.a + here.b) / 2 + views.reached)),
    )
    return replace(result, fits=_fits(views, result))


def _value(unknown, part):
    """What an unknown is in `Refinement.values`."""
    if unknown.shape:
        return np.array(part).reshape(unknown.shape)
    return tuple(map(float, part)) if len(part) > 1 else float(part[0])


def certify(views, found, rest):
    """The `Certainty` of the values, by blocks of pixels as samples; with the `Rest` that is no
    noise, and with the way that was still to go."""
    slopes = views.slopes(found.here.x)
    nothing = Certainty((), (), (), (), (), 0, len(slopes))
    tensors = any(unknown.shape for unknown in views.unknowns)
    if tensors or found.about is None or _blocks_lack(found):
        return nothing
    free = free_of_bounds(views, found) & ~views.is_on_bound(found.here.x)
    if not free.any():
        return nothing
    hessian, scores = found.about.hessian[np.ix_(free, free)], found.about.scores[free]
    unseen = found.about.unseen(views, found.here.x)[free]
    hessian[unseen] = hessian[:, unseen] = scores[unseen] = 0
    scale = 1 / np.sqrt(np.where(np.diagonal(hessian) > 0, np.diagonal(hessian), 1))
    blocks = scores.shape[1]
    at = np.concatenate(views.values(found.here.x))
    certainty = conclude(
        views.names,
        free,
        at,
        scores * scale[:, None],
        hessian * np.outer(scale, scale),
        scale * slopes[free],
        int(np.count_nonzero(views.weights)),
        max(1, blocks - len(slopes)),
    )
    matrix = certainty.matrix() * (1 if rest.is_noise else rest.area)
    if not found.converged:
        away = dict(zip(views.names, slopes * step_in_bounds(views, found, 0), strict=True))
        ahead = np.array([away[name] for name in certainty.names])
        matrix = matrix + np.outer(ahead, ahead)
    return replace(certainty, covariance=tuple(map(tuple, matrix.tolist())))


def _on_bounds(views, x):
    """The names of the unknowns of which a number is on a bound."""
    on = views.is_on_bound(x)
    return tuple(
        unknown.name
        for unknown, part in zip(views.unknowns, views.parts(on), strict=True)
        if part.any() and not unknown.shape  # of a tensor, some texels always are
    )


def _message(found, interrupted):
    if interrupted:
        return "interrupted: the best so far"
    if found.converged:
        return "no step gains more than the noise"
    if found.worse:
        return "all that was found is worse than the scene's own values, which these are"
    if found.stuck:
        return "no step, however short, is a gain: other starts or more samples may find better"
    return f"stopped after {found.steps} steps: more of them may gain"


def _notes_on_pictures(views):
    """What one should know of the pictures."""
    clipped = [target.clipped for target in views.targets]
    if max(clipped) == 0:
        return ()
    return (
        f"{100 * np.mean(clipped):.2g} % of the pixels are clipped, at the largest number of their "
        "picture; they do not count",
    )


def _notes_on_noise(views, here):
    """What one should know of the rendering's own noise."""
    if here.noise(views) < max(here.error, 0):
        return ()
    return ("rendering is noisier than what is left; with more samples, errors would be smaller",)


def _blocks_lack(found):
    """Whether the pictures have too few blocks of pixels to tell how the gradient varies."""
    return found.about.scores.shape[1] <= len(found.about.scores)


def _notes_on_rest(views, found, rest):
    """What one should know of what is left."""
    if found.about is not None and _blocks_lack(found):
        return ("the pictures have too few pixels for standard errors",)
    if rest.is_noise:
        return ()
    larger = "" if found.about is None else f"; standard errors are {rest.area**0.5:.2g} × as large"
    return (
        f"what is left is no noise (χ² per degree of freedom at least {rest.chi2:.2g}, "
        f"{rest.sure:.0f} standard errors above chance), for neighbouring pixels differ alike: "
        f"{'' if found.converged else 'the search is not at its end, or '}"
        "the material is none that the model can be, or the camera, a light or a shape is off"
        f"{larger}",
    )


def _fits(views, result):
    """A `Fit` for each model whose parameters were searched."""
    found = {}
    for owner in dict.fromkeys(unknown.owner for unknown in views.unknowns if unknown.model):
        own = [unknown for unknown in views.unknowns if unknown.owner == owner]
        model = own[0].model
        known = numbers_in(views.parameters, owner, model)
        if known is None:
            continue
        names = {unknown.name: unknown.parameter for unknown in own}
        values = known | {names[name]: result.values[name] for name in names}
        found[owner] = Fit(
            model=model(**values),
            data="pictures of the scene",
            loss_name="rendered",
            loss=result.loss,
            samples=int(views.seen.sum()),
            evaluations=result.steps,
            seconds=result.seconds,
            message=result.message,
            at_bounds=tuple(names[name] for name in result.at_bounds if name in names),
            notes=tuple(note.replace(f"{owner}.", "") for note in result.notes),
            certainty=_of_model(result.certainty, owner),
            versions=dict(versions()),
        )
    return found


def _of_model(certainty, owner):
    """The part of a `Certainty` that speaks of the parameters of a BSDF, by their own names."""
    rows = [row for row, name in enumerate(certainty.names) if name.startswith(f"{owner}.")]
    matrix = certainty.matrix()[np.ix_(rows, rows)]
    return replace(
        certainty,
        names=tuple(certainty.names[row].removeprefix(f"{owner}.") for row in rows),
        covariance=tuple(map(tuple, matrix.tolist())),
        freedom=tuple(certainty.freedom[row] for row in rows),
    )
