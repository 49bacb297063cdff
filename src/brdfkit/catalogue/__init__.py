"""Materials known by name: those that brdfkit brings, public collections, and downloads.

`index.py`: all of them; `shipped.py`: brdfkit's own; `public.py`: collections, from `data/`;
`downloading.py`: one file with its checksum; `remote.py`: a file out of an archive, by ranges.
"""
