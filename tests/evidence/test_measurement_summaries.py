from dataclasses import replace

import numpy as np
import pytest

from bezstab.evidence import measure_poles, measurement_summary
from bezstab.mechanism import compiled_mechanism, load_scene
from bezstab.methods import lookup


def test_errors_verdicts_and_wrong_sides_are_counted() -> None:
    mechanism = compiled_mechanism(load_scene("pendulum"))
    (good,) = measure_poles(mechanism, lookup("SYM"), 0.001, np.array([1.0]), np.array([0.5]))
    assert good.measured is not None
    off = replace(good, measured=good.measured * 1.5, measured_verdict="diverges")
    lost = replace(good, measured=None, measured_verdict="too close to call")
    one_side = replace(good, measured_rate=1.1, floquet_abs=1.2)
    summary = measurement_summary([good, off, lost, one_side])
    assert (summary.points, summary.measured, summary.called, summary.wrong) == (4, 3, 3, 1)
    assert summary.largest_error == pytest.approx(0.5 * abs(good.predicted), abs=1e-6)
    assert (summary.followed, summary.wrong_sides) == (1, "1, 1, 0")
    assert summary.floquet_error == pytest.approx(0.1, abs=1e-12)
