"""`render`: path-traced pictures of materials: the scene, the passes, the picture file."""

from brdfkit.rendering.rendering import Rendering as Rendering
from brdfkit.rendering.rendering import render as render
from brdfkit.rendering.rendering import render_scene as render_scene
