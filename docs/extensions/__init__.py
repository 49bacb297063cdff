"""What the documentation site makes itself when it is built: one file, one thing."""
