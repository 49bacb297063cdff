"""`render_volume`: pictures of volumes. `looks.py` is what a volume looks like if nobody says,
`framing.py` where it is seen from, `light.py` what lights it and is behind it, `scene.py` puts them
together, `render_volume.py` is the verb.
"""

from brdfkit.rendering.volumes.render_volume import render_volume as render_volume
