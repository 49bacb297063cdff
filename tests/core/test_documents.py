"""What objects tell of themselves: the same words as text and as HTML, which notebooks show."""

import io
import re
from html.parser import HTMLParser

import numpy as np
import pytest
from made_capture import CAMERA, SIDE
from matplotlib.text import Text
from PIL import Image

import brdfkit as bk
from brdfkit.core.colours import to_srgb
from brdfkit.core.documents import Cell, Document, Folded, Paragraph, Picture, Shown, Table
from brdfkit.core.documents.html import to_html
from brdfkit.core.documents.parts import BAD
from brdfkit.core.documents.text import to_text
from brdfkit.core.figures import to_png
from brdfkit.core.geometry.directions import from_angles
from brdfkit.images.ball.ball import WHITE, draw_ball
from brdfkit.images.ball.lights import studio_radiance
from brdfkit.images.ball.normals import find_normals
from brdfkit.inverse.photographs.objects.fit_object import FittedObject
from brdfkit.inverse.photographs.result.comparison import Comparison
from brdfkit.regression.certainty import Certainty
from brdfkit.volumes.summary.summary import summarise

NASTY = "a<b> & \"c\" 'd'"
VOID = {"img", "br", "path"}


class Reader(HTMLParser):
    """Reads HTML: its text, its tags and their attributes; the tags must balance."""

    def __init__(self, html):
        super().__init__()
        self.open, self.tags, self.attributes, self.texts = [], [], [], []
        self.feed(html)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.attributes += attributes
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.tags.append(tag)
        self.attributes += attributes

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, text):
        if "style" not in self.open:
            self.texts.append(text)

    @property
    def text(self):
        return " ".join(" ".join(self.texts).split())


def refinement():
    """A `Refinement` of one number, as a search of two steps ends."""
    certainty = Certainty((NASTY,), ((0.01,),), (30.0,), (), (), 432, 1)
    said = ("no step gains more than the noise", True, ((16, 0.1), (64, 0.01)), (NASTY,), (NASTY,))
    pictures = (np.full((2, 2, 3), 0.5),)
    spent = (64, 2, 80.0, 1.5)
    rest = (certainty, {}, (NASTY,), pictures, pictures)
    return bk.Refinement({NASTY: 0.2}, 0.1, 0.05, *spent, *said, *rest)


def textures():
    """An `Svbrdf` of four texels."""
    values = {"alpha_u": np.full((2, 2), 0.2), "normal": np.tile([0.0, 0.0, 1.0], (2, 2, 1))}
    errors = {name: np.full((2, 2), 0.01) for name in values}
    pictures = np.full((1, 24, 24, 3), 0.5)
    capture = bk.photographs.Capture(
        pictures, [[0, 0, 1]], [[1, 1, 1]], CAMERA, (SIDE, SIDE), (NASTY,)
    )
    return bk.photographs.Svbrdf(
        name=NASTY,
        model="ggx",
        maps=values,
        fixed={},
        size=(SIDE, SIDE),
        smoothness=0.1,
        held_out={0.1: 0.02},
        notes=(NASTY,),
        seconds=1.5,
        capture=capture,
        uncertainty=errors,
        misfit=np.ones((2, 2)),
        residual=0.01,
        predicted={NASTY: 40.0},
    )


def an_object():
    """An `ObjectMaps` of four pixels."""
    lights = bk.photographs.Lights(np.eye(3), np.ones((3, 3)))
    names = tuple(f"{NASTY}{k}" for k in range(3))
    capture = bk.photographs.ObjectCapture(
        NASTY, np.full((3, 4, 3), 0.5, np.float32), np.full((2, 2), True), lights, names
    )
    comparison = Comparison(0.02, 0.05, 0.01, 0.04, {NASTY: (0.02, 0.05)})
    weights = np.full((2, 2, 3), 0.5)
    return bk.photographs.ObjectMaps(
        name=NASTY,
        model="lambert",
        maps={"reflectance": weights, "normal": np.tile([0.0, 0.0, 1.0], (2, 2, 1))},
        fixed={},
        mask=capture.mask,
        uncertainty={"reflectance": np.full((2, 2), 0.01)},
        lights=np.full((2, 2), 3.0),
        exposures=dict.fromkeys(names, 1.0),
        noise=0.01,
        fitted_errors=comparison,
        held_out_errors=comparison,
        lambertian_errors=comparison,
        normal_error=1.0,
        lambertian_normal_error=2.0,
        notes=(NASTY,),
        seconds=1.5,
        capture=capture,
        held_out_capture=capture,
        state=FittedObject.begin(4, 1),
    )


def samplers():
    """A `SamplerComparison` of two samplers and three rounds."""
    noise = {"envmap": np.array([1.0, 1.1, 0.9]), NASTY: np.array([0.5, 0.6, 0.5])}
    seconds = {"envmap": np.ones(3), NASTY: np.array([1.0, 1.0, 1.1])}
    return bk.rendering.SamplerComparison(NASTY, NASTY, "ball", noise, seconds, 3)


@pytest.fixture(scope="module")
def shown():
    """One object of every class that derives from `Shown`, by the class's name."""
    plaster = bk.load("plaster")
    fit = bk.fit(plaster, "ward", use_standard_error=False)
    named = bk.Measured.from_table(np.full((9, 9, 18, 3), 0.1), name=NASTY, info={NASTY: NASTY})
    rendering = bk.render([named, fit], spp=4, size=48)
    objects = [
        named,
        bk.audit(named),
        bk.environments.audit("sky"),
        fit,
        bk.models()["ggx"](alpha_u=0.1),
        bk.models(),
        bk.losses.named,
        bk.compare(named, [fit, "lambert"]),
        bk.check("lambert", only=["energy"]),
        bk.rank(plaster, ["lambert", "ward"]),
        bk.sweep("plaster", "lambert", workers=1),
        bk.plan(2),
        bk.uncertainty.bootstrap(fit, plaster, draws=2),
        bk.uncertainty.profile(fit, plaster, parameter="alpha_u", points=5),
        bk.Reproduction(NASTY, ()),
        refinement(),
        textures(),
        an_object(),
        rendering,
        rendering.errors(),
        bk.gallery([[(NASTY, named), fit]], spp=2, size=32),
        summarise(bk.volumes.load("slab", size=8)),
        samplers(),
        bk.shadows.ShadowComparison({NASTY: (bk.shadows.Scores(psnr=30.0),)}, 1, 1, ()),
    ]
    return {type(thing).__name__: thing for thing in objects}


@pytest.fixture(scope="module")
def pages(shown):
    """The HTML of each."""
    return {name: thing._repr_html_() for name, thing in shown.items()}


def subclasses(cls):
    return {cls} | {s for child in cls.__subclasses__() for s in subclasses(child)}


def test_every_class_that_shows_itself_is_tested(shown):
    known = {c for thing in shown.values() for c in type(thing).__mro__}
    public = {c for c in subclasses(Shown) if not issubclass(c, bk.Model)} - {Shown}
    assert public <= known


def test_html_stands_alone(pages):
    for name, html in pages.items():
        read = Reader(html)
        assert len(html.encode()) < 200_000, name
        assert not {"script", "iframe", "link", "object"} & set(read.tags)
        assert not [k for k, _ in read.attributes if k.startswith("on")]
        for key, value in read.attributes:
            if key in ("src", "href"):
                assert value.startswith("data:image/"), name
        assert not re.search(r"https?://(?!www\.w3\.org/2000/svg)", html), name
        assert "@import" not in html


def test_text_and_html_say_the_same(shown, pages):
    for name, thing in shown.items():
        text, html = str(thing), Reader(pages[name]).text
        assert repr(thing) == text
        if isinstance(thing, bk.Model):  # its text is the call that makes it
            continue
        for word in text.split():
            assert word in html or word == "!", (name, word)


def test_names_are_escaped(pages):
    for name in (
        "Measured",
        "Audit",
        "Comparison",
        "Reproduction",
        "Rendering",
        "ImageErrors",
        "Gallery",
    ):
        html = pages[name]
        assert "<b>" not in html
        assert NASTY in Reader(html).text
    html = to_html(
        Document(
            NASTY,
            (
                Table(((Cell(NASTY, hint=NASTY), NASTY),), (NASTY, NASTY), ((NASTY, NASTY),)),
                Paragraph(NASTY),
                Picture(lambda: b"\x89PNG", NASTY, 10),
                Folded(NASTY, NASTY),
            ),
        )
    )
    read = Reader(html)
    assert "<b>" not in html
    assert read.text.count(NASTY) == 10
    assert [v for k, v in read.attributes if k in ("alt", "title")] == [NASTY, NASTY]


def test_text_is_aligned_and_without_pictures():
    def fail():
        raise AssertionError("text draws nothing")

    table = Table((("long name", "1.5"), (Cell("b", BAD), "10")), ("what", ">much"), (("", "2"),))
    document = Document("title", (Picture(fail, "", 1), table, Paragraph("bad", BAD)))
    assert to_text(document).splitlines() == [
        "title",
        "  what       much",
        "  long name   1.5",
        "  ! b          10",
        "                2",
        "  ! bad",
    ]
    assert to_text(Document("empty", (Table(()),))) == "empty"


def test_what_cannot_be_drawn_is_said_and_the_rest_is_shown():
    def fail():
        raise RuntimeError("<lobes> of mine")

    picture = Picture(fail, "a ball of mine", 1)
    text = Reader(to_html(Document("title", (picture, Table((("value", "1"),)))))).text
    assert text == "title Not shown: a ball of mine (RuntimeError: <lobes> of mine). value 1"


def test_a_name_is_one_line_of_text():
    document = Document("title", (Table((("two\nlines", "1"),), ("na\nme", ">1")),))
    assert to_text(document).splitlines() == ["title", "  name      1", "  twolines  1"]


def test_values_on_bounds_and_errors_are_told():
    fit = bk.fit(bk.load("plaster"), "ggx")  # it has no highlight: that weight ends on its bound
    row = next(line for line in str(fit).splitlines() if "specular" in line)
    assert row.endswith("! on its bound")
    assert "±" not in row
    assert str(fit).count("±") == 3
    assert 'class="bad"' in fit._repr_html_()


def test_a_chip_has_the_colour_of_the_weight():
    ward = bk.models()["ward"](diffuse_reflectance=[0.5, 0.0, 2.0])
    expected = np.round(255 * to_srgb(np.array([0.25, 0, 1]))).astype(int)
    assert "background:rgb({},{},{})".format(*expected) in ward._repr_html_()


def test_the_mark_lies_between_the_bounds():
    ward = bk.models()["ward"]
    low, high = ward.parameters["alpha_u"].bounds
    middle = ward(alpha_u=np.sqrt(low * high))  # its order of magnitude is searched
    assert middle._repr_html_().count('style="left:50%"') == 2


def test_the_ball_is_a_picture_of_the_material(monkeypatch):
    def matt(wi, wo):
        return np.full((len(wi), 1), WHITE / np.pi)

    white, cover = draw_ball(matt, 24)
    assert cover.sum() == pytest.approx(np.pi * 12**2, rel=0.01)
    assert white[cover == 0].max() == 0
    assert np.percentile(white[cover > 0], 99) == pytest.approx(WHITE, rel=0.05)
    # the radiance is linear in the BRDF
    half, _ = draw_ball(lambda wi, wo: 0.5 * matt(wi, wo), 24)
    np.testing.assert_allclose(half, 0.5 * white)
    # with many directions, against the sum over all of the light, but for a common factor
    monkeypatch.setattr("brdfkit.images.ball.ball.DIRECTIONS", 1000)
    white, _ = draw_ball(matt, 24)
    heights, azimuths = np.meshgrid(np.linspace(-0.995, 0.995, 200), np.arange(400) * np.pi / 200)
    light = from_angles(np.arccos(heights), azimuths).reshape(-1, 3)
    at = (np.arange(24) + 0.5) / 12 - 1
    x, y = (grid[cover == 1] for grid in np.meshgrid(at, -at))
    cosines = np.maximum(find_normals(x, y) @ light.T, 0)
    ratios = white[cover == 1, 0] / (cosines @ studio_radiance(light))
    assert ratios.std() < 0.02 * ratios.mean()


# Pictures in light and in dark notebooks


def contrast(grey, other):
    """WCAG's contrast of two greys 0..255 of sRGB."""
    linear = [((c / 255 + 0.055) / 1.055) ** 2.4 + 0.05 for c in (grey, other)]
    return max(linear) / min(linear)


@pytest.mark.parametrize("kind", ["figure", "rendering"])
def test_pictures_are_legible_on_light_and_dark_grounds(kind):
    """The ground is transparent, and what is written on it stands out from white and from black."""
    if kind == "figure":
        figure = bk.plot("ggx", theta_i=[45])
        black = [text.get_color() for text in figure.findobj(Text)]
        png = to_png(figure)
        assert [text.get_color() for text in figure.findobj(Text)] == black
    else:
        pictures = {"ggx": np.full((8, 8, 3), 0.2)}
        png = bk.Rendering(pictures, 1, 0.0, 0, {}).drawn()
    pixels = np.array(Image.open(io.BytesIO(png)).convert("RGBA"))
    assert pixels[0, 0, 3] == 0
    written = pixels[:60][pixels[:60, :, 3] == 255]
    grey = np.median(written[np.ptp(written[:, :3].astype(int), axis=1) < 6])
    assert contrast(grey, 255) > 3.5
    assert contrast(grey, 17) > 3.5


def test_a_long_name_has_a_line_of_its_own():
    rows = (("long-name-" * 8, "1"), ("ggx", "22"))
    shown = to_text(Document("errors", (Table(tuple((*r, "") for r in rows), ("m", ">e", "x")),)))
    assert rows[0][0] in shown
    assert [len(line) < 50 for line in shown.splitlines()].count(False) == 1
