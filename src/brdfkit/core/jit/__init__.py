"""Helpers for Dr.Jit: the choice of LLVM, threads, loops, padded arrays and double precision."""
