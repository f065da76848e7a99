"""A whole diagnosis: recalibrate, locate, search round by round, decide, prove."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter

import numpy as np

from permway.arrays import Complexes
from permway.diagnosis import decide, grammar
from permway.diagnosis.advise import advise
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.catalogue import hypotheses
from permway.diagnosis.compare import assemble
from permway.diagnosis.compete import Quick, Ring, stacked
from permway.diagnosis.constancy import constancy
from permway.diagnosis.decide import CLASS_DEVIANCE
from permway.diagnosis.evidence import Evidence, gather, predictable
from permway.diagnosis.fit import Fit, gained
from permway.diagnosis.heldout import Rest, gains, log_e_value, parts, upper_half
from permway.diagnosis.hypothesis import Hypothesis, Situation
from permway.diagnosis.labels import mislabelled
from permway.diagnosis.locate import Found, Spot, scan
from permway.diagnosis.nulls import threshold
from permway.diagnosis.recalibrate import UNFIT, recalibrate
from permway.diagnosis.recovered import law_stiffness, same_place
from permway.diagnosis.result import Diagnosis
from permway.diagnosis.search import Finalist, Progress, Round, candidates, lines, penalty, search
from permway.diagnosis.speak import Proof, mixed_up, verdict_of
from permway.diagnosis.verdict_parts import NextMeasurement
from permway.errors import InputError
from permway.recordings.campaign import Campaign

MOST_EFFECTS, SHOWN_INCONSTANT = 3, 8

SECOND = 0.03
"""Share of the first effect's gain from which a further one counts as an effect."""

NEARLY = 1.3
"""Mean square of the deviations below which the recalibrated base is searched itself."""

BLUNT = 0.2
"""Relative error of frequency responses with which the search then begins."""

FEW = 0.4
"""Share of pairs that may be missed by far if the others are to hold the base without them."""


def diagnose(
    campaign: Campaign, *, seed: int = 0, threads: int | None = None, progress: Progress | None = None
) -> Diagnosis:
    """Say what a campaign's model leaves out.

    Parameters
    ----------
    campaign : Campaign
    seed : int
        Of simulated nulls: the same seed gives the same verdict.
    threads : int, optional
        Of the solver.
    progress : callable, optional
        Called with the stage, and how much of it is done.

    Raises
    ------
    InputError
        If no record can be predicted, or a file cannot be read.
    """
    clock = _Clock(progress)
    clock("read")
    kept, left_out = predictable(campaign)
    evidence = gather(campaign, kept, threads=threads)
    clock("recalibrate")
    base, searched = _bases(evidence, clock)
    clock("locate")
    found = _scanned(searched)
    mixed = mislabelled(base)
    rounds, accepted = ([], []) if mixed is not None else _rounds(searched, base, found, seed, clock)
    left = _left(base, found, accepted, clock)
    described = None if mixed is not None else _described(searched, base, found, rounds, accepted, left, clock)
    if described is not None:
        rounds, accepted = [described], [described.finalists[0]]
        left = _left(base, found, accepted, clock)
    amended = accepted[-1].fit if accepted else None
    proof: Proof | None = None
    advice: tuple[NextMeasurement, ...] = ()
    if amended is not None:
        clock("hold out")
        proof = _proof(base, amended, rounds, accepted, clock)
        advice = _advice(rounds, clock)
    clock("compare")
    law, remaining = _law(base, accepted, found, left)
    inconstant = tuple(constancy(Ring(base))[:SHOWN_INCONSTANT])
    return Diagnosis(
        verdict=verdict_of(base, rounds, accepted, found, left, proof, advice)
        if mixed is None
        else mixed_up(base, mixed),
        base=base,
        amended=amended,
        found=found,
        left=left,
        candidates=tuple(candidates(rounds[0])) if rounds else (),
        comparison=assemble(base.evidence, base, left_out=left_out),
        after=None if amended is None else assemble(amended.evidence, amended, left_out=left_out),
        law_dZ=law,
        remaining=remaining,
        seconds=clock.seconds(),
        inconstant=inconstant,
    )


def _bases(evidence: Evidence, clock: _Clock) -> tuple[Fit, Fit]:
    """The recalibrated base, and the one that the search begins from.

    Where learnt smooth errors do not explain what is left, responses are taken less
    seriously, so that what is missing in one place bends the base less.
    """
    rough = recalibrate(evidence, learn=False, reweigh=True, progress=lambda _: clock.tick())
    # What hides in noise, and what spectra weigh, is told by a prediction: by a better one each time.
    sharp = rough.evidence.reweighed(rough.evidence.predicted(rough.campaign))
    base = recalibrate(sharp, start=rough.z, reweigh=False, progress=lambda _: clock.tick())
    if base.heat < NEARLY:
        again = base.evidence.reweighed(base.evidence.predicted(base.campaign))
        base = recalibrate(again, start=base.z, reweigh=False, progress=lambda _: clock.tick())
        return base, base
    searched = recalibrate(
        sharp.blunted(BLUNT), start=rough.z, learn=False, reweigh=False, progress=lambda _: clock.tick()
    )
    about = searched.evidence.predicted(searched.campaign)
    if searched.heat > NEARLY and sharp.missed(2.0 * BLUNT, about) < FEW:
        # A few pairs are missed by more than all are blunted by: they are blunted by as much, and lead no longer.
        searched = recalibrate(
            sharp.blunted(BLUNT, about),
            start=searched.z,
            learn=False,
            reweigh=False,
            progress=lambda _: clock.tick(),
        )
    other = recalibrate(sharp, start=searched.z, reweigh=False, progress=lambda _: clock.tick())
    return min((base, other), key=lambda fit: fit.objective), searched


def _left(base: Fit, found: Sequence[Found], accepted: Sequence[Finalist], clock: _Clock) -> tuple[Found, ...]:
    """Scan of the amended model, the place among it that told most of the base."""
    clock("scan what is left")
    if not accepted:
        return ()
    fit = accepted[-1].fit
    before, after = base.campaign.model.line, fit.campaign.model.line
    return _scanned(fit, lambda spot: bool(found) and same_place(before, found[0].spot, after, spot))


def _described(
    searched: Fit,
    base: Fit,
    found: tuple[Found, ...],
    rounds: Sequence[Round],
    accepted: Sequence[Finalist],
    left: Sequence[Found],
    clock: _Clock,
) -> Round | None:
    """Small elements, where no named effect explains what a free stiffness does; None unless they do it better."""
    least = rounds[0].threshold
    if accepted:
        best = accepted[-1].fit
        if accepted[0].hypothesis.domain != "path" or decide.explained(base, best, left) >= decide.EXPLAINED:
            return None
    else:
        best = base
        if not found or found[0].gain - found[0].degrees * np.log(lines(base)) <= least:
            return None
    offered = grammar.hypotheses(Situation(searched, found))
    result = search(
        searched, offered, learnt_base=base, prefix="1.", threshold=lambda _ring, _screened: least, progress=clock
    )
    if not result.finalists:
        return None
    one = result.finalists[0]
    return result if best.objective - one.fit.objective > penalty(one.quick, result.ring) else None


def _advice(rounds: Sequence[Round], clock: _Clock) -> tuple[NextMeasurement, ...]:
    """What to measure next where two effects rival each other."""
    for found in rounds:
        if len(found.finalists) > 1:
            best, rival = found.finalists[:2]
            if rival.fit.objective - best.fit.objective < CLASS_DEVIANCE * best.fit.heat:
                return advise(best.fit, rival.fit, (best.hypothesis.entry, rival.hypothesis.entry), progress=clock)
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


def _scanned(fit: Fit, also: Callable[[Spot], bool] = lambda _: False) -> tuple[Found, ...]:
    return tuple(scan(fit, also)) if any(isinstance(b, FrfBlock) for b in fit.evidence.blocks) else ()


def _rounds(
    rough: Fit, base: Fit, found: tuple[Found, ...], seed: int, clock: _Clock
) -> tuple[list[Round], list[Finalist]]:
    """Add effects while one passes; take out those that a later one made needless.

    Where smooth errors of usual size do not explain what is left, the search begins from a base that has learnt no
    larger ones, for these would hide what is sought, and that takes responses less seriously, for what is missing
    would bend it; what it finds has to be better than the base that has learnt, on responses as they are.
    """

    def least(ring: Ring, screened: Sequence[Quick]) -> float:
        return threshold(ring, screened, seed=seed)

    rounds: list[Round] = []
    accepted: list[Finalist] = []
    fit = base
    screened: tuple[Quick, ...] = ()
    for order in range(MOST_EFFECTS):
        result = None
        for start in [fit] if rough is fit else [rough, fit]:
            offered = _of_the_owners(base, hypotheses(Situation(start, found)), start)
            prefix = f"{order + 1}."
            result = search(
                start,
                offered,
                learnt_base=fit,
                prefix=prefix,
                threshold=least,
                before=screened,
                progress=clock,
            )
            screened = result.screened
            if result.finalists:
                break
        assert result is not None
        rounds.append(result)
        if not result.finalists:
            break
        if accepted and result.finalists[0].gain < SECOND * accepted[0].gain:
            # So little beside the first is as likely to mend how the first was idealised.
            break
        accepted.append(result.finalists[0])
        if len(accepted) > 1:
            accepted = _without_needless(base, accepted, result.threshold, clock)
        # Once a model nearly fits, nothing is gained from blunting.
        fit = accepted[-1].fit
        rough = fit if fit.heat < UNFIT else accepted[-1].rough
        if order + 1 < MOST_EFFECTS:
            clock("locate")
            found = _scanned(rough)
    return rounds, accepted


def _of_the_owners(base: Fit, offered: Iterable[Hypothesis], fit: Fit) -> list[Hypothesis]:
    """Without changes of what an earlier effect has brought: an effect is not explained by a second one on it."""
    owner, line = base.campaign.model.line, fit.campaign.model.line
    brought = {*line.laws, *line.bodies} - {*owner.laws, *owner.bodies}
    kept = []
    for hypothesis in offered:
        values = {f.name: f.value(float(z)) for f, z in zip(hypothesis.free, hypothesis.starts[0], strict=True)}
        if hypothesis.locate(values).what not in brought:
            kept.append(hypothesis)
    return kept


def _without_needless(base: Fit, accepted: list[Finalist], least: float, clock: _Clock) -> list[Finalist]:
    """Backward: earlier effects that the last one has made needless are dropped, and the rest fitted again."""
    kept = list(accepted)
    for one in accepted[:-1]:
        rest = [f for f in kept if f is not one]
        whole = kept[-1].fit
        clock("drop")
        build, free = base.build, base.free
        for other in rest:
            build, more = stacked(build, other.hypothesis, other.prefix)
            free = (*free, *more)
        at = {f.name: float(z) for f, z in zip(whole.free, whole.z, strict=True)}
        start = np.array([at[f.name] for f in free])
        try:
            build({f.name: f.value(float(z)) for f, z in zip(free, start, strict=True)})
        except (InputError, KeyError):
            # A later effect stands on this one.
            continue
        without = recalibrate(whole.evidence, build=build, free=free, start=start, learn=False)
        asked = len(one.hypothesis.free) * float(np.log(lines(base)))
        needed = max(least + asked, SECOND * max(f.gain for f in accepted))
        if without.objective - whole.objective < needed:
            kept = [*rest[:-1], _with_fit(rest[-1], without)]
    return kept


def _with_fit(finalist: Finalist, fit: Fit) -> Finalist:
    return replace(finalist, rough=fit, fit=fit)


def _proof(base: Fit, amended: Fit, rounds: list[Round], accepted: list[Finalist], clock: _Clock) -> Proof:
    """Records left out, e-value and placebo."""
    chosen = list(parts(base.evidence))
    for one in accepted:
        channels = one.hypothesis.locate(one.values).channels
        if one.hypothesis.domain == "measurement" and channels:
            chosen += upper_half(base.evidence, channels)
    before, after = Rest(base), Rest(amended)
    held_out = gains(before, after, chosen)
    log_e = log_e_value(before, after)
    clock("placebo")
    sham = _placebo(rounds[0], accepted[0])
    placebo_gain, placebo_held_out = 0.0, []
    if sham is not None:
        found = rounds[0].ring.full(sham, prefix="placebo.", most_steps=6)
        fit = recalibrate(
            base.evidence, build=found.build, free=found.free, start=found.z, learn=False, most_steps=6
        )
        placebo_gain = gained(base, fit)
        placebo_held_out = gains(before, Rest(fit), chosen)
    gain = gained(base, amended)
    bic = gain - sum(len(f.hypothesis.free) for f in accepted) * float(np.log(lines(base)))
    return Proof(
        held_out=held_out,
        log_e=log_e,
        placebo=placebo_held_out,
        bic_gain=bic,
        conditions=decide.conditions(
            bic_gain=bic,
            threshold=rounds[0].threshold,
            log_e=log_e,
            held_out=held_out,
            gain=gain,
            placebo=placebo_gain,
        ),
    )


def _placebo(found: Round, best: Finalist) -> Quick | None:
    """As many parameters, nearly, of another family; of those the one of middling gain."""
    count = len(best.hypothesis.free)
    others = [q for q in found.screened if q.hypothesis.family != best.hypothesis.family]
    if not others:
        return None
    near = min(abs(len(q.hypothesis.free) - count) for q in others)
    alike = sorted((q for q in others if abs(len(q.hypothesis.free) - count) == near), key=lambda q: q.gain)
    return alike[len(alike) // 2]


@dataclass
class _Clock:
    """Times the stages and says where it is."""

    progress: Progress | None
    _times: dict[str, float] = field(default_factory=dict)
    _stage: str = ""
    _since: float = 0.0
    _ticks: int = 0

    def __call__(self, stage: str, done: int = 0, total: int = 0) -> None:
        now = perf_counter()
        if self._stage:
            self._times[self._stage] = self._times.get(self._stage, 0.0) + now - self._since
        if stage != self._stage:
            self._ticks = 0
        self._stage, self._since = stage, now
        if self.progress is not None:
            self.progress(stage, done, total)

    def tick(self) -> None:
        """A step of a stage whose length is not known."""
        self._ticks += 1
        if self.progress is not None:
            self.progress(self._stage, self._ticks, 0)

    def seconds(self) -> dict[str, float]:
        """By stage."""
        self(self._stage)
        return dict(self._times)
