"""A stroke on the picture of a volume shows or hides what is under it, and little else."""

import drjit as dr
import numpy as np
import pytest

import brdfkit as bk
from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing.session import Session
from brdfkit.viewing.volumes import transfer_table
from brdfkit.viewing.volumes.application import VolumeApplication
from brdfkit.viewing.volumes.painting import paint
from brdfkit.viewing.volumes.rays import cast_rays
from brdfkit.viewing.volumes.state import VolumeState

VALUES = (0.4, 0.9)  # of the left and the right ball
FRONT = {"camera.azimuth": 0, "camera.elevation": 0, "transfer.extinction": 4.0}
# Both balls are seen from the front, left and right of the middle
LEFT, RIGHT = ([[x - 0.05, 0.5], [x, 0.48], [x + 0.05, 0.5]] for x in (0.3, 0.7))


def make_balls(labels=False):
    """Two balls in empty space, beside each other."""
    z, y, x = np.meshgrid(*[np.linspace(-1, 1, 24)] * 3, indexing="ij")
    values = np.zeros(x.shape, np.float32)
    for k, middle in enumerate((-0.5, 0.5)):
        inside = (x - middle) ** 2 + y**2 + z**2 < 0.4**2
        values[inside] = k + 1 if labels else VALUES[k]
    return bk.volumes.Volume(values, np.diag([1 / 12, 1 / 12, 1 / 12, 1]), "balls", labels)


@pytest.fixture(scope="module")
def balls():
    return VolumeState(make_balls())


def make_state(states, mode, opacities):
    """A state whose transfer function gives the balls these values of A."""
    state = states.first() | FRONT
    if mode.startswith("bumps"):
        bump = {"y": 0.5, "sx": 0.1, "sy": 4.0, "colour": "#e8a060"}
        bumps = [bump | {"x": x, "a": a} for x, a in zip((0.44, 1.0), opacities, strict=True)]
        return states.change(state, {"transfer.mode": mode, "transfer.bumps": bumps})
    at, a = (0, 0.2, 0.4, 0.6, 0.9), (0, 0, opacities[0], 0, opacities[1])
    points = [[value, "#ffffff", opacity] for value, opacity in zip(at, a, strict=True)]
    return states.change(state, {"transfer.mode": "points", "transfer.points": points})


def see(states, state):
    """The mean opacities under the left and the right stroke."""
    places = [np.linspace(stroke[0], stroke[-1], 30) for stroke in (LEFT, RIGHT)]
    clip = np.array(state["clip"])
    rays = [cast_rays(states.live, states.camera(state), p, 1.0, clip) for p in places]
    depths = [
        r.depths(states.functions.table(state), state["transfer.extinction"]).sum(1) for r in rays
    ]
    return np.array([-np.expm1(-depth).mean() for depth in depths])


@pytest.mark.parametrize("mode", ["points", "bumps", "bumps2d"])
@pytest.mark.parametrize("opacities", [(0.05, 0.05), (0.0, 0.3), (0.0, 0.0)])
def test_a_stroke_shows_what_is_faint_or_invisible(balls, mode, opacities):
    state = make_state(balls, mode, opacities)
    left, right = see(balls, balls.change(state, paint(balls, state, LEFT, 1.0))) - see(
        balls, state
    )
    assert left > 0.15
    assert abs(right) < left / 2


@pytest.mark.parametrize("mode", ["points", "bumps", "bumps2d"])
def test_a_stroke_hides_what_is_visible(balls, mode):
    state = make_state(balls, mode, (0.3, 0.3))
    hidden = balls.change(state, paint(balls, state, RIGHT, 1.0, hide=True))
    left, right = see(balls, hidden) - see(balls, state)
    assert right < -0.15
    assert abs(left) < -right / 2


@pytest.mark.quick
def test_strokes_on_labels_change_their_label_alone():
    states = VolumeState(make_balls(labels=True))
    first = states.first() | FRONT | {"transfer.extinction": 2.0}
    assert first["transfer.mode"] == "preset"
    hidden = states.change(first, paint(states, first, LEFT, 1.0, hide=True))
    left, right = see(states, hidden) - see(states, first)
    assert left < -0.15
    assert right == pytest.approx(0, abs=1e-6)
    assert states.functions.table(hidden)[:, :3] == pytest.approx(
        states.functions.table(first)[:, :3], abs=0.01
    )


@pytest.mark.quick
def test_strokes_again_and_again_leave_a_simple_function(balls):
    state = make_state(balls, "points", (0.02, 0.02))
    seen = [see(balls, state)]
    for _ in range(3):
        state = balls.change(state, paint(balls, state, LEFT, 1.0))
        seen.append(see(balls, state))
    assert (np.diff([left for left, _ in seen]) > 0.05).all()
    assert seen[-1][1] - seen[0][1] < (seen[-1][0] - seen[0][0]) / 2
    assert len(state["transfer.points"]) <= transfer_table.POINTS


@pytest.mark.quick
@pytest.mark.parametrize(
    ("stroke", "opacities", "changes", "hide", "reason"),
    [
        ([[0.01, 0.01]], (0.1, 0.1), {"camera.distance": 20.0}, False, "does not meet"),
        ([[0.5, 0.3], [0.5, 0.7]], (0.1, 0.1), {}, False, "do not differ"),
        ([[0.5, 0.3], [0.5, 0.7]], (0.1, 0.1), {}, True, "Nothing is visible"),
        (LEFT, (1.0, 1.0), {"density": 10.0}, False, "opaque"),
        (LEFT, (0.1, 0.1), {"renderer": "isosurface"}, False, "this renderer"),
        ([], (0.1, 0.1), {}, False, "no stroke"),
        ([[0.5, "a"]], (0.1, 0.1), {}, False, "no stroke"),
        ([[0.5, float("nan")]], (0.1, 0.1), {}, False, "no stroke"),
        ([[0.5, 10**400]], (0.1, 0.1), {}, False, "no stroke"),
        ([[0.5, 0.5]] * 2000, (0.1, 0.1), {}, False, "too long"),
    ],
)
def test_a_stroke_that_cannot_work_is_a_sentence(balls, stroke, opacities, changes, hide, reason):
    state = balls.change(make_state(balls, "points", opacities), changes)
    with pytest.raises(BrdfkitError, match=reason):
        paint(balls, state, stroke, 1.0, hide)


@pytest.mark.quick
def test_a_stroke_beyond_the_last_bump_is_a_sentence(balls):
    state = make_state(balls, "bumps", (0.02, 0.3))
    bumps = state["transfer.bumps"] * (transfer_table.LARGEST_BUMPS // 2)
    with pytest.raises(BrdfkitError, match="64 are the most"):
        paint(balls, balls.change(state, {"transfer.bumps": bumps}), LEFT, 1.0)


def test_a_stroke_is_one_undo_step_and_needs_no_kernel(mi):
    application = VolumeApplication(make_balls())
    application.first = make_state(application.states, "points", (0.02, 0.3)) | {
        "renderer": "emission_absorption"
    }
    session = Session(application)
    session.handle({"type": "hello", "width": 64, "height": 64, "state": None})
    message = {"type": "paint", "stroke": LEFT, "hide": False}
    session.work()
    session.handle({"type": "set", "changes": {"transfer.mode": "bumps"}})
    session.work()  # what computes the integrals of a table
    session.handle({"type": "undo"})
    before, kernels = session.state, []
    for _ in range(2):
        ((state, _),) = session.handle(message)
        assert state["type"] == "state"
        assert state["state"]["transfer.points"] == session.state["transfer.points"]
        dr.kernel_history_clear()
        with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
            session.work()
            kernels += [k for k in dr.kernel_history() if not k.get("cache_hit", True)]
    assert kernels == []
    for _ in range(2):
        session.handle({"type": "undo"})
    assert session.state == before
    ((error, _), _) = session.handle(message | {"stroke": [[0.5, 0.3]]})
    assert error["type"] == "error"
    assert session.state == before
