"""The command line: a few lines over the Python API for each command."""

from __future__ import annotations

import os
import signal
import sys
import warnings
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer

from permway.cli_challenge import challenges
from permway.cli_import import imports
from permway.cli_output import Json, Outside, Threads, progress_bar, say, stage_bar, tell
from permway.errors import InputError, PermwayError


class _Commands(typer.core.TyperGroup):
    """The commands; Ctrl-C says so and ends with 130 whatever typer makes of it."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            tell("interrupted")
            raise typer.Exit(130) from None


app = typer.Typer(
    name="permway",
    cls=_Commands,
    help="Predicts how a train, its track and the viaduct below vibrate, frequency by frequency.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.add_typer(imports, name="import")
app.add_typer(challenges, name="challenge")


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
    with progress_bar("solving", as_json) as progress:
        data = run(described, threads=threads, progress=progress)
    result: dict[str, Any] = {
        "dataset": str(write_dataset(data, path)),
        "frequencies": int(data.sizes.get("frequency", data.sizes.get("passby_frequency", 0))),
        "variables": sorted(str(name) for name in data.data_vars),
    }
    if plot is not None:
        from permway.report.response import draw_dataset

        result["pictures"] = [str(p) for p in draw_dataset(data, plot)]
    say(result, as_json)


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

    with progress_bar("identifying", as_json) as progress:
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
    say(result, as_json)


@app.command()
def compare(
    campaign: Annotated[Path, typer.Argument(help="Campaign file (TOML).")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Folder for page, numbers, pictures; by default beside the campaign."),
    ] = None,
    raw_only: Annotated[bool, typer.Option("--raw-only", help="With the owner's values only.")] = False,
    allow_outside: Outside = False,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """Predicted against measured: with the owner's values, and recalibrated."""
    from permway.diagnosis.compare import compare as run
    from permway.files import prepare_folder
    from permway.recordings.campaign import read_campaign
    from permway.report.compare import write_comparison

    described = read_campaign(campaign, allow_outside=allow_outside)
    folder = prepare_folder(output or campaign.parent / "comparison")
    with progress_bar("comparing", as_json) as progress:
        result = run(described, raw_only=raw_only, threads=threads, progress=progress)
    say(write_comparison(result, folder), as_json)


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
    allow_outside: Outside = False,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """What a model leaves out: where, what, how surely, and how much better it fits with it."""
    from permway.diagnosis.diagnose import diagnose as run
    from permway.files import prepare_folder
    from permway.recordings.campaign import read_campaign
    from permway.report.diagnosis import write_diagnosis

    described = read_campaign(campaign, allow_outside=allow_outside)
    folder = prepare_folder(output or campaign.parent / "diagnosis")
    with stage_bar("diagnosing", as_json) as progress:
        result = run(described, seed=seed, threads=threads, progress=progress)
    say(write_diagnosis(result, folder, page=not no_report), as_json)


@app.command()
def separability(
    campaign: Annotated[Path, typer.Argument(help="Campaign file (TOML).")],
    allow_outside: Outside = False,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """What a campaign's sensors can and cannot tell apart, whatever they read."""
    from permway.diagnosis.separability import separability as run
    from permway.recordings.campaign import read_campaign

    described = read_campaign(campaign, allow_outside=allow_outside)
    with stage_bar("separability", as_json) as progress:
        result = run(described, threads=threads, progress=progress)
    say(result.summary(), as_json)


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

    with progress_bar("reproducing", as_json) as progress:
        result = write_report(output, threads=threads, progress=progress)
    say(result, as_json)


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
    with progress_bar("sweeping", as_json) as progress:
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
    say({**shown, "already_there": done.already_there, "failed": failed}, as_json)
    if failed:
        raise typer.Exit(1)


@app.command()
def doctor(as_json: Json = False) -> None:
    """What machine and versions permway runs with."""
    import platform

    import numpy
    import scipy
    import xarray

    from permway import __version__

    say(
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
    tell("interrupted")
    os._exit(130)


def main() -> NoReturn:
    """Run the command line: 0 done, 2 bad input, 1 a model that cannot be solved, 130 interrupted."""
    # Until work begins there is nothing to unwind, and libraries may swallow the exception while they load.
    signal.signal(signal.SIGINT, _leave)
    warnings.showwarning = lambda message, *_, **__: tell(f"note: {message}")
    try:
        app(standalone_mode=True)
    except PermwayError as error:
        tell(error)
        sys.exit(2 if isinstance(error, InputError) else 1)
    sys.exit(0)
