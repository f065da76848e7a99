"""What is kept of frozen records is that of the record, of what else was given, and of no dead one."""

import gc

import numpy as np
from permway import slab_track_viaduct_32m
from permway.model.kept import Kept


class Record:
    """A weak reference to it can be had."""


def test_it_is_made_once_for_each_record_use_and_what_is_given() -> None:
    kept: Kept[Record, object] = Kept(8)
    one, other = Record(), Record()
    first = kept.of(one, object, given="a")
    assert kept.of(one, object, given="a") is first
    assert kept.of(other, object, given="a") is not first
    assert kept.of(one, object, use="cold", given="a") is not first
    assert kept.of(one, object, given="a") is first
    assert kept.of(one, object, given="b") is not first


def test_no_more_is_kept_than_was_asked_for_and_nothing_of_the_dead() -> None:
    kept: Kept[Record, int] = Kept(3)
    records = [Record() for _ in range(5)]
    made = [kept.of(record, lambda n=n: n) for n, record in enumerate(records)]
    assert made == [0, 1, 2, 3, 4]
    assert kept.of(records[4], lambda: -1) == 4
    assert kept.of(records[0], lambda: -1) == -1
    assert len(kept._known) == 3
    records.clear()
    gc.collect()
    assert not kept._known


def test_what_a_caller_does_to_an_answer_changes_no_other() -> None:
    line = slab_track_viaduct_32m()
    frequency = np.array([10.0, 20.0])
    before = line.stiffness(frequency, 20.0)
    expected = before.copy()
    before[:] = 0.0
    assert np.array_equal(line.stiffness(frequency, 20.0), expected)
    colder = line.stiffness(frequency, -20.0)
    assert not np.array_equal(colder, expected)
    assert np.array_equal(line.stiffness(frequency, 20.0), expected)
    assert np.array_equal(line.stiffness(2.0 * frequency, 20.0)[0], expected[1])
