"""NumPy's arrays for Dr.Jit, which reads a little more than is there.

Dr.Jit takes over the memory of an array of one dimension, without a copy, and a kernel of its LLVM
backend reads whole packets: up to 15 numbers behind the end. Where the array ends with a page of
memory and nothing follows, the process ends there.
"""

import mmap

import numpy as np

PACKET = 16  # numbers, the most (AVX-512)


def padded(values):
    """`values` (n,), contiguous, with a packet of readable memory behind them.

    They are copied only where they are not contiguous, or too near the end of a page.

    >>> padded(np.arange(3.0))
    array([0., 1., 2.])
    """
    values = np.ascontiguousarray(values)
    left = -(values.ctypes.data + values.nbytes) % mmap.PAGESIZE  # bytes of the last page
    if left >= PACKET * values.itemsize:
        return values
    room = np.empty(len(values) + PACKET, values.dtype)
    copy, behind = np.split(room, [len(values)])
    copy[:], behind[:] = values, 0
    return copy
