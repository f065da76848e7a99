"""`permway challenge`: concealed effects, made, diagnosed and scored."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from permway.cli.output import Folder, Json, Scheduler, examples, over, print_result, progress_bar, stage_bar
from permway.errors import InputError

if TYPE_CHECKING:
    from permway.challenge.follow import Advice
    from permway.challenge.suite import Spread

challenges = typer.Typer(
    help="Concealed effects: make, diagnose, score.",
    no_args_is_help=True,
    rich_markup_mode=None,
)


@challenges.command("make", epilog=examples("permway challenge make -o cases --tier single --cases 20"))
def challenge_make(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for campaigns and truths.")],
    seed: Annotated[int, typer.Option(min=0, help="Of the first campaign.")] = 1,
    cases: Annotated[int, typer.Option(min=1, help="How many campaigns.")] = 10,
    tier: Annotated[
        str,
        typer.Option(
            help="null, single, twin, multiple, outside, nonlinear, graded, sparse, running; "
            "small, fixture, passages."
        ),
    ] = "single",
    as_json: Json = False,
) -> None:
    """Campaigns with something concealed in each.

    Made by finite elements that share no code with the solver. The truths lie in a folder of their own. Graded
    effects are faded until the records hardly constrain them, which takes a minute each; trains that run are
    integrated in time, which takes ten. Small ones are drawn whole, layout and all, from `--seed` and a number
    from 0 on, and take a fraction of a second; half are made by the tool's own model.
    """
    from permway.challenge.case import TIERS
    from permway.challenge.make import make
    from permway.challenge.small.suite import TIERS as SMALL_TIERS
    from permway.challenge.small.suite import made, names_of
    from permway.posterior.deviance import against_folder

    if tier in SMALL_TIERS:
        with progress_bar("making", as_json) as progress:
            names = names_of([tier], seed, cases)
            for index, name in enumerate(names):
                made(output, name)
                progress(index + 1, len(names))
        print_result({"folder": str(output), "campaigns": len(names)}, as_json)
        return
    if tier not in TIERS:
        remedy = f"use one of {[*TIERS, *SMALL_TIERS]}"
        raise InputError("is no tier", where="--tier", value=tier, remedy=remedy)
    with progress_bar("making", as_json) as progress:
        for index in range(cases):
            make(seed + index, 1, tier, output, against=against_folder)
            progress(index + 1, cases)
    print_result({"folder": str(output), "campaigns": cases}, as_json)


@challenges.command("run", epilog=examples("permway challenge run cases --workers 2"))
def challenge_run(
    folder: Folder,
    workers: Annotated[int, typer.Option(min=1, max=256, help="Campaigns at the same time.")] = 1,
    report: Annotated[bool, typer.Option("--report", help="Write each one's page.")] = False,
    as_json: Json = False,
) -> None:
    """Diagnose every campaign that has no verdict yet."""
    from permway.challenge.run import run

    with progress_bar("running", as_json) as progress:
        result = run(folder, workers=workers, report=report, progress=progress)
    print_result(dict(result), as_json)


@challenges.command("weigh", epilog=examples("permway challenge weigh cases --workers 2"))
def challenge_weigh(
    folder: Folder,
    workers: Annotated[int, typer.Option(min=1, max=256, help="Campaigns at the same time.")] = 1,
    as_json: Json = False,
) -> None:
    """How hard each campaign is, by its deviance.

    The deviance that no recalibration takes away, against a control with the same parameters, noise and errors,
    and nothing concealed. Easy above 200, medium above 50, hard above 15; below, the right answer is that the
    records leave it open.
    """
    from permway.challenge.weigh import weigh
    from permway.posterior.deviance import against_folder

    with progress_bar("weighing", as_json) as progress:
        found = weigh(folder, against_folder, workers=workers, progress=progress)
    print_result({"deviance": found} if as_json else {k: round(v, 1) for k, v in found.items()}, as_json)


@challenges.command("score", epilog=examples("permway challenge score cases --json"))
def challenge_score(folder: Folder, as_json: Json = False) -> None:
    """Hold the verdicts against the truths."""
    print_result(_scores(folder), as_json)


@challenges.command("follow", epilog=examples("permway challenge follow cases --workers 2"))
def challenge_follow(
    folder: Folder,
    workers: Annotated[int, typer.Option(min=1, max=256, help="Campaigns at the same time.")] = 1,
    as_json: Json = False,
) -> None:
    """Measure what verdicts advise, and diagnose again.

    Of campaigns that were run: whether the rivals are distinguished then. The new ones lie in the folder's
    `followed`, a challenge of its own.
    """
    from dataclasses import asdict

    from permway.challenge.follow import FOLLOWED, follow, separated
    from permway.challenge.run import run
    from permway.challenge.summary import share

    follow(folder, _asked_for)
    with progress_bar("running", as_json) as progress:
        result = run(folder / FOLLOWED, workers=workers, progress=progress)
    found = separated(folder)
    shares = {
        "apart": share([one.apart for one in found]),
        "right": share([one.right for one in found if one.apart and one.right is not None]),
    }
    cases = [asdict(one) for one in found]
    print_result({**result, **shares, **({"cases": cases} if as_json else {})}, as_json)


def _asked_for(campaign: Path, words: str) -> Advice:
    """What a verdict's words ask to measure."""
    from permway.campaign.campaign import read_campaign
    from permway.challenge.follow import Advice
    from permway.diagnosis.gather import predictable
    from permway.diagnosis.menu import item_of

    read = read_campaign(campaign)
    item = item_of(read, predictable(read).kept, words)
    # A team writes speeds down in km/h.
    return Advice(item.kind, item.body, 3.6 * item.value if item.kind == "speed" else item.value)


@challenges.command(
    "suite", epilog=examples("permway challenge suite -o suite --seed 600000 --cases 20 --workers 2")
)
def challenge_suite(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for all of it.")],
    seed: Annotated[int, typer.Option(min=0, help="Of the first campaign; tiers begin a thousand apart.")],
    cases: Annotated[
        int | None, typer.Option(min=1, help="How many, tiers mixed by their share; by default all.")
    ] = None,
    workers: Annotated[int, typer.Option(min=1, max=256, help="Campaigns at the same time.")] = 1,
    tiers: Annotated[
        str | None,
        typer.Option(
            help="small, fixture, passages, or several with commas between: a suite of its own, see below."
        ),
    ] = None,
    method: Annotated[
        str | None,
        typer.Option(
            "--diagnose",
            metavar="PATH",
            help="Of small campaigns: another installation's `permway`, or a command that ends in `-m permway`.",
        ),
    ] = None,
    limit: Annotated[
        float, typer.Option(min=1.0, help="Of small campaigns: processor time of one diagnosis, s.")
    ] = 120.0,
    scheduler: Scheduler = None,
    as_json: Json = False,
) -> None:
    """All tiers made, diagnosed, weighed and scored.

    205 campaigns, some minutes each. Stopped and called again, it goes on where it was; called with more cases, it
    adds them. Writes score.json, from which docs/make_challenge.py makes the page of results.

    With --tiers small: random small campaigns of that seed, 1,000 unless --cases states otherwise.
    With --tiers fixture: forty campaigns of one layout. Writes score.json and table.md.
    With --tiers passages: trains that pass one accelerometer beside the track, 40 unless --cases states otherwise.
    """
    import json

    from permway._core import __version__
    from permway.challenge.suite import run_suite
    from permway.challenge.weigh import whole
    from permway.posterior.deviance import against_folder

    spread = over(scheduler)
    if scheduler is not None and method is not None:
        raise InputError("is on this machine only", where="--diagnose", value=method, remedy="without --scheduler")
    if tiers is not None:
        print_result(_small(output, tiers, seed, cases, workers, method, limit, spread, as_json), as_json)
        return
    if method is not None:
        raise InputError("goes with --tiers", where="--diagnose", value=method)
    with progress_bar("suite", as_json) as progress:
        result = run_suite(
            output,
            seed,
            against_folder,
            cases=cases,
            workers=workers,
            spread=spread,
            progress=progress,
        )
    count = "" if cases is None else f" --cases {cases}"
    command = f"permway challenge suite -o suite --seed {seed}{count}"
    scores = {"version": __version__, "seed": seed, "commands": [command], **_scores(output)}
    whole(output / "score.json", json.dumps(scores, indent=1) + "\n")
    print_result({**result, "scores": str(output / "score.json")}, as_json)


def _small(
    folder: Path,
    tiers: str,
    seed: int,
    cases: int | None,
    workers: int,
    method: str | None,
    limit: float,
    spread: Spread | None,
    as_json: bool,
) -> dict[str, object]:
    """The suite of small campaigns and its table."""
    from permway._core import __version__
    from permway.challenge.small.judge import judged
    from permway.challenge.small.suite import run_small
    from permway.challenge.small.table import as_json as lines_of
    from permway.challenge.small.table import markdown, reliability_markdown, table, worst_markdown
    from permway.challenge.weigh import whole
    from permway.diagnosis.catalogue import entries

    chosen = tiers.split(",")
    with stage_bar("small campaigns", as_json) as progress:
        names = run_small(
            folder,
            chosen,
            seed,
            cases=cases,
            workers=workers,
            method=method,
            limit_s=limit,
            spread=spread,
            progress=progress,
        )
    count = "" if cases is None else f" --cases {cases}"
    command = f"permway challenge suite -o suite --tiers {tiers} --seed {seed}{count}"
    found = table(judged(folder, names, {name: entry.FAMILY for name, entry in entries().items()}))
    scores = {"version": __version__, "command": command, **found}
    whole(folder / "score.json", lines_of(scores))
    page = f"{markdown(found)}\n{reliability_markdown(found)}\n{worst_markdown(found)}"
    whole(folder / "table.md", page)
    failed = sum(found["rows"][0]["failed"].values())
    files = {"scores": str(folder / "score.json"), "table": str(folder / "table.md")}
    return {"verdicts": found["rows"][0]["cases"] - failed, "failed": failed, **files}


def _scores(folder: Path) -> dict[str, object]:
    """By tier, by difficulty, case by case, and recalibrated parameter by parameter."""
    from permway.challenge.calibration import confusion, power, reliability
    from permway.challenge.recalibrated import by_parameter, pulls
    from permway.challenge.score import score
    from permway.challenge.summary import summary
    from permway.diagnosis.catalogue import entries

    scored = score(folder, {name: entry.FAMILY for name, entry in entries().items()})
    cases = [
        {
            "case": s.name,
            "status": s.status,
            "truth": ", ".join(s.truth),
            "named": ", ".join(s.named),
            "deviance": s.deviance,
            "found": s.found,
            "placed": s.placed,
            "family": s.family,
            "in_class": s.in_class,
            "false_name": s.false_name,
            "harmed": s.harmed,
            "gain_dB": None if s.gain_dB is None else round(s.gain_dB, 3),
            # A verdict that was not made by `run` has no time.
            "seconds": s.seconds if math.isfinite(s.seconds) else None,
        }
        for s in scored
    ]
    return {
        "tiers": summary(scored),
        "power": power(scored),
        "reliability": reliability(scored),
        "confusion": confusion(scored),
        "cases": cases,
        "parameters": by_parameter(pulls(folder, scored)),
    }
