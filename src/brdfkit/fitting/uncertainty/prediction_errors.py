"""`prediction_error`: variance and bias of the values that a fitted linear model predicts."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import in_turn
from brdfkit.fitting.settings import select_fitted_samples
from brdfkit.materials.resolve import MaterialLike, to_material
from brdfkit.model.evaluation import compute_lobe_values
from brdfkit.model.samples.samples import Samples
from brdfkit.regression import Fit
from brdfkit.regression.losses.loss import sum_squared_differences
from brdfkit.regression.losses.named_losses import to_loss
from brdfkit.regression.refitting import Refit


@dataclass(frozen=True, eq=False)
class PredictionError:
    """Expected errors of a fitted linear model at each sample [Kurt 2007, eq. 7.8].

    Attributes
    ----------
    variance : ndarray, shape (n, channels)
        Variance that noise causes in the prediction, z (Z'Z)⁻¹ z' σ² [sr⁻²]. The row vector z has
        the values of the model's lobes at the sample, the matrix Z has these rows for all samples,
        and σ is the standard deviation of the noise.
    bias : ndarray, shape (n, channels)
        Error that repeated measurements would not reduce, z (Z'Z)⁻¹ Z'η - η(z) [sr⁻¹], because
        the model cannot represent the true BRDF η.
    """

    variance: NDArray[np.float64]
    bias: NDArray[np.float64]

    @property
    def mean_square(self) -> NDArray[np.float64]:
        """The mean squared error of the prediction, variance + bias², (n, channels) [sr⁻²]."""
        return self.variance + self.bias**2

    @property
    def largest(self) -> NDArray[np.float64]:
        """The largest squared bias δ_max, (channels,) [sr⁻²] [Kurt 2007, eq. 7.10]."""
        return (self.bias**2).max(axis=0)

    def __str__(self) -> str:
        noise, bias = (np.sqrt(np.mean(part)) for part in (self.variance, self.bias**2))
        most = np.sqrt(self.largest.max())
        return f"by noise {noise:.3g} sr⁻¹ (rms), by bias {bias:.3g} (rms), {most:.3g} at most"


@in_turn
def prediction_error(
    fit: Fit,
    material: MaterialLike,
    *,
    truth: MaterialLike | None = None,
    sigma: ArrayLike | None = None,
) -> PredictionError:
    """Compute the variance and the bias of a fit's prediction at the fitted samples.

    The formulas hold if the fit is linear in the data: for a model without searched shape
    parameters, such as ``koenderink`` and ``pca_polynomial``, a linear loss and no robust weight.
    Clamping at 0 and weights on their bounds are ignored, although they are not linear.

    Parameters
    ----------
    fit : Fit
        The fit.
    material : Measured, str or Path
        The material that was fitted, or its name or path.
    truth : Measured, Fit, Model, str or Path, optional
        The true BRDF η. By default the measured values; the bias is then minus the residuals.
    sigma : float or array_like, shape (channels,), optional
        Standard deviation of the noise [sr⁻¹], equal at all samples. By default it is estimated
        from the residuals.

    Returns
    -------
    PredictionError
        Variance and bias; prints as a line.

    Raises
    ------
    BrdfkitError
        For a fit that is not linear in the data, and where `material` was not measured or `truth`
        is no material.

    Examples
    --------
    >>> linear = fit("plaster", "koenderink", loss="plain")    # doctest: +SKIP
    >>> print(prediction_error(linear, "plaster"))    # doctest: +SKIP
    """
    samples = select_fitted_samples(fit, material)
    _require_linear_fit(fit, samples)
    # Reject fits with weights of samples, which a fit does not keep, and with a corrected albedo
    Refit(fit, samples).require_uncorrected_albedo()
    Z = compute_lobe_values(fit.model, samples.wi, samples.wo)[0]
    # `solve` is (Z'WZ)⁻¹ Z'W, with the lobes' values Z and the loss's weights W. It maps measured
    # values to weights of the lobes
    root = _compute_root_weights(to_loss(fit.loss_name), samples)
    solve = np.linalg.pinv(root[:, None] * Z) * root
    values = samples.values if truth is None else to_material(truth).eval(samples.wi, samples.wo)
    if values.shape != samples.values.shape:
        raise BrdfkitError(
            f"truth has {values.shape[1]} channels and the measurement {samples.values.shape[1]}; "
            "give a truth with the same."
        )
    bias = Z @ (solve @ values) - values
    if sigma is None:
        residuals = Z @ (solve @ samples.values) - samples.values
        sigma = np.sqrt((residuals**2).sum(axis=0) / max(len(Z) - Z.shape[1], 1))
    sigma = _check_noise_deviation(sigma, values.shape[1])
    spread = ((Z @ (solve @ solve.T)) * Z).sum(axis=1, keepdims=True)
    return PredictionError(spread * np.broadcast_to(sigma, values.shape[1:]) ** 2, bias)


def _check_noise_deviation(sigma: ArrayLike, channels: int) -> FloatArray:
    """Return the standard deviation of the noise as an array: one number, or one per channel.

    Raises `BrdfkitError` unless `sigma` is that.
    """
    try:
        numbers = np.asarray(sigma, float)
    except (TypeError, ValueError):
        numbers = np.array(np.nan)
    if numbers.shape not in ((), (channels,)) or not np.all(np.isfinite(numbers)):
        raise BrdfkitError(
            f"sigma = {sigma!r} should be a number, or one for each of {channels} channels."
        )
    return numbers


def _require_linear_fit(fit: Fit, samples: Samples) -> None:
    """Raise `BrdfkitError` unless the values that a fit predicts are linear in the data."""
    model, settings = type(fit.model), fit.settings
    known = {*model.determine_parameters(samples), *settings.get("fixed", ())}
    searched = [
        name for name in model.shapes(bool(settings.get("anisotropic"))) if name not in known
    ]
    reason = None
    if searched:
        reason = f"it was searched for {', '.join(searched)}"
    elif any(lobe.quadratic for lobe in fit.model.lobes()):
        reason = "it holds squares of weights"
    elif fit.model.fixed_lobes():
        reason = "it holds lobes without a weight"
    elif not to_loss(fit.loss_name).linear:
        reason = f"the {fit.loss_name} loss is not linear"
    elif settings.get("robust"):
        reason = f"{settings['robust']} weighs samples by their values"
    if reason:
        raise BrdfkitError(
            f"{fit.name}: its prediction is not linear in the data ({reason}); fit a linear model, "
            "such as koenderink, by a linear loss, such as plain."
        )


def _compute_root_weights(loss: Any, samples: Samples) -> FloatArray:
    """Return √W (n,) for a linear loss, whose squared differences are W (model - measured)²."""
    ones = np.ones((len(samples.wi), 1))
    black = replace(samples, values=0 * ones)
    return np.sqrt(loss.importance(samples) * sum_squared_differences(loss, ones, black))
