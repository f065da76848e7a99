"""A cluster whose workers, and whose scheduler, are killed: nothing is lost, and nothing comes back twice."""

import random
import time
from collections import Counter
from functools import partial

import pytest
from clusters import Cluster
from on_workers import counted, noted, refused
from permway.errors import InputError, SolveError
from permway.study import cluster as module
from permway.study import folders
from permway.study.cluster import on_cluster
from permway.study.folders import on_cluster_in_folder, worked_in_folder

pytest.importorskip("distributed")
# What distributed states about itself on closing, above all when a process was killed.
pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning"),
]

COUNT = 40


@pytest.fixture(autouse=True)
def patient(monkeypatch):
    """Processes start slowly on a machine that has much else to do."""
    monkeypatch.setattr(module, "CONNECT_S", 60.0)


@pytest.fixture(scope="module")
def cluster():
    found = Cluster(2)
    yield found
    found.stop()


@pytest.fixture
def own_cluster():
    """One whose scheduler is killed."""
    found = Cluster(2)
    yield found
    found.stop()


def test_workers_killed_at_random(cluster, tmp_path):
    log, chance = tmp_path / "log", random.Random(48)
    items = [(number, (number, str(log), 0.05)) for number in range(COUNT)]
    kills, found = {chance.randrange(4, 12), chance.randrange(14, 22), chance.randrange(24, 32)}, []
    for answer in on_cluster(noted, items, cluster.address):
        found.append(answer)
        if len(found) in kills:
            cluster.kill_worker(chance)
    assert Counter(name for name, _ in found) == Counter(range(COUNT))
    assert all(outcome.value == name**2 and not outcome.error for name, outcome in found)
    begun = Counter(int(line) for line in log.read_text().split())
    assert begun.keys() == set(range(COUNT))
    # What a killed worker had under way, and what it had done but not handed over, was done once more: no more.
    assert begun.total() <= COUNT + 3 * 2 * module.FEWEST_UNDER_WAY


def test_the_scheduler_killed_and_started_again(own_cluster, tmp_path):
    log = tmp_path / "log"
    items = [(number, (number, str(log), 0.02)) for number in range(COUNT)]
    found = []
    for answer in on_cluster(noted, items, own_cluster.address):
        found.append(answer)
        if len(found) == COUNT // 2:
            own_cluster.stop()
            own_cluster.start(2)
    assert Counter(name for name, _ in found) == Counter(range(COUNT))
    assert all(outcome.value == name**2 for name, outcome in found)
    # What had come back was not computed again.
    begun = Counter(int(line) for line in log.read_text().split())
    answered = {name for name, _ in found[: COUNT // 2]}
    assert all(begun[name] == 1 for name in answered)


def test_a_scheduler_that_stays_away_is_said(own_cluster, monkeypatch, tmp_path):
    monkeypatch.setattr(module, "AGAIN_S", 1.0)
    found, items = [], [(number, (number, str(tmp_path / "log"), 0.02)) for number in range(COUNT)]

    def work():
        for answer in on_cluster(noted, items, own_cluster.address):
            found.append(answer)
            if len(found) == 5:
                monkeypatch.setattr(module, "CONNECT_S", 0.5)
                own_cluster.stop()

    with pytest.raises(SolveError, match="run the same again to go on"):
        work()
    assert len(found) < COUNT


def test_what_fails_by_itself_fails_alone(cluster):
    found = dict(on_cluster(refused, [(1, (1,)), (2, (2,))], cluster.address))
    assert {name: outcome.error for name, outcome in found.items()} == {
        1: "ValueError: not 1",
        2: "ValueError: not 2",
    }


def test_files_go_out_and_come_back_on_a_slow_disk_stopped_and_called_again(cluster, tmp_path, monkeypatch):
    """What came back is whole, and is asked for no more; stopped once, and then a worker is killed."""
    written, write_bytes = [], folders.write_bytes

    def slow(path, content):
        time.sleep(0.05)
        written.append(path.relative_to(tmp_path).as_posix())
        write_bytes(path, content)

    monkeypatch.setattr(folders, "write_bytes", slow)
    given = {f"n{number}": tmp_path / f"n{number}" / "given.txt" for number in range(24)}
    for number, path in enumerate(given.values()):
        path.parent.mkdir()
        path.write_text(f"{number}\n100\n")

    def run():
        left = [name for name, path in given.items() if not (path.parent / "made" / "done.txt").exists()]
        jobs = ((name, [given[name]], partial(counted, name, 0.02)) for name in left)
        for name, outcome in on_cluster_in_folder(cluster.address, tmp_path, jobs, ("*/done.txt",)):
            assert (outcome.value, outcome.error) == (int(name[1:]) + 100, "")
            yield name

    stopped = run()
    first = [next(stopped) for _ in range(5)]
    stopped.close()
    assert len(written) == 2 * 5
    second = []
    for name in run():
        second.append(name)
        if len(second) == 6:
            cluster.kill_worker(random.Random(1))
    assert Counter(first + second) == Counter(list(given))
    assert written == [f"{name}/made/{file}" for name in first + second for file in ("sum.txt", "done.txt")]
    for number, path in enumerate(given.values()):
        assert (path.parent / "made" / "sum.txt").read_text() == f"{number + 100}"


def test_another_version_is_refused_and_inputs_do_not_come_back():
    work, files = partial(counted, "n", 0.0), {"n/given.txt": b"1 2"}
    with pytest.raises(InputError, match=r"the worker has permway .*, the client 0\.0\.0.*install the same"):
        worked_in_folder(work, files, "0.0.0")
    returned, made = worked_in_folder(work, files, module._core.__version__)
    assert (returned, made) == (3, {"n/made/done.txt": b"done", "n/made/sum.txt": b"3"})
