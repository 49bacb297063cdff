"""Aligns and pads NumPy arrays for Dr.Jit, which uses their memory without a copy.

A kernel of its LLVM backend reads whole packets, up to 15 numbers beyond the end of an array. If
the array ends with a page of memory and the next page is not mapped, the process crashes. Besides,
Dr.Jit compiles another kernel for each pattern of aligned and unaligned arguments. Since NumPy
places arrays anywhere, equal computations would be compiled again and again.
"""

import mmap
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray

PACKET = 16  # numbers in the largest packet that a kernel reads at once (AVX-512)
ALIGNMENT = 128  # bytes in the largest packet of doubles


def pad(values: AnyArray) -> AnyArray:
    """Return values (n,) contiguous, aligned and followed by a packet of readable memory.

    They are copied only if they are not contiguous, not aligned, or end too near the end of a page.

    >>> pad(np.arange(3.0))
    array([0., 1., 2.])
    """
    values = np.ascontiguousarray(values)
    left = -(values.ctypes.data + values.nbytes) % mmap.PAGESIZE  # bytes left in the last page
    if values.ctypes.data % ALIGNMENT == 0 and left >= PACKET * values.itemsize:
        return values
    copy = make_padded_rows(1, len(values), values.dtype)[0]
    copy[:] = values
    return copy


def make_padded_rows(count: int, n: int, dtype: Any = float) -> AnyArray:
    """Return an empty array (count, n) of aligned rows, each followed by a packet of memory."""
    itemsize = np.dtype(dtype).itemsize
    step = ALIGNMENT // itemsize  # numbers between aligned addresses
    width = -(-(n + PACKET) // step) * step
    memory = np.empty(count * width + step, dtype)
    first = -memory.ctypes.data % ALIGNMENT // itemsize
    return memory[first : first + count * width].reshape(count, width)[:, :n]
