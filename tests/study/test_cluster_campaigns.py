"""A suite of small campaigns, and diagnoses of many campaigns, on a cluster whose workers are killed: as here."""

import json
import random
import shutil

import pytest
from clusters import Cluster
from permway.challenge.small import suite as module
from permway.challenge.small.suite import names_of, run_small
from permway.cli.output import over
from permway.errors import InputError, SolveError
from permway.study import cluster as on
from permway.study.diagnoses import KEY, diagnose_many

pytest.importorskip("distributed")
pytestmark = [
    pytest.mark.injection,
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]

CASES, SEED = 4, 480


@pytest.fixture
def cluster(monkeypatch):
    monkeypatch.setattr(on, "CONNECT_S", 60.0)
    found = Cluster(2)
    yield found
    found.stop()


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    folder = tmp_path_factory.mktemp("here")
    run_small(folder, ["small"], SEED, cases=CASES)
    return folder


def stated(path):
    """A verdict without what depends on the machine."""
    verdict = json.loads(path.read_text())
    return {key: value for key, value in verdict.items() if key not in ("seconds", "campaign", "made_by")}


def test_a_suite_of_small_campaigns(cluster, here, tmp_path, monkeypatch):
    monkeypatch.setattr(module, "EACH", 1)
    chance, killed = random.Random(7), []

    def kill(_stage, done, _of):
        if done == 1 and not killed:
            killed.append(True)
            cluster.kill_worker(chance)

    folder = tmp_path / "there"
    names = run_small(folder, ["small"], SEED, cases=CASES, spread=over(cluster.address), progress=kill)
    assert killed
    assert len(names) == CASES
    files = {path.relative_to(here).as_posix() for path in here.rglob("*") if path.is_file()}
    assert {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()} == files
    for name in names:
        assert (folder / "truth" / f"{name}.json").read_bytes() == (here / "truth" / f"{name}.json").read_bytes()
        assert stated(folder / "verdicts" / name / "verdict.json") == stated(
            here / "verdicts" / name / "verdict.json"
        )
    # Called again there is nothing left to do; of a verdict that is gone there is.
    asked = []

    def spread(_folder, jobs, _last):
        asked.extend(name for name, _, _ in jobs)
        return iter(())

    run_small(folder, ["small"], SEED, cases=CASES, spread=spread)
    (folder / "verdicts" / names[2] / "verdict.json").unlink()
    run_small(folder, ["small"], SEED, cases=CASES, spread=spread)
    assert asked == [names[2]]


def test_diagnoses_of_many_campaigns(cluster, here, tmp_path):
    names = names_of(["small"], SEED, CASES)
    campaigns, folders = [], []
    for name in names:
        shutil.copytree(here / name, tmp_path / name)
        campaigns.append(tmp_path / name / "campaign.toml")
        folders.append(tmp_path / name / "diagnosis")
    killed = []

    def kill(_stage, done, _of):
        if done == 1 and not killed:
            killed.append(True)
            cluster.kill_worker(random.Random(3))

    options = {"page": False, "scheduler": cluster.address}
    found = diagnose_many(campaigns, folders, progress=kill, **options)
    assert killed
    assert (len(found.done), found.already_there, found.failed) == (CASES, (), {})
    for name, folder in zip(names, folders, strict=True):
        status = stated(folder / "verdict.json")["status"]
        assert status == stated(here / "verdicts" / name / "verdict.json")["status"]
        assert (folder / "amended.toml").is_file()
    # Of one record that is changed the diagnosis is made anew, of the others it is there.
    with (campaigns[0]).open("a") as file:
        file.write("\n# stated differently\n")
    campaigns[1].write_text(campaigns[1].read_text().replace('title = "', 'title = "Another ', 1))
    again = diagnose_many(campaigns, folders, **options)
    assert again.done == (str(folders[1]),)
    assert len(again.already_there) == CASES - 1


def test_failures_elsewhere_are_named(tmp_path, monkeypatch):
    """Pieces that fail on workers are named, what came back is kept, and two diagnoses never share a folder."""
    from permway.study.cluster import Outcome

    def spread(_folder, jobs, _last):
        for name, _, _ in jobs:
            yield name, Outcome(error="worker out of memory")

    with pytest.raises(SolveError, match=r"1 pieces of work failed.*small-480-0000: worker out of memory"):
        run_small(tmp_path / "out", ["small"], SEED, cases=2, spread=spread)
    with pytest.raises(InputError, match="two campaigns would write there"):
        diagnose_many([tmp_path / "a", tmp_path / "b"], [tmp_path / "out", tmp_path / "out"])
    assert not (tmp_path / "out" / KEY).exists()
