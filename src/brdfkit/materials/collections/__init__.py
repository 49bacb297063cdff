"""Public collections of measured materials, such as MERL's, and how to download their files.

`public.py` lists the collections that `data/measured/index.toml` describes. `downloading.py`
downloads a file, or a part of a zip archive, and verifies its checksum.
"""
