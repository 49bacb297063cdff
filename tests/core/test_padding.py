"""NumPy's memory in kernels: that of Dr.Jit's LLVM backend reads whole packets, beyond the end."""

import mmap
import subprocess
import sys
import textwrap

import numpy as np
import pytest

from brdfkit.core.jit.padding import ALIGNMENT, PACKET, pad


@pytest.mark.quick
@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.uint32])
@pytest.mark.parametrize("n", [1, 1026])
def test_behind_an_array_a_packet_is_readable(n, dtype):
    """Wherever in a page it ends: then on the same page, or in the copy."""
    itemsize = np.dtype(dtype).itemsize
    memory = np.zeros(4 * mmap.PAGESIZE // itemsize + n, dtype)
    copies = 0
    for start in range(mmap.PAGESIZE // itemsize):
        values = memory[start : start + n]
        values[:] = np.arange(n)
        found = pad(values)
        np.testing.assert_array_equal(found, values)
        assert (found.dtype, found.flags.c_contiguous) == (dtype, True)
        assert found.ctypes.data % ALIGNMENT == 0
        if found is values:
            last = values.ctypes.data + values.nbytes - 1
            assert (last + PACKET * itemsize) // mmap.PAGESIZE == last // mmap.PAGESIZE
        else:
            copies += 1
            assert found.base.size >= n + PACKET
    assert copies < mmap.PAGESIZE // itemsize
    strided = np.arange(2 * n, dtype=dtype)[::2]
    np.testing.assert_array_equal(pad(strided), strided)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="mprotect of Linux")
@pytest.mark.parametrize("n", [1024, 1026, 1039])
def test_directions_at_the_end_of_memory(n):
    """The page behind them belongs to nobody: who reads there is killed."""
    code = f"""
    import ctypes, mmap
    import brdfkit
    import drjit as dr
    import numpy as np
    from brdfkit.core.jit import double_precision

    size = -(-{n} * 24 // mmap.PAGESIZE) * mmap.PAGESIZE
    memory = mmap.mmap(-1, size + mmap.PAGESIZE)
    start = ctypes.addressof(ctypes.c_char.from_buffer(memory))
    mprotect = ctypes.CDLL(None).mprotect
    mprotect.argtypes = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int
    assert mprotect(start + size, mmap.PAGESIZE, 0) == 0
    w = np.frombuffer(memory, float, size // 8)[-{n} * 3 :].reshape(3, {n}).T
    w[:] = 1.0
    v = double_precision.to_vector(w)
    assert float(np.asarray(dr.sum(v.x * v.y * v.z))[0]) == {n}
    """
    command = [sys.executable, "-c", textwrap.dedent(code)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stderr) == (0, "")
