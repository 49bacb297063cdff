"""Makes Dr.Jit's kernels compile in a third of the time, at which they run slower: tests compile
thousands, and run most of them once on a few numbers.

What a test starts in a process of its own has kernels as users have them.
"""

import ctypes
import os
import sys
from pathlib import Path

from brdfkit.core.jit import llvm

LANES = 8  # numbers in a packet: kernels compile longer with 16, and run longer with 4
# LLVM makes no improvement that it can do without, allocates registers block by block, and does not
# try the selection of instructions that knows no vectors; values stay the same
OPTIONS = (
    "-opt-bisect-limit=0",
    "-opt-bisect-verbose=0",
    "-optimize-regalloc=false",
    "-regalloc=fast",
    "-fast-isel=false",
)


def shorten() -> None:
    """Shorten the compilation of all kernels of this process, before its first one."""
    import drjit as dr  # after brdfkit, which chooses its LLVM

    if sys.platform != "linux" or llvm.find_loaded_version() < llvm.OLDEST:
        return
    words = [b"", *(option.encode() for option in OPTIONS)]
    arguments = (ctypes.c_char_p * len(words))(*words)
    ctypes.CDLL(os.environ[llvm.VARIABLE]).LLVMParseCommandLineOptions(len(words), arguments, None)

    core = ctypes.CDLL(str(Path(dr.__file__).with_name("libdrjit-core.so")))  # C++, hence the names
    read_cpu, read_features = core._Z19jit_llvm_target_cpuv, core._Z24jit_llvm_target_featuresv
    read_cpu.restype = read_features.restype = ctypes.c_char_p
    core._Z19jit_llvm_set_targetPKcS0_j(read_cpu(), read_features(), LANES)
