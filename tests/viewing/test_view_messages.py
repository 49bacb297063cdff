"""Any message of a page is answered, and a wrong one by a sentence: never by a defect."""

import json
import logging
from functools import cache

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import brdfkit as bk
from brdfkit.viewing.drops import DropSession
from brdfkit.viewing.volumes.application import VolumeApplication

NUMBERS = st.one_of(
    st.integers(-3, 20),
    st.floats(),
    st.sampled_from([10**400, -(10**400), 2**63, 1e308, 5e-324, 0.5, True]),
)
LEAVES = st.one_of(st.none(), NUMBERS, st.text(max_size=9), st.sampled_from(["#ff8800", "#12345"]))
ANY = st.recursive(
    LEAVES,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=3), inner),
    max_leaves=9,
)
TRIPLES = st.lists(NUMBERS, min_size=3, max_size=3)
COLOURS = st.sampled_from(["#ff8800", "#FFFFFF", "#-1-1-1", "#ff", 3])
SHARES = st.sampled_from([0, 0.25, 0.5, 1.0, True, "0.5", 10**400, float("nan"), -1e308, 1e308])
POINTS = st.lists(st.tuples(SHARES, COLOURS, SHARES).map(list), min_size=1, max_size=3)
BUMP = st.fixed_dictionaries(dict.fromkeys("xya", SHARES) | {"colour": COLOURS})
BUMPS = st.lists(BUMP.map(lambda bump: bump | {"sx": bump["x"], "sy": bump["y"]}), max_size=2)
# For each documented type, its fields, and what else than anything they may be
FIELDS = {
    "hello": {"width": NUMBERS, "height": NUMBERS, "state": "changes"},
    "set": {"changes": "changes", "moving": st.booleans()},
    "resize": {"width": NUMBERS, "height": NUMBERS},
    "undo": {},
    "redo": {},
    "reset": {},
    "cancel": {},
    "pause": {"paused": st.booleans()},
    "visible": {"visible": st.booleans()},
    "shown": {"number": NUMBERS},
    "probe": {"x": NUMBERS, "y": NUMBERS},
    "probe_slice": {"plane": NUMBERS, "x": NUMBERS, "y": NUMBERS},
    "upload": {
        "name": st.sampled_from(["a.raw", "a.nii", "a.hdr", "a.json", "a.mhd", "../a", "a.exr"]),
        "size": st.integers(0, 9),
        "offset": st.integers(0, 9),
        "count": st.integers(1, 2),
        "index": st.integers(0, 2),
    },
    "load": {"name": st.sampled_from(["/etc/passwd", "a", "ggx "])},
    "raw": {
        "size": TRIPLES,
        "dtype": st.sampled_from(["uint8", "float32"]),
        "spacing": TRIPLES,
        "offset": NUMBERS,
    },
    "save": {"kind": st.sampled_from(["png", "exr", "state", "transfer", "film"])},
    "paint": {"stroke": st.lists(st.lists(SHARES, min_size=2, max_size=2)), "hide": st.booleans()},
    "copy": {"kind": st.sampled_from(["python", "command"])},
}


@cache
def application():
    """The view whose messages are drawn."""
    return VolumeApplication(bk.volumes.load("smoke", size=8), "smoke")


def draw_changes():
    """Changes of one or two settings, of which some are possible."""
    modes = st.sampled_from(["points", "bumps", "bumps2d", "preset"])
    special = {"transfer.points": POINTS, "transfer.bumps": BUMPS | st.just({})}
    special |= {"clip": st.lists(TRIPLES, max_size=3), "slices": TRIPLES, "camera.target": TRIPLES}
    special |= {"transfer.mode": modes, "transfer.extinction": NUMBERS}
    values = {
        name: special.get(name, NUMBERS) | st.just(value) | ANY
        for name, value in application().first_state().items()
    }
    one = st.one_of(*(st.tuples(st.just(name), value) for name, value in values.items()))
    return st.lists(one, min_size=1, max_size=2).map(dict)


def draw_messages():
    """Messages of each documented type, and any others."""
    changes = draw_changes()
    known = [
        st.fixed_dictionaries(
            {"type": st.just(kind)},
            optional={k: (changes if v == "changes" else v) | ANY for k, v in fields.items()},
        )
        for kind, fields in FIELDS.items()
    ]
    often = st.fixed_dictionaries({"type": st.just("set"), "changes": changes})
    other = st.dictionaries(st.text(max_size=6) | st.just("type"), ANY)
    return st.lists(st.tuples(often | st.one_of(*known, other), st.binary(max_size=9)), max_size=9)


@pytest.fixture
def defects():
    """What is logged, which only defects are."""
    records = []
    handler = logging.Handler()
    handler.emit = records.append
    logger = logging.getLogger("brdfkit")
    logger.addHandler(handler)
    yield records
    logger.removeHandler(handler)


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(messages=st.deferred(draw_messages))
def test_a_message_is_answered_by_no_defect(defects, messages):
    view = VolumeApplication(application().volume, "smoke")
    session = DropSession(view)
    for message, data in messages:
        for answer, _ in session.handle(message, data):
            json.dumps(answer, allow_nan=False)
        assert [str(record.exc_info[1]) for record in defects] == [], message
        json.dumps(session.state, allow_nan=False)
        view = session.application
        json.dumps(view.overlay(session.state, session.size), allow_nan=False)
        view.states.look(session.state)
        for side in range(view.sides(session.state)):
            shown = view.states.of_side(session.state, side)
            view.states.scene_kind(shown, session.size, moving=False)
    session.close()
