"""Tables for terminals of any width: columns fold, or rows become blocks; no word is cut."""

import textwrap

NAME = 24  # characters of a name beyond which it goes on below, where the table were too wide


def table(columns, sections, width, title=None):
    """A Rich table at most `width` characters wide; None where it would have to cut a word.

    `columns`: their names; `sections`: lists of rows of texts. A column whose name begins with ">"
    is flush right, for numbers. Such a column and the first, which holds names, are not folded, but
    for names of more than `NAME` characters.
    """
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    # names of the columns (a unit on a line of its own), and their widths
    headers = [column.removeprefix(">").replace(" [", "\n[") for column in columns]
    rows = [row for section in sections for row in section]
    cells = [[h, *texts] for h, *texts in zip(headers, *rows, strict=True)]
    whole = [k == 0 or column.startswith(">") for k, column in enumerate(columns)]
    widths = _widths(cells, whole, width - 3 * len(columns) + 1)  # less the gaps
    if widths is None:
        return None

    # the table
    title = title and Text(title)
    found = Table(box=SIMPLE_HEAD, title=title, title_justify="left", pad_edge=False)
    found.show_header = any(columns)
    for column, header, w in zip(columns, headers, widths, strict=True):
        found.add_column(
            Text(header), justify="right" if column[:1] == ">" else "left", width=w, overflow="fold"
        )
    for section in sections:
        for row in section:
            found.add_row(*map(Text, row))
        found.add_section()
    return found


def blocks(columns, sections, width):
    """The lines of a narrow table: the texts of each row one below the other, with column names."""
    for row in (row for section in sections for row in section):
        for k, (column, text) in enumerate(zip(columns, row, strict=True)):
            name = column.removeprefix(">")
            if not (name or text):
                continue
            yield textwrap.fill(
                f"{name}: {text or '-'}" if name else text,
                width,
                initial_indent="  " if k else "",
                subsequent_indent="    ",
                break_long_words=False,
                break_on_hyphens=False,
            )


def _widths(cells, whole, room):
    """The widths of columns in `room` characters together; None where that is too little.

    `cells`: the texts of each column; `whole`: which columns are not folded. Each column is as wide
    as its longest word at least. What is left is shared in proportion to what the columns lack.
    """
    from rich.cells import cell_len

    most = [max(cell_len(line) for c in column for line in c.split("\n")) for column in cells]
    words = [max((cell_len(w) for c in column for w in c.split()), default=0) for column in cells]
    least = [m if w else longest for m, w, longest in zip(most, whole, words, strict=True)]
    least[0] = max(min(least[0], NAME), least[0] - max(sum(least) - room, 0))
    wanted = [m - n for m, n in zip(most, least, strict=True)]
    spare = min(room - sum(least), sum(wanted))
    if spare < 0:
        return None
    return [n + spare * w // max(sum(wanted), 1) for n, w in zip(least, wanted, strict=True)]
