"""Which format a file has: by what it begins with; its name must not contradict."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Literal, get_args

from permway.errors import InputError

Format = Literal["text", "uff", "mat", "mat73", "npz", "hdf5", "netcdf", "netcdf3", "tdms", "wav", "lvm", "mdf"]

_HDF5 = b"\x89HDF\r\n\x1a\n"
_SUFFIXES: dict[str, tuple[Format, ...]] = {
    **dict.fromkeys((".csv", ".tsv"), ("text",)),
    **dict.fromkeys((".uff", ".unv", ".uf", ".58"), ("uff",)),
    ".mat": ("mat", "mat73"),
    ".npz": ("npz",),
    **dict.fromkeys((".h5", ".hdf5", ".hdf"), ("hdf5", "netcdf")),
    **dict.fromkeys((".nc", ".nc4", ".cdf"), ("netcdf", "netcdf3")),
    ".tdms": ("tdms",),
    ".wav": ("wav",),
    ".lvm": ("lvm",),
    **dict.fromkeys((".mf4", ".mdf"), ("mdf",)),
}
_UNREAD: tuple[tuple[bytes, str, str], ...] = (
    (b"\x93NUMPY", "a bare NumPy array, without names and units", "save it with numpy.savez and name its parts"),
    (b"\x80", "a Python pickle, which could run code", "save it with numpy.savez"),
    (b"\x1f\x8b", "a gzip archive", "unpack it"),
    (b"7z\xbc\xaf", "a 7-Zip archive", "unpack it"),
    (b"\xd0\xcf\x11\xe0", "an old spreadsheet", "export it as CSV"),
    (b"RF64", "a WAV file of more than 4 GB (RF64)", "export it as HDF5, or in parts"),
    (b"RIFX", "a big-endian WAV file", "export it as an ordinary WAV file"),
    (b"\xff\xfe", "text in UTF-16", 'export it in UTF-8, or say in the record encoding = "utf-16"'),
    (b"\xfe\xff", "text in UTF-16", 'export it in UTF-8, or say in the record encoding = "utf-16"'),
)


def recognise(source: Path, stated: str | None = None, encoding: str | None = None) -> Format:
    """The format of a file.

    Parameters
    ----------
    source : Path
    stated : str, optional
        The format as the caller states it; the content must not be plainly another.
    encoding : str, optional
        Character set of a text: one in UTF-16 has zero bytes, and is a text only if that was stated.

    Raises
    ------
    InputError
        If the content is none that is read here, or another than its name or the caller states.
    """
    if stated is not None and stated not in get_args(Format):
        raise InputError(
            "no format of this name", where="format", value=stated, remedy=f"use one of {get_args(Format)}"
        )
    if encoding is not None and encoding.lower().replace("_", "-").startswith(("utf-16", "utf-32")):
        return "text"
    found = _by_content(source)
    wanted: tuple[str, ...] = _SUFFIXES.get(source.suffix.lower(), ()) if stated is None else (stated,)
    if stated in ("hdf5", "netcdf", "mat73") and found in ("hdf5", "netcdf", "mat73"):
        return stated  # type: ignore[return-value]
    if not wanted or found in wanted:
        # A file of HDF5 is named .nc or .h5, and nothing inside need state which.
        return "netcdf" if found == "hdf5" and "hdf5" not in wanted and "netcdf" in wanted else found
    if found == "hdf5" and wanted[0] in ("netcdf", "mat"):
        return "netcdf" if wanted[0] == "netcdf" else "mat73"
    raise InputError(
        f"the {'name' if stated is None else 'caller'} states {' or '.join(wanted)}, the content is {found}",
        where=str(source),
        value=source.suffix if stated is None else stated,
        remedy=f'rename it, or say format="{found}" if that is right',
    )


def _by_content(source: Path) -> Format:
    with source.open("rb") as file:
        head = file.read(4096)
    for start, what, remedy in _UNREAD:
        if head.startswith(start):
            raise InputError(f"is {what}", where=str(source), remedy=remedy)
    if head[:4] == b"RIFF" and head[8:12] == b"WAVE":
        return "wav"
    if head[:8] == b"MDF     ":
        return "mdf"
    if head[:8] == b"UnFinMF ":
        raise InputError("was not finalised: its recorder stopped before", where=str(source), remedy="finalise it")
    if head[:4] == b"TDSm":
        return "tdms"
    if head[:4] == b"TDSh":
        raise InputError("is the index of a TDMS file", where=str(source), remedy="give the .tdms file beside it")
    if head[:4] in (b"PK\x03\x04", b"PK\x05\x06"):
        return "npz"
    if head.startswith(b"MATLAB 7.3") or (head.startswith(b"MATLAB") and head[512:520] == _HDF5):
        return "mat73"
    if head.startswith(_HDF5):
        return "netcdf" if source.suffix.lower() in (".nc", ".nc4", ".cdf") else "hdf5"
    if head[:4] in (b"CDF\x01", b"CDF\x02", b"CDF\x05"):
        return "netcdf3"
    if head[126:128] in (b"IM", b"MI") and head[124:128] in (b"\x00\x01IM", b"\x01\x00MI"):
        return "mat"
    if head.removeprefix(b"\xef\xbb\xbf").startswith(b"LabVIEW Measurement"):
        return "lvm"
    if re.match(rb"\s*-1[ \t]*\r?\n\s*\d+", head):
        return "uff"
    if b"\x00" in head or len(re.findall(rb"[\x01-\x08\x0e-\x1f]", head)) > len(head) // 50:
        raise InputError(
            "the content is no format that is read here",
            where=str(source),
            value=head[:16],
            remedy="give UFF, MAT (version 4: save as -v7), CSV, TSV, NPZ, HDF5, NetCDF, TDMS, LVM, MDF or WAV",
        )
    return "text"
