"""Commands for levels over one-third octaves: a track's decay rate, and the insertion loss between two models."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from permway.cli.output import Json, Threads, examples, print_result, progress_bar

levels = typer.Typer(rich_markup_mode=None)
Table = Annotated[Path | None, typer.Option("--output", "-o", help="Table (.csv) or dataset (.nc) to write.")]
Plot = Annotated[Path | None, typer.Option(help="Folder for the picture (PNG).")]


@levels.command(
    "decay-rate",
    epilog=examples(
        "permway decay-rate track.toml --at 10.3",
        "permway decay-rate track.toml --at 10.3 --from 250 --to 2500 -o rates.csv --plot pictures",
    ),
)
def decay_rate(
    model: Annotated[Path, typer.Argument(help="Model file (TOML).")],
    at: Annotated[float, typer.Option(help="Place of the accelerometer and of the first blow, m.")],
    output: Table = None,
    plot: Plot = None,
    body: Annotated[str, typer.Option(help="The rail's name.")] = "rail",
    bay: Annotated[float, typer.Option(help="Distance between sleepers, m.")] = 0.6,
    from_Hz: Annotated[float, typer.Option("--from", help="First band, Hz.")] = 100.0,
    to_Hz: Annotated[float, typer.Option("--to", help="Last band, Hz.")] = 5000.0,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """Track decay rate as a test by EN 15461 finds it.

    Vertical, in one-third octaves, by the standard's 29 places of blows, up to 66 bays from the accelerometer.
    """
    from permway.campaign.track_decay import track_decay_rate
    from permway.files import check_output
    from permway.formats.model_file import read_model

    described = read_model(model)
    if output is not None:
        check_output(output, (".csv", ".nc"))
    data = track_decay_rate(
        described.line,
        at_m=at,
        body=body,
        bay_m=bay,
        from_Hz=from_Hz,
        to_Hz=to_Hz,
        temperature_C=described.temperature_C,
        formulation=described.formulation,
        threads=threads,
    )
    result: dict[str, Any] = {
        "floor_dB_per_m": data.attrs["floor_dB_per_m"],
        "bands": [
            {"band_Hz": float(f), "decay_rate_dB_per_m": float(rate), "note": "" if good else "upper bound"}
            for f, rate, good in zip(data["band"], data["decay_rate"], data["suitable"], strict=True)
        ],
    }
    result |= _written(data, output)
    if plot is not None:
        from permway.report.levels import draw_decay_rate

        result["picture"] = str(draw_decay_rate(data, plot))
    print_result(result, as_json)


@levels.command(
    "insertion-loss",
    epilog=examples(
        "permway insertion-loss stiff.toml soft.toml",
        "permway insertion-loss stiff.toml soft.toml -o loss.csv --plot pictures",
    ),
)
def insertion_loss(
    without: Annotated[Path, typer.Argument(help="Model file (TOML) of the reference.")],
    having: Annotated[Path, typer.Argument(metavar="WITH", help="Model file of what has the elastic part.")],
    output: Table = None,
    plot: Plot = None,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """Insertion loss between two models.

    In dB and one-third octaves, positive where the second vibrates less: of acceleration at wheels and sensors
    under the train, or at the sensors under forces of equal power. Both need the same frequencies and names of
    places.
    """
    from permway.files import check_output
    from permway.formats.model_file import read_model
    from permway.problem.solve import solve
    from permway.recordings.insertion_loss import insertion_loss as run

    both = [read_model(path) for path in (without, having)]
    if output is not None:
        check_output(output, (".csv", ".nc"))
    answers = []
    for number, described in enumerate(both, start=1):
        with progress_bar(f"solving {number} of 2", as_json) as progress:
            answers.append(solve(described, threads=threads, progress=progress))
    data = run(*answers)
    loss = data["insertion_loss"].stack(column=[d for d in data["insertion_loss"].dims if d != "band"])
    names = [name if isinstance(name, str) else " / ".join(map(str, name)) for name in loss["column"].values]
    result: dict[str, Any] = {
        "excitation": data.attrs["excitation"],
        "bands": [
            {"band_Hz": float(f), **{n: round(float(v), 2) for n, v in zip(names, row, strict=True)}}
            for f, row in zip(data["band"].values, loss.values, strict=True)
        ],
        "total": {
            n: round(float(v), 2)
            for n, v in zip(names, data["insertion_loss_total"].values.reshape(-1), strict=True)
        },
    }
    result |= _written(data.drop_vars("insertion_loss_total"), output)
    if plot is not None:
        from permway.report.levels import draw_insertion_loss

        result["picture"] = str(draw_insertion_loss(data, plot))
    print_result(result, as_json)


def _written(data: Any, output: Path | None) -> dict[str, str]:
    """Write a table or a dataset if one is wanted, and say where."""
    from permway.problem.solve import write_dataset
    from permway.tables import write_csv

    if output is None:
        return {}
    if output.suffix == ".csv":
        return {"table": str(write_csv(data, output))}
    return {"dataset": str(write_dataset(data, output))}
