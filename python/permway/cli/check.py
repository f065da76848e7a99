"""The commands of a campaign's first minutes: begin one from a folder, and check it before it is diagnosed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from permway.cli.output import Folder, Json, Outside, Threads, examples, print_result

if TYPE_CHECKING:
    from permway.checking.check import Checked

checks = typer.Typer(rich_markup_mode=None)


@checks.command(
    epilog=examples(
        "permway check campaign/campaign.toml",
        "permway check campaign/campaign.toml -o look --json",
        "permway check campaign/campaign.toml --no-picture",
    )
)
def check(
    campaign: Annotated[Path, typer.Argument(help="Campaign file (TOML).")],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Folder for check.png; by default beside the campaign.")
    ] = None,
    no_picture: Annotated[bool, typer.Option("--no-picture", help="Without check.png.")] = False,
    allow_outside: Outside = False,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """What a campaign's records hold, and what is wrong.

    In seconds: what was read, levels and phases against the model as it stands, and blunders before any physics
    (units, signs, labels, noise floors, tolerances), each with what to write in the campaign file. Nothing is
    fitted.
    """
    from permway.campaign.campaign import read_campaign
    from permway.campaign.kinds import kind_of
    from permway.campaign.rolls import how_trains_run
    from permway.checking.check import check as run
    from permway.checking.table import blunder_rows, record_rows
    from permway.checking.unlike import far_off

    checked = run(read_campaign(campaign, allow_outside=allow_outside), threads=threads)
    rows = blunder_rows(checked)
    result: dict[str, Any] = {
        "blunders": rows if as_json else [sentence_of(row) for row in rows],
    }
    far = far_off([(dataset, right) for dataset, _, right in checked.records])
    if far is not None:
        result["levels"] = far
    result["records"] = record_rows(checked)
    missing = {one.record.name: kind_of(one.record).unmeasured(one) for one in checked.reading.whole}
    if any(missing.values()):
        result["not_measured"] = [f"{name}: {_pairs(checked, name, of)}" for name, of in missing.items() if of]
    runs = how_trains_run(checked.campaign.stated, checked.campaign.model)
    if runs is not None:
        result["trains"] = runs
    if checked.reading.left_out:
        result["not_predicted"] = [f"{name}: {why}" for name, why in checked.reading.left_out.items()]
    if not no_picture:
        from permway.report.checking import draw_check

        picture = draw_check(checked, output or campaign.parent / "check")
        if picture is not None:
            result["picture"] = str(picture)
    print_result(result, as_json)
    if not checked.reading.whole:
        # What stops every record is an error of input, which has one status in all commands.
        raise typer.Exit(2)


@checks.command(epilog=examples("permway new exports", "permway new exports --json"))
def new(folder: Folder, as_json: Json = False) -> None:
    """A campaign and a model, started from a folder.

    Looks at every export of the folder (UFF, MAT, CSV, NPZ, HDF5, TDMS, LVM, WAV) as `permway look` does, and
    writes campaign.toml and model.toml into it: every channel, unit, rate and label that was found, and what only
    you know as comments that begin with "question". Nothing is written before everything is read.
    """
    from permway.recordings.skeleton import write_skeleton

    print_result(write_skeleton(folder), as_json)


def _pairs(checked: Checked, name: str, missing: list[str]) -> str:
    """How many pairs of a record are there, and which are not."""
    from permway.recordings.look_campaign import listed

    data = next(one.data for one in checked.reading.whole if one.record.name == name)
    count = data.sizes["sensor"] * data.sizes["force"]
    return f"{count - len(missing)} of {count} pairs; not {listed(missing)}"


def sentence_of(row: dict[str, Any]) -> str:
    """A blunder in one line, for people."""
    sure = "" if row["log_odds"] is None else f" [{odds(row['log_odds'])}]"
    asked = "asked: " if row["asked"] else ""
    return f"{asked}{row['where']}: {row['what']}{sure}; {row['remedy']}"


def odds(log_odds: float) -> str:
    """Odds in words; beyond a million the error model is not to be believed."""
    ratio = 2.718281828 ** min(log_odds, 14.0)
    return "odds above a million to 1" if log_odds > 13.8 else f"odds {ratio:.2g} to 1"
