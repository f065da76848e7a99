"""A whole diagnosis by the posterior: read, search, weigh, hold out, answer."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from permway.campaign.campaign import Campaign
from permway.campaign.load import Dataset
from permway.diagnosis.advise import advise
from permway.diagnosis.catalogue import known
from permway.diagnosis.clock import Clock, Progress
from permway.diagnosis.compare import RECALIBRATED, assemble
from permway.diagnosis.fit import WIDTH
from permway.diagnosis.fit import Fit as Base
from permway.diagnosis.frf_lines import LINES_PER_FREQUENCY
from permway.diagnosis.gather import gather, predictable
from permway.diagnosis.labels import mislabelled
from permway.diagnosis.observations import Observations
from permway.diagnosis.recalibrated_values import recalibrated_of
from permway.diagnosis.result import Diagnosis
from permway.diagnosis.side_by_side import one_thread_of_blas
from permway.diagnosis.verdict import RIGHT, Verdict
from permway.diagnosis.verdict_parts import Moved, NextMeasurement
from permway.diagnosis.verdict_records import mixed_up, with_bad_channels
from permway.posterior.answer import verdict_of
from permway.posterior.covariance import Frame
from permway.posterior.detectable import detectable
from permway.posterior.fit import Fit
from permway.posterior.fitter import Fitter
from permway.posterior.held_out import gains
from permway.posterior.masses import Masses
from permway.posterior.member import Member
from permway.posterior.places import weighed
from permway.posterior.search import explored, unsearched

ENOUGH = 20_000
"""Residuals that are weighed: of more, frequency responses are taken at fewer lines. Further ones show little that
the model's own idealisation does not hide: :data:`permway.posterior.member.IDEALISED` is the same number. Twice as
many make the evidence 1.3 times as large and take twice the time."""

FEWEST = 4.0
"""Lines of a frequency response within its own frequency, at least."""


@one_thread_of_blas()
def diagnose(
    campaign: Campaign,
    *,
    ruled_out: Collection[str] = (),
    threads: int | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Say what a campaign's model leaves out.

    Parameters
    ----------
    campaign : Campaign
    ruled_out : collection of str
        Effects of the catalogue that cannot be.
    threads : int, optional
        Processes that share the work; the answer does not depend on how many.
    progress : callable, optional
        Called with the stage, how much of it is done, and of how much.

    Raises
    ------
    InputError
        If no record can be predicted, a file cannot be read, or what is ruled out is not in the catalogue.
    """
    ruled_out = known(ruled_out)
    clock = Clock(progress)
    clock("read")
    kept, left_out, bad = predictable(campaign)
    whole = gather(campaign, kept, threads=threads)
    frame = Frame.of(_enough(campaign, kept, whole))
    mixed = mislabelled(frame.observations)
    search = unsearched(frame) if mixed else explored(Fitter(frame), ruled_out=ruled_out, progress=clock)
    masses = Masses.of(search.members)
    base = as_base(masses.empty.fit)
    clock("hold out")
    best, empty = masses.best, masses.empty
    held_out = gains(empty.fit, best.fit) if best.amendments else []
    after = as_base(best.fit) if best.amendments else base
    if mixed is not None:
        verdict = mixed_up(base, mixed)
    else:
        moved = with_moved(recalibrated_of(after), best)
        verdict = verdict_of(masses, held_out, recalibrated_of(base), moved)
    if verdict.status in RIGHT:
        verdict = verdict.model_copy(update={"detectable": detectable(*search.small, frame.sigma.size)})
    clock("advise")
    verdict = verdict.model_copy(update={"next": _advice(masses, verdict, clock)})
    clock("compare")
    if frame.observations.rows.channel.size < whole.rows.channel.size:
        base, after = (as_base(_on(whole, member.fit)) for member in (empty, best))
    amended = after if verdict.effects and best.amendments else None
    return Diagnosis(
        verdict=with_bad_channels(verdict, bad).model_copy(update={"ruled_out": ruled_out}),
        base=base,
        amended=amended,
        comparison=assemble(base.observations, base, left_out=left_out),
        after=None if amended is None else assemble(amended.observations, amended, left_out=left_out),
        seconds=clock.seconds(),
        weighed=weighed(masses, search.small[0]),
    )


def _enough(campaign: Campaign, kept: Sequence[Dataset], whole: Observations) -> Observations:
    """The records at so many lines as are weighed."""
    found, lines = whole, LINES_PER_FREQUENCY
    while found.rows.channel.size > ENOUGH and lines > FEWEST:
        count = found.rows.channel.size
        responses = sum(block.rows.channel.size for block in found.blocks if block.is_thinned)
        share = (ENOUGH - (count - responses)) / max(responses, 1)
        lines = max(lines * min(max(share, 0.5), 0.95), FEWEST)
        found = gather(campaign, kept, threads=whole.threads, lines=lines)
    return found


def _on(observations: Observations, fit: Fit) -> Fit:
    """What was fitted, on all lines of the records."""
    fitter = Fitter(Frame.of(observations))
    return fitter.begin(fit.model, fit.z, fit.hyper)


def _advice(masses: Masses, verdict: Verdict, progress: Progress) -> tuple[NextMeasurement, ...]:
    """What to measure next, where the best set and another of other names are rivals."""
    if verdict.status not in ("ambiguous", "insufficient") or not masses.best.amendments:
        return ()
    rival = next((m for m in masses.members if m.names != masses.best.names), masses.empty)
    names = tuple(" and ".join(m.names) or RECALIBRATED for m in (masses.best, rival))
    return advise(as_base(masses.best.fit), as_base(rival.fit), (names[0], names[1]), progress=progress)


def with_moved(after: Mapping[str, Moved], member: Member) -> dict[str, Moved]:
    """Nominal parameters, those that an amendment moves with its shift in them."""
    found = dict(after)
    known = member.fit.frame.observations.campaign.parameters.known
    for index, amendment in enumerate(member.amendments):
        name, at = amendment.moves, member.moved(index)
        if name not in found or at is None:
            continue
        per_z, own = amendment.free[0].value(1.0), member.own(index).start
        z = float(member.fit.z[at] + per_z * member.fit.z[own])
        both = np.array([1.0, per_z])
        half = WIDTH * float(np.sqrt(both @ member.fit.spread[np.ix_([at, own], [at, own])] @ both))
        low, high = (known[name].value(end) for end in (z - half, z + half))
        moved = {"value": known[name].value(z), "z": z, "low": low, "high": high}
        found[name] = found[name].model_copy(update=moved)
    return found


def as_base(fit: Fit) -> Base:
    """The fit in the form that comparisons and reports draw."""
    sizes = {}
    observations = fit.frame.observations
    for source in observations.columns.sources:
        kind = source.name.split(" ", 1)[0]
        sizes[source.name] = fit.hyper[kind] if kind in fit.hyper.names else observations.sizes[source.name]
    observations = observations.with_sizes(
        sizes, max(fit.hyper["length"], 0.5) if "length" in fit.hyper.names else None
    )
    residuals, whitener = fit.state.residuals, observations.whitener
    clean = residuals - whitener.calibration(whitener.explained(residuals), residuals.size)
    chi2 = fit.covariance.square(residuals)
    return Base(
        free=fit.model.free,
        z=fit.z,
        covariance=fit.spread,
        campaign=fit.state.solved.campaign,
        observations=observations,
        residuals=residuals,
        clean=clean,
        chi2=chi2,
        prior=float(fit.z @ fit.z),
        log_determinant=fit.covariance.log_determinant,
        jacobian=fit.jacobian,
        inflation=max(1.0, whitener.square(residuals) / max(1, residuals.size)),
        evaluations=0,
        build=fit.model.build,
    )
