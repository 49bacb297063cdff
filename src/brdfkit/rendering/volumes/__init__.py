"""`render_volume` and `render_orbit`: pictures and films of volumes.

`render_volume.py` and `orbit.py` contain the two functions. `scene.py` makes the scene for Mitsuba,
`camera.py` places the camera, and `defaults.py` chooses a transfer function, a surface level and a
material if the user gives none.
"""
