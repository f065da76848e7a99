"""The command that shows what a file of recordings holds."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from permway.cli.output import Json, examples, print_result
from permway.errors import InputError

looking = typer.Typer(rich_markup_mode=None)


@looking.command(
    epilog=examples(
        "permway look run.csv",
        "permway look logger.csv --header-row 7 --unit 'ax=m/s2'",
        "permway look blows.uff --json | jq .responses",
    )
)
def look(
    file: Annotated[Path, typer.Argument(help="UFF, MAT, CSV, TSV, NPZ, HDF5, NetCDF, TDMS, LVM, MDF or WAV.")],
    header_row: Annotated[int | None, typer.Option(help="Line that names the columns, from 1; 0: none.")] = None,
    skip_rows: Annotated[int | None, typer.Option(help="Lines at the beginning that are no table.")] = None,
    time_column: Annotated[
        str | None, typer.Option(help="What holds the times; 'none' leaves the file's times aside.")
    ] = None,
    decimal: Annotated[str | None, typer.Option(help="Sign before the decimals: . or ,")] = None,
    encoding: Annotated[str | None, typer.Option(help="Character set, as latin-1 or utf-16.")] = None,
    unit: Annotated[
        list[str] | None, typer.Option(help="LABEL=UNIT of a channel or the times, or UNIT of all; repeatable.")
    ] = None,
    sampling_hz: Annotated[float | None, typer.Option("--sampling-Hz", help="Sampling rate, Hz.")] = None,
    pair: Annotated[
        list[str] | None, typer.Option(help="COLUMN=READ/STRUCK of a response in a table; repeatable.")
    ] = None,
    part: Annotated[str | None, typer.Option(help="Group, struct or array of several.")] = None,
    form: Annotated[
        str | None, typer.Option("--format", help="Format; by default determined from the file.")
    ] = None,
    as_json: Json = False,
) -> None:
    """What a file holds, as it is read, and a campaign of it.

    Prints channels with units, rates and lengths, or frequency responses, as they are read here; what is missing;
    and the part of a campaign file to paste. Options have the names of the keys of [[records]].
    """
    from permway.recordings.lab_folder import examine
    from permway.recordings.look import Asked
    from permway.recordings.readers.hints import Hints

    if decimal not in (None, ".", ","):
        raise InputError('must be "." or ","', where="decimal", value=decimal)
    hints = Hints(
        header_row=header_row,
        skip_rows=skip_rows,
        time_column=time_column,
        decimal=decimal,  # type: ignore[arg-type]
        encoding=encoding,
        unit=_units(unit or []),
        pairs=_pairs(pair or []),
    )
    result = examine(file, Asked(form, part, sampling_hz, hints))
    print_result(result if as_json else _shown(result), as_json)


def _units(stated: list[str]) -> str | dict[str, str] | None:
    if len(stated) == 1 and "=" not in stated[0]:
        return stated[0]
    bad = next((text for text in stated if "=" not in text), None)
    if bad is not None:
        raise InputError("one unit for all, or LABEL=UNIT each", where="--unit", value=bad)
    return {label: unit for label, _, unit in (text.rpartition("=") for text in stated)} or None


def _pairs(stated: list[str]) -> dict[str, tuple[str, str]] | None:
    found: dict[str, tuple[str, str]] = {}
    for text in stated:
        column, _, pair = text.rpartition("=")
        read, _, struck = pair.partition("/")
        if not (column and read and struck):
            raise InputError("must be COLUMN=READ/STRUCK", where="--pair", value=text)
        found[column] = (read, struck)
    return found or None


def _shown(result: dict[str, Any]) -> dict[str, Any]:
    """For people: empty entries left out, and the part of the campaign file line by line."""
    shown = {key: value for key, value in result.items() if value not in ("", [], None)}
    if "campaign" in shown:
        shown["campaign"] = ["", *str(shown["campaign"]).splitlines()]
    for row in shown.get("channels", []):
        for key, value in row.items():
            row[key] = "" if value is None else value
    return shown
