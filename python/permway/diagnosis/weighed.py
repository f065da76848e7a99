"""Posterior probabilities for people: where along the line they lie, what has no place, rivals."""

from __future__ import annotations

from dataclasses import dataclass

from permway.arrays import Reals
from permway.diagnosis.hypothesis import Domain


@dataclass(frozen=True)
class Along:
    """Where along one body, or one layer of joints, effects of one family act.

    Attributes
    ----------
    what : str
        Body, or law of the joints.
    joints : bool
        Whether it is a layer of joints.
    family : str
    x_m : ndarray, shape (places,)
        Joints, or middles of pieces of the body, ascending.
    probability : ndarray, shape (places,)
        That an effect of the family acts there. An effect on a stretch acts at all places of it, so that they do
        not sum to one.
    """

    what: str
    joints: bool
    family: str
    x_m: Reals
    probability: Reals


@dataclass(frozen=True)
class Aside:
    """What acts at no place along the line.

    Attributes
    ----------
    what : str
        Part of the vehicle, or parameter whose stated value is wrong; "" of all.
    channels : tuple of str
        Sensors, of a fault of the measurement.
    domain : "path", "irregularity", "vehicle" or "measurement"
    family : str
    probability : float
    """

    what: str
    channels: tuple[str, ...]
    domain: Domain
    family: str
    probability: float


@dataclass(frozen=True)
class Rival:
    """A set of effects at their most probable places.

    Attributes
    ----------
    names : tuple of str
        Of the catalogue; empty: nothing is missing.
    places : tuple of str
        In words, of each.
    laws : tuple of str
        Mechanics in words, of each.
    probability : float
    behind_nats : float
        By how much its evidence, prior probability included, is behind the best set's.
    parameters : int
        Of its effects.
    """

    names: tuple[str, ...]
    places: tuple[str, ...]
    laws: tuple[str, ...]
    probability: float
    behind_nats: float
    parameters: int


@dataclass(frozen=True)
class Weighed:
    """What the posterior says of places and sets.

    Attributes
    ----------
    along : tuple of Along
        The most probable first.
    aside : tuple of Aside
        The most probable first.
    rivals : tuple of Rival
        The most probable first.
    nothing : float
        Probability that nothing is missing.
    unknown : float
        Probability that what is missing is something else than all sets that were tried.
    tried : mapping of str to ndarray
        By body or law: places along the line at which effects were tried, m.
    """

    along: tuple[Along, ...]
    aside: tuple[Aside, ...]
    rivals: tuple[Rival, ...]
    nothing: float
    unknown: float
    tried: dict[str, Reals]
