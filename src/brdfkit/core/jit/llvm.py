"""Finds an LLVM that works with Dr.Jit before Dr.Jit is loaded, and chooses Mitsuba's variant.

Dr.Jit looks for libLLVM when it is imported and takes the newest of the system. With LLVM 15 or 16
all works until the first kernel that contains a `minimum`: then LLVM aborts the process. So brdfkit
chooses the library, through the environment variable DRJIT_LIBLLVM_PATH:

1. the library that the user named there, if it is LLVM 17 or newer;
2. the library that the package karellen-llvm-core brought into this environment;
3. the newest of the system, if it is LLVM 17 or newer;
4. none: Mitsuba's scalar variants remain.
"""

import os
import re
import site
import sys
import warnings
from pathlib import Path

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import delay_signals
from brdfkit.core.jit.threads import in_turn

VARIABLE = "DRJIT_LIBLLVM_PATH"
OLDEST = 17
SYSTEM_FOLDERS = ("/usr/lib/*-linux-gnu*", "/usr/lib64", "/usr/lib", "/usr/local/lib")
VARIANTS = ("cuda_ad_rgb", "llvm_ad_rgb", "scalar_rgb")
# A path at which there is no library, so that Dr.Jit turns its LLVM backend off
NO_LIBRARY = "no-LLVM-17-or-newer-found"


def choose_llvm_library() -> None:
    """Point Dr.Jit to a usable libLLVM when brdfkit is imported.

    If Dr.Jit was imported before, its choice stands; a warning says so if it is a bad one.
    """
    if "drjit" in sys.modules:
        if 0 < find_loaded_version() < OLDEST:
            warnings.warn(_describe_unusable_llvm(), stacklevel=3)
    elif sys.platform == "linux":
        chosen = find_llvm_library()
        named = os.environ.get(VARIABLE)
        if named and named not in (chosen, NO_LIBRARY):
            instead = f"{chosen} is used instead" if chosen else "the scalar variants remain"
            warnings.warn(
                f"{VARIABLE} names {named}, which is not an LLVM of version {OLDEST} or newer; "
                f"{instead}.",
                stacklevel=3,
            )
        os.environ[VARIABLE] = str(chosen or NO_LIBRARY)


def find_llvm_library() -> str | None:
    """Return the path of the libLLVM to use, None where none of version 17 or newer is found."""
    named = os.environ.get(VARIABLE)
    if named and read_llvm_version(named) >= OLDEST:
        return named
    for prefix in (sys.prefix, site.getuserbase()):
        bundled = Path(prefix, "lib", "libLLVM.so")
        if read_llvm_version(bundled) >= OLDEST:
            return str(bundled)
    paths = [p for folder in SYSTEM_FOLDERS for p in Path("/").glob(f"{folder[1:]}/libLLVM*.so*")]
    newest = max(paths, key=read_llvm_version, default=None)
    return str(newest) if newest and read_llvm_version(newest) >= OLDEST else None


def read_llvm_version(path: str | Path) -> int:
    """Return the major version of a libLLVM by its name or by loading it; 0 if it does not load."""
    by_name = re.search(r"libLLVM(?:-|\.so\.)(\d+)", os.path.realpath(path))
    if by_name and Path(path).exists():
        return int(by_name[1])
    import ctypes  # imported here to keep `--help` fast

    try:
        library = ctypes.CDLL(str(path))
        major = ctypes.c_uint()
        library.LLVMGetVersion(ctypes.byref(major), None, None)
        return major.value
    except (OSError, AttributeError):  # no such library; LLVM before 16 has no LLVMGetVersion
        return 0


def describe_llvm_remedy() -> str:
    """Return what to do where Dr.Jit has no usable LLVM, as the end of a sentence.

    If the machine has a usable LLVM after all, Dr.Jit was imported too early to take it.
    """
    if find_llvm_library():
        return "start Python anew and import brdfkit before mitsuba and drjit"
    return (
        "install karellen-llvm-core (Linux x86-64) or set DRJIT_LIBLLVM_PATH to a libLLVM of "
        f"version {OLDEST} or newer"
    )


def find_loaded_version() -> int:
    """Return the major version of the LLVM that Dr.Jit has loaded, -1 where it has none."""
    import drjit as dr

    return dr.detail.llvm_version()[0]


def require_safe_variant(variant: str | None) -> None:
    """Raise `BrdfkitError` where kernels of a variant of Mitsuba would abort the process."""
    if variant and variant.startswith("llvm") and 0 < find_loaded_version() < OLDEST:
        raise BrdfkitError(_describe_unusable_llvm())


@in_turn
def use_variant() -> str:
    """Return Mitsuba's current variant; where none is set, set the best that works first.

    A warning is given if that is only `scalar_rgb`, which is many times slower.
    """
    import mitsuba as mi

    if mi.variant() is None:
        usable = find_loaded_version() >= OLDEST
        with delay_signals():
            mi.set_variant(*(v for v in VARIANTS if usable or not v.startswith("llvm")))
        if mi.variant() == "scalar_rgb":
            warnings.warn(
                f"Mitsuba has no CUDA device and no LLVM {OLDEST} or newer: its slow variant "
                f"scalar_rgb is used; to mend it, {describe_llvm_remedy()}.",
                stacklevel=3,  # names the caller: level 1 is here, level 2 the wrapper of `in_turn`
            )
    variant = str(mi.variant())
    require_safe_variant(variant)
    return variant


def _describe_unusable_llvm() -> str:
    """Return a sentence on the LLVM that Dr.Jit has loaded, and on what to do."""
    return (
        f"Dr.Jit was imported before brdfkit and took LLVM {find_loaded_version()}, which aborts "
        f"the process in Mitsuba's llvm variants: {describe_llvm_remedy()}."
    )
