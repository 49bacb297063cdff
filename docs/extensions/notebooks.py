"""The notebooks of `notebooks/` as pages: Markdown whose head says `md:myst` is executed."""


def setup(app):
    app.connect("source-read", mark)


def mark(app, docname, source):
    """Say what jupytext's head says in the words by which MyST-NB knows a notebook."""
    head, line, rest = source[0].partition("\n  formats: md:myst\n")
    if docname.startswith("notebooks/") and line:
        source[0] = f"{head}\n  text_representation: {{format_name: myst}}\n{rest}"
