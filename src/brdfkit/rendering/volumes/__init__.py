"""`render_volume` and `render_orbit`: pictures and films of volumes.

`looks.py` is what a volume looks like if nobody says, `framing.py` where it is seen from,
`light.py` what lights it and is behind it, `scene.py` puts them together, `render_volume.py` and
`orbit.py` are the verbs.
"""
