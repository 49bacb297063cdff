"""What Dr.Jit needs of its surroundings: an LLVM that works, whole arrays, one thread at a time."""
