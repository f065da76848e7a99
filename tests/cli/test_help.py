"""What the command line shows of itself: help with examples, JSON everywhere, completion, silence when piped."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import typer.main
from permway.cli import app
from permway.cli import machine as cli_machine


def _walk(command: object, path: tuple[str, ...] = ()) -> list[tuple[tuple[str, ...], object]]:
    inner = getattr(command, "commands", None)
    if inner is None:
        return [(path, command)]
    return [found for name, item in inner.items() for found in _walk(item, (*path, name))]


COMMANDS = _walk(typer.main.get_command(app))
NAMES = [" ".join(path) for path, _ in COMMANDS]


def run(*arguments: object, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "permway", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
        env={**os.environ, **environment},
    )


def test_all_commands_are_here() -> None:
    once = {
        "new",
        "check",
        "solve",
        "fit-pad",
        "import sheet",
        "compare",
        "separability",
        "diagnose",
        "sweep",
        "demo",
        "doctor",
    }
    assert once | {"reproduce", "challenge make", "challenge run", "challenge score"} <= set(NAMES)


@pytest.mark.parametrize(("path", "command"), COMMANDS, ids=NAMES)
def test_every_command_teaches(path: tuple[str, ...], command: object) -> None:
    options = {name for parameter in command.params for name in parameter.opts}  # type: ignore[attr-defined]
    assert "--json" in options
    assert all(p.help for p in command.params if p.name != "help")  # type: ignore[attr-defined]
    epilog = command.epilog  # type: ignore[attr-defined]
    shown = [line for line in epilog.splitlines() if line.startswith("  ")]
    assert shown
    for line in shown:
        words = line.split("|")[0].split()
        assert words[: len(path) + 1] == ["permway", *path]
        assert {word for word in words if word.startswith("-")} <= options
    assert len(command.help.splitlines()[0]) <= 60  # type: ignore[attr-defined]


def test_the_list_of_commands_is_not_cut_off_and_states_the_exit_status() -> None:
    text = run("--help", COLUMNS="80").stdout
    assert "..." not in text.partition("\n")[2]
    assert re.search(r"Exit status:\n +0 .*\n +1 .*\n +2 .*\n +130 ", text)


@pytest.mark.parametrize(
    ("words", "found"), [("permway so", {"solve"}), ("permway s", {"solve", "sweep", "separability"})]
)
def test_completion(words: str, found: set[str]) -> None:
    asked = {"_PERMWAY_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": "1"}
    assert set(run(**asked).stdout.split()) == found
    assert "_PERMWAY_COMPLETE" in run(_PERMWAY_COMPLETE="source_bash").stdout


def test_doctor_states_machine_threads_and_vectors() -> None:
    done = run("doctor", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    stated = json.loads(done.stdout)
    assert stated["threads"] == os.cpu_count()
    assert stated["vectors"] in ("AVX-512, 512 bits", "AVX2, 256 bits", "portable")
    assert stated["self_test"] == "passed"
    assert all(re.match(r"\d+\.\d+", stated[name]) for name in (*cli_machine.PACKAGES[:-1], "hdf5"))


def test_doctor_ends_with_1_where_the_core_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cli_machine, "CLOSE", -1.0)
    with pytest.raises(SystemExit) as end:
        app(["doctor"], prog_name="permway")
    assert end.value.code == 1


SMALL = """
[frequencies]
values_Hz = [10.0, 100.0]
[line]
preset = "slab_track_viaduct_32m"
[line.options]
pad = { preset = "wj7b_constant" }
[[forces]]
body = "rail"
x_m = 16.0
[[sensors]]
body = "rail"
x_m = 16.0
"""


@pytest.mark.skipif(sys.platform == "win32", reason="needs a terminal of its own")
def test_a_bar_on_a_terminal_and_silence_when_piped(tmp_path: Path) -> None:
    import pty

    path = tmp_path / "model.toml"
    path.write_text(SMALL)
    assert run("solve", path).stderr == ""
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "permway", "solve", str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=theirs, text=True) as process:
        os.close(theirs)
        shown = b""
        try:
            while piece := os.read(ours, 4096):
                shown += piece
        except OSError:
            # The terminal's other end was closed.
            pass
        assert process.wait(120) == 0
    os.close(ours)
    assert b"solving" in shown
