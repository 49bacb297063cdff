"""Damaged files: whatever the bytes, a `Measured` or a `BrdfkitError`, and no warning."""

import gzip
import lzma
from functools import reduce

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from small_files import FILES, place

from brdfkit.errors import BrdfkitError
from brdfkit.formats import load
from brdfkit.measured import Measured

pytestmark = pytest.mark.quick

TOKENS = [b"nan", b"inf", b"-1e999", b"1e308", b"-1", b"0", b",", b" ", b"\n", b"\r", b"#", b"_"]
TOKENS += [b"\0", b"\xff\xfe", b"\xc3\xa4", "٣".encode(), b"VARS ", b"\x7f\xf0" * 4]

# edits: where, as a share of the length; how many bytes go; what comes in their place
place_in_file = st.one_of(st.floats(0, 1), st.floats(0, 0.02))
insertion = st.one_of(st.sampled_from(TOKENS), st.binary(max_size=9))
edit = st.tuples(place_in_file, st.sampled_from([0, 1, 2, 8, 10**9]), insertion)
fuzzing = settings(
    deadline=None, max_examples=100, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


def damaged(content, edit):
    where, removed, inserted = edit
    at = int(where * len(content))
    return content[:at] + inserted + content[at + removed :]


def load_or_sentence(path):
    try:
        material = load(path)
    except BrdfkitError as error:
        sentence = str(error)
    else:
        assert_sound(material)
        return
    assert sentence.endswith(".")
    assert "\n" not in sentence


def assert_sound(material):
    assert isinstance(material, Measured)
    samples = material.samples
    assert samples.valid.any()
    assert samples.values.shape == (len(samples.valid), len(material.channels))
    assert np.isfinite(samples.values[samples.valid]).all()
    assert (samples.wi[samples.valid, 2] > 0).all()
    assert str(material)


@pytest.mark.parametrize("kind", FILES)
@given(edits=st.lists(edit, min_size=1, max_size=4))
@fuzzing
def test_damaged_files(tmp_path, kind, edits):
    load_or_sentence(place(tmp_path, kind, reduce(damaged, edits, FILES[kind][1])))


@pytest.mark.parametrize("pack", [gzip.compress, lzma.compress])
@given(edits=st.lists(edit, min_size=1, max_size=3))
@fuzzing
def test_damaged_compressed_files(tmp_path, pack, edits):
    packed = pack(FILES["astm"][1])
    load_or_sentence(place(tmp_path, "astm", reduce(damaged, edits, packed), "paint.astm.packed"))


@given(data=st.binary(max_size=64), suffix=st.sampled_from([".binary", ".brdf", ".astm", ".dat"]))
@fuzzing
def test_any_bytes(tmp_path, data, suffix):
    load_or_sentence(place(tmp_path, "astm", data, "noise" + suffix))
