"""Tools that all packages share: errors, files, geometry, Dr.Jit, summaries of results, pages."""
