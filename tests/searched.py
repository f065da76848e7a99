"""The search of a diagnosis over some entries of the catalogue alone, on records that need not be files."""

from __future__ import annotations

from dataclasses import dataclass

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue import entries
from permway.diagnosis.fit import Fit
from permway.diagnosis.observations import Observations
from permway.posterior.cells import BESIDE
from permway.posterior.covariance import Frame
from permway.posterior.diagnose import as_base
from permway.posterior.fitter import Fitter
from permway.posterior.member import Member
from permway.posterior.recalibrated import recalibrated
from permway.posterior.search import explored


@dataclass(frozen=True)
class Searched:
    """What a search left.

    Attributes
    ----------
    members : list of Member
        All sets of amendments that came near the best, the most probable first, and the empty one.
    """

    members: list[Member]

    @property
    def empty(self) -> Member:
        """Nothing is missing."""
        return next(m for m in self.members if not m.amendments)

    def best(self, *names: str) -> Member | None:
        """The most probable set of one amendment, of some entries or of any."""
        singles = [m for m in self.members if len(m.amendments) == 1]
        return next((m for m in singles if not names or m.names[0] in names), None)

    def gain(self, member: Member | None) -> float:
        """Of a set's log evidence over the empty one, nats; 0 where the search let go of it."""
        return 0.0 if member is None else member.fit.log_evidence - self.empty.fit.log_evidence


def searched(observations: Observations, *names: str) -> Searched:
    """Search for some entries of the catalogue, each at all its places."""
    others = [name for name in (*entries(), *BESIDE) if name not in names]
    return Searched(explored(Fitter(Frame.of(observations)), ruled_out=others).members)


def recalibrated_base(observations: Observations) -> Fit:
    """The empty set's fit in the form that reports draw."""
    return as_base(recalibrated(observations))


def weighed_by(observations: Observations, campaign: Campaign) -> Observations:
    """Records weighed by what a campaign predicts of them."""
    frame = Frame.of(observations)
    solved = frame.observations.predicted(campaign)
    residuals = frame.observations.residuals(solved.datasets)
    return frame.about(solved, frame.covariance(frame.first()), residuals).observations
