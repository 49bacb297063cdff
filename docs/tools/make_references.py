"""Makes `docs/references.md`, the list of all works that brdfkit cites.

python docs/tools/make_references.py
"""

from pathlib import Path

from brdfkit.core.references import read_references

PAGE = Path(__file__).parents[1] / "references.md"
HEAD = """# References

The works that brdfkit cites, by the key that stands in brackets in its texts. A new one is an entry
of [`references.toml`](../src/brdfkit/core/references.toml), of which `make docs` makes this page.

"""


def make_page():
    """Return the text of the page."""
    return HEAD + "".join(f"- {reference}\n" for reference in read_references().values())


if __name__ == "__main__":
    PAGE.write_text(make_page(), encoding="utf-8")
