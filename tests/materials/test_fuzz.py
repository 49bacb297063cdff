"""Damaged files: a sound `Measured` or `Fit`, or one sentence; no warning, little time and memory.

Every small file × every mutation × a number of seeds, then hypothesis, which shrinks what it finds.
"""

import time
import tracemalloc
from functools import reduce
from random import Random

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mutations import EVERY, NUMBERS, WORDS
from small_files import FILES, curet_table, place, written

from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.formats import list_formats
from brdfkit.materials.loading import load
from brdfkit.materials.measured import Measured
from brdfkit.regression.result import Fit

CORPUS = {**FILES, **written(), "curet table": ("table.txt", curet_table())}
LEAST_CASES = 7_000
LONGEST = 2.0  # seconds of the processor, a case, where NumPy sorts four million numbers in 0.04
MOST_MEMORY = 64e6  # bytes, or
MOST_OF_SIZE = 32  # times the file's size
MEASURED_EVERY = 11  # cases; tracing slows them


def cases(kind):
    """How many seeds a small file gets with each mutation: a large one is read slowly."""
    size = sum(len(CORPUS[k][1]) for k in {kind, kind.replace(" table", "")})
    return 24 if size < 10_000 else 8 if size < 1_000_000 else 2


def put(folder, kind, data):
    """Write the damaged file; returns the path to load."""
    if kind != "curet table":
        return place(folder, kind, data)
    path = place(folder, "curet")
    (folder / "table.txt").write_bytes(data)
    return path


def load_or_sentence(path):
    try:
        found = load(path)
    except BrdfkitError as error:
        sentence = str(error)
    else:
        assert_sound(found)
        return
    assert sentence.endswith(".")
    assert "\n" not in sentence
    assert len(sentence) < len(str(path)) + 400
    assert str(path).partition("#")[0] in sentence or "table.txt" in sentence


def assert_sound(found):
    assert str(found)
    if isinstance(found, Fit):
        assert np.isfinite(np.hstack(list(found.values.values()))).all()
        return
    assert isinstance(found, Measured)
    samples = found.samples
    valid = samples.at(samples.valid)
    assert samples.valid.any()
    assert samples.values.shape == (len(samples.valid), len(found.channels))
    assert np.isfinite(valid.values).all()
    for w in (valid.wi, valid.wo):
        assert (w[:, 2] > 0).all()
        np.testing.assert_allclose(np.linalg.norm(w, axis=1), 1, atol=1e-6)
    if found.standard_error is not None:
        assert np.isfinite(found.standard_error[samples.valid]).all()


def within_limits(path, size, trace):
    """`load_or_sentence` in little time and, where `trace` says so, in little memory."""
    began = time.process_time()
    if trace:
        tracemalloc.start()
    try:
        load_or_sentence(path)
        most = max(MOST_MEMORY, MOST_OF_SIZE * size)
        assert not trace or tracemalloc.get_traced_memory()[1] < most
    finally:
        tracemalloc.stop()
    took = time.process_time() - began
    assert took < LONGEST or took < LONGEST / 0.04 * seconds_to_sort()


def seconds_to_sort():
    """How slow the machine is now, with what else runs beside."""
    numbers = np.random.default_rng(0).random(4_000_000)
    began = time.process_time()
    numbers.sort()
    return time.process_time() - began


@pytest.mark.parametrize("mutation", EVERY, ids=lambda mutation: mutation.__name__)
@pytest.mark.parametrize("kind", CORPUS)
def test_damaged_files(tmp_path, kind, mutation):
    for seed in range(cases(kind)):
        data = mutation(Random(seed), CORPUS[kind][1])
        path = put(tmp_path, kind, data)
        try:
            within_limits(path, len(data), trace=seed % MEASURED_EVERY == 0)
        except Exception as error:
            raise AssertionError(f"seed {seed}: {error!r}") from error


def test_there_are_enough_cases(capsys):
    total = sum(cases(kind) for kind in CORPUS) * len(EVERY)
    with capsys.disabled():
        print(f" {total:,} cases: {len(CORPUS)} files × {len(EVERY)} mutations × seeds", end=" ")
    assert total >= LEAST_CASES


# -- hypothesis -------------------------------------------------------------------------------

# edits: where, as a share of the length; how many bytes go; what comes in their place
place_in_file = st.one_of(st.floats(0, 1), st.floats(0, 0.02))
insertion = st.one_of(st.sampled_from(NUMBERS + WORDS), st.binary(max_size=9))
edit = st.tuples(place_in_file, st.sampled_from([0, 1, 2, 8, 10**9]), insertion)
fuzzing = settings(
    deadline=None, max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


def edited(content, edit):
    where, removed, inserted = edit
    at = int(where * len(content))
    return content[:at] + inserted + content[at + removed :]


@pytest.mark.parametrize("kind", [kind for kind in CORPUS if cases(kind) > 2])
@given(edits=st.lists(edit, min_size=1, max_size=4))
@fuzzing
def test_edited_files(tmp_path, kind, edits):
    load_or_sentence(put(tmp_path, kind, reduce(edited, edits, CORPUS[kind][1])))


SUFFIXES = sorted({suffix for module in list_formats() for suffix in module.SUFFIXES})


@given(data=st.binary(max_size=64), suffix=st.sampled_from(SUFFIXES))
@fuzzing
def test_any_bytes(tmp_path, data, suffix):
    load_or_sentence(place(tmp_path, "astm", data, "noise" + suffix))
