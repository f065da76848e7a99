"""`permway import`: a folder as others hand it over, into a campaign."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from permway.cli.output import Folder, Json, examples, print_result

imports = typer.Typer(
    help="Turn a folder as others hand it over into a campaign.", no_args_is_help=True, rich_markup_mode=None
)
Into = Annotated[Path, typer.Option("--output", "-o", help="Folder for campaign.toml and model.toml.")]
Copy = Annotated[bool, typer.Option(help="Copy the records beside the campaign, or refer to where they lie.")]


@imports.command("sheet", epilog=examples("permway import sheet team-folder -o campaign"))
def import_sheet(folder: Folder, output: Into, copy: Copy = True, as_json: Json = False) -> None:
    """A measuring team's sheet.json, hammer FRFs and runs."""
    from permway.campaign.importers.sheet import import_sheet as run

    print_result(run(folder, output, copy=copy).summary(), as_json)


@imports.command("rubber-rig", epilog=examples("permway import rubber-rig folder -o campaigns"))
def import_rubber_rig(
    folder: Folder,
    output: Into,
    copy: Copy = False,
    law: Annotated[
        str,
        typer.Option(help="Form of the law; constant is what a data sheet states, the DMA withheld."),
    ] = "fractional_zener",
    as_json: Json = False,
) -> None:
    """DMA tables and shaker records, a campaign for each rubber."""
    from permway.campaign.importers.rubber_rig import import_rubber_rig as run

    print_result(
        {"campaigns": [campaign.summary() for campaign in run(folder, output, copy=copy, law=law)]}, as_json
    )


@imports.command("pad-materials", epilog=examples("permway import pad-materials folder -o campaigns"))
def import_pad_materials(
    folder: Folder,
    output: Into,
    copy: Copy = False,
    law: Annotated[str, typer.Option(help="Form of the law.")] = "springpot_parallel",
    as_json: Json = False,
) -> None:
    """Moduli of rail pads over frequency, a campaign for each."""
    from permway.campaign.importers.pad_materials import import_pad_materials as run

    print_result(
        {"campaigns": [campaign.summary() for campaign in run(folder, output, copy=copy, law=law)]}, as_json
    )


@imports.command(
    "track-decay", epilog=examples("permway import track-decay folder -o campaign --support continuous")
)
def import_track_decay(
    folder: Folder,
    output: Into,
    copy: Copy = False,
    support: Annotated[str, typer.Option(help="'discrete' or 'continuous'.")] = "discrete",
    as_json: Json = False,
) -> None:
    """Track decay rates in one-third octaves."""
    from permway.campaign.importers.track_decay import import_track_decay as run

    print_result(run(folder, output, copy=copy, support=support).summary(), as_json)
