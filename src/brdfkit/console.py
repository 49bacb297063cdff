"""What the command line prints: tables for people, or JSON; a progress bar on the terminal."""

import json
import time
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import cached_property

# A bar that appears for a blink is noise
PATIENCE = 1.0


@dataclass(frozen=True)
class Console:
    """Prints results; `as_json`: as JSON, for programs; `quiet`: nothing at all."""

    as_json: bool = False
    quiet: bool = False

    @cached_property
    def out(self):
        from rich.console import Console

        return Console(quiet=self.quiet, highlight=False, soft_wrap=True)

    @contextmanager
    def progress(self, what):
        """A callback (done, total) that shows a bar with the time left, after a second."""
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

        terminal = Console(stderr=True)
        columns = TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn(compact=True)
        bar = Progress(*columns, console=terminal, transient=True, disable=self.quiet)
        task = bar.add_task(what, total=None)
        began = time.monotonic()

        def report(done, total):
            bar.update(task, completed=done, total=total)
            if terminal.is_terminal and time.monotonic() - began > PATIENCE:
                bar.start()

        try:
            yield report
        finally:
            if bar.live.is_started:  # stopping an unstarted bar prints an empty line
                bar.stop()

    def json(self, record):
        if not self.quiet:
            print(json.dumps(record, indent=2, default=str))

    def table(self, *columns, title=None):
        from rich.box import SIMPLE_HEAD
        from rich.markup import escape
        from rich.table import Table

        table = Table(box=SIMPLE_HEAD, title=title, title_justify="left", pad_edge=False)
        for column in columns:
            side = "right" if column.startswith(">") else "left"
            table.add_column(escape(column.removeprefix(">")), justify=side)
        return table

    def models(self, models):
        """The list of models."""
        if self.as_json:
            return self.json({name: _parameters(model) for name, model in models.items()})
        table = self.table("model", "what it is", "parameters")
        for name, model in models.items():
            table.add_row(name, _page(model)[0].partition(": ")[2], ", ".join(model.parameters))
        self.out.print(table)
        self.out.print("One model's page: brdfkit models NAME")
        return None

    def model(self, model):
        """The page of one model."""
        if self.as_json:
            return self.json({model.type_name(): _parameters(model)})
        from rich.markup import escape

        self.out.print(escape("\n".join(_page(model))))
        table = self.table("parameter", ">default", ">from", ">to", "meaning")
        for name, p in model.parameters.items():
            low, high = (f"{v:g}" if v < float("inf") else "" for v in p.bounds)
            default = p.follows or f"{p.default:g}"
            per_channel = " (per channel)" if p.linear else ""
            table.add_row(name, default, low, high, p.meaning + per_channel)
        self.out.print(table)
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

    def measured(self, data):
        """What is in a measured material."""
        record = _summary(data)
        if self.as_json:
            return self.json(record)
        self.out.print(f"[bold]{data.name}[/bold]")
        table = self.table("", "")
        table.show_header = False
        for key, value in record.items():
            if key != "name":
                table.add_row(key.replace("_", " "), str(value))
        self.out.print(table)
        return None

    def fits(self, material, fits, comparison, psnr, written):
        """The fits, best first."""
        if self.as_json:
            return self.json(
                {
                    "material": material.name,
                    "fits": [_fit_record(f, comparison, psnr) for f in fits],
                    "written": [str(path) for path in written],
                }
            )
        for found in fits:
            self.out.print(str(found), markup=False)
            self.out.print()
        extra = [">PSNR [dB]"] if psnr else []
        losses = list(next(iter(comparison.errors.values())))
        table = self.table(
            "model",
            *(f">{n}" for n in losses),
            *extra,
            ">time [s]",
            title=f"{material.name}: errors",
        )
        for found in fits:
            errors = [f"{e:.5f}" for e in comparison.errors[found.name].values()]
            image = [f"{psnr[found.name]:.1f}"] if psnr else []
            table.add_row(found.name, *errors, *image, f"{found.seconds:.2f}")
        self.out.print(table)
        self.written(written)
        return None

    def rendering(self, picture, path):
        """What was rendered, and where it is."""
        written = [path, path.with_suffix(".png")] if path.suffix == ".exr" else [path]
        if self.as_json:
            return self.json(
                {
                    "pictures": list(picture.pictures),
                    "psnr": picture.psnr(),
                    "spp": picture.spp,
                    "seconds": picture.seconds,
                    "written": [str(p) for p in written],
                }
            )
        self.out.print(str(picture), markup=False)
        self.written(written)
        return None

    def reports(self, reports):
        """What the checks found."""
        if self.as_json:
            return self.json(
                [
                    {"name": r.name, "passed": bool(r), "findings": [asdict(f) for f in r.findings]}
                    for r in reports
                ]
            )
        for report in reports:
            self.out.print(str(report), markup=False)
        return None

    def written(self, paths):
        for path in paths:
            self.out.print(f"written: {path}", markup=False)


def _page(model):
    import inspect
    import sys

    return inspect.cleandoc(sys.modules[model.__module__].__doc__ or model.__name__).splitlines()


def _parameters(model):
    return {
        name: {
            "default": p.default,
            "bounds": [None if abs(b) == float("inf") else b for b in p.bounds],
            "follows": p.follows,
            "linear": p.linear,
            "meaning": p.meaning,
        }
        for name, p in model.parameters.items()
    }


def _summary(data):
    import numpy as np

    samples = data.samples
    valid = samples.values[samples.valid]
    cosines = np.minimum(samples.wi[samples.valid, 2], samples.wo[samples.valid, 2])
    kind = "×".join(map(str, data.table.shape)) + " table" if data.is_table else "samples"
    channels = " ".join(data.channels)
    if len(data.channels) > 5:
        channels = f"{len(data.channels)} wavelengths, {data.channels[0]} to {data.channels[-1]}"
    return {
        "name": data.name,
        "kind": kind,
        "channels": channels,
        "valid": f"{samples.valid.sum():,} of {len(samples.valid):,}",
        "negative": f"{(valid < 0).any(axis=1).mean():.2%} of the valid",
        "BRDF": f"{valid.min():.4g} to {valid.max():.4g}, median {np.median(valid):.4g} sr⁻¹",
        "angles": f"to {np.degrees(np.arccos(cosines.min())):.1f}°",
        **data.info,
    }


def _fit_record(fit, comparison, psnr):
    return {
        "model": fit.name,
        "parameters": fit.parameters,
        "loss": fit.loss_name,
        "error": fit.loss,
        "errors": comparison.errors[fit.name],
        "psnr": psnr.get(fit.name),
        "at_bounds": fit.at_bounds,
        "evaluations": fit.evaluations,
        "samples": fit.samples,
        "seconds": fit.seconds,
        "message": fit.message,
    }
