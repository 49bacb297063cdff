"""Shared by all tests: the variant, the models, and where third-party measurements lie."""

import os
from pathlib import Path

import pytest

import brdfkit as bk


@pytest.fixture
def llvm_variant():
    """Mitsuba in llvm_ad_rgb."""
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    return mi


@pytest.fixture
def measured_data():
    """The folder of third-party measurements; tests on them are skipped without it."""
    folder = os.environ.get("BRDFKIT_DATA")
    if not folder:
        pytest.skip("BRDFKIT_DATA names no folder of measurements")
    return Path(folder)


def pytest_generate_tests(metafunc):
    """Every model × every test that asks for `model_name`."""
    if "model_name" in metafunc.fixturenames:
        metafunc.parametrize("model_name", bk.models())


@pytest.fixture
def model(model_name):
    return bk.models()[model_name]
