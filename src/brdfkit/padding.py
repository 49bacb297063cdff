"""NumPy's arrays for Dr.Jit, which reads a little more than is there.

Dr.Jit takes over the memory of an array of one dimension, without a copy, and a kernel of its LLVM
backend reads whole packets: up to 15 numbers behind the end. Where the array ends with a page of
memory and nothing follows, the process ends there.
"""

import numpy as np

PACKET = 16  # numbers, the most (AVX-512)


def padded(values):
    """A copy of `values` (n,), contiguous, with a packet of its own memory behind it.

    >>> padded(np.arange(3.0))
    array([0., 1., 2.])
    """
    room = np.zeros(len(values) + PACKET, values.dtype)
    room[: len(values)] = values
    return room[: len(values)]
