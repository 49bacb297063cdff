"""What takes a client: results are those without one, and what dead workers had is repeated."""

import os
import pickle
import signal
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.core.cluster import Parcel
from brdfkit.core.discovery import plugin_files
from brdfkit.core.jit.llvm import use_variant
from brdfkit.materials.resolve import to_material
from brdfkit.rendering.on_cluster import Order, Piece, group_passes, render_piece
from brdfkit.rendering.shown import ShownMaterials
from brdfkit.rendering.tracing import divide_into_passes

WHITE = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.8}, "name": "white"}
PAIR = [WHITE, ("grey", {"type": "diffuse"})]
FELT = '''"""Felt: pauses in the worker that first uses it."""

import multiprocessing
import os
import signal
import time
from pathlib import Path

from brdfkit.model import Model, weight
from brdfkit.model.lobes import lambertian

BEGAN = Path(__file__).with_name("began")


class Felt(Model):
    diffuse_reflectance = weight(0.3, "k_d")

    def lobes(self):
        if multiprocessing.parent_process() and not BEGAN.exists():
            BEGAN.write_text(str(os.getpid()))
            time.sleep(60)
        return (lambertian(),)
'''
DEADLY = FELT.replace("not BEGAN.exists()", "True").replace("time.sleep(60)", "os.abort()")


TRUTHS = {
    "chalk": bk.models()["lambert"](diffuse_reflectance=(0.5, 0.4, 0.3)),
    "paint": bk.models()["ward"](alpha_u=0.2, diffuse_reflectance=(0.1, 0.2, 0.3)),
}
FILES = [f"{name}.npz" for name in TRUTHS]


@pytest.fixture(scope="module")
def cluster():
    """A client of two processes with one thread each."""
    distributed = pytest.importorskip("distributed")
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": ":0"}
    with distributed.LocalCluster(**options) as made, distributed.Client(made) as found:
        yield found


@pytest.fixture
def client(cluster, request):
    """This client, whose workers run; the parameter: how many of them may die of a task."""

    def allow_deaths(count, dask_scheduler):
        dask_scheduler.allowed_failures = count

    cluster.run_on_scheduler(allow_deaths, getattr(request, "param", 3))
    cluster.wait_for_workers(2)
    return cluster


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A current folder with two small materials, where no user's model is known."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(plugin_files, "_users", {})
    for seed, (name, truth) in enumerate(TRUTHS.items()):
        wi, wo = draw_direction_pairs(300, seed=seed, max_degrees=75)
        bk.save(bk.Measured.from_samples(wi, wo, truth.eval(wi, wo)), f"{name}.npz")
    return tmp_path


def wait_until_idle(client):
    """Wait until the workers do nothing; fail after some seconds."""
    for _ in range(200):
        if not any(client.processing().values()):
            return
        time.sleep(0.05)
    raise AssertionError(client.processing())


@pytest.fixture
def killed(here):
    """Kills the worker that first uses the model in `felt.py`; gives its number in a list."""
    Path("felt.py").write_text(FELT)
    found = []

    def kill_the_first_that_began():
        for _ in range(1200):
            time.sleep(0.05)
            if Path("began").exists() and (pid := Path("began").read_text()):
                os.kill(int(pid), signal.SIGKILL)
                found.append(int(pid))
                return

    killer = threading.Thread(target=kill_the_first_that_began)
    killer.start()
    yield found
    killer.join()


def test_a_sweep_loses_nothing_if_a_worker_is_killed(client, killed):
    """In the middle of a fit. The results are those without a cluster, to 1e-10."""
    models, workers = ["lambert", "ward", "felt.py", "koenderink"], client.run(os.getpid)
    found = bk.sweep(["paint.npz", "missing.npz"], models, client=client, folder="out")
    assert killed[0] in workers.values()
    assert {row.file for row in found.failed} == {"missing.npz"}
    assert len(found.fits) == 4
    for row in found.rows[:4]:
        alone = bk.fit(row.file, row.model)
        assert row.error == pytest.approx(alone.loss, rel=1e-10, abs=1e-10)
        for name, value in alone.values.items():
            assert row.fit.values[name] == pytest.approx(value, rel=1e-10, abs=1e-10)
    assert bk.sweep("paint.npz", models, folder="out").found == 4


@pytest.mark.parametrize("client", [0], indirect=True)
def test_only_the_fit_fails_of_which_every_worker_dies(client, here):
    Path("deadly.py").write_text(DEADLY)
    found = bk.sweep("chalk.npz", ["lambert", "deadly.py"], client=client)
    assert [row.model for row in found.failed] == ["deadly"]
    assert found.problems == [
        "chalk.npz: deadly ended every worker that tried it; see the workers' logs."
    ]


def test_ctrl_c_leaves_nothing_to_do_on_the_cluster(client, here):
    def interrupt(done, total):
        if done:
            raise KeyboardInterrupt

    found = bk.sweep(FILES, ["lambert", "koenderink"], client=client, progress=interrupt)
    assert (len(found.rows), found.requested) == (1, 4)
    wait_until_idle(client)


def test_a_comparison_is_the_same(client):
    things = [bk.models()["lambert"](diffuse_reflectance=0.3), "ggx", "plaster", "ggx"]
    done = []
    found = bk.compare("plaster", things, client=client, progress=lambda *n: done.append(n))
    assert found == bk.compare("plaster", things)
    assert done == [(n, 4) for n in range(5)]


def test_a_ranking_is_the_same_after_a_worker_is_killed(client, killed):
    models, workers = ["koenderink", "lambert", "felt.py"], client.run(os.getpid)
    found = bk.rank("paint.npz", models, client=client)
    assert killed[0] in workers.values()
    alone = bk.rank("paint.npz", models)
    assert found.best == alone.best
    assert [row.model for row in found.rows] == [row.model for row in alone.rows]
    for row, other in zip(found.rows, alone.rows, strict=True):
        for name in ("error", "behind", "uncertainty", "picture", "bic"):
            assert getattr(row, name) == pytest.approx(getattr(other, name), rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("client", [0], indirect=True)
def test_a_picture_that_ends_every_worker_is_named(client, here):
    Path("deadly.py").write_text(DEADLY)
    bk.load_plugins("deadly.py")
    said = "^deadly, passes 1 to 1 ended every worker that tried it; see the workers' logs.$"
    with pytest.raises(bk.BrdfkitError, match=said):
        bk.render("deadly", spp=1, size=8, client=client)


@pytest.fixture(scope="module")
def rendered(cluster):
    """The same picture from two seeds, in eight pieces of two passes."""
    cluster.wait_for_workers(2)
    return [bk.render(WHITE, spp=256, size=64, seed=seed, client=cluster) for seed in (1, 2)]


def test_a_picture_is_the_mean_of_its_pieces(rendered):
    passes = list(enumerate(divide_into_passes(256, 16)))
    pieces = group_passes(passes, 8, growing=False)
    assert [len(piece) for piece in pieces] == [2] * 8
    shown = ShownMaterials({"white": to_material(WHITE)}, "ball", (64, 64), None)
    order = Order(shown, 1, use_variant(), ())
    means = [render_piece(order, Piece(0, "white", tuple(piece))) for piece in pieces]
    assert len({mean.tobytes() for mean in means}) == 8
    np.testing.assert_allclose(rendered[0].pictures["white"], np.mean(means, axis=0), rtol=1e-5)
    spread = np.std(means, axis=0, ddof=1) / np.sqrt(8)
    np.testing.assert_allclose(rendered[0].standard_error, spread, rtol=1e-3, atol=1e-6)


@pytest.mark.parametrize("how", [{"spp": 32}, {"noise_floor": 25}], ids=str)
def test_pictures_are_those_without_a_cluster(client, how):
    done = []
    progress = {"progress": lambda *n: done.append(n)}
    found = bk.render(PAIR, **how, size=16, client=client, **progress)
    alone = bk.render(PAIR, **how, size=16)
    assert (found.spp, found.requested, found.seed) == (alone.spp, alone.requested, alone.seed)
    for name, picture in alone.pictures.items():
        np.testing.assert_allclose(found.pictures[name], picture, rtol=1e-5, atol=1e-6)
    np.testing.assert_array_equal(found.mask, alone.mask)
    assert found.noise_floor == pytest.approx(alone.noise_floor, abs=1e-3)
    assert done[-1][0] == done[-1][1]


def test_ctrl_c_keeps_the_pieces_that_are_finished(client):
    def interrupt(done, total):
        if done == total - 1:
            raise KeyboardInterrupt

    found = bk.render(PAIR, spp=256, size=16, client=client, progress=interrupt)
    assert 0 < found.spp < found.requested == 256
    wait_until_idle(client)


def test_the_noise_of_a_merged_picture_is_right(rendered):
    """The squared difference of two seeds, over its variance, has the mean of F(1, 14) = 14/12 for
    8 pieces each. At a level of 0.001; every fourth pixel, as neighbours share samples."""
    one, other = rendered
    pixels = np.zeros_like(one.mask)
    pixels[::4, ::4] = True
    pixels &= one.mask
    difference = (one.pictures["white"] - other.pictures["white"])[pixels][:, 1].astype(float)
    variance = sum(r.standard_error[pixels][:, 1].astype(float) ** 2 for r in rendered)
    z = difference**2 / variance
    assert len(z) > 60
    assert abs(z.mean() - 14 / 12) < 3.29 * np.sqrt(3.54 / len(z))


def test_a_thesis_is_reproduced_the_same(client):
    parts = ["check_values"]
    found = bk.reproduce("balint2019", parts=parts, client=client)
    assert found.claims == bk.reproduce("balint2019", parts=parts).claims
    assert found.unfinished == ()


@pytest.mark.quick
@pytest.mark.parametrize(
    "call",
    [
        lambda **given: bk.compare("plaster", "ggx", **given),
        lambda **given: bk.rank("plaster", "ggx", **given),
        lambda **given: bk.render("plaster", **given),
        lambda **given: bk.reproduce("balint2019", **given),
    ],
    ids=["compare", "rank", "render", "reproduce"],
)
def test_what_is_no_client_is_said(call):
    with pytest.raises(bk.BrdfkitError, match=r"client = 8 should be a .*brdfkit\[cluster\]"):
        call(client=8)


def test_what_workers_should_not_open_is_refused(here):
    Path("table.csv").write_text("1")
    parcel = Parcel.pack("content", [Path("table.csv").absolute()])
    assert pickle.loads(pickle.dumps(parcel)).open() == "content"
    Path("table.csv").write_text("2")
    with pytest.raises(bk.BrdfkitError, match=r"table\.csv: has changed since the work began"):
        pickle.loads(pickle.dumps(parcel)).open()
    with pytest.raises(bk.BrdfkitError, match="the worker has brdfkit"):
        replace(parcel, version="0.0.9").open()
    with pytest.raises(bk.BrdfkitError, match="cannot be sent to a cluster"):
        Parcel.pack(threading.Lock())
