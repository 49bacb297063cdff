"""`Fit`, what a fit returns: the model with its values, and how they were found."""

from __future__ import annotations

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
from brdfkit.regression.albedo_cells import albedo_line
from brdfkit.regression.certainty import Certainty, intervals
from brdfkit.regression.light import Albedo
from brdfkit.regression.measurement_noise import BY_ERRORS

NAN = float("nan")
# The share of effective samples below which a fit tells them, less than cells of a table have by
# the default loss; and that of directions without any sample, from which
FEW, MUCH = 0.49, 0.01


@dataclass(frozen=True, repr=False)
class Fit(Shown):
    """A model fitted to a measured material. Evaluates and renders like its model. Made by `fit`.

    Attributes
    ----------
    model : Model
        The model with the values that were found.
    data : str
        Name of the measured material.
    loss_name : str
        Name of the loss, one of `brdfkit.losses.named`, or "rendered" by `refine`.
    loss : float
        E of that loss, in its units.
    samples : int
        Number of samples that were fitted.
    evaluations : int
        How often the loss was evaluated.
    seconds : float
        Wall-clock time.
    message : str
        Why the search stopped.
    at_bounds : tuple of str
        Parameters that ended on a bound.
    notes : tuple of str
        What else one should know of the fit.
    settings : dict
        The other arguments of `fit`.
    certainty : Certainty, optional
        What the data say of the parameters: the ``names`` of those that they determine (weights as
        ``"diffuse_reflectance[0]"``), their ``covariance``, the degrees of ``freedom`` of each
        variance, and in words what is ``undetermined`` and what ``trades``
        off; None in fits saved by earlier versions.
    albedo : Albedo, optional
        The light that the fit reflects at 5°, 45°, 75° and 85°, and its data where they tell it:
        ``theta_i`` [degrees], and ``fit`` and ``measured`` at each, by channel.
    effective_samples : float
        As many samples of equal weight would tell the mean as well: (Σ w)² / Σ w²; 0 in fits to
        pictures, and in those saved by earlier versions.
    unrepresented : float
        The share of the loss's measure of directions below `max_angle` that no sample stands for.
    checksum : str
        `Measured.checksum` of the material, by which it is known again; empty as `certainty`.
    versions : dict of str to str
        The versions of brdfkit, Mitsuba, Dr.Jit, NumPy and SciPy that made the fit.

    Notes
    -----
    Standard errors, intervals and covariances suppose that the samples are independent and that the
    model is right up to noise. Neighbouring cells of a table are not independent, and there the
    misfit of the model is larger than the noise: of a whole table, standard errors say how sharply
    the loss determines the parameters, not how near they are to a truth. Intervals are linear: of
    parameters that trade off, or a highlight of a dozen noisy samples, 85 to 90 % hold the truth.
    Fits by the loss "picture" have no standard errors: their pixels show the same samples.
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
        """What pictures and tables call it."""
        return self.model.name

    @property
    def values(self) -> dict[str, float | tuple[float, ...]]:
        """The parameters' values by name; a weight is a tuple with one number per channel."""
        return self.model.values

    @property
    def wavelengths(self) -> tuple[float, ...]:
        """The wavelengths [nm] of the weights of a spectral fit; none of one in linear sRGB."""
        return self.model.wavelengths

    @property
    def rgb(self) -> Model:
        """The model in linear sRGB: `Model.rgb`."""
        return self.model.rgb

    @property
    def warnings(self) -> tuple[str, ...]:
        """Those of the `notes` that say what is wrong with the light of the fit."""
        return tuple(self.albedo.warnings()) if self.albedo else ()

    @property
    def standard_errors(self) -> dict[str, float | tuple[float, ...]]:
        """The standard errors of `values`; NaN for what is fixed, on a bound or undetermined."""
        return self._per_value(self.certainty.standard_errors() if self.certainty else {})

    @property
    def intervals(self) -> dict[str, tuple[float, float] | tuple[tuple[float, float], ...]]:
        """The 95 % confidence intervals (low, high) of `values`, by Student's t."""
        half = self._per_value(self.certainty.half_widths() if self.certainty else {})
        return intervals(self.values, half)

    @property
    def covariance(self) -> NDArray[np.float64]:
        """The covariance (n, n) of ``certainty.names``."""
        return self.certainty.matrix() if self.certainty else np.zeros((0, 0))

    @property
    def correlation(self) -> NDArray[np.float64]:
        """The correlation (n, n) of ``certainty.names``."""
        return self.certainty.correlation() if self.certainty else np.zeros((0, 0))

    @property
    def degrees_of_freedom(self) -> int | None:
        """The measured numbers less the searched parameters; below 0 where these are more."""
        return self.certainty.numbers - self.certainty.parameters if self.certainty else None

    @property
    def aic(self) -> float:
        """Akaike's criterion, N ln(E²) + 2 k, of N numbers and k parameters: of models fitted to
        the same data under the same loss, less is better. It supposes independent samples and noise
        that is Gaussian and equal in the loss's differences, no robust weight, and no table; NaN of
        a fit of pictures, whose pixels show the same samples."""
        return self._samplewise.criterion(self.loss, 2.0) if self._samplewise else NAN

    @property
    def bic(self) -> float:
        """The Bayesian criterion, N ln(E²) + k ln N; see `aic`."""
        return self._samplewise.bic(self.loss) if self._samplewise else NAN

    def _per_value(self, known):
        """Numbers by the names of `Certainty` in the form of `values`, NaN where there is none."""
        found: dict[str, Any] = {}
        for name, value in self.values.items():
            # What follows another parameter is as certain, unless it was given a value of its own
            other = self.model.parameters[name].follows
            if isinstance(value, tuple):
                found[name] = tuple(known.get(f"{name}[{c}]", NAN) for c in range(len(value)))
            elif other and name not in known and value == self.values[other]:
                found[name] = known.get(other, NAN)
            else:
                found[name] = known.get(name, NAN)
        return found

    @property
    def _samplewise(self) -> Certainty | None:
        """The certainty of a fit whose criteria mean something: by samples, not by pictures."""
        return None if self.loss_name in ("picture", "rendered") else self.certainty

    @property
    def loss_label(self) -> str:
        """The loss in words: its name, and whether standard errors weigh the samples in it.

        The error of `compare` by the same name weighs no samples, and is another number.
        """
        weighed = any(note.startswith(BY_ERRORS) for note in self.notes)
        return f"{self.loss_name} loss{', weighed by standard errors' if weighed else ''}"

    def eval(self, wi: ArrayLike, wo: ArrayLike) -> NDArray[np.float64]:
        """BRDF (n, channels) in sr⁻¹ of direction pairs (n, 3)."""
        return self.model.eval(wi, wo)

    def residuals(self, data: Any) -> Any:
        """What the fit leaves of a measurement: measured less modelled values, where it was fitted.

        They are signed, above 0 where the fit is too dark. Plots and pictures show values below 0
        as 0; `Measured.mix_channels` with ``-np.eye(3)`` shows where the fit is too bright.

        Parameters
        ----------
        data : Measured
            The material that was fitted: its ``checksum`` is the fit's. Of another one the
            residuals tell how the fit predicts it.

        Returns
        -------
        Measured
            The residuals [sr⁻¹] of the samples, or of the cells of a table.

        Raises
        ------
        BrdfkitError
            Where `data` was not measured, or none of its samples was fitted.

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
        """The dictionary for `mitsuba.load_dict`."""
        return self.model.scene_dict()

    def document(self) -> Document:
        """What the fit tells of itself: its values, its light, notes, and how they were found."""
        old = ("no standard errors: saved by an earlier version",) * (self.certainty is None)
        return Document(
            f"{self.name} fitted to {self.data}: {self.loss_label} {self.loss:.6g}",
            (
                *make_thumbnails(self.name, self.rgb.eval),
                make_value_table(self.model, self.standard_errors, self.at_bounds),
                *((Paragraph(albedo_line(self.albedo)),) if self.albedo else ()),
                *(Paragraph(note, BAD if note in self.warnings else "") for note in self.notes),
                *(Paragraph(note) for note in old),
                Paragraph(f"{self.message}; {self._effort()}", kind=SOFT),
                Folded(f"the page of {self.model.type_name()}", str(read_page(type(self.model)))),
            ),
        )

    def _effort(self):
        """How many samples, evaluations and seconds made the fit; what the samples leave out."""
        sample, often = "s" * (self.samples != 1), "s" * (self.evaluations != 1)
        parts = [f"{self.samples:,} sample{sample}"]
        if 0 < self.effective_samples < FEW * self.samples:
            parts.append(f"worth {self.effective_samples:,.0f} of equal weight")
        if self.unrepresented >= MUCH:
            parts.append(f"none for {self.unrepresented:.0%} of the directions")
        parts += [f"{self.evaluations} evaluation{often}", f"{self.seconds:.2f} s"]
        return ", ".join(parts)
