"""Helpers for Dr.Jit: the choice of LLVM, threads, loops, padding, derivatives and doubles."""
