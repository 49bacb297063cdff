"""Puts pages below others in the side bar, so that it has few entries.

The page of a folder, `README.md`, has the pages that it links to below it. Other pages have those
that `BELOW` lists. Their Markdown names no table of contents: a forge would show it as code.
"""

import re

PAGE = re.compile(r"\]\((\w+)\.md\)")
CONTENTS = "\n\n```{{toctree}}\n:hidden:\n\n{}\n```\n"
BELOW = {
    "five_minutes": ["notebooks/README", "notes", "glossary"],
    "environments": ["environment_samplers"],
    "distance_fields": ["single_ray_shadows"],
    "volumes": ["volume_programs", "view_programs"],
    "validation": [
        *("leaderboard", "losses", "real_measurements", "measured", "goniometer", "refining"),
        "shadow_map_gradients",
        *(f"reproduce/{name}" for name in ("kurt2007", "ergun2008", "ergun2015")),
        *(f"reproduce/{name}" for name in ("balint2019", "lesar2018")),
    ],
    "architecture": ["contributing", "changelog", "references"],
}


def setup(app):
    app.connect("source-read", add_contents)


def add_contents(app, docname, source):
    if docname.endswith("/README"):
        last = dict.fromkeys(reversed(PAGE.findall(source[0])))  # in the table, not before it
        source[0] += CONTENTS.format("\n".join(reversed(last)))
    elif docname in BELOW:
        source[0] += CONTENTS.format("\n".join(BELOW[docname]))
