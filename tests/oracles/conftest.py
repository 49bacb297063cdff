"""Tests against other programs run only when they are asked for: make oracles."""

import pytest


def pytest_collection_modifyitems(config, items):
    if "oracles" in config.getoption("-m"):
        return
    for item in items:
        if item.get_closest_marker("oracles"):
            item.add_marker(pytest.mark.skip(reason="other programs are asked by: make oracles"))
