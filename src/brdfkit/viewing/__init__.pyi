from .render_view import render_view as render_view
from .view import view as view
