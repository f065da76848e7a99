"""A law in a file of its own, LAW.toml."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from permway.errors import InputError
from permway.laws import AnyLaw, law_from_dict, law_to_dict
from permway.laws.base import Law
from permway.laws.toml import to_toml
from permway.reading import read_toml

if TYPE_CHECKING:
    from permway.laws.identify import Identification

_FORMAT = 1


def save_law(path: str | Path, law: Identification | Law) -> None:
    """Write a law, and how it was identified if it was, as TOML; whole or not at all.

    Parameters
    ----------
    path : path
        To write; an existing file is replaced only when the new one is complete.
    law : Identification or Law
        What to write.

    Raises
    ------
    InputError
        If the folder does not exist or cannot be written to.
    """
    target = Path(path)
    content: dict[str, object] = {"format": _FORMAT}
    if isinstance(law, Law):
        content["law"] = law_to_dict(law)
    else:
        content["law"] = law_to_dict(law.law)
        content["identification"] = _account(law)
    text = to_toml(content)
    try:
        # In the same folder, for only within one file system is a rename a single step.
        handle, name = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
    except OSError as error:
        raise InputError(
            f"cannot be written: {error.strerror}",
            where=str(target),
            remedy="give a path in an existing folder",
        ) from error
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        Path(name).chmod(0o644)
        Path(name).replace(target)
    except OSError as error:
        Path(name).unlink(missing_ok=True)
        raise InputError(f"cannot be written: {error.strerror}", where=str(target)) from error


def load_law(path: str | Path) -> AnyLaw:
    """Read the law of a LAW.toml.

    Parameters
    ----------
    path : path
        With a table `law`.

    Returns
    -------
    Law
        As written; a `TFDV` if a shift was identified with it.

    Raises
    ------
    InputError
        For a file that is missing, not TOML, of another format, or whose law has a fault, with the place in
        it.
    """
    source = Path(path)
    content = read_toml(source, "give an existing file")
    if content.get("format", _FORMAT) != _FORMAT:
        raise InputError(
            "written in a format this version does not know",
            where=f"{source}: format",
            value=content["format"],
            remedy=f"this version reads format {_FORMAT}",
        )
    table = content.get("law")
    if not isinstance(table, dict):
        raise InputError(
            "no table named law", where=str(source), value=sorted(content), remedy="begin it with [law]"
        )
    return law_from_dict(table, where=f"{source}: law")


def identified_quantity(path: str | Path) -> str | None:
    """What the law of a file was identified from, "modulus" or "stiffness"; None of a law written by hand.

    Raises
    ------
    InputError
        As :func:`load_law`.
    """
    account = read_toml(Path(path), "give an existing file").get("identification")
    quantity = account.get("quantity") if isinstance(account, dict) else None
    return quantity if isinstance(quantity, str) else None


def _account(found: Identification) -> dict[str, object]:
    return {
        "family": found.family,
        "shift": found.shift,
        "quantity": found.table.quantity,
        "source": found.table.source,
        "rows": found.n_rows,
        "seed": found.seed,
        "evaluations": found.evaluations,
        "rms_log10_modulus": found.rms_log10_modulus,
        "rms_loss_factor": found.rms_loss_factor,
        "aic": found.aic,
        "bic": found.bic,
        "notes": list(found.notes),
        "parameters": [
            {"name": p.name, "value": p.value, "low_5": p.low, "high_95": p.high, "note": p.note or None}
            for p in found.parameters
        ],
    }
