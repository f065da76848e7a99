"""The command line: a few lines over the Python API for each command."""

from __future__ import annotations

import json
import os
import signal
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer
from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from permway.errors import InputError, PermwayError

_stderr = Console(stderr=True, highlight=False)


class _Commands(typer.core.TyperGroup):
    """The commands; Ctrl-C says so and ends with 130 whatever typer makes of it."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            _tell("interrupted")
            raise typer.Exit(130) from None


def _tell(message: object) -> None:
    _stderr.print(f"permway: {message}", markup=False, soft_wrap=True)


app = typer.Typer(
    name="permway",
    cls=_Commands,
    help="Predicts how a train, its track and the viaduct below vibrate, frequency by frequency.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON, for machines.")]
Threads = Annotated[int | None, typer.Option(min=1, max=1024, help="Threads; by default all processors.")]


@contextmanager
def _progress(title: str, quiet: bool) -> Iterator[Callable[[int, int], None]]:
    """A bar on the terminal; nothing when piped. Within it, and after, Ctrl-C unwinds what is under way."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeRemainingColumn(),
        console=_stderr,
        transient=True,
        disable=quiet or not _stderr.is_terminal,
    ) as bar:
        task = bar.add_task(title, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


@contextmanager
def _stages(title: str, quiet: bool) -> Iterator[Callable[[str, int, int], None]]:
    """A bar that names the stage it is in; of a stage whose length is not known it only shows that it moves."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TimeElapsedColumn(),
        console=_stderr,
        transient=True,
        disable=quiet or not _stderr.is_terminal,
    ) as bar:
        task = bar.add_task(title, total=None)

        def progress(stage: str, done: int, total: int) -> None:
            bar.update(task, description=f"{title}: {stage}", completed=done, total=total or None)

        yield progress


def _say(result: dict[str, Any], as_json: bool) -> None:
    """JSON on one line, or a line for each key; lists of records as columns."""
    if as_json:
        typer.echo(json.dumps(result, allow_nan=False))
        return
    width = max(len(key) for key in result)
    for key, value in result.items():
        first, *others = _lines(value)
        typer.echo(f"{key:<{width}}  {first}".rstrip())
        for line in others:
            typer.echo(f"{'':<{width}}  {line}")


def _lines(value: object) -> list[str]:
    if isinstance(value, dict):
        return [f"{key}: {_text(item)}" for key, item in value.items()]
    if not isinstance(value, list):
        return [_text(value)]
    if not value or not all(isinstance(item, dict) for item in value):
        return [_text(item) for item in value] or ["none"]
    rows = [list(value[0]), *([_text(item.get(key, "")) for key in value[0]] for item in value)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return ["  ".join(f"{cell:<{w}}" for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows]


def _text(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    return ", ".join(_text(item) for item in value) if isinstance(value, list) else str(value)


@app.command()
def solve(
    model: Annotated[Path, typer.Argument(help="Model file (TOML).")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Dataset to write (NetCDF); by default beside the model."),
    ] = None,
    plot: Annotated[Path | None, typer.Option(help="Folder for pictures (PNG).")] = None,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """Receptances, wheel-rail forces and power spectra of a model."""
    from permway.model.file import read_model
    from permway.response.solve import solve as run
    from permway.response.solve import write_dataset

    path = output or model.with_suffix(".nc")
    described = read_model(model)
    # Said before the sweep, not after it.
    if not path.parent.is_dir():
        raise InputError("there is no such folder", where=str(path.parent), remedy="make it first")
    if path.resolve() == model.resolve():
        raise InputError("is the model file itself", where=str(path), remedy="name another file with -o")
    with _progress("solving", as_json) as progress:
        data = run(described, threads=threads, progress=progress)
    result: dict[str, Any] = {
        "dataset": str(write_dataset(data, path)),
        "frequencies": int(data.sizes.get("frequency", data.sizes.get("passby_frequency", 0))),
        "variables": sorted(str(name) for name in data.data_vars),
    }
    if plot is not None:
        from permway.report.response import draw_dataset

        result["pictures"] = [str(p) for p in draw_dataset(data, plot)]
    _say(result, as_json)


@app.command("fit-pad")
def fit_pad(
    dma: Annotated[Path, typer.Argument(help="DMA table (CSV or TSV, units in the header).")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Law to write (TOML).")] = Path("law.toml"),
    law: Annotated[str, typer.Option(help="Form of the law; 'compare' tries several.")] = "compare",
    shift: Annotated[str, typer.Option(help="Shift over temperature: wlf, arrhenius, free, none.")] = "wlf",
    reference: Annotated[float, typer.Option(help="Reference temperature, degrees Celsius.")] = 20.0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the genetic algorithm.")] = 0,
    plot: Annotated[Path | None, typer.Option(help="Folder for pictures (PNG).")] = None,
    as_json: Json = False,
) -> None:
    """Identify a pad's law and its shift over temperature from DMA tests."""
    from permway.laws.fitting import fit_table

    with _progress("identifying", as_json) as progress:
        result = fit_table(
            dma,
            output=output,
            law=law,
            shift=shift,
            reference_temperature_C=reference,
            seed=seed,
            pictures=plot,
            progress=progress,
        )
    _say(result, as_json)


@app.command()
def compare(
    campaign: Annotated[Path, typer.Argument(help="Campaign file (TOML).")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Folder for page, numbers, pictures; by default beside the campaign."),
    ] = None,
    raw_only: Annotated[bool, typer.Option("--raw-only", help="With the owner's values only.")] = False,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """Predicted against measured: with the owner's values, and recalibrated."""
    from permway.diagnosis.compare import compare as run
    from permway.files import prepare_folder
    from permway.recordings.campaign import read_campaign
    from permway.report.compare import write_comparison

    described = read_campaign(campaign)
    folder = prepare_folder(output or campaign.parent / "comparison")
    with _progress("comparing", as_json) as progress:
        result = run(described, raw_only=raw_only, threads=threads, progress=progress)
    _say(write_comparison(result, folder), as_json)


@app.command()
def diagnose(
    campaign: Annotated[Path, typer.Argument(help="Campaign file (TOML).")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", help="Folder for report, verdict and model; by default beside the campaign."
        ),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of simulated campaigns with nothing missing.")] = 0,
    no_report: Annotated[bool, typer.Option("--no-report", help="Without report.html.")] = False,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """What a model leaves out: where, what, how surely, and how much better it fits with it."""
    from permway.diagnosis.diagnose import diagnose as run
    from permway.files import prepare_folder
    from permway.recordings.campaign import read_campaign
    from permway.report.diagnosis import write_diagnosis

    described = read_campaign(campaign)
    folder = prepare_folder(output or campaign.parent / "diagnosis")
    with _stages("diagnosing", as_json) as progress:
        result = run(described, seed=seed, threads=threads, progress=progress)
    _say(write_diagnosis(result, folder, page=not no_report), as_json)


@app.command()
def separability(
    campaign: Annotated[Path, typer.Argument(help="Campaign file (TOML).")],
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """What a campaign's sensors can and cannot tell apart, whatever they read."""
    from permway.diagnosis.separability import separability as run
    from permway.recordings.campaign import read_campaign

    described = read_campaign(campaign)
    with _stages("separability", as_json) as progress:
        result = run(described, threads=threads, progress=progress)
    _say(result.summary(), as_json)


@app.command()
def reproduce(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for report.html and tables.json.")] = Path(
        "permway-paper"
    ),
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """Every figure and table of the paper, printed beside computed."""
    from permway.report.paper import write_report

    with _progress("reproducing", as_json) as progress:
        result = write_report(output, threads=threads, progress=progress)
    _say(result, as_json)


@app.command()
def sweep(
    study: Annotated[Path, typer.Argument(help="Study file (TOML).")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Folder for a file per case; by default beside the study."),
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(help="Address of a Dask scheduler; by default this machine computes.")
    ] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Discard results that lie in the folder.")] = False,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """Many models: a file per case, resumed where it stopped; status 1 if cases failed."""
    from permway.study.file import read_study
    from permway.study.run import run_study

    described = read_study(study)
    with _progress("sweeping", as_json) as progress:
        done = run_study(
            described,
            output or study.with_suffix(".cases"),
            scheduler=scheduler,
            threads=threads,
            fresh=fresh,
            progress=progress,
        )
    failed = [{"case": case, "error": error} for case, error in sorted(done.failed.items())]
    shown = {"folder": str(done.folder), "cases": done.cases, "computed": done.computed}
    _say({**shown, "already_there": done.already_there, "failed": failed}, as_json)
    if failed:
        raise typer.Exit(1)


imports = typer.Typer(
    help="Turn a folder as others hand it over into a campaign.", no_args_is_help=True, rich_markup_mode=None
)
app.add_typer(imports, name="import")

Folder = Annotated[Path, typer.Argument(help="Folder to read.")]
Into = Annotated[Path, typer.Option("--output", "-o", help="Folder for campaign.toml and model.toml.")]
Copy = Annotated[bool, typer.Option(help="Copy the records beside the campaign, or refer to where they lie.")]


@imports.command("sheet")
def import_sheet(folder: Folder, output: Into, copy: Copy = True, as_json: Json = False) -> None:
    """A measuring team's sheet.json, hammer FRFs and runs."""
    from permway.recordings.importers.sheet import import_sheet as run

    _say(run(folder, output, copy=copy).summary(), as_json)


@imports.command("rubber-rig")
def import_rubber_rig(
    folder: Folder,
    output: Into,
    copy: Copy = False,
    law: Annotated[str, typer.Option(help="Form of the law.")] = "fractional_zener",
    as_json: Json = False,
) -> None:
    """DMA tables and shaker records of rubbers: a campaign for each."""
    from permway.recordings.importers.rubber_rig import import_rubber_rig as run

    _say({"campaigns": [campaign.summary() for campaign in run(folder, output, copy=copy, law=law)]}, as_json)


@imports.command("pad-materials")
def import_pad_materials(
    folder: Folder,
    output: Into,
    copy: Copy = False,
    law: Annotated[str, typer.Option(help="Form of the law.")] = "springpot_parallel",
    as_json: Json = False,
) -> None:
    """Moduli of rail pad rubbers over frequency: a campaign for each."""
    from permway.recordings.importers.pad_materials import import_pad_materials as run

    _say({"campaigns": [campaign.summary() for campaign in run(folder, output, copy=copy, law=law)]}, as_json)


@imports.command("track-decay")
def import_track_decay(
    folder: Folder,
    output: Into,
    copy: Copy = False,
    support: Annotated[str, typer.Option(help="'discrete' or 'continuous'.")] = "discrete",
    as_json: Json = False,
) -> None:
    """Track decay rates in one-third octaves."""
    from permway.recordings.importers.track_decay import import_track_decay as run

    _say(run(folder, output, copy=copy, support=support).summary(), as_json)


_challenge = typer.Typer(help="Concealed effects: make campaigns, diagnose them, score the verdicts.")
app.add_typer(_challenge, name="challenge")


@_challenge.command("make")
def challenge_make(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for campaigns and truths.")],
    seed: Annotated[int, typer.Option(min=0, help="Of the first campaign.")] = 1,
    cases: Annotated[int, typer.Option(min=1, help="How many campaigns.")] = 10,
    tier: Annotated[str, typer.Option(help="null, single, twin, multiple, outside or nonlinear.")] = "single",
    as_json: Json = False,
) -> None:
    """Campaigns by finite elements that share no code with the solver, each with something concealed."""
    from permway.challenge.case import TIERS
    from permway.challenge.make import make

    if tier not in TIERS:
        raise InputError("is no tier", where="--tier", value=tier, remedy=f"use one of {list(TIERS)}")
    with _progress("making", as_json) as progress:
        for index in range(cases):
            make(seed + index, 1, tier, output)
            progress(index + 1, cases)
    _say({"folder": str(output), "campaigns": cases}, as_json)


@_challenge.command("run")
def challenge_run(
    folder: Folder,
    workers: Annotated[int, typer.Option(min=1, max=256, help="Campaigns at the same time.")] = 1,
    report: Annotated[bool, typer.Option("--report", help="Write each one's page.")] = False,
    as_json: Json = False,
) -> None:
    """Diagnose every campaign that has no verdict yet."""
    from permway.challenge.run import run

    with _progress("running", as_json) as progress:
        result = run(folder, workers=workers, report=report, progress=progress)
    _say(dict(result), as_json)


@_challenge.command("score")
def challenge_score(folder: Folder, as_json: Json = False) -> None:
    """Hold the verdicts against the truths."""
    from permway.challenge.score import score, summary
    from permway.diagnosis.catalogue import entries

    scored = score(folder, {name: entry.FAMILY for name, entry in entries().items()})
    cases = [
        {"case": s.name, "status": s.status, "truth": ", ".join(s.truth), "said": ", ".join(s.said)}
        for s in scored
    ]
    _say({"tiers": summary(scored), "cases": cases}, as_json)


@app.command()
def doctor(as_json: Json = False) -> None:
    """What machine and versions permway runs with."""
    import platform

    import numpy
    import scipy
    import xarray

    from permway import __version__

    _say(
        {
            "permway": __version__,
            "python": platform.python_version(),
            "machine": f"{platform.system()} {platform.machine()}",
            "processors": os.cpu_count(),
            "numpy": numpy.__version__,
            "scipy": scipy.__version__,
            "xarray": xarray.__version__,
        },
        as_json,
    )


def _version(wanted: bool) -> None:
    if wanted:
        from permway import __version__

        typer.echo(__version__)
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


def _leave(_signal: int, _frame: object) -> None:
    _tell("interrupted")
    os._exit(130)


def main() -> NoReturn:
    """Run the command line: 0 done, 2 bad input, 1 a model that cannot be solved, 130 interrupted."""
    # Until work begins there is nothing to unwind, and libraries may swallow the exception while they load.
    signal.signal(signal.SIGINT, _leave)
    warnings.showwarning = lambda message, *_, **__: _tell(f"note: {message}")
    try:
        app(standalone_mode=True)
    except PermwayError as error:
        _tell(error)
        sys.exit(2 if isinstance(error, InputError) else 1)
    sys.exit(0)
