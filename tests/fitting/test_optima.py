"""No fit has become worse: every model on thirty materials, against the list of optima.

Each model is searched on some of the materials, by one loss after the other: the whole list would
take three minutes. `python tests/fitting/optima.py` runs all of it.
"""

import optima
import pytest

from brdfkit.model import labels

KNOWN = optima.read()
MATERIALS = [*optima.SHIPPED, *optima.MEASURED, *optima.RECONSTRUCTED]


@pytest.mark.parametrize("name", MATERIALS)
def test_optima(name):
    data = optima.material(name)
    if data is None:
        pytest.skip("BRDFKIT_DATA names no folder of measurements")
    worse = []
    rows = [(model, loss, error) for (of, model, loss), error in KNOWN.items() if of == name]
    for number, (model, loss, error) in enumerate(rows):
        if (number + MATERIALS.index(name)) % 7 == 0:
            found = optima.search(model, data, loss)
            # Models that are clamped at 0 have an end at every kink, and rounding leads to one or
            # another; a fit of few samples that nearly meets them all is rounding
            share = 1e-2 if labels.model(model).has_signed_weights() else 1e-6
            if found > error * (1 + share) + 1e-9:
                worse.append(f"{model} {loss}: {found:.9g}, not {error:.9g}")
    assert not worse
