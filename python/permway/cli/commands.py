"""The command line: a few lines over the Python API for each command."""

from __future__ import annotations

import os
import signal
import sys
import warnings
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer

from permway.cli.campaign import campaigns
from permway.cli.challenge import challenges
from permway.cli.check import checks
from permway.cli.imports import imports
from permway.cli.levels import levels
from permway.cli.look import looking
from permway.cli.modes import shapes
from permway.cli.output import Json, Scheduler, Threads, examples, print_message, print_result, progress_bar
from permway.cli.track import tracks
from permway.errors import InputError, PermwayError


class _Commands(typer.core.TyperGroup):
    """The commands; Ctrl-C says so and ends with 130 whatever typer makes of it."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            print_message("interrupted")
            raise typer.Exit(130) from None


EPILOG = """\b
Exit status:
  0    done
  1    a model that cannot be solved, or cases of a sweep that failed
  2    wrong input or usage: one line on stderr states what, where, and what to do
  130  interrupted

\b
Each command has --help with examples, and --json for machines.
Completion by the shell: permway --install-completion"""

app = typer.Typer(
    name="permway",
    cls=_Commands,
    help="Predicts how a train, its track and the viaduct below vibrate vertically, frequency by frequency, "
    "holds that against recordings, and states what physics is missing. Begin with: permway demo",
    epilog=EPILOG,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.add_typer(looking)
app.add_typer(checks)
app.add_typer(campaigns)
app.add_typer(shapes)
app.add_typer(levels)
app.add_typer(tracks)
app.add_typer(imports, name="import")
app.add_typer(challenges, name="challenge")


@app.command(
    epilog=examples(
        "permway solve model.toml",
        "permway solve model.toml -o answer.nc --plot pictures",
        "permway solve model.toml --json | jq .dataset",
    )
)
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
    """Receptances, forces and spectra of a model.

    The model file states bodies, joints and laws in SI units, and what is wanted: [[forces]] and [[sensors]] give
    receptances, [train] and [irregularity] wheel-rail forces and power spectra, [passby] the train's run in time.
    """
    from permway.formats.model_file import read_model
    from permway.problem.solve import solve as run
    from permway.problem.solve import write_dataset

    path = output or model.with_suffix(".nc")
    described = read_model(model)
    # Stated before the sweep, not after it.
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
    print_result(result, as_json)


@app.command(
    "fit-pad",
    epilog=examples(
        "permway fit-pad dma.csv -o law.toml --plot pictures",
        "permway fit-pad dma.csv --law fractional_zener --shift none",
        "permway fit-pad sweep.csv --frequency 2",
        "permway fit-pad stiffness.csv --shape-factor 1.84",
    ),
)
def fit_pad(
    dma: Annotated[Path, typer.Argument(help="DMA table (text: CSV, TSV).")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Law to write (TOML).")] = Path("law.toml"),
    law: Annotated[str, typer.Option(help="Form of the law; 'compare' tries several.")] = "compare",
    shift: Annotated[
        str,
        typer.Option(
            help="Shift over temperature: wlf, arrhenius, wlf_arrhenius (Arrhenius in the glass), free, none; "
            "'compare' tries the first three."
        ),
    ] = "wlf",
    reference: Annotated[
        float | None,
        typer.Option(
            help="Temperature for which the law's parameters are written, degrees Celsius; by default 20, or the "
            "table's nearest. What the law states at any temperature does not depend on it."
        ),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the genetic algorithm.")] = 0,
    plot: Annotated[Path | None, typer.Option(help="Folder for pictures (PNG).")] = None,
    frequency: Annotated[
        float | None, typer.Option(help="Frequency of a temperature sweep without such a column, Hz.")
    ] = None,
    temperature: Annotated[
        float | None, typer.Option(help="Temperature of a frequency sweep without such a column, degrees Celsius.")
    ] = None,
    decimal: Annotated[
        str | None, typer.Option(help='Decimal sign, "." or ",", where cells leave it open.')
    ] = None,
    shape_factor: Annotated[
        float | None,
        typer.Option(help="Stiffness of the part over modulus, e A / h in m: makes a modulus of a stiffness."),
    ] = None,
    as_json: Json = False,
) -> None:
    """A pad's law and its shift from DMA tests.

    The table has a row for each test: frequency; temperature; storage modulus (Pa) or stiffness (N/m) with loss
    modulus, loss factor or phase, or absolute value and phase; units in the header or in a row below it. The law
    is written as a file that a model can name: of a modulus for a law of type "pad", of a stiffness as it is.
    """
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
            frequency_Hz=frequency,
            temperature_C=temperature,
            decimal=decimal,
            shape_factor_m=shape_factor,
            progress=progress,
        )
    print_result(result, as_json)


@app.command(epilog=examples("permway reproduce -o paper --threads 2"))
def reproduce(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for report.html and tables.json.")] = Path(
        "permway-paper"
    ),
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """The paper's figures and tables, recomputed.

    Writes report.html and tables.json, in which every printed number stands beside the computed one. About half a
    minute on two processors.
    """
    from permway.paper.report import write_report

    with progress_bar("reproducing", as_json) as progress:
        result = write_report(output, threads=threads, progress=progress)
    print_result(result, as_json)


@app.command(
    epilog=examples(
        "permway sweep study.toml -o results",
        "permway sweep study.toml -o results --scheduler tcp://cluster:8786",
        "permway sweep study.toml -o results --fresh",
    )
)
def sweep(
    study: Annotated[Path, typer.Argument(help="Study file (TOML).")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Folder for a file per case; by default beside the study."),
    ] = None,
    scheduler: Scheduler = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Discard results that lie in the folder.")] = False,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """Many models: a file per case, resumable.

    Killed or interrupted at any time, the same command goes on where it stopped: finished cases lie there whole.
    Status 1 if cases failed.
    """
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
    print_result({**shown, "already_there": done.already_there, "failed": failed}, as_json)
    if failed:
        raise typer.Exit(1)


@app.command(epilog=examples("permway doctor", "permway doctor --json | jq .vectors", "permway doctor --bench"))
def doctor(
    bench: Annotated[
        bool, typer.Option("--bench", help="Also time three lines and a small diagnosis: some 20 seconds.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Machine, versions, and whether the core works.

    Holds the core's answer for a mass on a spring against the closed form; status 1 if it is wrong. With --bench
    also how fast this machine is, and one number to compare machines by, the score: the cores of a reference that
    it is worth. Other programs should rest meanwhile.
    """
    from permway.cli.machine import account

    result = account()
    if bench and result["self_test"] == "passed":
        from permway.cli.bench import bench as measure

        with progress_bar("measuring", as_json):
            result |= measure()
    print_result(result, as_json)
    if result["self_test"] != "passed":
        raise typer.Exit(1)


def _version(wanted: bool) -> None:
    if wanted:
        from permway._core import __version__

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
    print_message("interrupted")
    os._exit(130)


def main() -> NoReturn:
    """Run the command line: 0 done, 2 bad input, 1 a model that cannot be solved, 130 interrupted."""
    # Until work begins there is nothing to unwind, and libraries may swallow the exception while they load.
    signal.signal(signal.SIGINT, _leave)
    warnings.showwarning = lambda message, *_, **__: print_message(f"note: {message}")
    try:
        app(standalone_mode=True, prog_name="permway")
    except PermwayError as error:
        print_message(error)
        sys.exit(2 if isinstance(error, InputError) else 1)
    sys.exit(0)
