"""Writes generated pages into a folder of their own, which git ignores."""


def refresh(folder, pages):
    """Make a folder hold these pages, file name → text; what has not changed keeps its date."""
    folder.mkdir(exist_ok=True)
    for file in folder.iterdir():
        if file.name not in pages:
            file.unlink()
    for name, text in pages.items():
        file = folder / name
        if not file.exists() or file.read_text(encoding="utf-8") != text:
            file.write_text(text, encoding="utf-8")
