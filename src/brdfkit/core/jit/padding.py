"""Aligns and pads NumPy arrays for Dr.Jit, which uses their memory without a copy.

A kernel of its LLVM backend reads whole packets: up to 15 numbers beyond the end. Where the array
ends with a page of memory and the next page is not mapped, the process crashes. And it is another
kernel, compiled anew, for each pattern of aligned and unaligned arguments: as NumPy's arrays lie
where they may, equal computations would be compiled again and again.
"""

import mmap

import numpy as np

PACKET = 16  # numbers, the largest packet (AVX-512)
ALIGNMENT = 128  # bytes, of the largest packet of doubles


def pad(values):
    """`values` (n,), contiguous and aligned, followed by a packet of readable memory.

    They are copied only where they are not contiguous, not aligned, or end too near the end of a
    page.

    >>> pad(np.arange(3.0))
    array([0., 1., 2.])
    """
    values = np.ascontiguousarray(values)
    left = -(values.ctypes.data + values.nbytes) % mmap.PAGESIZE  # bytes up to the page's end
    if values.ctypes.data % ALIGNMENT == 0 and left >= PACKET * values.itemsize:
        return values
    copy = make_padded_rows(1, len(values), values.dtype)[0]
    copy[:] = values
    return copy


def make_padded_rows(count, n, dtype=float):
    """An array (count, n) whose rows are aligned and followed by a packet of readable memory."""
    itemsize = np.dtype(dtype).itemsize
    step = ALIGNMENT // itemsize  # numbers between aligned addresses
    width = -(-(n + PACKET) // step) * step
    room = np.empty(count * width + step, dtype)
    first = -room.ctypes.data % ALIGNMENT // itemsize
    return room[first : first + count * width].reshape(count, width)[:, :n]
