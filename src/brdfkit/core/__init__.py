"""Tools that know nothing of BRDFs: errors, files, geometry, Dr.Jit, documents, pages."""
