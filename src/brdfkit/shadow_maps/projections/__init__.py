"""One projection of a shadow map a file, by the file's name; a new file is found by being there."""
