"""Commands on campaigns: compare, diagnose, separability, and the demonstration."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from permway.cli.output import (
    Json,
    Outside,
    Scheduler,
    Threads,
    examples,
    print_message,
    print_result,
    progress_bar,
    stage_bar,
)
from permway.errors import InputError

campaigns = typer.Typer(rich_markup_mode=None)


@campaigns.command(
    epilog=examples(
        "permway compare campaign/campaign.toml -o page", "permway compare campaign/campaign.toml --raw-only"
    )
)
def compare(
    campaign: Annotated[Path, typer.Argument(help="Campaign file (TOML).")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Folder for page, numbers, pictures; by default beside the campaign."),
    ] = None,
    raw_only: Annotated[bool, typer.Option("--raw-only", help="With the nominal values only.")] = False,
    allow_outside: Outside = False,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """Predicted against measured, as a page.

    With the nominal values, and recalibrated within the tolerances that the campaign file states.
    """
    from permway.campaign.campaign import read_campaign
    from permway.files import prepare_folder
    from permway.posterior.compare import compare as run
    from permway.report.compare import write_comparison

    described = read_campaign(campaign, allow_outside=allow_outside)
    folder = prepare_folder(output or campaign.parent / "comparison")
    with progress_bar("comparing", as_json) as progress:
        result = run(described, raw_only=raw_only, threads=threads, progress=progress)
    print_result(write_comparison(result, folder), as_json)


@campaigns.command(
    epilog=examples(
        "permway diagnose campaign/campaign.toml -o diagnosis",
        "permway diagnose campaign/campaign.toml --no-report --json",
        "permway diagnose */campaign.toml -o diagnoses --scheduler tcp://cluster:8786",
    )
)
def diagnose(
    campaigns: Annotated[list[Path], typer.Argument(help="Campaign file (TOML), or several.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="Folder for report, verdict and model; by default beside the campaign. Of several campaigns it "
            "gets a folder each, named as theirs.",
        ),
    ] = None,
    rule_out: Annotated[
        list[str] | None,
        typer.Option("--rule-out", metavar="EFFECT", help="Of the catalogue, what cannot be; may be repeated."),
    ] = None,
    no_report: Annotated[bool, typer.Option("--no-report", help="Without report.html.")] = False,
    allow_outside: Outside = False,
    scheduler: Scheduler = None,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """What a model leaves out, where, how surely.

    First states what is probably stated wrongly, as `permway check` does. Then weighs sets of effects against each
    other and against nothing missing, names what is probable enough or states that the records do not decide, and
    says how much better it predicts records that are left out. Writes report.html, verdict.json and amended.toml;
    takes minutes. Of several campaigns those that have been diagnosed are left as they are.
    """
    from permway.campaign.campaign import read_campaign
    from permway.diagnosis.catalogue import known
    from permway.study.diagnoses import diagnose_into

    ruled_out = known(rule_out or ())
    if len(campaigns) > 1 or scheduler is not None:
        if allow_outside:
            raise InputError(
                "is for one campaign on this machine", where="--allow-outside", remedy="diagnose it by itself"
            )
        _many(campaigns, output, ruled_out, not no_report, scheduler, threads, as_json)
        return
    campaign = campaigns[0]
    written = diagnose_into(
        read_campaign(campaign, allow_outside=allow_outside),
        output or campaign.parent / "diagnosis",
        ruled_out=ruled_out,
        page=not no_report,
        threads=threads,
        say=print_message,
        progress=lambda: stage_bar("diagnosing", as_json),
    )
    print_result(written if as_json else _in_words(written), as_json)


def _many(
    campaigns: list[Path],
    output: Path | None,
    ruled_out: Collection[str],
    page: bool,
    scheduler: str | None,
    threads: int | None,
    as_json: bool,
) -> None:
    """Diagnoses of several campaigns, and how many came to their end; status 1 if one did not."""
    from permway.files import prepare_folder
    from permway.study.diagnoses import diagnose_many

    if output is None:
        folders = [campaign.parent / "diagnosis" for campaign in campaigns]
    else:
        folders = [prepare_folder(output) / campaign.resolve().parent.name for campaign in campaigns]
    with stage_bar("diagnosing", as_json) as progress:
        found = diagnose_many(
            campaigns,
            folders,
            ruled_out=ruled_out,
            page=page,
            scheduler=scheduler,
            threads=threads,
            progress=progress,
        )
    failed = [{"folder": name, "error": error} for name, error in found.failed.items()]
    shown = {"diagnosed": len(found.done), "already_there": len(found.already_there), "failed": failed}
    print_result(shown, as_json)
    if failed:
        raise typer.Exit(1)


@campaigns.command(epilog=examples("permway separability campaign/campaign.toml --json"))
def separability(
    campaign: Annotated[Path, typer.Argument(help="Campaign file (TOML).")],
    allow_outside: Outside = False,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """What a campaign's sensors can distinguish.

    Before any record is read: which effects the sensors would confuse, whatever they measure.
    """
    from permway.campaign.campaign import read_campaign
    from permway.diagnosis.separability import separability as run

    described = read_campaign(campaign, allow_outside=allow_outside)
    with stage_bar("separability", as_json) as progress:
        result = run(described, threads=threads, progress=progress)
    print_result(result.summary() if as_json else _in_words(result.summary()), as_json)


@campaigns.command(
    epilog=examples("permway demo", "permway demo -o trial --no-open", "permway demo --json | jq .verdict")
)
def demo(
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder that gets the campaign and its diagnosis.")
    ] = Path("permway-demo"),
    no_open: Annotated[bool, typer.Option("--no-open", help="Do not open the report in a browser.")] = False,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """A whole diagnosis of an embedded campaign.

    Lays a small campaign with something concealed in it into a folder, diagnoses it in under a minute, opens the
    report, and states what was concealed.
    """
    from permway.demo import run

    with stage_bar("demo", as_json) as progress:
        result = run(output, threads=threads, show=not (no_open or as_json), progress=progress)
    print_result(result if as_json else _in_words(result), as_json)


def _in_words(written: Mapping[str, Any]) -> dict[str, Any]:
    """The same for people: effects by what engineers call them, and one time for all stages."""
    from permway.diagnosis.plain_names import name_of

    found = dict(written)
    for key, columns in (("effects", ("name", "effect")), ("inseparable", ("one", "other"))):
        rows = found.get(key, [])
        found[key] = [{k: _name(name_of, v) if k in columns else v for k, v in row.items()} for row in rows]
    if isinstance(found.get("seconds"), Mapping):
        found["seconds"] = round(sum(found["seconds"].values()))
    return {key: value for key, value in found.items() if key in written}


def _name(name_of: Callable[[str], str], identifiers: str) -> str:
    return " or ".join(name_of(one) for one in identifiers.split(" or "))
