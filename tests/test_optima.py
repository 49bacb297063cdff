"""No fit has become worse: every model on thirty materials, against the list of optima.

Each model is fitted on every other material, by one loss and the other in turn: the whole list
would take two minutes. `python tests/optima.py` runs all of it.
"""

import optima
import pytest

import brdfkit as bk

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
        if (number + MATERIALS.index(name)) % 4 == 0:
            found = bk.fit(model, data, loss, use_standard_error=False).loss
            # A fit of few samples that nearly meets them all is rounding
            if found > error * (1 + 1e-6) + 1e-9:
                worse.append(f"{model} {loss}: {found:.9g}, not {error:.9g}")
    assert not worse
