"""The report of peers.py as Markdown."""

from __future__ import annotations

TITLES = {
    "rail": "Rail on 241 supports, 1500 frequencies from 20 to 3000 Hz",
    "viaduct-1": "The paper's line: 51 fasteners, four layers, 1500 frequencies from 1 to 1000 Hz, four wheels",
    "viaduct-10": "Ten spans of it: 510 fasteners, 1550 joints, the same",
}
# The bar of a case is against this peer.
AGAINST = {"rail": "rolland", "viaduct-1": "numpy", "viaduct-10": "numpy"}
PEERS = {
    "rolland": "rolland (TSBDiscr1L)",
    "numpy": "numpy, dense (LAPACK)",
    "sparse": "scipy, sparse (splu)",
}


def _verdict(value: float, bar: float, aim: float | None = None, *, less: bool = False) -> str:
    met = value <= bar if less else value >= bar
    text = f"bar {bar:g}: {'met' if met else '**missed**'}"
    if aim is not None:
        text += f"; aim {aim:g}: {'met' if value >= aim else 'not met'}"
    return text


def _case(row: dict) -> list[str]:
    own = row["permway"]
    lines = [
        f"### {TITLES[row['case']]}",
        "",
        "| | ms per frequency | median | ratio | of processor time | of solving | memory, MiB | difference |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
        f"| permway, chain | {own['ms_per_frequency']:.5f} | {own['median_ms_per_frequency']:.5f} | 1 | 1 | 1 "
        f"| {own['peak_memory_MiB']:.0f} | |",
    ]
    for name, peer in row["peers"].items():
        ratios = (peer[f"ratio{of}"] for of in ("", "_of_processor", "_of_solving"))
        lines.append(
            f"| {PEERS[name]} | {peer['ms_per_frequency']:.4f} | {peer['median_ms_per_frequency']:.4f} | "
            + " | ".join(f"{ratio:.0f}" for ratio in ratios)
            + f" | {peer['peak_memory_MiB']:.0f} | {peer['difference']:.0e} |"
        )
    peer = row["peers"].get(AGAINST[row["case"]])
    if peer:
        lines += ["", f"Against {AGAINST[row['case']]}: {peer['ratio']:.0f} times. "]
        lines[-1] += _verdict(peer["ratio"], row["bar"], row["aim"]).capitalize() + "."
        if row["case"] == "rail":
            lines[-1] += f" Memory in MiB, {_verdict(own['peak_memory_MiB'], 200, less=True)}."
    return [*lines, ""]


def _stations(rows: list[dict]) -> list[str]:
    lines = [
        "### Cost of a station, one thread, 1000 frequencies, one force and one sensor",
        "",
        "| spans | ns per frequency and fastener, core | median | whole call | setting up, ms |",
        "|---:|---:|---:|---:|---:|",
    ]
    for row in rows:
        lines.append(
            f"| {row['spans']} | {row['core_ns_per_station']:.1f} | {row['median_core_ns_per_station']:.1f} "
            f"| {row['call_ns_per_station']:.1f} | {row['setting_up_ms']:.2f} |"
        )
    costs = [row["core_ns_per_station"] for row in rows]
    from_two = costs[1:]
    lines += [
        "",
        f"Largest over smallest: {max(costs) / min(costs):.2f} from 1 to 200 spans "
        f"({_verdict(max(costs) / min(costs), 1.15, less=True)}); {max(from_two) / min(from_two):.2f} from 2 on.",
        "",
    ]
    return lines


def _threads(rows: list[dict], long: list[dict]) -> list[str]:
    lines = [
        "### Two threads against one, and 3.2 km",
        "",
        "| spans | frequencies | one thread over two, core | median of rounds | whole call |",
        "|---:|---:|---:|---:|---:|",
    ]
    for row in rows:
        lines.append(
            f"| {row['spans']} | {row['frequencies']} | {row['core_ratio']:.2f} | {row['median_core_ratio']:.2f} "
            f"| {row['call_ratio']:.2f} |"
        )
    lines += ["", _verdict(min(row["core_ratio"] for row in rows), 1.85).capitalize() + ".", ""]
    for row in long:
        lines.append(
            f"- 100 spans (15,500 joints), 2000 frequencies, threads {row['threads']}: {row['call_s']:.2f} s, "
            f"with building the model {row['model_and_call_s']:.2f} s, memory {row['peak_memory_MiB']:.0f} MiB."
        )
    return [*lines, ""]


def markdown(report: dict) -> str:
    """Everything as tables, bars beside."""
    machine, versions = report["machine"], report["versions"]
    lines = [
        "# permway and its peers",
        "",
        f"{machine['processor']}, {machine['cores']} cores, {', '.join(machine['instructions'])}; "
        + ", ".join(f"{name} {version}" for name, version in versions.items())
        + f". Load average {machine['load_average'][0]} before, {report['load_average_after'][0]} after "
        "(one side runs at a time, so 1 is ours). One thread each. permway's time is the whole public call; of "
        "solving is its compiled core against numpy's `solve` alone, or the whole of another peer. Difference: "
        "largest, in terms of the direct receptances at the two places.",
        "",
    ]
    for row in report["cases"]:
        lines += _case(row)
    lines += _stations(report["stations"]) + _threads(report["threads"], report["long"])
    return "\n".join(lines)
