"""Work shared between processes: the same results, errors whole, nothing left behind."""

from __future__ import annotations

import os
import pickle
import signal
import sys
import time
from multiprocessing import active_children, get_context

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._relaxing import relaxing
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.gather import gather
from permway.diagnosis.observations import Observations
from permway.diagnosis.side_by_side import each, one_thread_of_blas
from permway.diagnosis.tangent import Problem
from permway.errors import InputError, SolveError
from searched import searched
from simulated import simulate
from threadpoolctl import threadpool_info, threadpool_limits

forks = pytest.mark.skipif(sys.platform != "linux", reason="processes are forked on Linux alone")


def _slowly(item: int) -> tuple[int, int]:
    time.sleep(0.02)
    return item**2, os.getpid()


def test_results_come_in_the_order_of_their_items() -> None:
    started: list[int] = []
    found = each(_slowly, range(20), threads=3, progress=started.append)
    assert [square for square, _ in found] == [item**2 for item in range(20)]
    # What others begin is not reported here.
    assert started == sorted(set(started))
    assert set(started) <= set(range(20))
    assert started


@forks
@pytest.mark.parametrize(("threads", "processes"), [(1, 1), (2, 2), (3, 3)])
def test_as_many_processes_take_part_as_threads(threads: int, processes: int) -> None:
    assert len({process for _, process in each(_slowly, range(24), threads=threads)}) == processes
    assert not active_children()


@forks
def test_no_process_is_made_for_a_few_items() -> None:
    assert len({process for _, process in each(_slowly, range(7), threads=2, least=4)}) == 1
    assert len({process for _, process in each(_slowly, range(8), threads=2, least=4)}) == 2


@forks
def test_what_is_shared_already_is_not_shared_again() -> None:
    def inner(item: int) -> set[int]:
        return {process for _, process in each(_slowly, range(4), threads=2)} | {os.getpid()}

    assert all(len(processes) == 1 for processes in each(inner, range(6), threads=2))


@forks
def test_a_worker_of_a_pool_does_all_itself() -> None:
    with get_context("fork").Pool(1) as pool:
        found = pool.apply(each, (_slowly, range(6)), {"threads": 2})
    assert len({process for _, process in found}) == 1


def test_an_error_comes_back_whole() -> None:
    def work(item: int) -> int:
        time.sleep(0.02)
        if item > 2:
            raise InputError("is too large", where="item", value=item, remedy="take less")
        return item

    with pytest.raises(InputError, match=r"item: is too large \(got \d\); take less") as caught:
        each(work, range(8), threads=2)
    assert caught.value.where == "item"
    assert caught.value.remedy == "take less"
    assert not active_children()


def test_an_input_error_goes_from_one_process_to_another() -> None:
    error = InputError("is unknown", where="bodies.rail.E", value=2.1e11, remedy="name it")
    other = pickle.loads(pickle.dumps(error))
    assert type(other) is InputError
    assert str(other) == str(error)
    assert other.value == 2.1e11


@forks
def test_a_process_that_ends_before_its_work_is_reported() -> None:
    here = os.getpid()

    def work(item: int) -> int:
        time.sleep(0.02)
        if os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return item

    with pytest.raises(SolveError, match="ended before it was done"):
        each(work, range(8), threads=2)


@forks
def test_an_interrupt_ends_all_within_a_second() -> None:
    here = os.getpid()

    def work(item: int) -> int:
        if os.getpid() == here:
            raise KeyboardInterrupt
        time.sleep(60.0)
        return item

    started = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        each(work, range(8), threads=2)
    assert time.monotonic() - started < 1.0
    assert not active_children()


def test_blas_has_one_thread_within_and_as_many_as_before_after() -> None:
    def threads() -> list[int]:
        return [one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"]

    with threadpool_limits(2, user_api="blas"):
        assert set(threads()) == {2}
        with one_thread_of_blas():
            assert set(threads()) == {1}
        assert set(threads()) == {2}


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    return simulate(tmp_path_factory.mktemp("side") / "c", 5, amend=_softer).campaign


def _softer(campaign: Campaign) -> Campaign:
    return relaxing(campaign, "pad", stiffness_factor=1.0, order=0.3, share=0.5, rest=1.0)


def _slopes(observations: Observations) -> np.ndarray:
    campaign = observations.campaign
    problem = Problem(observations, campaign.with_values, free_parameters(campaign))
    state = problem.at(np.zeros(len(problem.free)))
    assert state is not None
    return problem.jacobian(state)


def test_slopes_are_the_same_to_the_last_digit(campaign: Campaign) -> None:
    one, two = (_slopes(gather(campaign, threads=threads)) for threads in (1, 2))
    np.testing.assert_array_equal(one, two)


def test_a_search_is_the_same_whoever_worked_on_it(campaign: Campaign) -> None:
    one, two = (
        searched(gather(campaign, threads=threads), "pad_frequency", "sensor_gain").members for threads in (1, 2)
    )
    assert [member.names for member in one] == [member.names for member in two]
    for first, second in zip(one, two, strict=True):
        np.testing.assert_array_equal(first.fit.z, second.fit.z)
        assert first.log_mass == second.log_mass
    assert any(member.amendments for member in one)
