"""Defines `Fit`, the result of a fit: a model with its fitted values, and how they were found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brdfkit.core.discovery.plugin_pages import read_page
from brdfkit.core.documents import Document, Folded, Paragraph, Shown
from brdfkit.core.documents.parts import BAD, SOFT
from brdfkit.core.errors import BrdfkitError
from brdfkit.images.thumbnails import make_thumbnails
from brdfkit.model import Model
from brdfkit.model.value_table import make_value_table
from brdfkit.regression.albedo import Albedo
from brdfkit.regression.albedo_cells import describe_albedo
from brdfkit.regression.certainty import Certainty, make_confidence_intervals
from brdfkit.regression.measurement_noise import BY_ERRORS

NAN = float("nan")
# A fit prints the effective number of its samples if it is below this share of their number
FEW_EFFECTIVE = 0.49
# A fit prints the share of directions without samples if it is at least this
MANY_UNREPRESENTED = 0.01


@dataclass(frozen=True, repr=False)
class Fit(Shown):
    """A model fitted to a measured material, which evaluates and renders like its model.

    The function `fit` makes it.

    Attributes
    ----------
    model : Model
        The model with the fitted values.
    data : str
        Name of the measured material.
    loss_name : str
        Name of the loss, one of `brdfkit.losses.named`, or "rendered" by `refine`.
    loss : float
        The error E of this loss, in its units.
    samples : int
        Number of samples that were fitted.
    evaluations : int
        Number of evaluations of the loss.
    seconds : float
        Wall-clock time of the fit.
    message : str
        The reason why the search stopped.
    at_bounds : tuple of str
        Parameters that ended on a bound.
    notes : tuple of str
        Remarks on the fit, in sentences.
    settings : dict
        The other arguments of `fit`.
    certainty : Certainty, optional
        The certainty of the parameters: the ``names`` of those that the data determine (weights as
        ``"diffuse_reflectance[0]"``), their ``covariance``, the degrees of ``freedom`` of each
        variance, and sentences on parameters that are ``undetermined`` or ``trades`` between
        parameters that the data hardly distinguish; None in fits saved by earlier versions.
    albedo : Albedo, optional
        The albedos of the fit at 5°, 45°, 75° and 85°, and of its data where they determine them:
        ``theta_i`` [degrees], and ``fit`` and ``measured`` at each angle, by channel.
    effective_samples : float
        The number of samples with equal weights whose mean would be as certain, (Σ w)² / Σ w²; 0 in
        fits to pictures, and in fits saved by earlier versions.
    unrepresented : float
        The share of the loss's measure of directions below `max_angle` that no sample represents.
    checksum : str
        `Measured.checksum` of the material, which identifies it; empty in fits saved by earlier
        versions.
    versions : dict of str to str
        The versions of brdfkit, Mitsuba, Dr.Jit, NumPy and SciPy that made the fit.

    Notes
    -----
    Standard errors, intervals and covariances assume that the samples are independent and that the
    model is correct up to noise. Neighbouring cells of a table are not independent, and the error
    of the model is larger than their noise. So the standard errors of a whole table say how sharply
    the loss determines the parameters, not how close they are to true values. Intervals are linear:
    of parameters that trade off, or with a highlight of a dozen noisy samples, 85 to 90 % contain
    the true value. Fits by the loss "picture" have no standard errors, because their pixels show
    the same samples, nor have fits to completed tables, whose cells follow from the same values.
    """

    model: Model
    data: str
    loss_name: str
    loss: float
    samples: int
    evaluations: int
    seconds: float = field(compare=False)
    message: str
    at_bounds: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    settings: dict[str, Any] = field(default_factory=dict, hash=False)
    certainty: Certainty | None = None
    albedo: Albedo | None = None
    effective_samples: float = 0.0
    unrepresented: float = 0.0
    checksum: str = ""
    versions: dict[str, str] = field(default_factory=dict, compare=False)

    @property
    def name(self) -> str:
        """The name of the fit in pictures and tables, which is the name of its model."""
        return self.model.name

    @property
    def values(self) -> dict[str, float | tuple[float, ...]]:
        """The parameters' values by name; a weight is a tuple with one number per channel."""
        return self.model.values

    @property
    def wavelengths(self) -> tuple[float, ...]:
        """The wavelengths [nm] of the weights of a spectral fit; empty for one in linear sRGB."""
        return self.model.wavelengths

    @property
    def rgb(self) -> Model:
        """The fitted model in linear sRGB, which a spectral fit is converted to."""
        return self.model.rgb

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on albedos of the fit that are above 1 or far from those of the data."""
        return tuple(self.albedo.warnings()) if self.albedo else ()

    @property
    def standard_errors(self) -> dict[str, float | tuple[float, ...]]:
        """The standard errors of `values`; NaN if fixed, on a bound or undetermined."""
        return self._arrange_like_values(
            self.certainty.compute_standard_errors() if self.certainty else {}
        )

    @property
    def intervals(self) -> dict[str, tuple[float, float] | tuple[tuple[float, float], ...]]:
        """The 95 % confidence intervals (low, high) of `values`, by Student's t."""
        half = self._arrange_like_values(
            self.certainty.compute_half_widths() if self.certainty else {}
        )
        return make_confidence_intervals(self.values, half)

    @property
    def covariance(self) -> NDArray[np.float64]:
        """The covariance (n, n) of the n parameters in ``certainty.names``."""
        return self.certainty.make_covariance_matrix() if self.certainty else np.zeros((0, 0))

    @property
    def correlation(self) -> NDArray[np.float64]:
        """The correlation (n, n) between the n parameters in ``certainty.names``."""
        return self.certainty.compute_correlation() if self.certainty else np.zeros((0, 0))

    @property
    def degrees_of_freedom(self) -> int | None:
        """The number of measured values less the number of searched parameters."""
        return self.certainty.numbers - self.certainty.parameters if self.certainty else None

    @property
    def aic(self) -> float:
        """Akaike's information criterion, N ln(E²) + 2 k, with the loss E.

        N is the number of measured values and k the number of parameters.
        Less is better among models fitted to the same data under the same loss. The criterion
        assumes independent samples, Gaussian noise of the same variance in all differences that the
        loss squares, and no robust weights. It is NaN for a fit to pictures, because several pixels
        show the same sample and so are not independent.
        """
        return (
            self._sample_certainty.compute_information_criterion(self.loss, 2.0)
            if self._sample_certainty
            else NAN
        )

    @property
    def bic(self) -> float:
        """The Bayesian information criterion, N ln(E²) + k ln N, to compare models like `aic`.

        E is the loss, N the number of measured values, k the number of parameters. Less is better.
        """
        return self._sample_certainty.compute_bic(self.loss) if self._sample_certainty else NAN

    def _arrange_like_values(self, numbers: Mapping[str, float]) -> dict[str, Any]:
        """Return `numbers` of single channels grouped by parameter, in the form of `values`.

        `numbers`: numbers by the names of `Certainty`, as "weight[0]"; a missing one becomes NaN.
        """
        grouped: dict[str, Any] = {}
        for name, value in self.values.items():
            # A parameter that takes its value from another one has the same standard error
            other = self.model.parameters[name].follows
            if isinstance(value, tuple):
                grouped[name] = tuple(numbers.get(f"{name}[{c}]", NAN) for c in range(len(value)))
            elif other and name not in numbers and value == self.values[other]:
                grouped[name] = numbers.get(other, NAN)
            else:
                grouped[name] = numbers.get(name, NAN)
        return grouped

    @property
    def _sample_certainty(self) -> Certainty | None:
        """The certainty of a fit to samples; None for pictures, which have no `aic` and `bic`."""
        return None if self.loss_name in ("picture", "rendered") else self.certainty

    @property
    def loss_label(self) -> str:
        """The name of the loss for tables, marked if standard errors weighted the samples.

        Such a loss is not comparable with the number of `compare`, which does not weight them.
        """
        weighed = any(note.startswith(BY_ERRORS) for note in self.notes)
        return f"{self.loss_name} loss{', weighed by standard errors' if weighed else ''}"

    def eval(self, wi: ArrayLike, wo: ArrayLike) -> NDArray[np.float64]:
        """Return the BRDF (n, channels) in sr⁻¹ at pairs of directions (n, 3)."""
        return self.model.eval(wi, wo)

    def residuals(self, data: Any) -> Any:
        """Return measured less fitted values, at the samples that were fitted, as a material.

        Residuals are above 0 where the fit is too dark. Plots and pictures show values below 0 as
        0; `Measured.mix_channels` with ``-np.eye(3)`` shows where the fit is too bright.

        Parameters
        ----------
        data : Measured
            The material that was fitted, with the ``checksum`` of the fit. For another material,
            the residuals show how well the fit predicts it.

        Returns
        -------
        Measured
            The residuals [sr⁻¹] of the samples, or of the cells of a table.

        Raises
        ------
        BrdfkitError
            If `data` is no measured material, or none of its samples was fitted.

        Examples
        --------
        >>> plot(fit(paint, "ward").residuals(paint))    # doctest: +SKIP
        """
        if not hasattr(data, "subtract"):
            raise BrdfkitError(
                f"The residuals of {self.name} need the measured material, not a "
                f"{type(data).__name__}; load it first."
            )
        shown = data if self.wavelengths else data.rgb
        return shown.subtract(self, self.settings.get("max_angle", 80.0))

    def scene_dict(self) -> dict[str, Any]:
        """Return the dictionary for `mitsuba.load_dict`."""
        return self.model.scene_dict()

    def document(self) -> Document:
        """Return the page that a fit prints: values, albedos, notes and effort of the search."""
        old = ("no standard errors: saved by an earlier version",) * (self.certainty is None)
        return Document(
            f"{self.name} fitted to {self.data}: {self.loss_label} {self.loss:.6g}",
            (
                *make_thumbnails(self.name, self.rgb.eval),
                make_value_table(self.model, self.standard_errors, self.at_bounds),
                *((Paragraph(describe_albedo(self.albedo)),) if self.albedo else ()),
                *(Paragraph(note, BAD if note in self.warnings else "") for note in self.notes),
                *(Paragraph(note) for note in old),
                Paragraph(f"{self.message}; {self._describe_effort()}", kind=SOFT),
                Folded(f"the page of {self.model.type_name()}", str(read_page(type(self.model)))),
            ),
        )

    def _describe_effort(self) -> str:
        """Return a line of text with the numbers of samples, evaluations and seconds."""
        sample, often = "s" * (self.samples != 1), "s" * (self.evaluations != 1)
        parts = [f"{self.samples:,} sample{sample}"]
        if 0 < self.effective_samples < FEW_EFFECTIVE * self.samples:
            parts.append(f"worth {self.effective_samples:,.0f} of equal weight")
        if self.unrepresented >= MANY_UNREPRESENTED:
            parts.append(f"none for {self.unrepresented:.0%} of the directions")
        parts += [f"{self.evaluations} evaluation{often}", f"{self.seconds:.2f} s"]
        return ", ".join(parts)
