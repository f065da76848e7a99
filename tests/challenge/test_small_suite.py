"""The suite of small campaigns: resumable, bounded in time, by any installation; its table and its size."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from permway.challenge.recalibrated import pulls
from permway.challenge.score import Claim, Scored, score
from permway.challenge.small.diagnose import diagnose_all, interpreter_of
from permway.challenge.small.judge import Judged, judged
from permway.challenge.small.suite import names_of, run_small
from permway.challenge.small.table import as_json, markdown, table
from permway.diagnosis.catalogue import entries
from permway.errors import InputError

STUB = """
import os, time
from pathlib import Path

class Verdict:
    def __init__(self, text): self.text = text
    def write(self, path): Path(path).write_text(self.text)

class Result:
    def __init__(self, verdict): self.verdict = verdict

def diagnose(campaign, threads):
    with open(os.environ["STUB_LOG"], "a") as log: log.write(campaign.parent.name + "\\n")
    match campaign.parent.name:
        case "slow":
            while True: pass
        case "dies": os._exit(3)
        case "fails": raise ValueError("no such thing")
        case "sleeps": time.sleep(60)
    print("noise on the output")
    return Result(Verdict(os.environ.get("STUB_VERDICT", "{}")))
"""


@pytest.fixture
def stub(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Another installation, whose diagnosis does what a campaign's folder states."""
    package = tmp_path / "stub" / "permway"
    for name in ("", "diagnosis", "recordings"):
        (package / name).mkdir(parents=True)
        (package / name / "__init__.py").write_text("")
    (package / "diagnosis" / "diagnose.py").write_text(STUB)
    (package / "recordings" / "campaign.py").write_text("read_campaign = lambda path: path\n")
    monkeypatch.setenv("STUB_LOG", str(tmp_path / "log"))
    return f"env PYTHONPATH={tmp_path / 'stub'} {sys.executable} -m permway"


def test_each_campaign_ends_in_a_verdict_or_a_failure_and_none_is_diagnosed_twice(
    tmp_path: Path, stub: str
) -> None:
    names = ["slow", "fails", "dies", "one", "other"]
    jobs = [(tmp_path / name / "campaign.toml", tmp_path / "out" / name) for name in names]
    reported: list[tuple[int, int]] = []
    for _ in range(2):
        diagnose_all(jobs, method=stub, workers=2, limit_s=0.3, progress=lambda *at: reported.append(at))
    assert sorted((tmp_path / "log").read_text().split()) == sorted(names)
    assert reported == [(done, 5) for done in range(1, 6)]
    texts = {path.parent.name: path.read_text() for path in (tmp_path / "out").glob("*/failed.txt")}
    assert texts["slow"].startswith("TimeUp: no verdict after 0.3 s of processor")
    assert texts["fails"].startswith("ValueError: no such thing")
    assert texts["dies"].startswith("ProcessDied")
    assert set(texts) == {"slow", "fails", "dies"}
    for name in ("one", "other"):
        assert (tmp_path / "out" / name / "verdict.json").read_text() == "{}"
        cost = json.loads((tmp_path / "out" / name / "cost.json").read_text())
        assert 0.0 <= cost["processor_s"] < 0.3
        assert 5.0 < cost["peak_MB"] < 500.0


def test_ctrl_c_ends_what_runs(tmp_path: Path, stub: str) -> None:
    # A program that is started in the background ignores SIGINT, and what it starts inherits that.
    code = (
        "import signal, sys; from pathlib import Path; "
        "from permway.challenge.small.diagnose import diagnose_all; "
        "signal.signal(signal.SIGINT, signal.default_int_handler); "
        "p = Path(sys.argv[1]); diagnose_all([(p / 'sleeps' / 'campaign.toml', p / 'out')], method=sys.argv[2])"
    )
    process = subprocess.Popen([sys.executable, "-c", code, str(tmp_path), stub], stderr=subprocess.DEVNULL)
    log = tmp_path / "log"
    try:
        while not log.is_file():
            time.sleep(0.05)
            assert process.poll() is None
        process.send_signal(signal.SIGINT)
        # The campaign sleeps for a minute.
        assert process.wait(timeout=20.0) != 0
    finally:
        process.kill()
        process.wait()
    assert not (tmp_path / "out" / "verdict.json").exists()


def test_what_is_no_installation_is_refused(tmp_path: Path) -> None:
    script = tmp_path / "permway"
    script.write_text("#!/somewhere/bin/python3\nimport permway\n")
    assert interpreter_of(str(script)) == ["/somewhere/bin/python3"]
    assert interpreter_of("env A=1 python -m permway") == ["env", "A=1", "python"]
    assert interpreter_of(None) == [sys.executable]
    for wrong in ("", "permway diagnose", str(tmp_path), "python -m other"):
        with pytest.raises(InputError, match="no installation"):
            interpreter_of(wrong)


def test_a_tier_of_the_other_suite_is_refused() -> None:
    assert len(names_of(["small", "fixture"], 1, None)) == 1040
    with pytest.raises(InputError, match="no tier of this suite"):
        names_of(["small", "null"], 1, 3)


def test_a_stopped_suite_goes_on_and_its_verdicts_are_judged(
    tmp_path: Path, stub: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = {"body": None, "joint": "pad", "x": [5.4, 6.6], "within": [5.0, 7.0], "channels": []}
    effect = {
        "domain": "path",
        "place": place,
        "name": "fastener_loss",
        "class": [{"name": "fastener_loss", "probability": 0.93}, {"name": "novel", "probability": 0.05}],
        "parameters": {"factor": {"value": 0.3, "low": 0.2, "high": 0.4}},
    }
    moved = {
        "pad.k": {"value": 3e7, "low": 1e3, "high": 1e12},
        "pad.eta": {"value": 9.0, "low": 8.0, "high": 10.0},
    }
    verdict = {
        "status": "named",
        "effects": [effect],
        "held_out": {},
        "recalibrated": {"before": {}, "after": moved},
    }
    monkeypatch.setenv("STUB_VERDICT", json.dumps(verdict))
    run_small(tmp_path, ["fixture"], 1, cases=2, method=stub)
    names = run_small(tmp_path, ["fixture"], 1, cases=4, method=stub)
    assert len((tmp_path / "log").read_text().split()) == 4
    families = {name: entry.FAMILY for name, entry in entries().items()}
    right, weaker, *_ = judged(tmp_path, names, families)
    assert (right.found, right.placed, right.first, right.in_class, right.false_name) == (True,) * 4 + (False,)
    assert right.sure == (True,)
    assert right.nominal == (True, False)
    # Three pads that keep 0.3, and three that keep 0.05.
    assert (right.effect, weaker.effect) == ((True,), (False,))
    row = table(judged(tmp_path, names, families))["rows"][0]
    assert row["first"][:2] == [4, 4]
    assert row["nominal"][:2] == [4, 8]


def judged_case(random: np.random.Generator, index: int) -> Judged:
    kind = str(random.choice(["null", "single", "several", "fault", "outside"]))
    something = kind != "null"
    flag = bool(random.random() < 0.6)
    name = str(random.choice([*entries(), "novel"]))
    return Judged(
        name=f"small-123456-{index:04d}",
        tier="small",
        maker=str(random.choice(["model", "elements"])),
        layout=str(random.choice(["deck", "ballast", "slab", "beam", "rig"])),
        kind=kind,
        family=entries()[str(random.choice(list(entries())))].FAMILY if something else "",
        rough=flag,
        deviance=float(np.exp(random.uniform(1.6, 9.2))) if something else None,
        change_dB=float(np.exp(random.uniform(-4.0, 2.0))) if something else None,
        status="named",
        called=flag,
        found=flag if something else None,
        placed=flag if something else None,
        first=flag if something else None,
        in_class=flag if something else None,
        false_name=not flag,
        insufficient=False if something else None,
        sure=(flag,),
        nominal=(flag, True),
        effect=(flag,),
        claims=(Claim(name, float(random.random()), flag),),
        named="girder_local_modes|second_track|novel",
        truth="girder_local_modes, sensor_mounting",
        seconds=float(random.uniform(0.5, 119.0)),
        peak_MB=250.0,
    )


def test_a_score_of_a_thousand_campaigns_is_small_and_adds_up() -> None:
    random = np.random.default_rng(1)
    cases = [judged_case(random, index) for index in range(1000)]
    cases[0] = replace(cases[0], failure="no parameters", status="")
    found = table(cases)
    text = as_json({"version": "0", "command": "permway challenge suite", **found})
    assert len(text.encode()) < 20_000
    assert json.loads(text)["rows"] == found["rows"]
    everything = found["rows"][0]
    for group in ("kind", "errors", "layout", "maker"):
        rows = [row for row in found["rows"] if row["group"] == group]
        assert sum(row["cases"] for row in rows) == 1000
        assert sum(row["found"][1] for row in rows if "found" in row) == everything["found"][1]
    assert everything["failed"] == {"no parameters": 1}
    assert sum(row["true"][1] for row in found["reliability"]) == sum(
        c.name != "novel" for j in cases[1:] for c in j.claims
    ) + sum(c.name != "novel" for c in cases[0].claims)
    page = markdown(found, groups=["all", "deviance"])
    assert [line.split("|")[1].strip() for line in page.splitlines()[2:]] == [
        "all",
        "deviance: 0 to 15",
        "deviance: 15 to 50",
        "deviance: 50 to 200",
        "deviance: over 200",
    ]


def null_of(folder: Path) -> Scored:
    """A campaign of the fixture as if nothing were concealed in it, and one parameter were stated."""
    (one, *_) = score(folder, {})
    path = folder / "verdicts" / one.name / "verdict.json"
    moved = {"pad.k": {"value": 3e7, "low": 1e6, "high": 1e9}}
    path.write_text(json.dumps({**json.loads(path.read_text()), "recalibrated": {"before": moved, "after": {}}}))
    return replace(one, found=None)


def test_the_suite_writes_its_table(tmp_path: Path, stub: str, monkeypatch: pytest.MonkeyPatch) -> None:
    verdict = {"status": "recalibrated", "effects": [], "held_out": {}}
    verdict["recalibrated"] = {"before": {}, "after": {}}
    monkeypatch.setenv("STUB_VERDICT", json.dumps(verdict))
    words = ["-o", str(tmp_path / "s"), "--tiers", "fixture", "--cases", "2", "--seed", "1", "--diagnose", stub]
    command = [sys.executable, "-m", "permway", "challenge", "suite", *words, "--json"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False, env=dict(os.environ))
    assert ended.returncode == 0, ended.stderr
    printed = json.loads(ended.stdout)
    assert (printed["verdicts"], printed["failed"]) == (2, 0)
    scores = json.loads(Path(printed["scores"]).read_text())
    assert scores["rows"][0]["found"][:2] == [0, 2]
    # The other score reads such truths, too, whose parameters are not by part.
    assert pulls(tmp_path / "s", score(tmp_path / "s", {})) == []
    assert [p.inside for p in pulls(tmp_path / "s", [null_of(tmp_path / "s")])] == [True]
    assert "| all | 2 | 0 |" in Path(printed["table"]).read_text()
