"""Commands that show how a model moves: its modes, and its operating deflection shapes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from permway.cli.output import Json, Threads, examples, print_result
from permway.errors import InputError
from permway.model.place import Place

shapes = typer.Typer(rich_markup_mode=None)


@shapes.command(
    epilog=examples(
        "permway modes model.toml --from 2 --to 60 --plot pictures",
        "permway modes model.toml --to 60 -o modes.csv",
        "permway modes model.toml --to 60 --json | jq '.modes[0].frequency_Hz'",
    )
)
def modes(
    model: Annotated[Path, typer.Argument(help="Model file (TOML).")],
    from_Hz: Annotated[
        float | None, typer.Option("--from", help="Lowest frequency, Hz; by default the model's.")
    ] = None,
    to_Hz: Annotated[
        float | None, typer.Option("--to", help="Highest frequency, Hz; by default the model's.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Table (.csv), or all with complex shapes (.nc).")
    ] = None,
    plot: Annotated[Path | None, typer.Option(help="Folder for pictures of the shapes (PNG).")] = None,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """Natural frequencies, damping and mode shapes.

    Of the line without its train; of a model with [roll] those in which both rails move alike. Modes are poles of
    the response, not peaks: modes that overlap stay apart. Where they overlap too much for that, it is stated.
    """
    from permway.files import check_output
    from permway.formats.model_file import read_model
    from permway.problem.solve import write_dataset
    from permway.response.modes import modes as run
    from permway.tables import write_csv

    described = read_model(model)
    if output is not None:
        check_output(output, (".csv", ".nc"))
    band = described.frequencies.array()
    data = run(
        described.line,
        float(band[0]) if from_Hz is None else from_Hz,
        float(band[-1]) if to_Hz is None else to_Hz,
        temperature_C=described.temperature_C,
        formulation=described.formulation,
        threads=threads,
    )
    listed = ("natural_frequency", "damping_ratio", "modal_mass")
    result: dict[str, Any] = {
        "band_Hz": data.attrs["band_Hz"],
        "modes": [
            {
                "mode": int(one["mode"]),
                "frequency_Hz": float(one["natural_frequency"]),
                "damping_ratio": float(one["damping_ratio"]),
                "modal_mass_kg": float(one["modal_mass"]) if one["modal_mass"].notnull() else None,
                "moves_most": str(one["place"].values[abs(one["shape"].values).argmax()]),
            }
            for one in (data.isel(mode=i) for i in range(data.sizes["mode"]))
        ],
        "notes": _notes(data.attrs["unsettled_Hz"], described.train is not None, described.roll is not None),
    }
    if output is not None and output.suffix == ".csv":
        result["table"] = str(write_csv(data[list(listed)], output))
    elif output is not None:
        result["dataset"] = str(write_dataset(data, output))
    if plot is not None:
        from permway.report.modes import draw_modes

        result["pictures"] = [str(path) for path in draw_modes(data, plot)]
    print_result(result, as_json)


@shapes.command(
    "operating-shapes",
    epilog=examples(
        "permway operating-shapes model.toml --at 31.5",
        "permway operating-shapes model.toml --at 31.5 --at 63 --force hit -o shapes.html",
        "permway operating-shapes model.toml --at 31.5 -o shapes.nc",
    ),
)
def operating(
    model: Annotated[Path, typer.Argument(help="Model file (TOML).")],
    at_Hz: Annotated[list[float], typer.Option("--at", help="Frequency, Hz; may be repeated.")],
    force: Annotated[
        list[str] | None,
        typer.Option(help="Name of one of the model's [[forces]]; may be repeated. By default the first."),
    ] = None,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Page with the shapes in motion (.html), or dataset (.nc).")
    ] = Path("shapes.html"),
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """Operating deflection shapes, in motion on a page.

    How all bodies move at a frequency while 1 N acts. Of the line without its train; of a model with [roll] as if
    both rails moved alike. Bodies and joints are drawn, enlarged.
    """
    from permway.files import check_output
    from permway.formats.model_file import read_model
    from permway.problem.solve import write_dataset
    from permway.report.operating import animate_shapes
    from permway.response.operating import greatest_deg, operating_shapes

    described = read_model(model)
    check_output(output, (".html", ".nc"))
    data = operating_shapes(
        described.line,
        sorted(set(at_Hz)),
        forces=_chosen(described.forces, force),
        temperature_C=described.temperature_C,
        formulation=described.formulation,
        threads=threads,
    )
    rows = []
    for one in (
        data.isel(frequency=i, force=j) for i in range(data.frequency.size) for j in range(data.force.size)
    ):
        size = abs(one["shape"].values)
        rows.append(
            {
                "frequency_Hz": float(one["frequency"]),
                "force": str(one["force"].item()),
                "moves_most": str(one["place"].values[size.argmax()]),
                "greatest_m_per_N": float(size.max()),
                "after_force_deg": greatest_deg(one["shape"].values),
            }
        )
    result: dict[str, Any] = {"shapes": rows}
    if output.suffix == ".nc":
        result["dataset"] = str(write_dataset(data, output))
    else:
        result["page"] = str(animate_shapes(data, described.line, output, title=described.title or model.stem))
    print_result(result, as_json)


def _chosen(forces: Sequence[Place], names: list[str] | None) -> list[Place]:
    """Forces of a model by name, the first without."""
    if not forces:
        raise InputError("the model has no force", where="forces", remedy="add a [[forces]] with body and x_m")
    if not names:
        return [forces[0]]
    known = {place.label: place for place in forces}
    for name in names:
        if name not in known:
            raise InputError(
                "is no force of the model", where="--force", value=name, remedy=f"one of {list(known)}"
            )
    return [known[name] for name in dict.fromkeys(names)]


def _notes(unsettled_Hz: list[float], train: bool, roll: bool) -> list[str]:
    notes = []
    if unsettled_Hz:
        notes.append(
            f"left out: {len(unsettled_Hz)} more between {min(unsettled_Hz):.4g} and {max(unsettled_Hz):.4g} Hz, "
            "which overlap so much that the response does not distinguishes them"
        )
    if train:
        notes.append("without the train")
    if roll:
        notes.append("both rails alike: what rolls is left out")
    return notes
