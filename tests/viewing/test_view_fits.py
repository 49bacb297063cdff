"""Fits with the settings of a page, several at once, and what a page takes away of them."""

import shlex
import threading
from dataclasses import replace
from functools import cache

import pytest

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.model import labels
from brdfkit.viewing.materials import fit_task, presets, saving
from brdfkit.viewing.materials.application import MaterialApplication
from brdfkit.viewing.materials.fit_marks import describe_fit
from brdfkit.viewing.materials.mitsuba_xml import write_xml
from brdfkit.viewing.materials.parameter_state import to_state
from brdfkit.viewing.session import Session

SIZE = {"width": 64, "height": 64}
MODELS = "burley", "ward", "lambert"


@pytest.fixture(scope="module")
def application(module_in_llvm):
    """The view that all tests share, which renders nothing."""
    return MaterialApplication("satin_plastic", MODELS)


@pytest.fixture
def session(application):
    application.states.fits.clear()
    own = Session(application)
    own.handle({"type": "hello", "state": None} | SIZE)
    own.visible = False
    return own


@pytest.fixture
def quick_fits(monkeypatch):
    """Each model is fitted only once."""
    monkeypatch.setattr(fit_task, "fit", lambda material, model, **_: fit_once(model.label()))


@cache
def fit_once(label):
    """The fit of a model."""
    return bk.fit("satin_plastic", label)


def change(session, **changes):
    """Change settings, "__" for a dot in their names; return the messages."""
    named = {name.replace("__", "."): value for name, value in changes.items()}
    answers = session.handle({"type": "set", "changes": named, "moving": False})
    return [message for message, _ in answers]


def ask(session, **message):
    """Send a message, wait for its tasks, and return all answers."""
    answers = session.handle(message)
    while session.tasks:
        answers += session.work()
    return answers


def copy(session, kind):
    """The text of a copy."""
    ((message, _),) = session.handle({"type": "copy", "kind": kind})
    return message["text"]


def test_a_fit_has_the_settings_of_the_page(session, monkeypatch):
    given = {}

    def note(material, model, progress, **how):
        given[model.label()] = how
        return bk.fit(material, model, **how)

    monkeypatch.setattr(fit_task, "fit", note)
    change(session, model="ward", fit__loss="log", fit__max_angle=60, fit__anisotropic="no")
    change(session, model__alpha_u=0.07, fit__fixed=["alpha_u", "alpha_v"])
    ask(session, type="fit")
    settings = {"max_angle": 60, "anisotropic": False}  # alpha_v is tied to alpha_u
    assert given["ward"] == settings | {"loss": "log", "fixed": {"alpha_u": 0.07}}
    assert session.state["model.alpha_u"] == 0.07
    fitted = "brdfkit.fit(material, 'ward', loss='log', max_angle=60.0, fixed={'alpha_u': 0.07})"
    assert f"model = {fitted}" in copy(session, "python")
    change(session, model="burley")
    assert (session.state["fit.fixed"], session.state["fit.max_angle"]) == ([], 60)


def test_bounds_and_outliers_reach_the_command_and_are_checked(session):
    change(session, fit__bounds="  roughness=0.2,0.4", fit__robust="bisquare")
    name, *words = shlex.split(copy(session, "fit"))[1:]
    given = main.get_command(None, name).make_context(name, words).params
    expected = {"files": ("satin_plastic",), "names": ("burley",), "robust": "bisquare"}
    expected |= {"bound": ("roughness=0.2,0.4",), "fixed": (), "max_angle": 80, "loss": "cbrt"}
    assert given == given | expected
    for wrong in ("roughness=a", "rough=0,1", "roughness"):
        (error, _) = change(session, fit__bounds=wrong)
        assert error["type"] == "error"
    (error, _) = change(session, fit__fixed=["diffuse_reflectance"])
    assert "no parameter that a fit searches" in error["text"]


def test_a_cancelled_fit_refuses_none_and_ends_before_the_next(session, monkeypatch):
    end, running = threading.Event(), []

    def fit_slowly(material, model, progress, **_):
        running.append(model.label())
        assert len(running) == 1
        end.wait(10)
        running.pop()
        progress(1, 2)
        return fit_once(model.label())

    monkeypatch.setattr(fit_task, "fit", fit_slowly)
    session.handle({"type": "fit"})  # which is cancelled before it begins
    for _ in range(3):
        session.handle({"type": "cancel"})
        answers = session.handle({"type": "fit"})
        assert [message["type"] for message, _ in answers] == ["state", "busy"]
        session.work()
    ((message, _),) = session.work()
    assert message["text"] == fit_task.WAITS
    end.set()
    texts = [message.get("text") for message, _ in ask(session, type="resize", **SIZE)]
    assert texts[-1] == ""
    assert list(session.application.states.fits) == ["burley"]


def test_a_fit_is_shown_before_its_errors_are_computed(session, quick_fits):
    session.application.states.errors.kept.clear()
    messages = [message for message, _ in ask(session, type="fit")]
    types = [message["type"] for message in messages]
    computing = [m.get("text") for m in messages].index("Computing errors …")
    assert types.index("fit") < computing < types.index("errors")
    assert messages[computing - 1] == fit_task.END[0]
    assert "can_cancel" not in messages[computing]


def test_fit_all_pins_every_model(session, quick_fits):
    answers = ask(session, type="fit", all=True)
    texts = [message["text"] for message, _ in answers if message["type"] == "busy"]
    assert texts[0] == "Fitting burley … (1 of 3)"
    assert [pin["model"] for pin in session.state["pins"]] == [*MODELS]
    (table,) = [message for message, _ in answers if message["type"] == "errors"]
    assert "is best by cbrt" in table["verdict"]
    assert session.state["model.roughness"] == session.state["pins"][0]["values"]["model.roughness"]
    session.handle({"type": "undo"})
    assert session.state == session.first
    alone = MaterialApplication("satin_plastic", ["ggx"])
    assert fit_task.choose_labels(alone.states) == ["ggx", "ward", "ggx+ggx"]


def test_fit_all_keeps_the_fits_with_the_same_settings(session, monkeypatch):
    asked = []

    def note(material, model, progress, **how):
        asked.append(model.label())
        return bk.fit(material, model, **how)

    monkeypatch.setattr(fit_task, "fit", note)
    change(session, model="lambert")
    for loss, repeated in ("cbrt", 1), ("log", 0):
        change(session, fit__loss=loss)
        for _ in range(1 + repeated):
            ask(session, type="fit", all=True)
    assert sorted(asked) == sorted([*MODELS, *MODELS])


def test_fit_all_begins_with_the_models_that_were_given():
    states = MaterialApplication("satin_plastic", ["burley", "ward"]).states
    for label in labels.models():
        if label != "mixture":
            states.find_model(label)
    assert fit_task.choose_labels(states)[:2] == ["burley", "ward"]
    assert len(fit_task.choose_labels(states)) == 8


def test_another_page_of_the_same_data_has_the_fits(session, quick_fits):
    change(session, model="ward")
    ask(session, type="fit")
    application = session.application.again()
    other = Session(application)
    answers = other.handle({"type": "hello", "state": session.state} | SIZE)
    described = next(message for message, _ in answers if message["type"] == "fit")
    assert described["text"].startswith("cbrt loss")
    other.visible = False
    (table,) = [m for m, _ in ask(other, type="errors") if m["type"] == "errors"]
    assert table["rows"][0]["name"] == "ward"
    assert application.first == session.application.first
    another = MaterialApplication("plaster")
    another.states.share_fits(application.states)
    assert another.states.fits == {}


def test_the_notes_of_a_fit_are_in_words_of_the_page():
    made = fit_once("burley")
    notes = (
        "it reflects 1.2 of the light at 80°, more than arrives; a constraint prevents it: "
        "AlbedoAtMost(1), or --albedo-at-most 1",
        "f0 and specular_reflectance trade off",
        "the lobe towards phi_o is wrong, which mirror_azimuth=True (--mirror-azimuth) mends",
    )
    assert describe_fit(replace(made, notes=notes))["notes"] == [
        "it reflects 1.2 of the light at 80°, more than arrives",
        "f0 and specular_reflectance trade off",
        "the lobe towards φo is wrong",
    ]
    assert describe_fit(made)["notes"] == list(made.notes)


def test_files_that_take_long_are_made_aside(session, monkeypatch):
    monkeypatch.setattr(saving, "save", lambda thing, path: path.write_text(thing.name))
    assert session.handle({"type": "save", "kind": "bsdf"}) == []
    *_, (message, (content,)) = ask(session, type="save", kind="bsdf")
    assert (message["name"], content) == ("satin_plastic-burley.bsdf", b"burley")


def test_a_model_alone_offers_no_files_of_fits(module_in_llvm):
    offered = {own["kind"] for own in MaterialApplication("ggx").describe()[0]["saves"]}
    assert offered == saving.KINDS.keys() - {"fit", "errors", "report"}


def test_a_report_has_the_pinned_fits(session, quick_fits, monkeypatch):
    ((message, _), *_) = ask(session, type="save", kind="report")
    assert "choose Fit first" in message["text"]
    ask(session, type="fit", all=True)
    change(session, model="ward", model__alpha_u=0.5)
    session.handle({"type": "pin"})  # which is no fit

    def write(material, fits, path, **_):
        path.write_text(" ".join(fit.name for fit in fits))

    monkeypatch.setattr(saving, "report", write)
    answers = ask(session, type="save", kind="report")
    (content,) = answers[-1][1]
    assert (answers[-1][0]["name"], content) == (
        *("satin_plastic-report.html", b"burley ward lambert"),
    )


def test_a_preset_is_a_fit_to_another_material(session, monkeypatch):
    made = bk.fit("plaster", "burley")
    monkeypatch.setattr(presets, "fit", lambda name, model, **_: {"plaster": made}[name])
    ask(session, type="preset", name="plaster")
    assert session.state == session.state | to_state(made.rgb)
    ask(session, type="preset", name="")
    assert session.state == session.first
    ((message, _), _) = session.handle({"type": "preset", "name": "/etc/passwd"})
    assert "no preset" in message["text"]


def test_a_model_is_described_by_its_page(session):
    change(session, model="ward+ggx:fresnel=coloured")
    ((message, _),) = session.handle({"type": "about"})
    ward, ggx = message["models"]
    assert ward["formula"][0] == "f = k_d / π + k_s exp[-tan²θ_h (cos²φ_h / α_u² + sin²φ_h / α_v²)]"
    assert (ward["texts"][0][:17], len(ward["texts"])) == ("N, L and V are th", 1)
    assert ["α_u", "alpha_u", "0.001 to 1", "Width of the slopes along x."] in ggx["parameters"]
    assert ggx["references"][1]["link"].startswith("https://jcgt.org")
    named = dict(session.application.states.list_controls(bk.models()["ggx"]())["model"].choices)
    assert named["ward+ggx:fresnel=coloured"] == "The sum of ward and ggx:fresnel=coloured."


@pytest.mark.parametrize(
    "label", ["ggx:fresnel=coloured", "ggx+ward", "lafortune:lobe_count=2", "koenderink"]
)
def test_mitsuba_loads_the_copied_model(module_in_llvm, label):
    import mitsuba as mi

    model = labels.model(label)()
    weight = model.weights()[0]
    model = model.changed(**{weight: (1.25, 0.5, 0.125)})
    scene = f'<scene version="3.0.0"><shape type="sphere">{write_xml(model)}</shape></scene>'
    loaded = mi.load_string(scene).shapes()[0].bsdf()
    assert str(loaded) == str(mi.load_dict(model.scene_dict()))
