"""Writes the verdict's published schema, docs/verdict.schema.json: run `python docs/make_schema.py`."""

from __future__ import annotations

import json
from pathlib import Path

from permway.diagnosis.verdict import json_schema
from permway.files import write_text

if __name__ == "__main__":
    text = json.dumps(json_schema(), indent=2, ensure_ascii=False) + "\n"
    write_text(Path(__file__).parent / "verdict.schema.json", text)
