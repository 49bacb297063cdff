"""Light in volumes: collisions along rays, media, emitters, and surfaces lit within a volume.

`majorants.py` bounds the extinction, `tracking.py` finds where light collides, and `medium.py` puts
both together with albedo and emission. Paths turn at a `vertex.py` and receive the light of
`emitters.py`; `surface_light.py` lights a surface that is not a shape of the scene.
"""
