from fractions import Fraction
from functools import partial

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene
from bezstab.methods.registry import lookup
from bezstab.runs.simulating import run_of

POINT = (Fraction(1), Fraction("0.5"))
run = partial(
    run_of,
    compiled_mechanism(load_scene("pendulum")),
    lookup("SYM"),
    duration=Fraction("0.1"),
    h=Fraction("0.01"),
)


def test_a_sequence_of_equal_steps_is_the_run_with_that_step() -> None:
    even, by_sequence = run(point=POINT), run(point=POINT, sequence=(Fraction("0.01"),) * 2)
    np.testing.assert_allclose(by_sequence.q, even.q, rtol=1e-12)
    assert even.stabilise == by_sequence.stabilise == "baumgarte"


def test_feedback_alone_has_a_point() -> None:
    for point, held in ((POINT, "projection"), (POINT, "none"), (None, "baumgarte")):
        with pytest.raises(InputError, match="--stabilise baumgarte"):
            run(point=point, stabilise=held)  # type: ignore[arg-type]
