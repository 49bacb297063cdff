"""The parameters of a field as Mitsuba's arrays, which an optimiser may change."""

import numpy as np

from brdfkit.core.jit.padding import pad


def exposed(node):
    """Name → array of every parameter of a field: `mi.Float`, `mi.Vector3f` or `mi.TensorXf`.

    They are opaque: a kernel holds for all of their values. A combination that is sharp stays so:
    its `blend` is left out.
    """
    import drjit as dr
    import mitsuba as mi

    found = {}
    for name, value in node.parameters().items():
        if name.endswith(".blend") and value == 0:
            continue
        if isinstance(value, tuple):
            found[name] = mi.Vector3f(*(float(v) for v in value))
        elif np.ndim(value) == 3:
            flat = pad(np.ravel(value).astype(np.float32))
            found[name] = mi.TensorXf(mi.Float(flat), np.shape(value))
        else:
            found[name] = mi.Float(float(value))
    dr.make_opaque(found)
    return found
