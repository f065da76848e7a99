"""Campaigns with an effect concealed in them: drawn from a seed, written as a measuring team's folder."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Literal, Self, get_args

import numpy as np

from permway.challenge.effects import (
    CATALOGUE,
    FADING,
    NEAR_DEGENERATE,
    NONLINEAR,
    OUTSIDE,
    STRENGTHS,
    Effect,
    Site,
    Strength,
)
from permway.challenge.effects.rolling_train import RollingTrain
from permway.challenge.effects.taken_out import TAKEN_OUT, TakenOut
from permway.challenge.files import write_csv, write_mat, write_npz, write_uff
from permway.challenge.layout import (
    TOLERANCE,
    Layout,
    Tests,
    Values,
    draw_layout,
    draw_nominal,
    draw_tests,
    draw_true,
)
from permway.challenge.measure import HammerTest, Run, measure
from permway.challenge.plan import Chain, Plan, plan_of
from permway.challenge.running import running_layout, running_tests, with_dashpots
from permway.challenge.sheet import sheet
from permway.challenge.sparse import NOISE, sparse
from permway.challenge.tiers import number_of
from permway.errors import InputError

Tier = Literal["null", "single", "twin", "multiple", "outside", "nonlinear", "graded", "sparse", "running"]
TIERS: tuple[Tier, ...] = get_args(Tier)

COLD_TOO = 0.15
"""How often hammer tests at two temperatures are made where no effect needs them."""

INVENTED = 0.5
"""Share of invented mechanisms among effects of no catalogue; of the others the catalogue loses the family."""

NOISY, NOISIEST = 0.5, 100.0
"""Share of campaigns whose hammer tests are noisier than the cleanest, and up to how many times, in amplitude."""

DROWNED = 1000.0
"""Times the noise of the cleanest hammer test at most where effects are graded, and at least a tenth of it."""

SLOW_OR_FAST, WARMER_K = 0.005, 0.5
"""Largest relative error of a speed, and standard deviation of that of a temperature."""


@dataclass(frozen=True)
class Case:
    """A campaign and all that is true of it.

    Parameters
    ----------
    seed : int
    tier : Tier
    strength : Strength or None
        None for a null.
    layout : Layout
    nominal, true : Values
        What the user believes; what is.
    tests : Tests
    chain : Chain
    effects : tuple of Effect
        In the order drawn; all are of one strength.
    text : bool
        UFF and CSV; MAT and NPZ otherwise.
    taken_out : TakenOut or None
        What the catalogue has to do without, and the words for it.
    share : float
        How far the effects were faded: 1 as drawn, towards 0 as if they were not.
    """

    seed: int
    tier: Tier
    strength: Strength | None
    layout: Layout
    nominal: Values
    true: Values
    tests: Tests
    chain: Chain
    effects: tuple[Effect, ...]
    text: bool
    taken_out: TakenOut | None = None
    share: float = 1.0

    def faded(self, share: float) -> Self:
        """The same with weaker effects, see :meth:`Effect.faded`."""
        return replace(self, effects=tuple(effect.faded(share) for effect in self.effects), share=share)

    def plan(self) -> Plan:
        """Track, vehicle, profile and chain with the effects in them."""
        plan = plan_of(self.layout, self.true, self.tests, self.chain)
        for effect in self.effects:
            effect.apply(plan)
        return plan

    def measure(self) -> tuple[list[HammerTest], list[Run]]:
        """Hammer tests and runs; the same each time."""
        return measure(self.plan(), _random(self.seed, self.tier, 4))

    @property
    def sheet(self) -> dict[str, Any]:
        """The content of `sheet.json`."""
        return sheet(self.layout, self.nominal, self.tests)

    @property
    def truth(self) -> dict[str, Any]:
        """The content of `truth.json`."""
        parts = [effect.truth() for effect in self.effects]
        if self.taken_out is not None:
            parts = [{**part, "id": None, "words": list(self.taken_out.words)} for part in parts]
        return {
            "seed": self.seed,
            "tier": self.tier,
            "strength": self.strength,
            **({} if self.share == 1.0 else {"share": self.share}),
            "parameters": {g: {n: self.true[g][n] for n in table} for g, table in TOLERANCE.items()},
            "chain": asdict(self.chain),
            "fx": [_short(part) for part in parts if part["domain"] != "vehicle"],
            "vfx": [_short(part) for part in parts if part["domain"] == "vehicle"],
            "effects": parts,
            "ruled_out": [] if self.taken_out is None else list(self.taken_out.names),
            "notes": "; ".join(part["mechanical"] for part in parts)
            or "nothing is missing: parameters within tolerance only",
        }


def draw(seed: int, tier: Tier) -> Case:
    """Draw a campaign.

    Parameters
    ----------
    seed : int
        Zero or more.
    tier : Tier
        "null": nothing concealed; "single": one effect of the catalogue; "twin": one that has a near-degenerate
        alternative; "multiple": two or three; "outside": one of no catalogue, or one whose family is taken out of
        it; "nonlinear": one that depends on amplitude; "graded": one of the catalogue that is there to be
        faded; "sparse": as "twin", in records so few that they may leave it open; "running": trains that truly
        run, where the model has them stand.

    Raises
    ------
    InputError
        For a seed below zero, or a tier that is none of these.
    """
    if tier not in TIERS:
        raise InputError("is no tier", where="tier", value=tier, remedy=f"use one of {', '.join(TIERS)}")
    if seed < 0:
        raise InputError("must not be below zero", where="seed", value=seed)
    random = _random(seed, tier, 0)
    kinds, taken_out = _kinds(random, tier), None
    if tier == "outside" and random.random() >= INVENTED:
        kinds = [list(TAKEN_OUT)[int(random.integers(len(TAKEN_OUT)))]]
        taken_out = TAKEN_OUT[kinds[0]]
    strength = None if tier == "null" else STRENGTHS[int(random.integers(3))]
    cold = 2 if random.random() < COLD_TOO else 1
    temperatures = max([cold, *(kind.TEMPERATURES for kind in kinds)])
    layout = (running_layout if tier == "running" else draw_layout)(_random(seed, tier, 1))
    nominal = draw_nominal(_random(seed, tier, 1, 1))
    if tier == "running":
        nominal = with_dashpots(nominal)
    tests = draw_tests(_random(seed, tier, 1, 2), layout, temperatures=temperatures)
    if tier == "sparse":
        tests = sparse(tests, _random(seed, tier, 1, 3))
    true = draw_true(_random(seed, tier, 2), nominal)
    chain = _chain(_random(seed, tier, 3), _noisier(_random(seed, tier, 6), tier))
    if tier == "running":
        tests = running_tests(tests, layout, chain.speed)
    site, drawing = Site(layout, tests), _random(seed, tier, 5)
    effects = tuple(kind.draw(drawing, strength or "medium", site) for kind in kinds)
    return Case(
        seed=seed,
        tier=tier,
        strength=strength,
        layout=layout,
        nominal=nominal,
        true=true,
        tests=tests,
        chain=chain,
        effects=effects,
        text=bool(random.random() < 0.5),
        taken_out=taken_out,
    )


def _kinds(random: np.random.Generator, tier: Tier) -> list[type[Effect]]:
    match tier:
        case "null":
            return []
        case "running":
            return [RollingTrain]
        case "single" | "twin" | "outside" | "nonlinear" | "graded" | "sparse":
            pool = {
                "single": CATALOGUE,
                "twin": NEAR_DEGENERATE,
                "outside": OUTSIDE,
                "nonlinear": NONLINEAR,
                "graded": FADING,
                "sparse": NEAR_DEGENERATE,
            }[tier]
            return [pool[int(random.integers(len(pool)))]]
        case "multiple":
            order = random.permutation(len(CATALOGUE))
            apart: list[type[Effect]] = []
            for index in order:
                kind = CATALOGUE[int(index)]
                # Of one family two effects would be one to any diagnosis.
                if kind.FAMILY not in {other.FAMILY for other in apart}:
                    apart.append(kind)
            return apart[: int(random.integers(2, 4))]


def _noisier(random: np.random.Generator, tier: Tier) -> float:
    """Times the noise of a clean hammer test: the noisier the test, the harder an effect is to find.

    In cleaner tests a faded effect that weighs something is smaller than anybody would look for.
    """
    if tier == "graded":
        return float(DROWNED * 10.0 ** random.uniform(-1.0, 0.0))
    if tier == "sparse":
        return float(NOISE ** random.random())
    return float(NOISIEST ** random.random()) if random.random() < NOISY else 1.0


def _chain(random: np.random.Generator, noisier: float) -> Chain:
    speeds = tuple(round(1.0 + float(x), 5) for x in random.uniform(-SLOW_OR_FAST, SLOW_OR_FAST, 2))
    return Chain(
        calibration_dB=round(float(random.uniform(0.5, 1.5)), 3),
        noise=round(noisier * 1.2e-6 * float(np.exp(0.4 * random.standard_normal())), 9),
        speed=speeds,
        warmer_C=tuple(round(WARMER_K * float(x), 3) for x in random.standard_normal(2)),
    )


def _random(seed: int, tier: Tier, *purpose: int) -> np.random.Generator:
    return np.random.default_rng([seed, number_of(tier), *purpose])


def _short(part: dict[str, Any]) -> dict[str, Any]:
    return {"kind": part["kind"], **part["parameters"]}


def write(case: Case, folder: Path) -> list[Path]:
    """Measure a campaign and write it as `permway import sheet` reads it; the truth is not among the files.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    InputError
        If the folder cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot be made: {error.strerror or error}", where=str(folder)) from error
    hammers, runs = case.measure()
    files = [folder / "sheet.json"]
    files[0].write_text(json.dumps(case.sheet, indent=1) + "\n", encoding="utf-8")
    for test in hammers:
        files.append(folder / f"hammer_{test.temperature_C:+.0f}C.{'uff' if case.text else 'mat'}")
        (write_uff if case.text else write_mat)(files[-1], test, case.tests.sensors, case.tests.points)
    for run in runs:
        files.append(folder / f"run_{run.speed_kmh:.0f}kmh.{'csv' if case.text else 'npz'}")
        (write_csv if case.text else write_npz)(files[-1], run)
    return files


def write_truth(case: Case, path: Path) -> str:
    """Write what is true of a campaign, and beside it its SHA-256, which may be made known beforehand.

    Returns
    -------
    str
        The SHA-256 of the file, which `<path>.sha256` holds too.
    """
    content = (json.dumps(case.truth, indent=1) + "\n").encode()
    digest = hashlib.sha256(content).hexdigest()
    path.write_bytes(content)
    path.with_name(path.name + ".sha256").write_text(f"{digest}  {path.name}\n", encoding="ascii")
    return digest
