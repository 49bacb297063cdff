"""What Dr.Jit needs around it: an LLVM, whole arrays, one thread at a time, and no signals."""
