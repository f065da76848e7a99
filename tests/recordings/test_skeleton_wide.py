"""Tables of responses side by side, one hit point a file, as labs export them: `permway new` knows the point."""

from __future__ import annotations

import tomllib
from pathlib import Path

import permway
from permway.laws.toml import to_toml
from permway.recordings.skeleton import write_skeleton
from simulated import BLOWS, CAMPAIGN, FREQUENCY, MODEL, simulate


def test_a_file_of_one_hit_point_names_it(tmp_path: Path) -> None:
    (dataset,) = simulate(tmp_path / "made", 5).campaign.load()
    folder = tmp_path / "exports"
    folder.mkdir()
    frf, coherence = dataset.data["frf"].values, dataset.data["coherence"].values
    sensors, points = dataset.names("sensor"), dataset.names("force")
    for j, point in enumerate(points):
        head = ["Frequency [Hz]"]
        for name in sensors:
            head += [f"{name} Real [(m/s2)/N]", f"{name} Imag [(m/s2)/N]", f"{name} Coherence"]
        rows = [",".join(head)]
        for k, f in enumerate(FREQUENCY):
            cells = [f"{f:g}"]
            for i in range(len(sensors)):
                cells += [f"{frf[i, j, k].real:.6g}", f"{frf[i, j, k].imag:.6g}", f"{coherence[i, j, k]:.6f}"]
            rows.append(",".join(cells))
        (folder / f"{point}.csv").write_text("\n".join(rows) + "\n")
    write_skeleton(folder)
    path = folder / "campaign.toml"
    table = tomllib.loads(path.read_text("utf-8"))
    assert {p["name"] for p in table["forces"]} == {f"hit {point}" for point in points}
    assert [r["responses"] for r in table["records"]] == [sensors] * len(points)
    # Answered as an engineer would.
    at = {s["name"]: s for s in CAMPAIGN["sensors"]} | {f"hit {p['name']}": p for p in CAMPAIGN["forces"]}
    for one in (*table["sensors"], *table["forces"]):
        one |= {key: at[one["name"]][key] for key in ("body", "x_m")}
    for record in table["records"]:
        record["averages"] = BLOWS
    table["conditions"][0]["temperature_C"] = 12.0
    path.write_text(to_toml(table))
    (folder / "model.toml").write_text(to_toml(MODEL))
    checked = permway.check(path)
    assert checked.blunders == ()
    assert len(checked.records) == len(points)
