"""Pictures of materials, `render` and `preview`, and of volumes: scenes, passes and files."""

from brdfkit.images.tone_mapping import ToneMapping as ToneMapping
from brdfkit.rendering.film import Film as Film
from brdfkit.rendering.galleries import Gallery as Gallery
from brdfkit.rendering.galleries import gallery as gallery
from brdfkit.rendering.previewing.preview import preview as preview
from brdfkit.rendering.render_materials import render as render
from brdfkit.rendering.render_materials import render_scene as render_scene
from brdfkit.rendering.result import Rendering as Rendering
from brdfkit.rendering.volumes import render_orbit as render_orbit
from brdfkit.rendering.volumes import render_volume as render_volume
