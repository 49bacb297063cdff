"""What the command line prints: tables for people, or JSON; a progress bar on the terminal."""

import inspect
import json
import math
import sys
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import cached_property
from threading import Timer

from brdfkit import records

# A bar that appears for a blink is noise
PATIENCE = 1.0  # seconds


@dataclass(frozen=True)
class Console:
    """Prints results; `as_json`: as JSON, for programs; `quiet`: nothing at all."""

    as_json: bool = False
    quiet: bool = False

    @cached_property
    def out(self):
        from rich.console import Console

        # no markup: a name from a file may hold brackets
        return Console(quiet=self.quiet, highlight=False, markup=False, emoji=False, soft_wrap=True)

    @contextmanager
    def progress(self, what):
        """A callback (done, total) behind a bar with the time left, which shows after a second.

        The bar waits in a thread of its own, so that it shows before the first call, too.
        """
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

        terminal = Console(stderr=True)
        text = TextColumn("{task.description}", markup=False)
        columns = text, BarColumn(), TimeRemainingColumn(compact=True)
        bar = Progress(*columns, console=terminal, transient=True)
        task = bar.add_task(what, total=None)
        patience = Timer(PATIENCE, bar.start)
        patience.daemon = True
        if terminal.is_terminal and not self.quiet:
            patience.start()
        try:
            yield lambda done, total: bar.update(task, completed=done, total=total)
        finally:
            patience.cancel()
            if patience.ident:
                patience.join()
            if bar.live.is_started:  # stopping an unstarted bar prints an empty line
                bar.stop()

    def json(self, record):
        if not self.quiet:
            print(json.dumps(records.plain(record), indent=2))

    def table(self, *columns, title=None):
        """An empty table; a column whose name begins with ">" is flush right."""
        from rich.box import SIMPLE_HEAD
        from rich.table import Table
        from rich.text import Text

        title = title and Text(title)
        table = Table(box=SIMPLE_HEAD, title=title, title_justify="left", pad_edge=False)
        for column in columns:
            side = "right" if column.startswith(">") else "left"
            name = Text(column.removeprefix(">"))
            table.add_column(name, justify=side, no_wrap=not table.columns)
        return table

    def models(self, models):
        """The list of models."""
        if self.as_json:
            return self.json({name: records.parameters(model) for name, model in models.items()})
        table = self.table("model", "what it is", "parameters")
        for name, model in models.items():
            table.add_row(name, _page(model)[0].partition(": ")[2], ", ".join(model.parameters))
        self.out.print(table)
        self.out.print("One model's page: brdfkit models NAME")
        return None

    def model(self, model):
        """The page of one model."""
        if self.as_json:
            return self.json({model.type_name(): records.parameters(model)})
        self.out.print("\n".join(_page(model)))
        table = self.table("parameter", ">default", ">from", ">to", "meaning")
        for name, p in model.parameters.items():
            low, high = ("" if math.isinf(v) else f"{v:g}" for v in p.bounds)
            default = p.follows or f"{p.default:g}"
            per_channel = " (per channel)" if p.linear else ""
            table.add_row(name, default, low, high, p.meaning + per_channel)
        self.out.print(table)
        if model.options:
            table = self.table("option", "default", "choices", "meaning")
            for name, o in model.options.items():
                table.add_row(name, str(o.default), records.choices(o), o.meaning)
            self.out.print(table)
            example = records.example(model, next(iter(model.options)))
            self.out.print(f"With another choice: brdfkit fit FILE -m {example}")
        self.out.print(
            f'Mitsuba: {{"type": "{model.type_name()}", ...}}; every parameter may be a texture.'
        )
        return None

    def materials(self, materials):
        """The materials that brdfkit brings."""
        if self.as_json:
            return self.json({name: asdict(m) for name, m in materials.items()})
        table = self.table("material", "what it is", "licence")
        for name, m in materials.items():
            table.add_row(name, m.title, m.licence)
        self.out.print(table)
        self.out.print("Use a name where a file is asked for: brdfkit fit NAME")
        return None

    def collections(self, collections, materials, folder):
        """The public collections, behind the `materials` that come with brdfkit."""
        if self.as_json:
            return self.json({name: records.collection(c) for name, c in collections.items()})
        table = self.table("collection", "what it is", ">here", ">to download", "licence")
        licence = next(iter(materials.values())).licence
        table.add_row("brdfkit's own", ", ".join(materials), str(len(materials)), "", licence)
        for name, c in collections.items():
            download = sum(bool(listed.url) for listed in c.files.values())
            table.add_row(name, c.title, str(len(c.here())), str(download or "by hand"), c.licence)
        self.out.print(table)
        self.out.print("The materials of a collection: brdfkit data list NAME")
        self.out.print(f"Downloaded files lie in {folder}")
        return None

    def collection(self, collection):
        """The materials of a collection."""
        if self.as_json:
            return self.json(records.collection(collection))
        files, here = collection.files, collection.here()
        table = self.table("material", ">size [MB]", "")
        for name in sorted({*files, *here}):
            size = files[name].bytes if name in files else here[name].stat().st_size
            state = "here" if name in here else "to download" if files[name].url else "by hand"
            table.add_row(name, f"{size / 1e6:.1f}" if size else "", state)
        if table.rows:
            self.out.print(table)
        self.out.print(str(collection))
        if not any(listed.url for listed in files.values()):
            self.out.print(f"To use one, {collection.by_hand()}.")
        return None

    def downloaded(self, files, collections):
        """Where the files are, and the terms of those who published them."""
        if self.as_json:
            return self.json({"files": files, "terms": {c.name: c.terms for c in collections}})
        for name, file in files.items():
            self.out.print(f"{name}: {file}")
        for collection in collections:
            self.out.print(str(collection))
        return None

    def audit(self, found, written):
        """What is in a measured material, and what is doubtful."""
        if self.as_json:
            return self.json(records.audit(found, written))
        table = self.table("", "")
        table.show_header = False
        for key, value in found.rows().items():
            table.add_row(key, value)
        table.add_section()
        for key, value in found.data.info.items():
            table.add_row(key.replace("_", " "), str(value))
        self.out.print(found.name, style="bold")
        self.out.print(table)
        for finding in found.findings():
            self.out.print(f"! {finding}")
        self.written(written)
        return None

    def fits(self, material, fits, comparison, psnr, written):
        """The fits, best first."""
        if self.as_json:
            return self.json(
                {
                    "material": material.name,
                    "fits": [records.fit(f, comparison, psnr) for f in fits],
                    "written": written,
                }
            )
        for found in fits:
            self.out.print(str(found))
            self.out.print()
        losses = [f">{name}" for name in next(iter(comparison.errors.values()))]
        image = [">PSNR [dB]"] if psnr else []
        title = f"{material.name}: errors"
        table = self.table("model", *losses, *image, ">time [s]", title=title)
        for found in fits:
            errors = [f"{e:.5f}" for e in comparison.errors[found.name].values()]
            image = [f"{psnr[found.name]:.1f}"] if psnr else []
            table.add_row(found.name, *errors, *image, f"{found.seconds:.2f}")
        self.out.print(table)
        self.written(written)
        return None

    def rendering(self, picture, path):
        """What was rendered, and where it is."""
        written = [path]
        if path.suffix.lower() == ".exr":
            written += [path.with_suffix(".png")]
        if self.as_json:
            return self.json(
                {
                    "pictures": list(picture.pictures),
                    "psnr": picture.psnr(),
                    "spp": picture.spp,
                    "seconds": picture.seconds,
                    "written": written,
                }
            )
        self.out.print(str(picture))
        self.written(written)
        return None

    def reports(self, reports):
        """What the checks found."""
        if self.as_json:
            return self.json([records.report(report) for report in reports])
        for report in reports:
            self.out.print(str(report))
        return None

    def conversion(self, done):
        """What was written, and what that changed."""
        if self.as_json:
            return self.json({"written": done.path, "changes": done.changes})
        self.out.print(f"written: {done}")
        return None

    def written(self, paths):
        for path in paths:
            self.out.print(f"written: {path}")


def _page(model):
    """The lines of a model's page: its file's docstring."""
    return inspect.cleandoc(sys.modules[model.__module__].__doc__ or model.__name__).splitlines()
