"""The page of a folder, `README.md`, has the pages that it links to below it in the contents."""

import re

PAGE = re.compile(r"\]\((\w+)\.md\)")
CONTENTS = "\n\n```{{toctree}}\n:hidden:\n\n{}\n```\n"


def setup(app):
    app.connect("source-read", add_contents)


def add_contents(app, docname, source):
    if docname.endswith("/README"):
        last = dict.fromkeys(reversed(PAGE.findall(source[0])))  # in the table, not before it
        source[0] += CONTENTS.format("\n".join(reversed(last)))
