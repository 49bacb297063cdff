"""A measured material, and the verbs around it: files, collections, a goniometer, audits, plots."""
