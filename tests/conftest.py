"""Settings of all tests, and which of them take long; having this file here lets them import `lines`."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# Whole lines are slow to draw, and a machine under load slower still.
settings.register_profile("permway", deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True)
settings.load_profile("permway")


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print what tests recorded beyond that they passed: the outcomes of seeds that were drawn anew."""
    for reports in terminalreporter.stats.values():
        for report in reports:
            for name, value in getattr(report, "user_properties", ()):
                if name == "outcome" and report.when == "call":
                    terminalreporter.write_line(str(value))


HERE = Path(__file__).parent
LONG = {
    "fits": """
        cli/test_check.py docs/test_examples.py posterior recordings/test_skeleton.py
        recordings/test_skeleton_wide.py recordings/test_bad_channels.py report/test_compare.py report/test_demo.py
        report/test_diagnosis_page.py report/test_one_source.py sealed challenge/test_clipped.py
        challenge/test_follow.py first_hour checking/test_stated.py checking/test_noise_floors.py
        checking/test_blunders.py diagnosis/effects diagnosis/test_awaited.py diagnosis/test_bent_valley.py
        diagnosis/test_diagnose.py diagnosis/test_elsewhere.py diagnosis/test_frf_block.py
        diagnosis/test_nearby.py diagnosis/test_noise.py diagnosis/test_one_place.py
        diagnosis/test_passage.py diagnosis/test_passage_unevenness.py diagnosis/test_recalibrate.py
        diagnosis/test_ruled_out.py
        diagnosis/test_separability.py diagnosis/test_side_by_side.py diagnosis/test_small_sizes.py
        diagnosis/test_calibration_errors.py diagnosis/test_table_of_modes.py diagnosis/test_tolerances.py
    """,
    "campaigns": """
        challenge/test_challenge_and_sliding.py challenge/test_challenge_and_solver.py
        challenge/test_challenge_campaigns.py challenge/test_challenge_contact.py
        challenge/test_challenge_crossing.py challenge/test_challenge_elements.py
        challenge/test_challenge_sliders.py challenge/test_concealed_effects.py
        challenge/test_faults_and_blows.py challenge/test_graded.py challenge/test_parameters.py
        challenge/test_recalibrated.py challenge/test_rolling_train.py challenge/test_run.py
        challenge/test_small_campaigns.py challenge/test_small_null.py challenge/test_small_passages.py
        challenge/test_small_rate.py
        challenge/test_small_strength.py challenge/test_small_suite.py challenge/test_small_tier.py
        challenge/test_spans_on_fasteners.py challenge/test_suite.py challenge/test_tiers.py
        challenge/test_under_train.py challenge/test_weigh.py challenge/test_where_wheels_stand.py
    """,
    "programs": """
        cli/test_cli.py cli/test_help.py cli/test_disk_full.py kill report/test_browser.py
        response/test_processes.py study/test_cluster.py study/test_cluster_killed.py study/test_command.py
        study/test_interrupted.py study/test_sweep.py
    """,
    "long": """
        fuzz report/test_paper.py response/test_rolling.py
        laws/test_law_recordings.py property recordings/test_readers_fuzz.py recordings/test_readers_drawn.py
        recordings/test_estimates_coverage.py recordings/test_import_whole.py recordings/test_inputs_shared.py
        recordings/test_campaign_passage.py recordings/test_campaigns_shared.py
        recordings/test_scatter_by_unevenness.py docs/test_five_exports.py
    """,
}
"""By marker, files and folders that `pytest` alone leaves out; the tests of all others are marked "quick"."""


def pytest_configure(config: pytest.Config) -> None:
    """Take the quick tests of all, and every test of a file or folder that is named, unless -m asks otherwise."""
    if not config.option.markexpr:
        by_itself = config.args_source is pytest.Config.ArgsSource.TESTPATHS
        config.option.markexpr = "quick" if by_itself else "not injection"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark each test by what its file does."""
    marks = {HERE / name: mark for mark, names in LONG.items() for name in names.split()}
    gone = [str(path) for path in marks if not path.exists()]
    if gone:
        raise pytest.UsageError(f"tests/conftest.py names what does not exist: {', '.join(gone)}")
    for item in items:
        mark = next((marks[path] for path in (item.path, *item.path.parents) if path in marks), "quick")
        if item.get_closest_marker("injection") is None:
            item.add_marker(mark)
    # What takes longest is begun first, so that no worker is left with it at the end.
    order = ["campaigns", "fits", "long", "programs", "quick"]
    items.sort(
        key=lambda item: min((order.index(m.name) for m in item.iter_markers() if m.name in order), default=9)
    )
