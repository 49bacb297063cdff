"""NumPy's memory in kernels: that of Dr.Jit's LLVM backend reads whole packets, beyond the end."""

import subprocess
import sys
import textwrap

import numpy as np
import pytest

from brdfkit.padding import PACKET, padded


@pytest.mark.quick
@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.uint32])
@pytest.mark.parametrize("n", [0, 1, 1026])
def test_a_copy_with_room_behind(n, dtype):
    values = np.arange(2 * n, dtype=dtype)[::2]
    copy = padded(values)
    np.testing.assert_array_equal(copy, values)
    assert copy.dtype == dtype
    assert copy.flags.c_contiguous
    assert copy.base.size == n + PACKET
    assert not np.shares_memory(copy, values)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="mprotect of Linux")
@pytest.mark.parametrize("n", [1024, 1026, 1039])
def test_directions_at_the_end_of_memory(n):
    """The page behind them belongs to nobody: who reads there is killed."""
    code = f"""
    import ctypes, mmap
    import brdfkit
    import drjit as dr
    import numpy as np
    from brdfkit.model import double_precision

    size = -(-{n} * 24 // mmap.PAGESIZE) * mmap.PAGESIZE
    memory = mmap.mmap(-1, size + mmap.PAGESIZE)
    start = ctypes.addressof(ctypes.c_char.from_buffer(memory))
    mprotect = ctypes.CDLL(None).mprotect
    mprotect.argtypes = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int
    assert mprotect(start + size, mmap.PAGESIZE, 0) == 0
    w = np.frombuffer(memory, float, size // 8)[-{n} * 3 :].reshape(3, {n}).T
    w[:] = 1.0
    v = double_precision.vector(w)
    assert float(np.asarray(dr.sum(v.x * v.y * v.z))[0]) == {n}
    """
    command = [sys.executable, "-c", textwrap.dedent(code)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
