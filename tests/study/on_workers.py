"""What workers of a cluster are given to do in tests: they import it from this folder."""

import os
import time
from pathlib import Path


def noted(number, log, seconds):
    """Note that an item was begun, in a file that all processes of this machine add to; its square."""
    handle = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    os.write(handle, f"{number}\n".encode())
    os.close(handle)
    time.sleep(seconds)
    return number**2


def refused(number):
    """An item that fails by itself."""
    raise ValueError(f"not {number}")


def counted(name, seconds, folder):
    """Work in a folder: the sum of the numbers in a file, into another and into one that says that it is done."""
    total = sum(int(line) for line in (Path(folder) / name / "given.txt").read_text().split())
    time.sleep(seconds)
    (Path(folder) / name / "made").mkdir()
    (Path(folder) / name / "made" / "done.txt").write_text("done")
    (Path(folder) / name / "made" / "sum.txt").write_text(f"{total}")
    return total
