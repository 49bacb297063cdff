"""The documentation site; `make docs` builds it. What it makes itself is in `extensions/`."""

import os
import sys
from importlib import import_module
from pathlib import Path

DOCS = Path(__file__).parent
sys.path[:0] = [str(DOCS), str(DOCS / "tools"), str(DOCS.parent / "src")]

project = "brdfkit"
author = "the authors of brdfkit"
version = release = import_module("brdfkit").__version__
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_click",
    "sphinx_copybutton",
    "sphinx_design",
    *(f"extensions.{file.stem}" for file in sorted(DOCS.glob("extensions/[!_]*.py"))),
]
exclude_patterns = ["_build", "notebooks/*.ipynb"]
default_role = "code"

# Markdown as a forge shows it, too
myst_enable_extensions = ["colon_fence", "deflist", "dollarmath", "html_image"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # the generated pages' own levels

# Notebooks run once, and again when they change; one that fails ends the build
nb_execution_mode = os.environ.get("BRDFKIT_NOTEBOOKS", "cache")
nb_execution_raise_on_error = True
nb_execution_in_temp = True
nb_execution_timeout = 300
nb_render_image_options = {"alt": "What the cell above shows"}

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
napoleon_use_param = False
napoleon_use_rtype = False
napoleon_custom_sections = [("Attributes", "params_style")]
python_maximum_signature_line_length = 88

html_theme = "furo"
html_title = "brdfkit"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_show_copyright = False
html_copy_source = False
html_theme_options = {"top_of_page_buttons": []}
