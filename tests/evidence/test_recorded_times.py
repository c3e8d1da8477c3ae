"""Processor times that an earlier sweep measured: given to the runs they are of, and to no others."""

import json
from pathlib import Path

import pytest

from bezstab.errors import InputError
from bezstab.evidence import Run, read_times, with_recorded_times
from bezstab.methods import lookup

ROW = {"method": "SYM", "h": 0.01, "run_evaluations": 10, "seconds": 0.2, "seconds_min": 0.1, "seconds_max": 0.4}


def written(path: Path, text: str) -> Path:
    (file := path / "times.json").write_text(text, encoding="utf-8")
    return file


def run_of(evaluations: int) -> Run:
    return Run(
        method=lookup("SYM"),
        h=0.01,
        alpha_hat=0.3,
        beta_hat=0.1,
        z_abs=0.9,
        trajectory_error=1e-3,
        c_max=1e-5,
        measured_error=1e-5,
        predicted_error=1e-5,
        c_rms=1e-5,
        cdot_max=1e-5,
        cdot_rms=1e-5,
        energy_drift=0.0,
        evaluations=evaluations,
        factorizations=evaluations,
        seconds=1.0,
        seconds_min=1.0,
        seconds_max=1.0,
        failure=None,
        order=None,
    )


def test_a_run_gets_the_times_of_its_method_and_step(tmp_path: Path) -> None:
    rows = [{**ROW, "h": 0.02, "seconds": 7.0}, ROW, {**ROW, "method": "B2", "seconds": 8.0}]
    recorded = read_times(written(tmp_path, json.dumps(rows)), ["SYM"], [0.01])
    (run,) = with_recorded_times([run_of(10)], recorded)
    assert (run.seconds, run.seconds_min, run.seconds_max, run.evaluations) == (0.2, 0.1, 0.4, 10)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[]", "no run of SYM with h = 0.01 s"),
        (json.dumps([{**ROW, "h": 0.02}]), "no run of SYM with h = 0.01 s"),
        (json.dumps([{**ROW, "seconds": 0}]), "expected the rows that tradeoff prints"),
        (json.dumps([{**ROW, "seconds": None}]), "expected the rows that tradeoff prints"),
        ('[{"method": "SYM"}]', "expected the rows that tradeoff prints"),
        ('{"method": "SYM"}', "expected the rows that tradeoff prints"),
        ("3", "expected the rows that tradeoff prints"),
        ("[", "Expecting value"),
    ],
)
def test_what_says_nothing_of_these_runs_is_refused(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(InputError, match=rf"^times .*times\.json: {said}"):
        read_times(written(tmp_path, text), ["SYM"], [0.01])


@pytest.mark.promise(
    "Costs of runs",
    measured=(
        "evaluations counted exactly; processor time with its least and largest of the repeats, or as recorded in"
        " an earlier run, and then never those of other runs"
    ),
)
def test_times_of_longer_runs_are_refused(tmp_path: Path) -> None:
    """Eleven evaluations may be ten and another iteration of Newton's method; beside nine they are of another run."""
    recorded = read_times(written(tmp_path, json.dumps([{**ROW, "run_evaluations": 11}])), ["SYM"], [0.01])
    assert with_recorded_times([run_of(10)], recorded)[0].seconds == 0.2
    with pytest.raises(InputError, match=r"SYM with h = 0\.01 s took 11 evaluations, not 9"):
        with_recorded_times([run_of(9)], recorded)
