"""Public collections of measured materials: which there are, and how to download their files.

`public.py` lists the collections that `data/measured/index.toml` describes. `downloading.py`
downloads a file and verifies its checksum. `remote_file.py` reads parts of a file on a server.
"""
