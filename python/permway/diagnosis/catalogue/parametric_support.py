"""Discrete supports: the rail is stiffer over a fastener than between two."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from permway.campaign.campaign import Campaign
from permway.campaign.compare import POWER_DB
from permway.campaign.excitation import Rolling
from permway.campaign.parts import IrregularityKnown
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.catalogue._excite import rail_laws, stays, with_irregularity
from permway.diagnosis.catalogue._interval import spacing_of
from permway.diagnosis.catalogue._lines import FACTOR, coordinate, repeats
from permway.diagnosis.catalogue._runs import Excess, combs, excesses
from permway.diagnosis.gather import first_size
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, between_free, linear_free, log_free
from permway.diagnosis.recalibrate import recalibrate
from permway.errors import InputError, SolveError

ID = "parametric_support"
DOMAIN: Domain = "irregularity"
FAMILY = "tied to speed over length"
SUMMARY = (
    "Wheels roll over fasteners, and from span to span: their weight shakes them at multiples n of V over the "
    "spacing; what a profile does at one frequency it does so far away, too. By the model's own supports, with "
    "harmonics coupled, where the campaign says that trains stand; or as lines a n^-p in the profile, beyond that."
)
SHAPE_M = tuple(0.2 * 2.0**octave for octave in range(7))
"""Wavelengths at which the profile's spectrum may differ from the stated one where trains roll."""

MOST_DB = 20.0
"""By which it may, whatever is stated."""

PARAMETERS = {
    "share": "1, 0.4 to 2.5: of what rolling over the model's own supports changes; 1 is as the model has them",
    **{
        f"shape_{x:g}_m_dB": f"dB, -20 to 20: the spectrum less the stated one at {x:g} m, with share"
        for x in SHAPE_M
    },
    "amplitude_m": "m, 2.1e-8 to 1.2e-3: a, of the first line",
    "decay": "1, 1 to 5: p",
}
SIGNATURE = (
    "One line of all on-board channels, and weaker multiples, that go with the speed; no frequency response."
)
CONFUSED_WITH = {
    "rail_corrugation": "its wavelength is the fasteners' spacing by chance only; a hump, no line",
    "wheel_polygon": "one wheelset, and another length",
}
SOURCE = (
    "Nordborg, Wheel/rail noise generation due to nonlinear effects and parametric excitation (2002); Sheng, "
    "Jones and Thompson, Responses of infinite periodic structures to moving or stationary harmonic loads (2005)"
)
AMPLITUDE_M, HARMONICS = 5e-6, 4

RUNS = ("train.", "campaign.")
"""Where parameters lead that runs alone constrain."""

STANDS_OUT = 5.0
"""Standard deviations by which a line at V over the spacing stands out of a run whose train is looked at rolling:
that costs some seconds."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """For the law that holds most of the rail."""
    runs, model = excesses(situation), situation.campaign.model
    if not runs or model.train is None:
        return
    for law in rail_laws(model.line, model.train.body)[:1]:
        spacing = spacing_of(model.line, law)
        (found,) = combs(runs, [1.0 / spacing], harmonics=2, decay=2.0, most=1)
        seen = coordinate(found.amplitude_m, AMPLITUDE_M, FACTOR)
        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(log_free("amplitude_m", "m", AMPLITUDE_M, FACTOR), between_free("decay", "1", 1.0, 5.0)),
            amend=repeats(spacing, HARMONICS),
            locate=stays(law),
            starts=((seen, -0.5), (seen - 2.0, -0.5)),
            law=lambda v: f"{1e6 * v['amplitude_m']:.3g} um at V over the fasteners' spacing",
            size="amplitude_m",
            power=2.0,
        )
        if _pass(runs, spacing) and situation.campaign.stated.irregularity.rolls is None:
            yield from _rolling(situation, law, spacing)


def _pass(runs: list[Excess], spacing: float) -> bool:
    """Whether supports are seen to pass in a run."""
    scores = [float(run.score_at(np.array([run.speed / spacing]))[0]) for run in runs]
    return any(score > STANDS_OUT for score in scores)


def _rolling(situation: Situation, law: str, spacing: float) -> Iterator[Hypothesis]:
    """A train that rolls over the supports of the base; none if the line cannot be solved for that."""
    try:
        still = _known_at_rest(situation)
    except (InputError, SolveError):
        return
    rolls = with_irregularity(situation.campaign, rolling=Rolling(spacing_m=spacing))
    known = dict(rolls.rolling_about(still).stated.irregularity.rolls or {})
    shapes = {x: f"shape_{x:g}_m_dB" for x in SHAPE_M}
    sigma = float(POWER_DB) * first_size(situation.campaign, "irregularity")

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        own = campaign.stated.irregularity
        further = IrregularityKnown(shape_dB=tuple((x, values.get(name, 0.0)) for x, name in shapes.items()))
        at_m = np.array(sorted({*shapes, *(x for x, _ in own.shape_dB)}))
        shape = zip(at_m.tolist(), (own.shape_at(at_m) + further.shape_at(at_m)).tolist(), strict=True)
        rolling = Rolling(**{**known, "share": values["share"]})
        return with_irregularity(campaign, rolling=rolling, shape_dB=tuple(shape))

    try:
        # Here, so that processes that share the screening do not each begin with it.
        situation.fit.observations.predicted(amend(situation.campaign, {"share": 1.0}))
    except (InputError, SolveError):
        return
    yield Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            log_free("share", "1", 1.0, 1.2),
            *(linear_free(name, "dB", 0.0, sigma, -MOST_DB, MOST_DB) for name in shapes.values()),
        ),
        amend=amend,
        locate=stays(law),
        starts=((0.0,) * (1 + len(shapes)),),
        law=lambda v: (
            f"the train rolls over supports {spacing:g} m apart, {v['share']:.3g} of what the model's do"
        ),
        size="share",
        power=2.0,
        variant="rolling",
    )


def _known_at_rest(situation: Situation) -> Campaign:
    """The base without what runs fitted it to, for that is by a train that stands.

    Of records that are no runs, where there are any: they know nothing of rolling. Without them the base, train
    and speeds as stated.
    """
    fit, known = situation.fit, situation.campaign.parameters.known
    of_runs = {n for n, one in known.items() if all(path.startswith(RUNS) for path in one.parameter.paths)}
    z = np.array([0.0 if free.name in of_runs else at for free, at in zip(fit.free, fit.z, strict=True)])
    responses = tuple(block for block in fit.observations.blocks if isinstance(block, FrfBlock))
    if responses:
        observations = replace(fit.observations, blocks=responses)
        z = recalibrate(observations, build=fit.build, free=fit.free, start=z).z
    return fit.build({free.name: free.value(at) for free, at in zip(fit.free, z.tolist(), strict=True)})
