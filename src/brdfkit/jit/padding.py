"""Pads NumPy arrays for Dr.Jit, which reads a little beyond their end.

Dr.Jit uses the memory of a one-dimensional array without a copy, and a kernel of its LLVM backend
reads whole packets: up to 15 numbers beyond the end. Where the array ends with a page of memory and
the next page is not mapped, the process crashes.
"""

import mmap

import numpy as np

PACKET = 16  # numbers, the largest packet (AVX-512)


def pad(values):
    """`values` (n,), contiguous, followed by a packet of readable memory.

    They are copied only where they are not contiguous or end too near the end of a page.

    >>> pad(np.arange(3.0))
    array([0., 1., 2.])
    """
    values = np.ascontiguousarray(values)
    left = -(values.ctypes.data + values.nbytes) % mmap.PAGESIZE  # bytes up to the page's end
    if left >= PACKET * values.itemsize:
        return values
    room = np.empty(len(values) + PACKET, values.dtype)
    copy, behind = np.split(room, [len(values)])
    copy[:], behind[:] = values, 0
    return copy
