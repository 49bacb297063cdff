"""Pins of a session of a material: their state, their sides of the wipe, and their errors."""

import csv
import io
import json

import pytest

import brdfkit as bk
from brdfkit.viewing.materials import pins
from brdfkit.viewing.materials.application import MaterialApplication
from brdfkit.viewing.session import Session

HELLO = {"type": "hello", "width": 64, "height": 64, "state": None}


@pytest.fixture(scope="module")
def application(module_in_llvm):
    """The view that all tests share, with its scenes."""
    return MaterialApplication("car_paint", ["ggx", "ward"])


@pytest.fixture
def session(application):
    application.states.fits.clear()
    own = Session(application)
    own.handle(HELLO)
    return own


def change(session, changes):
    """Change settings; return the messages by their types."""
    answers = session.handle({"type": "set", "changes": changes, "moving": False})
    return {message["type"]: message for message, _ in answers}


def pin(session, **values):
    """Give the model values, pin it, and return the name of the pin."""
    change(session, {f"model.{name}": value for name, value in values.items()})
    session.handle({"type": "pin"})
    return pins.name_pin(session.state["pins"][-1])


def ask_errors(session):
    """The message with the table of errors; no picture is rendered meanwhile."""
    session.visible = False
    session.handle({"type": "errors"})
    messages = []
    while session.tasks:
        messages += [message for message, _ in session.work()]
    return next(message for message in messages if message["type"] == "errors")


def test_a_pin_keeps_its_values_through_undo_and_in_an_address(session):
    name = pin(session, alpha_u=0.5)
    change(session, {"model": "ward"})
    second = pin(session, alpha_u=0.3)
    assert (name, second) == ("pin1", "pin2")
    pin(session)  # the same again
    assert [own["model"] for own in session.state["pins"]] == ["ggx", "ward"]
    other = Session(session.application.again())
    other.handle(HELLO | {"state": json.loads(json.dumps(session.state))})
    assert other.state == session.state

    session.handle({"type": "show_pin", "pin": "pin1"})
    assert (session.state["model"], session.state["model.alpha_u"]) == ("ggx", 0.5)
    assert session.state["model.alpha_v.tied"]
    session.handle({"type": "undo"})
    assert session.state["model"] == "ward"
    ((message, _), _) = session.handle({"type": "show_pin", "pin": "pin7"})
    assert "there no more" in message["text"]


def test_a_pin_is_a_side_of_the_wipe_until_it_is_removed(session):
    name = pin(session, alpha_u=0.05)
    change(session, {"renderer": name, "solo": name, "model.alpha_u": 0.6})
    states = session.application.states
    shown = [states.find_side(session.state, side)[1].alpha_u for side in (name, "model")]
    assert (shown, states.name_side(session.state, name)) == ([0.05, 0.6], "1: ggx")
    answers = change(session, {"pins": []})
    choices = {c["name"]: c["choices"] for c in answers["controls"]["controls"]}
    assert [value for value, _ in choices["second"]] == ["", "measured", "model"]
    assert (session.state["renderer"], session.state["solo"]) == ("model", "")
    session.handle({"type": "undo"})
    assert (session.state["renderer"], session.state["solo"]) == (name, name)


def test_there_is_a_colour_for_each_pin_and_no_more(session):
    for k in range(len(pins.COLOURS)):
        pin(session, alpha_u=0.1 + k / 50)
    ((message, _),) = session.handle({"type": "pin"})  # these values are pinned
    assert message["type"] == "state"
    change(session, {"model.alpha_u": 0.9})
    ((message, _), _) = session.handle({"type": "pin"})
    assert "remove one first" in message["text"]
    assert len({pins.find_colour(own) for own in session.state["pins"]}) == 8


@pytest.mark.parametrize(
    ("wrong", "sentence"),
    [
        ({"number": 9}, "1 to 8"),
        ({"model": "open('a').py"}, "no model"),
        ({"values": {}}, "other parameters"),
        ({"more": 1}, "no more"),
    ],
)
def test_an_impossible_pin_is_refused(session, wrong, sentence):
    pin(session)
    before = dict(session.state)
    answers = change(session, {"pins": [before["pins"][0] | wrong]})
    assert sentence in answers["error"]["text"]
    assert session.state == before


def test_the_table_says_which_pin_is_the_best_and_by_how_much(session):
    measured, near, far = (bk.load("car_paint"), 0.115, 0.3)
    weights = {f"specular_reflectance.{c}": v for c, v in zip("RGB", (1, 0.5, 1.2), strict=True)}
    pin(session, **weights, alpha_u=far, f0=0.2)
    pin(session, alpha_u=near)
    pin(session, alpha_u=near * 1.0000001)
    content = ask_errors(session)
    rows = {row.get("pin", ""): row for row in content["rows"]}
    assert list(rows)[2:] == ["pin1", ""]  # the worst, and the noise
    assert {rows["pin2"]["note"], rows["pin3"]["note"]} == {
        *("best", "not distinguishable from the best")
    }
    model = session.application.states.find_side(session.state, "pin1")[1]
    errors = bk.compare(measured, model).errors["ggx"]
    assert rows["pin1"]["values"] == pytest.approx(
        [errors[name] for name, *_ in content["columns"]], rel=1e-9
    )
    assert "are not distinguishable by cbrt" in content["verdict"]
    change(session, {"pins": session.state["pins"][:2]})
    content = ask_errors(session)
    one, two = (row["values"][2] for row in content["rows"][:2])
    assert (
        f"ggx (2) is best by cbrt: its error {one:.3g} is {100 - 100 * one / two:.0f} %"
        in (content["verdict"])
    )

    ((message, (text,)),) = session.handle({"type": "save", "kind": "errors"})
    assert message["name"] == "car_paint-errors.csv"
    head, first, *_ = csv.reader(io.StringIO(text.decode()))
    assert (head[2:4], first[:2]) == (["cosine", "log"], ["ggx", "2"])
