"""One measured material, and all that leads to it: files, collections, instruments, checks,
plots.
"""
