"""brdfkit from many threads: its first use, and kernels of one thread at a time.

What is imported first, and by which thread, is tested in processes of their own.
"""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
import weakref
from concurrent.futures import ThreadPoolExecutor

import pytest

import brdfkit as bk
from brdfkit.core.interrupts import delay_signals
from brdfkit.core.jit.threads import cached_in_turn, in_turn
from brdfkit.rendering import render_materials

THREADS = 8


def assert_runs(code):
    command = [sys.executable, "-c", textwrap.dedent(code)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stderr) == (0, "")


def test_first_use_by_many_threads():
    """All verbs at once in a new process, which imports Mitsuba and sets its variant."""
    assert_runs("""
    from concurrent.futures import ThreadPoolExecutor
    import numpy as np
    import brdfkit as bk

    verbs = [
        lambda: bk.fit(bk.Measured.from_table(np.ones((6, 4, 8, 3))), "lambert"),
        lambda: bk.load("plaster"),
        *[lambda: bk.check("lambert", only=["energy"])] * 3,
        *[lambda: bk.render("lambert", size=8, spp=1)] * 7,
    ]
    with ThreadPoolExecutor(len(verbs)) as pool:
        list(pool.map(lambda verb: verb(), verbs))
    """)


def test_mitsuba_itself_may_be_imported_by_many_threads():
    """Its import puts another module in its place, and Python hands out the first one, too."""
    assert_runs(f"""
    import sys
    from concurrent.futures import ThreadPoolExecutor
    import brdfkit

    def use(k):
        while k and "mitsuba" not in sys.modules:  # the first one is in the midst of it
            pass
        import mitsuba as mi
        assert mi.variant() is None

    with ThreadPoolExecutor({THREADS}) as pool:
        list(pool.map(use, range({THREADS})))
    """)


@pytest.fixture
def inside(monkeypatch, llvm_variant):
    """The threads that trace: at each time they are noted by how many there are."""
    counts, now = [], []
    trace = render_materials.trace_scenes

    def traced(*args):
        now.append(threading.get_ident())
        time.sleep(0.05)  # another thread would come in
        counts.append(len(now))
        try:
            return trace(*args)
        finally:
            now.remove(threading.get_ident())

    monkeypatch.setattr(render_materials, "trace_scenes", traced)
    return counts


def test_renders_of_several_threads_run_one_after_the_other(inside, tmp_path):
    scene = tmp_path / "scene.xml"
    scene.write_text(
        """<scene version="3.0.0"><integrator type="path"/><emitter type="constant"/>
        <sensor type="perspective"><film type="hdrfilm"><integer name="width" value="4"/>
        <integer name="height" value="4"/></film></sensor></scene>"""
    )
    jobs = [lambda: bk.render("lambert", size=4, spp=1), lambda: bk.render(scene)] * 2
    with ThreadPoolExecutor(len(jobs)) as pool:
        list(pool.map(lambda job: job(), jobs))
    assert inside == [1] * len(jobs)


def test_a_scene_ends_in_its_turn(monkeypatch, llvm_variant):
    """Mitsuba traces through the BSDFs of every scene, also of one that another thread frees."""
    seen = []
    trace_here, trace = render_materials._trace_here, render_materials.trace_scenes

    def noted(loaded, *others):
        for scene in loaded.values():
            seen.extend(weakref.ref(b) for b in map(bsdf, scene.shapes()) if hasattr(b, "textures"))
        return trace(loaded, *others)

    def counted(*args):
        result = trace_here(*args)
        assert [plugin() for plugin in seen] == [None, None]
        return result

    monkeypatch.setattr(render_materials, "trace_scenes", noted)
    monkeypatch.setattr(render_materials, "_trace_here", counted)
    bk.render(["ward", "ggx"], size=4, spp=1)


def bsdf(shape):
    return shape.bsdf()


@pytest.mark.quick
def test_a_turn_may_take_another_and_ends_with_an_error():
    @in_turn
    def countdown(n):
        return countdown(n - 1) if n else 1 / 0

    with pytest.raises(ZeroDivisionError):
        countdown(3)
    with ThreadPoolExecutor(1) as pool:  # another thread gets its turn
        assert pool.submit(in_turn(lambda: "mine")).result(timeout=300) == "mine"


@pytest.mark.quick
def test_a_cached_property_waits_for_its_turn_without_a_lock_of_its_own():
    """Python 3.11 locks it: one thread would have that and want the turn, one the turn and that."""
    computing, turn = threading.Event(), threading.Event()

    class Thing:
        @cached_in_turn
        def value(self):
            computing.set()
            turn.wait(0.2)
            return compute()

    compute = in_turn(lambda: 1)

    @in_turn
    def ask(thing):
        turn.set()
        return thing.value

    thing, other = Thing(), Thing()
    with ThreadPoolExecutor(2) as pool:
        first = pool.submit(lambda: thing.value)
        computing.wait(10)
        second = pool.submit(ask, other)
        assert (first.result(timeout=300), second.result(timeout=300)) == (1, 1)


def load_while_a_signal_comes(received, done):
    with delay_signals():
        os.kill(os.getpid(), received)
        done.append("loaded")


@pytest.mark.quick
@pytest.mark.parametrize("received", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_waits_until_a_library_is_loaded(received):
    before = signal.signal(received, signal.default_int_handler)
    done = []
    try:
        with pytest.raises(KeyboardInterrupt):
            load_while_a_signal_comes(received, done)
    finally:
        signal.signal(received, before)
    assert done


def test_every_module_can_be_imported_first():
    """The one that imports Mitsuba at its beginning could not."""
    modules = "registration.registering", "bsdf.adapter"
    code = "; ".join(f"import brdfkit.mitsuba_bridge.{name}" for name in modules)
    subprocess.run([sys.executable, "-c", code], check=True)


def test_environment_maps_load_in_one_thread(tmp_path, monkeypatch):
    """In one thread Mitsuba alone waits for ever for the pixels of an OpenEXR file."""
    code = """
        import numpy as np, brdfkit as bk, drjit as dr, mitsuba as mi
        mi.set_variant("llvm_ad_rgb")
        dr.set_thread_count(2)
        mi.Bitmap(np.full((16, 32, 3), 0.3, np.float32)).write("grey.exr")
        dr.set_thread_count(1)
        bk.render("lambert", spp=1, size=8, environment="grey.exr")
        assert dr.thread_count() == 1
    """
    monkeypatch.chdir(tmp_path)
    assert_runs(code)
