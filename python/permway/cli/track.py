"""`permway dispersion` and `permway irregularity`: what a model file states about a track without solving it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from permway.cli.output import Json, examples, print_result

tracks = typer.Typer(rich_markup_mode=None)
Plot = Annotated[Path | None, typer.Option(help="Folder for the picture (PNG).")]


@tracks.command(
    epilog=examples(
        "permway dispersion model.toml --plot pictures",
        "permway dispersion model.toml --body rail --held girder -o waves.csv",
    )
)
def dispersion(
    model: Annotated[Path, typer.Argument(help="Model file (TOML).")],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Table of wavenumbers and frequencies (CSV).")
    ] = None,
    plot: Plot = None,
    body: Annotated[
        str | None, typer.Option(help="Beam that the load moves on; by default the first without ends.")
    ] = None,
    held: Annotated[
        list[str] | None, typer.Option(help="Body taken as rigid and at rest; may be repeated.")
    ] = None,
    from_m: Annotated[
        float | None, typer.Option("--from", help="Begin of the stretch whose joints are shared out, m.")
    ] = None,
    to_m: Annotated[float | None, typer.Option("--to", help="End of the stretch, m.")] = None,
    as_json: Json = False,
) -> None:
    """Waves along a track, and its critical speed.

    Joints and rows of masses are shared out over the length, loss is left out. The critical speed is the lowest at
    which a wave carries its energy as fast as it runs: a load that moves so meets no bound.
    """
    from permway.formats.model_file import read_model
    from permway.response.dispersion import dispersion as run

    described = read_model(model)
    found = run(
        described.line,
        body=body,
        held=tuple(held or ()),
        from_m=from_m,
        to_m=to_m,
        temperature_C=described.temperature_C,
    )
    speed, kappa = found.critical_speed_m_per_s, found.critical_wavenumber_rad_per_m
    result: dict[str, Any] = {
        "critical_speed_m_per_s": speed,
        "critical_speed_km_per_h": None if speed is None else 3.6 * speed,
        "critical_wavelength_m": None if kappa is None else 6.283185307179586 / kappa,
        "critical_frequency_Hz": None if speed is None or kappa is None else speed * kappa / 6.283185307179586,
        "bodies": list(found.bed.bodies),
        "stretch_m": list(found.bed.stretch_m),
        "branches": [
            {"branch": i + 1, "cut_on_Hz": float(f[0]), "slowest_m_per_s": float(c.min())}
            for i, (f, c) in enumerate(zip(found.frequency_Hz.T, found.phase_speed_m_per_s.T, strict=True))
        ],
        "notes": list(found.notes),
    }
    if output is not None:
        from permway.files import write_bytes

        names = ["wavenumber [rad/m]", *(f"frequency {i + 1} [Hz]" for i in range(found.frequency_Hz.shape[1]))]
        rows = (
            ",".join(f"{v:.9g}" for v in (k, *f))
            for k, f in zip(found.wavenumber_rad_per_m, found.frequency_Hz, strict=True)
        )
        result["table"] = str(write_bytes(output, "\n".join([",".join(names), *rows, ""]).encode()))
    if plot is not None:
        from permway.report.track import draw_dispersion

        result["picture"] = str(draw_dispersion(found, plot))
    print_result(result, as_json)


@tracks.command(
    epilog=examples(
        "permway irregularity model.toml --plot pictures",
        "permway irregularity model.toml -o profile.csv --length 1000 --spacing 0.25 --seed 1",
    )
)
def irregularity(
    model: Annotated[Path, typer.Argument(help="Model file (TOML), of which only [irregularity] is read.")],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Profile drawn from the spectrum (CSV: m, mm).")
    ] = None,
    plot: Plot = None,
    length: Annotated[float, typer.Option(help="Length of the profile, m.")] = 1000.0,
    spacing: Annotated[float, typer.Option(help="Distance between its samples, m.")] = 0.25,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the profile.")] = 0,
    as_json: Json = False,
) -> None:
    """Standard deviations D1 to D3, and a profile in space.

    Bands of wavelengths as in EN 13848-1: D1 3 to 25 m, D2 25 to 70 m, D3 70 to 150 m. Only wavelengths that the
    spectrum's source covers are counted.
    """
    import numpy as np

    from permway.files import write_bytes
    from permway.formats.irregularity_file import irregularity_of
    from permway.model.track_quality import band_deviations, draw_profile

    described = irregularity_of(model)
    profile = draw_profile(described, length_m=length, spacing_m=spacing, seed=seed)
    x = spacing * np.arange(profile.size, dtype=np.float64)
    shortest, longest = described.valid_wavelength_m
    result: dict[str, Any] = {
        "irregularity": type(described).__name__,
        "wavelengths_m": [shortest, longest],
        "bands": [
            {
                "band": band.band,
                "from_m": band.from_m,
                "to_m": band.to_m,
                "deviation_mm": None if band.deviation_m is None else 1e3 * band.deviation_m,
                "note": ""
                if band.whole
                else "no wave of the source"
                if band.covered_m is None
                else f"only {band.covered_m[0]:g} to {band.covered_m[1]:g} m",
            }
            for band in band_deviations(described)
        ],
        "profile_deviation_mm": 1e3 * float(profile.std()),
    }
    if output is not None:
        rows = "".join(f"{a:.6g},{1e3 * b:.6g}\n" for a, b in zip(x, profile, strict=True))
        result["profile"] = str(write_bytes(output, ("x [m],longitudinal level [mm]\n" + rows).encode()))
    if plot is not None:
        from permway.report.track import draw_irregularity

        result["picture"] = str(draw_irregularity(described, x, profile, plot))
    print_result(result, as_json)
