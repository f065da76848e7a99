"""A whole diagnosis: recalibrate, locate, search round by round, decide, prove."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from permway.arrays import Complexes
from permway.campaign.campaign import Campaign
from permway.diagnosis.advise import advise
from permway.diagnosis.bases import bases
from permway.diagnosis.candidates import candidates
from permway.diagnosis.catalogue import known
from permway.diagnosis.clock import Clock, Progress
from permway.diagnosis.compare import assemble
from permway.diagnosis.compete import Ring
from permway.diagnosis.constancy import constancy
from permway.diagnosis.decide import CLASS_DEVIANCE
from permway.diagnosis.describe import Description
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather, predictable
from permway.diagnosis.labels import mislabelled
from permway.diagnosis.locate import scanned
from permway.diagnosis.prove import proven
from permway.diagnosis.recovered import law_stiffness, same_place
from permway.diagnosis.result import Diagnosis
from permway.diagnosis.rounds import effects
from permway.diagnosis.sampling import corrected, sampled
from permway.diagnosis.search import Finalist, Round
from permway.diagnosis.side_by_side import one_thread_of_blas
from permway.diagnosis.speak import Proof, verdict_of
from permway.diagnosis.speak_measurement import mixed_up, with_spoilt
from permway.diagnosis.spot import Found
from permway.diagnosis.verdict_parts import RECALIBRATED, NextMeasurement
from permway.errors import InputError

SHOWN_INCONSTANT = 8
"""Parameters that would not stay constant, at most."""


@one_thread_of_blas()
def diagnose(
    campaign: Campaign,
    *,
    seed: int = 0,
    ruled_out: Collection[str] = (),
    draws: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Say what a campaign's model leaves out.

    Parameters
    ----------
    campaign : Campaign
    seed : int
        Of simulated nulls: the same seed gives the same verdict.
    ruled_out : collection of str
        Effects of the catalogue that cannot be, as somebody knows who was there; the verdict tells of them.
    draws : int
        Of the parameters of what is found, for intervals and classes; 0 for curvature alone. Each takes a solve.
    threads : int, optional
        Of the solver, or processes that share the work.
    progress : callable, optional
        Called with the stage, and how much of it is done.

    Raises
    ------
    InputError
        If no record can be predicted, a file cannot be read, what is ruled out is not in the catalogue, or draws
        are negative.
    """
    ruled_out = known(ruled_out)
    if draws < 0:
        raise InputError("must not be negative", where="draws", value=draws, remedy="0 is for curvature alone")
    clock = Clock(progress)
    clock("read")
    kept, left_out, spoilt = predictable(campaign)
    evidence = gather(campaign, kept, threads=threads)
    clock("recalibrate")
    base, searched = bases(evidence, clock)
    clock("locate")
    found = scanned(searched)
    mixed = mislabelled(base)
    description = Description(searched, base, found, clock)
    rounds, accepted = (
        ([], []) if mixed is not None else effects(searched, base, found, seed, clock, description, ruled_out)
    )
    described = None if mixed is not None else description.of(rounds, accepted)
    if draws:
        rounds = [corrected(one, draws=draws, seed=seed, progress=clock) for one in rounds]
    catalogued = rounds
    if described is not None:
        rounds, accepted = [described], [described.finalists[0]]
    amended: Fit | None = None
    proof: Proof | None = None
    advice: tuple[NextMeasurement, ...] = ()
    if accepted:
        clock("hold out")
        accepted, proof = proven(base, rounds, accepted, clock, others=catalogued[0])
        if draws:
            proof = replace(proof, spans=_spans(proof.weighed, accepted, draws, seed, clock))
        amended = proof.weighed
        advice = _advice(base, rounds, accepted, proof, clock)
    left = description.left(accepted[-1].fit) if accepted else ()
    clock("compare")
    inconstant = tuple(constancy(Ring(base))[:SHOWN_INCONSTANT])
    said = (
        verdict_of(base, rounds, accepted, found, left, proof, advice) if mixed is None else mixed_up(base, mixed)
    )
    if not said.amended:
        # What explains too little to be spoken of is in no file.
        accepted, amended, left = [], None, ()
    law, remaining = _law(base, accepted, found, left)
    spoken = {id(one.hypothesis): effect for one, effect in zip(accepted, said.effects, strict=False)}
    return Diagnosis(
        verdict=with_spoilt(said, spoilt).model_copy(update={"ruled_out": ruled_out}),
        base=base,
        amended=amended,
        found=found,
        left=left,
        candidates=tuple(candidates(rounds[0], spoken)) if rounds else (),
        comparison=assemble(base.evidence, base, left_out=left_out),
        after=None if amended is None else assemble(amended.evidence, amended, left_out=left_out),
        law_dZ=law,
        remaining=remaining,
        seconds=clock.seconds(),
        inconstant=inconstant,
    )


def _spans(
    weighed: Fit, accepted: Sequence[Finalist], draws: int, seed: int, clock: Clock
) -> dict[str, tuple[float, float]]:
    """Of every effect whose draws say enough."""
    spans: dict[str, tuple[float, float]] = {}
    for one in accepted:
        found = sampled(weighed, one.own, draws=draws, seed=seed, progress=clock)
        spans.update(found.spans if found is not None else {})
    return spans


def _advice(
    base: Fit, rounds: Sequence[Round], accepted: Sequence[Finalist], proof: Proof, clock: Clock
) -> tuple[NextMeasurement, ...]:
    """What to measure next where two effects rival each other, or where one is no more than a suspicion."""
    for found in rounds:
        rivals = [f for f in found.finalists if f.hypothesis.entry != found.finalists[0].hypothesis.entry]
        if rivals:
            best, rival = found.finalists[0], rivals[0]
            if rival.fit.objective - best.fit.objective < CLASS_DEVIANCE * best.fit.heat:
                return advise(best.fit, rival.fit, (best.hypothesis.entry, rival.hypothesis.entry), progress=clock)
    if not proof.conditions.hold:
        suspected = accepted[0].hypothesis.entry
        return advise(accepted[-1].fit, base, (suspected, RECALIBRATED), progress=clock)
    return ()


def _law(
    base: Fit, accepted: Sequence[Finalist], found: Sequence[Found], left: Sequence[Found]
) -> tuple[dict[str, Complexes], Found | None]:
    """What the effects of the line add where the scan found most, by their names, and what stays free there."""
    path = [one.hypothesis.entry for one in accepted if one.hypothesis.domain == "path"]
    if not path or not found:
        return {}, None
    fit = accepted[-1].fit
    added = law_stiffness(base, fit, found[0])
    if added is None:
        return {}, None
    before, after = base.campaign.model.line, fit.campaign.model.line
    free = next((f for f in left if same_place(before, found[0].spot, after, f.spot)), None)
    return {" + ".join(path): added}, free
