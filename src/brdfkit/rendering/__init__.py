"""`render` and `preview`: pictures of materials; their scene, their passes and their files."""

from brdfkit.rendering.galleries import Gallery as Gallery
from brdfkit.rendering.galleries import gallery as gallery
from brdfkit.rendering.preview import preview as preview
from brdfkit.rendering.rendering import render as render
from brdfkit.rendering.rendering import render_scene as render_scene
from brdfkit.rendering.result import Rendering as Rendering
from brdfkit.rendering.tone_mapping import ToneMapping as ToneMapping
