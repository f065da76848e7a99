"""Writes the verdicts of the sealed campaigns: `python tests/sealed/make.py ../shared/campaigns`.

Each folder is imported and diagnosed by the commands that a user would call, with no option of its own. A campaign
that has a verdict already is left alone; remove the file to have it made again.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).parent


def one(folder: Path) -> str:
    """Import and diagnose one campaign."""
    target = HERE / f"{folder.name}.verdict.json"
    if target.is_file():
        return f"{folder.name}: there already"
    with tempfile.TemporaryDirectory() as scratch:
        campaign, out = Path(scratch) / "campaign", Path(scratch) / "diagnosis"
        for command in (
            ["import", "sheet", str(folder), "-o", str(campaign)],
            ["diagnose", str(campaign / "campaign.toml"), "-o", str(out), "--no-report"],
        ):
            ended = subprocess.run([sys.executable, "-m", "permway", *command], capture_output=True, text=True)
            if ended.returncode != 0:
                return f"{folder.name}: {ended.stderr.strip()}"
        shutil.move(out / "verdict.json", target)
    return f"{folder.name}: {ended.stdout.splitlines()[0]}"


def main() -> None:
    """Over all folders called sealed-*."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("campaigns", type=Path, help="where the folders sealed-* lie")
    parser.add_argument("--workers", type=int, default=1, help="campaigns at the same time")
    arguments = parser.parse_args()
    folders = sorted(arguments.campaigns.glob("sealed-*"))
    with ThreadPoolExecutor(arguments.workers) as pool:
        for stated in pool.map(one, folders):
            print(stated, flush=True)


if __name__ == "__main__":
    main()
