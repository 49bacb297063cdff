"""Materials known by name: brdfkit's own, those of public collections, and their download.

`core/index.py` reads `data/measured/index.toml`; `core/catalogue.py`: brdfkit's own materials;
`public.py`: the collections; `downloading.py`: fetches a file and checks it; `remote_file.py`:
reads parts of a file on a server.
"""
