"""Path-traced pictures of materials."""

from brdfkit.rendering.rendering import Rendering as Rendering
from brdfkit.rendering.rendering import render as render
from brdfkit.rendering.rendering import render_scene as render_scene
