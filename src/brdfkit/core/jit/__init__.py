"""Helpers for Dr.Jit: finding LLVM, threads, loops, padding, and double precision."""
