"""Materials of public collections, known by name, and their download.

`public.py` lists the collections, which `data/measured/index.toml` describes; `downloading.py`
fetches a file and checks it; `remote_file.py` reads parts of a file on a server.
"""
