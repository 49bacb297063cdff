"""Every model × every public check, at the defaults and at random values; and that a check
notices what it is for."""

import drjit as dr
import numpy as np
import pytest
from random_models import random_model

import brdfkit as bk
from brdfkit.checks.material_subject import Subject
from brdfkit.checks.registry import checks
from brdfkit.checks.sampling import compute_weight_spreads
from brdfkit.core import catalogue
from brdfkit.core.discovery.plugin_files import MODELS
from brdfkit.core.geometry.vectors import half_vector
from brdfkit.model import Model, follows, labels, shape, weight
from brdfkit.model.lobes import Cosine, HalfVector, Lobe, lambertian
from brdfkit.model.microfacet import Beckmann

pytestmark = pytest.mark.usefixtures("llvm_variant")


@pytest.mark.parametrize("check", checks[MODELS])
def test_default_model(configured, check):
    report = bk.check(in_full(configured), only=[check])
    assert report, str(report)


def in_full(model):
    """`model` at its defaults, each of them given, the weights in three channels: so it runs in the
    kernels of `test_random_model`, which take longer to compile than to run."""
    defaults = model().values.items()
    return model(**{name: np.full(3, v) if name in model.weights() else v for name, v in defaults})


def test_every_model_in_a_polarised_spectral_variant(model):
    in_variant(model, "llvm_ad_spectral_polarized")


@pytest.mark.parametrize("variant", ["llvm_ad_mono", "llvm_ad_spectral"])
@pytest.mark.parametrize("name", ["ggx", "koenderink", "lafortune", "student_t"])
def test_models_in_other_variants(name, variant):
    """Some: what differs there are weights and spectra, in code that all models share."""
    in_variant(bk.models()[name], variant)


def in_variant(model, variant):
    """Check a model in colours; no spectrum holds those below 0."""
    import mitsuba as mi

    mi.set_variant(variant)
    channels = None if mi.is_spectral and model.has_signed_weights() else 3
    own = ["weights", "plugin is formula", "plugin gradient", "finite"]
    report = bk.check(random_model(model, 1, channels), only=own)
    assert report, str(report)


@pytest.mark.parametrize(
    ("name", "variant"),
    [
        ("ggx", "llvm_ad_spectral_polarized"),
        ("koenderink", "llvm_ad_mono"),
        ("oren_nayar:form=full", "llvm_ad_spectral_polarized"),
        ("brushed_aluminium", "llvm_ad_mono"),
    ],
)
def test_every_check_in_other_variants(name, variant):
    import mitsuba as mi

    mi.set_variant(variant)
    measured = name in catalogue.list_materials()
    channels = None if name == "koenderink" else 3
    thing = bk.load(name) if measured else random_model(labels.model(name), 2, channels)
    # a table is reciprocal where its file is; beyond 80° some measurements gain energy
    report = bk.check(thing, only=set(checks[MODELS]) - {"reciprocity", "energy"})
    assert report, str(report)


def test_random_model(form, configured):
    if form.endswith("fresnel=coloured"):
        pytest.skip("Schlick's formula with another colour")
    # Beyond 80° Ward-Dür gains energy by its formula, which is what `energy` would find
    report = bk.check(random_model(configured, 0), only=set(checks[MODELS]) - {"energy"})
    assert report, str(report)


def test_weights_of_samples_vary_little(configured):
    """Standard deviation of the weight ≤ 0.75 of its mean at the defaults, to grazing; ≤ 1.5 for
    12 random sets of values, of lobes as narrow as they come."""
    spreads = compute_weight_spreads(Subject(configured()), samples=100_000)
    assert max(spreads) <= 0.75, spreads
    for seed in range(12):
        subject = Subject(random_model(configured, seed, full_bounds=True))
        spreads = compute_weight_spreads(subject, samples=20_000)
        assert max(spreads) <= 1.5, (subject.material, spreads)


def test_measured_table_passes_the_checks():
    report = bk.check(bk.load("red_plastic"), only=set(checks[MODELS]) - {"reciprocity"})
    assert report, str(report)


# What each check is for, done wrong


class Right(Model):
    diffuse_reflectance = weight(0.4, "")
    specular_reflectance = weight(0.4, "")
    alpha = shape(0.3, (0.01, 1.0), "")

    def specular(self, wi, wo):
        ward = bk.models()["ward"].bind({"alpha_u": self.alpha, "alpha_v": self.alpha})
        return ward.lobes()[1].eval(wi, wo)

    def lobes(self):
        facets = HalfVector(Beckmann(self.alpha, self.alpha))
        return lambertian(), Lobe(self.specular, facets)


class WrongDensity(HalfVector):
    def pdf(self, wi, wo):
        return 1.05 * super().pdf(wi, wo)


class WithWrongDensity(Right):
    def lobes(self):
        facets = WrongDensity(Beckmann(self.alpha, self.alpha))
        return lambertian(), Lobe(self.specular, facets)


class NotReciprocal(Right):
    def specular(self, wi, wo):
        return super().specular(wi, wo) * (1 + 1e-6 * wo.z)


class TooBright(Right):
    diffuse_reflectance = weight(0.9, "")


class NegativeAtGrazing(Right):
    def lobes(self):
        return Lobe(lambda wi, wo: wo.z - 0.05, Cosine(), diffuse=True), super().lobes()[1]


class UndefinedAtTheNormal(Right):
    """Rounding takes h.z to a little above 1 at some mirror directions."""

    def specular(self, wi, wo):
        return (1 - half_vector(wi, wo).z) ** (3 * self.alpha)


class UndefinedDerivative(Right):
    p = shape(0.5, (0.5, 2.0), "")

    def specular(self, wi, wo):
        return dr.sqrt(self.p - 0.5 + dr.square(wi.z - wo.z))


class WrongDerivative(Right):
    def specular(self, wi, wo):
        return super().specular(wi, wo) * self.alpha / dr.detach(self.alpha)


@pytest.mark.parametrize(
    ("wrong", "check"),
    [
        (WithWrongDensity, "chi squared"),
        (NotReciprocal, "reciprocity"),
        (TooBright, "energy"),
        (NegativeAtGrazing, "finite"),
        (WrongDerivative, "gradient"),
        (UndefinedAtTheNormal, "defined"),
        (UndefinedDerivative, "defined"),
    ],
)
def test_check_notices(wrong, check, monkeypatch):
    assert _check(Right, check, monkeypatch)
    assert not _check(wrong, check, monkeypatch)


def test_coverage_notices_a_missing_lobe(monkeypatch):
    """χ² passes a sampler that never reaches the diffuse lobe; coverage does not."""

    class Narrow:
        """Draws half vectors of the lobe only: what lies beyond is missed."""

        def __init__(self, facets):
            self.facets = facets

        def sample(self, wi, u):
            return self.facets.sample(wi, u)

        def pdf(self, wi, wo):
            return self.facets.pdf(wi, wo)

    class Missing(Right):
        alpha = shape(0.05, (0.01, 1.0), "")

        def lobes(self):
            facets = Narrow(HalfVector(Beckmann(self.alpha, self.alpha)))
            return Lobe(lambda wi, wo: 1 / dr.pi, facets), Lobe(self.specular, facets)

    monkeypatch.setattr("brdfkit.mitsuba_bridge.bsdf.base.COSINE_SHARE", 0.0)
    assert _check(Missing, "chi squared", monkeypatch)
    assert not _check(Missing, "coverage", monkeypatch)


MINE = """import drjit as dr
import numpy as np
from brdfkit.model.lobes import Cosine, Lobe
from brdfkit.model import Model, shape, weight


class Mine(Model):
    reflectance = weight(0.3, "")
    k = shape(0.5, (0.1, 2.0), "")

    def lobes(self):
        return (Lobe(self.specular, Cosine()),)

    def specular(self, wi, wo):
        """


@pytest.mark.quick
@pytest.mark.parametrize(
    ("lines", "said"),
    [
        (
            "if wi.z > 0.5: return 0\n        return self.k",
            "line 15: write dr.select in place of `if`",
        ),
        ("return np.exp(-wi.z) * self.k", "py: write functions of dr in place of NumPy's"),
        ("return self.q", "line 15: 'Mine' object has no attribute 'q'"),
    ],
)
def test_a_model_that_raises_has_failed(lines, said, tmp_path, monkeypatch):
    """Each check for itself; the figure names the line."""
    monkeypatch.setattr("brdfkit.core.discovery.plugin_files._users", {})
    (tmp_path / "users_mine.py").write_text(MINE + lines)
    bk.load_plugins(tmp_path)
    mine = bk.models()["users_mine"]
    report = bk.check(mine(), only=["plugin is formula", "finite"])
    assert not report
    for finding in report.findings:
        assert finding.figure.startswith("users_mine.py")
        assert said in finding.figure
        assert "\n" not in finding.figure


@pytest.mark.quick
@pytest.mark.parametrize("unused", ["k", "k_v"])
def test_a_parameter_without_effect_is_named(unused, monkeypatch):
    class Unused(Right):
        k = shape(0.5, (0.1, 2.0), "")
        k_v = follows("k", k, "")

        def specular(self, wi, wo):
            return super().specular(wi, wo) * (self.k if unused == "k_v" else self.k_v)

    passed, figure = checks[MODELS]["gradient"](Subject(Unused()))
    assert (passed, figure) == (False, f"{unused} has no effect that Dr.Jit can follow")


def test_a_parameter_without_effect_has_no_gradient(monkeypatch):
    class Unused(Right):
        k = shape(0.5, (0.1, 2.0), "")

    assert _check(Unused, "plugin gradient", monkeypatch)


def _check(model, check, monkeypatch):
    """The report of a model that lies in no file."""
    import mitsuba as mi

    from brdfkit.mitsuba_bridge.bsdf import adapter

    class Bsdf(adapter.define_bsdf(mi, model)):
        def __init__(self):
            super().__init__(mi.Properties("test"))

    subject = Subject(model())
    monkeypatch.setitem(subject.__dict__, "bsdf", Bsdf())
    passed, figure = checks[MODELS][check](subject)
    assert np.isscalar(passed) or isinstance(passed, bool | np.bool_), figure
    return passed
