"""What is fuzzed: for each target the inputs, and what is done with one."""

from __future__ import annotations

import contextlib
import io
import json
import tempfile
import tomllib
import zipfile
import zlib
from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, Literal

import core
import numpy as np
import sheets
import written
from campaigns import tables
from damage import damaged_bytes, damaged_table, toml
from hypothesis import strategies as st
from permway.campaign.campaign import read_campaign
from permway.campaign.importers.sheet import import_sheet
from permway.cli import app
from permway.errors import InputError, PermwayError
from permway.formats.model_file import read_model
from permway.laws.dma import read_dma
from permway.laws.lawfile import load_law
from permway.laws.measured import read_measured
from permway.laws.transmissibility import read_shaker
from permway.problem.model import Frequencies
from permway.problem.solve import solve
from permway.recordings.readers import read_frf, read_table, read_time
from permway.recordings.record import FrfRecord, TableRecord, TimeRecord
from permway.study.file import read_study
from scipy import io as matlab

Outcome = Literal["read", "refused", "broken"]
ROOT = Path(__file__).resolve().parents[2]
MOST = 2**26
"""Of readers' `max_bytes`."""

COMMANDS = 40
"""One in so many refused files is given to the command line too."""


class BrokenLawError(AssertionError):
    """The law was broken otherwise than by an exception."""


class Target(ABC):
    """Inputs, each a file's name and content, and what is done with one in a folder."""

    @abstractmethod
    def inputs(self) -> st.SearchStrategy[tuple[str, bytes]]:
        """Damaged files."""

    @abstractmethod
    def run(self, name: str, content: bytes, folder: Path) -> Outcome:
        """Use one; anything but an `InputError` breaks the law."""


@cache
def seed_file(name: str) -> bytes:
    """A valid record of 40 samples."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        written.WRITERS[name](path, written.samples(40))
        return path.read_bytes()


@cache
def frf_file(suffix: str) -> bytes:
    """Valid frequency responses."""
    frequency, values, coherence = written.frf(12)
    names = {"sensor": np.array(["r", "d"]), "hammer": np.array(["a", "b", "c"])}
    content = {"f": frequency, "frf": values, "coh": coherence, **names}
    buffer = io.BytesIO()
    if suffix == "npz":
        np.savez(buffer, **content)
    else:
        matlab.savemat(buffer, content, do_compression=suffix == "packed.mat")
    return buffer.getvalue()


PLAIN = [name for name in written.WRITERS if name not in ("a.nc", "a.h5", "v73.mat")]
HDF5 = ["a.nc", "a.h5", "v73.mat"]
FRFS = {"frf.npz": "npz", "frf.mat": "mat", "packed.mat": "packed.mat"}


@st.composite
def _damaged_file(draw: st.DrawFn) -> tuple[str, bytes]:
    name = draw(st.sampled_from([*PLAIN, *FRFS]))
    content = frf_file(FRFS[name]) if name in FRFS else seed_file(name)
    inside = {
        "npz": _inside_zip,
        "mat": _inside_mat,
        "csv": _inside_text,
        "tsv": _inside_text,
        "uff": _inside_text,
    }
    change: Callable[..., Any] | None = inside.get(name.rpartition(".")[2])
    if change is not None and draw(st.booleans()):
        return name, draw(change(content))
    return name, draw(damaged_bytes(content))


@st.composite
def _inside_zip(draw: st.DrawFn, content: bytes) -> bytes:
    """A member of the archive damaged, and packed again as if it were right."""
    made = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as new:
        chosen = draw(st.sampled_from(old.namelist()))
        for name in old.namelist():
            part = old.read(name)
            if name == chosen:
                part = draw(damaged_bytes(part) | _header(part))
                name = draw(st.sampled_from([name, name, name, "fs.npy", "../x.npy", "time.npy", "x"]))
            new.writestr(name, part)
    return made.getvalue()


@st.composite
def _header(draw: st.DrawFn, part: bytes) -> bytes:
    """An array's header that announces another shape or type."""
    with contextlib.suppress(ValueError):
        array = np.load(io.BytesIO(part))
        shape = draw(st.lists(st.sampled_from([0, 1, 2, 3, 40, 10**6, 10**12, 2**62]), max_size=4))
        kinds = [
            "<f8",
            ">f4",
            "<c16",
            "<U3",
            "<U90000000",
            "|S3",
            "|O",
            "<M8[s]",
            "|V8",
            "<f2",
            "|b1",
            "<u8",
            "<f16",
        ]
        head = {
            "descr": draw(st.sampled_from([*kinds, array.dtype.str])),
            "fortran_order": draw(st.booleans()),
            "shape": tuple(shape) if draw(st.booleans()) else array.shape,
        }
        made = io.BytesIO()
        np.lib.format.write_array_header_1_0(made, head)
        return made.getvalue() + array.tobytes()
    return part


@st.composite
def _inside_mat(draw: st.DrawFn, content: bytes) -> bytes:
    """An element of a MAT file damaged below its compression, its length right."""
    parts, at = [content[:128]], 128
    while at + 8 <= len(content):
        kind, size = (int.from_bytes(content[at + k : at + k + 4], "little") for k in (0, 4))
        body, end = content[at + 8 : at + 8 + size], at + 8 + size
        if kind == 15:
            inner = draw(damaged_bytes(zlib.decompress(body))) if draw(st.booleans()) else zlib.decompress(body)
            body = zlib.compress(inner)
        elif draw(st.booleans()):
            body = draw(damaged_bytes(body))
        parts += [kind.to_bytes(4, "little"), len(body).to_bytes(4, "little"), body]
        if kind != 15:
            parts.append(bytes(-len(body) % 8))
            end += -size % 8
        at = end
    return b"".join(parts)


@st.composite
def _inside_text(draw: st.DrawFn, content: bytes) -> bytes:
    """Cells and fields replaced, lines dropped, doubled and moved."""
    lines = content.decode("latin-1").split("\n")
    stated = [
        "0",
        "-1",
        "7",
        "99999999",
        "nan",
        "1e300",
        "-1e-300",
        "x",
        "",
        "inf",
        "58b",
        "1,5",
        "\ufeff",
        '"',
        "1e5000",
    ]
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, max(min(len(lines), 14 if draw(st.booleans()) else len(lines)) - 1, 0)))
        kind = draw(st.sampled_from(["field", "field", "cell", "drop", "double", "swap"]))
        if kind == "field":
            width, field = draw(st.integers(1, 14)), draw(st.integers(0, 70))
            lines[at] = lines[at][:field] + draw(st.sampled_from(stated)).rjust(width) + lines[at][field + width :]
        elif kind == "cell":
            cells = lines[at].split(",")
            cells[draw(st.integers(0, len(cells) - 1))] = draw(st.sampled_from(stated) | st.text(max_size=6))
            lines[at] = ",".join(cells)
        elif kind == "drop" and len(lines) > 1:
            del lines[at]
        elif kind == "double":
            lines[at:at] = [lines[at]] * draw(st.sampled_from([1, 2, 100]))
        else:
            other = draw(st.integers(0, len(lines) - 1))
            lines[at], lines[other] = lines[other], lines[at]
    return "\n".join(lines).encode("utf-8", "replace")


class Readers(Target):
    """Every format that is read but HDF5's kin."""

    reads: tuple[Callable[..., Any], ...] = (read_time, read_frf, read_table)

    def inputs(self) -> st.SearchStrategy[tuple[str, bytes]]:
        return _damaged_file()

    def run(self, name: str, content: bytes, folder: Path) -> Outcome:
        path = folder / name
        path.write_bytes(content)
        outcome: Outcome = "refused"
        for read in self.reads:
            try:
                record = read(path, max_bytes=MOST)
            except InputError as error:
                _reported(error)
                continue
            outcome = "read"
            if not isinstance(record, FrfRecord | TableRecord | TimeRecord):
                raise BrokenLawError(f"{read.__name__} gives a {type(record).__name__}")
            if isinstance(record, TimeRecord) and not np.isfinite(record.values).all():
                raise BrokenLawError("samples that are not finite")
        return outcome


class Hdf5(Readers):
    """HDF5, NetCDF-4, MAT 7.3; each opened in a process of its own first, which takes its time."""

    def run(self, name: str, content: bytes, folder: Path) -> Outcome:
        # One reader is enough for what it takes.
        self.reads = ((read_time, read_table)[sum(content) % 2],)
        return super().run(name, content, folder)

    def inputs(self) -> st.SearchStrategy[tuple[str, bytes]]:
        return st.sampled_from(HDF5).flatmap(lambda name: st.tuples(st.just(name), damaged_bytes(seed_file(name))))


DMA = b"frequency_Hz,temperature_C,storage_MPa,loss_factor\n" + b"".join(
    b"%d,%d,%.3f,0.2\n" % (f, t, 10.0 + f - 0.1 * t) for t in (-20, 20) for f in (1, 10, 50)
)
MEASURED = b"frequency_Hz,real,imaginary\n1.0,1e7,1e6\n10.0,1.1e7,2e6\n100.0,2e7,3e6\n"
LAW = b'format = 1\n[law]\ntype = "hysteretic"\nstiffness = 6e7\nloss_factor = 0.2\n'


class Tables(Target):
    """DMA tests, measured laws, shakers' sweeps, laws."""

    files: ClassVar = {"dma.csv": DMA, "measured.csv": MEASURED, "law.toml": LAW}

    def inputs(self) -> st.SearchStrategy[tuple[str, bytes]]:
        names = st.sampled_from(sorted(self.files))
        return names.flatmap(
            lambda name: st.tuples(st.just(name), _inside_text(self.files[name]) | damaged_bytes(self.files[name]))
        )

    def run(self, name: str, content: bytes, folder: Path) -> Outcome:
        path = folder / name
        path.write_bytes(content)
        outcome: Outcome = "refused"
        for read in (read_dma, read_shaker, load_law, lambda p: read_measured(p, "impedance")):
            try:
                read(path)
                outcome = "read"
            except InputError as error:
                _reported(error)
        return outcome


def _toml_inputs(name: str, seeds: list[dict[str, Any]]) -> st.SearchStrategy[tuple[str, bytes]]:
    structured = damaged_table(seeds).map(toml)
    raw = st.sampled_from(seeds).flatmap(lambda table: damaged_bytes(toml(table)))
    return st.tuples(st.just(name), structured | structured | structured | raw)


@cache
def _examples() -> list[tuple[str, dict[str, Any]]]:
    return [(p.name, tomllib.loads(p.read_text())) for p in sorted((ROOT / "examples").glob("*.toml"))]


class Models(Target):
    """Model files; one that is read is solved at one frequency where it is small."""

    def inputs(self) -> st.SearchStrategy[tuple[str, bytes]]:
        seeds = [table for _, table in _examples() if "frequencies" in table] + [tables()[1], LAWS]
        return _toml_inputs("model.toml", seeds)

    def run(self, name: str, content: bytes, folder: Path) -> Outcome:
        path = folder / name
        path.write_bytes(content)
        (folder / "soil.csv").write_bytes(MEASURED)
        (folder / "law.toml").write_bytes(LAW)
        try:
            model = read_model(path)
        except InputError as error:
            _reported(error)
            _command("solve", path, content)
            return "refused"
        if content[-1] % 8 == 0 and model.line.joint_table().x.size < 500 and model.passby is None:
            at = Frequencies(values_Hz=(float(model.frequencies.array()[0]),))
            with contextlib.suppress(PermwayError):
                solve(model.model_copy(update={"frequencies": at}), threads=1)
        return "read"


LAWS: dict[str, Any] = {
    **tables()[1],
    "line": {
        **tables()[1]["line"],
        "laws": {
            "pad": {"type": "measured", "file": "soil.csv", "quantity": "impedance"},
            "bearing": {"file": "law.toml"},
        },
    },
    "frequencies": {"values_Hz": [5.0, 10.0, 20.0]},
}


class Campaigns(Target):
    """Campaign files, with the model and the records beside them, which are then loaded."""

    def inputs(self) -> st.SearchStrategy[tuple[str, bytes]]:
        campaign, model = self._seed()
        return st.one_of(
            *[_toml_inputs("campaign.toml", [campaign])] * 4,
            _toml_inputs("model.toml", [model]),
            _inside_text(self._run()).map(lambda made: ("run.csv", made)),
            _inside_zip(frf_file("npz")).map(lambda made: ("frf.npz", made)),
        )

    def run(self, name: str, content: bytes, folder: Path) -> Outcome:
        campaign, model = self._seed()
        (folder / "frf.npz").write_bytes(frf_file("npz"))
        (folder / "run.csv").write_bytes(self._run())
        (folder / "table.csv").write_text("test,100,125,160\n1,2.0,3.0,4.0\n2,5.0,6.0,7.0\n")
        (folder / "model.toml").write_bytes(toml(model))
        (folder / "campaign.toml").write_bytes(toml(campaign))
        (folder / name).write_bytes(content)
        path = folder / "campaign.toml"
        try:
            read_campaign(path).load()
        except InputError as error:
            _reported(error)
            if name == "campaign.toml":
                _command("separability", path, content)
            return "refused"
        return "read"

    @staticmethod
    @cache
    def _seed() -> tuple[dict[str, Any], dict[str, Any]]:
        campaign, model = tables()
        campaign["records"][0] |= {"file": "frf.npz", "references": {"a": "hit", "b": "hit far"}}
        row = {"file": "table.csv", "channels": {"a": "rail@12"}, "select": {"test": 2}}
        campaign["records"] += [
            {"name": "row", "condition": "still", "statistic": "decay", "spacing_m": 0.6, **row},
            {"name": "bands", "condition": "tests", "statistic": "bands", **row},
        ]
        return campaign, model

    @staticmethod
    @cache
    def _run() -> bytes:
        x = np.random.default_rng(3).normal(size=(2, 2000))
        return "\n".join(["axle,floor", *(f"{a:.4g},{b:.4g}" for a, b in x.T.tolist())]).encode()


class Studies(Target):
    """Study files, and the model of their first case."""

    def inputs(self) -> st.SearchStrategy[tuple[str, bytes]]:
        seeds = [table for _, table in _examples() if "axes" in table]
        plain = tables()[1]
        several = {"path": "line.laws.pad.stiffness", "values": {"from": 1e7, "to": 9e7, "count": 5}}
        paired = {"paths": ["temperature_C", "line.joints[0].scale"], "values": [[1.0, 2.0], [3.0, 4.0]]}
        seeds.append({"model": plain, "keep": ["receptance"], "axes": {"a": several, "b": paired}})
        seeds.append({"model": plain, "combine": "sample", "sample": {"count": 4}, "axes": {"a": {**several}}})
        return _toml_inputs("study.toml", seeds)

    def run(self, name: str, content: bytes, folder: Path) -> Outcome:
        path = folder / name
        path.write_bytes(content)
        for file, table in _examples():
            if not (folder / file).exists():
                (folder / file).write_bytes(toml(table))
        try:
            study = read_study(path)
            study.plan.file_name(study.plan.cases - 1)
            study.model(0)
        except InputError as error:
            _reported(error)
            return "refused"
        return "read"


class Sheets(Target):
    """Measuring teams' sheets; the records beside them are not there."""

    def inputs(self) -> st.SearchStrategy[tuple[str, bytes]]:
        structured = damaged_table([sheets.SHEET]).map(lambda table: json.dumps(table, default=str).encode())
        return st.tuples(st.just("sheet.json"), structured | damaged_bytes(json.dumps(sheets.SHEET).encode()))

    def run(self, name: str, content: bytes, folder: Path) -> Outcome:
        (folder / name).write_bytes(content)
        (folder / "hammer_+12C.mat").write_bytes(frf_file("mat"))
        try:
            import_sheet(folder, folder / "out")
        except InputError as error:
            _reported(error)
            return "refused"
        return "read"


class Core(Target):
    """The compiled core's tables: shapes, types, numbers, indices. See :mod:`core`."""

    def inputs(self) -> st.SearchStrategy[tuple[str, bytes]]:
        return st.integers(0, 2**63).map(lambda number: ("core.txt", str(number).encode()))

    def run(self, name: str, content: bytes, folder: Path) -> Outcome:
        stated = core.attempt(int(content))
        if stated.startswith("broken"):
            raise BrokenLawError(stated)
        return "read" if stated == "solved" else "refused"


def _reported(error: InputError) -> None:
    """An error must say what and where, on one line of the terminal."""
    if not error.what or not error.where:
        raise BrokenLawError(f"an InputError without what or where: {error!r}")


def _command(command: str, path: Path, content: bytes) -> None:
    """Now and then the same through the command line: exit status 2."""
    if sum(content[-8:]) % COMMANDS:
        return
    streams = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(streams[0]), contextlib.redirect_stderr(streams[1]):
        try:
            app([command, str(path)], standalone_mode=False)
        except InputError:
            return
        except SystemExit as end:
            if end.code == 2:
                return
            raise BrokenLawError(f"the command ends with {end.code}") from end
    raise BrokenLawError("the command takes what Python refuses")


TARGETS: dict[str, Target] = {
    "readers": Readers(),
    "hdf5": Hdf5(),
    "tables": Tables(),
    "model": Models(),
    "campaign": Campaigns(),
    "study": Studies(),
    "sheet": Sheets(),
    "core": Core(),
}
