"""Poles that stand out of noise: stated errors cover the truth, and noise is not taken for poles, nor poles for it."""

import numpy as np
import pytest

from bezstab.evidence import probed_pole
from bezstab.evidence.noisy_prediction import fit_in_noise
from bezstab.methods import REGISTRY, lookup
from bezstab.stability import FloatArray, poles, region, window
from tests.evidence.samples import of_campaign
from tests.reference.sampled_responses import geometric, of_poles, two_poles

KICK = 1e-4
ROWS = 120


def white(random: np.random.Generator, size: float, rows: int = ROWS) -> FloatArray:
    return np.asarray(size * random.normal(size=rows))


@pytest.mark.parametrize(("noise", "runs", "angle"), [(1e-9, 1, 0.5), (1e-7, 1, 0.0), (1e-7, 2, 0.5)])
def test_a_pole_of_seven_tenths_is_found_whatever_covers_it(noise: float, runs: int, angle: float) -> None:
    """By one run or two, beside what the motion forces slowly; known the better, the less noise there is."""
    random = np.random.default_rng(1)
    forced = 1e-3 + 1e-6 * np.cos(0.01 * np.arange(ROWS))
    c = KICK * two_poles(ROWS, 0.7, angle, 0.3, 0.0) + forced + white(random, noise)
    found = probed_pole(c) if runs == 1 else probed_pole(c, forced + white(random, noise))
    assert found.pole is not None, found.reason
    assert found.uncertainty is not None
    assert abs(found.pole - 0.7 * np.exp(1j * angle)) < found.uncertainty < 500 * noise / KICK
    assert "in noise of " in found.reason


def logs_in_noise(count: int, seed: int) -> list[float]:
    """Return how far off the poles are that are told of so many random logs, in stated errors.

    Poles of random methods at random points of their regions, kicked at random, two runs: the nearest pole counts.
    """
    random = np.random.default_rng(seed)
    off: list[float] = []
    tried = 0
    while tried < count:
        method = lookup(str(random.choice(list(REGISTRY))))
        z = poles(method, *random.uniform(*np.transpose(window(region(method)))).tolist())
        if not 0.2 < abs(z[0]) < 0.995:  # gone at once, or still there at the end
            continue
        tried += 1
        clean = KICK * of_poles(z[np.abs(z) > 1e-3], int(random.integers(60, 400)), seed=tried)
        noise = KICK * 10 ** random.uniform(-6, -0.5)
        found = probed_pole(clean + white(random, noise, len(clean)), white(random, noise, len(clean)))
        if found.pole is not None and found.uncertainty is not None:
            off.append(float(np.abs(z - found.pole).min()) / found.uncertainty)
    return off


@pytest.mark.parametrize("count", [8, pytest.param(of_campaign(600, 40), marks=pytest.mark.slow)])
def test_the_stated_error_covers_the_pole_of_random_logs_in_noise(count: int) -> None:
    """In 97 of 100 at least. The others have two poles closer together than the noise resolves: they look like one."""
    off = logs_in_noise(count, seed=12)
    assert len(off) > 0.5 * count
    assert np.mean(np.array(off) <= 1) >= 0.97
    assert np.median(off) > 0.1  # nor is so much allowed that it covers anything


@pytest.mark.slow
def test_where_there_is_nothing_but_noise_that_is_said() -> None:
    random = np.random.default_rng(2)
    for _ in range(of_campaign(25, 10)):
        size = float(10 ** random.uniform(-12, 0))
        c = white(random, size, int(random.integers(60, 400)))
        fit = fit_in_noise(c, order=8)
        assert fit is not None
        assert not fit.poles
        assert fit.noise == pytest.approx(size, rel=0.35)  # four times 1 / sqrt(2 * 60)
        for found in (probed_pole(c), probed_pole(c, 0 * c), probed_pole(c + 0.3)):
            assert found.pole is None
            assert found.reason.startswith("noise of")


@pytest.mark.slow
def test_what_is_no_white_noise_is_not_taken_for_it() -> None:
    """Neither what is related from sample to sample, nor what grows, nor what a motion forces without any noise."""
    k = np.arange(300)
    steps = white(np.random.default_rng(3), 1.0, 300)
    related = np.convolve(steps, 0.7**k)[:300]
    for c in (related, steps * (1 + k) ** 2, np.sin(0.02 * k + 0.3 * np.sin(0.05 * k)), np.log(1 + k)):
        found = probed_pole(c, 0 * c)
        assert found.pole is None or "noise" not in found.reason


def test_noise_does_not_end_with_the_stretch() -> None:
    """A few poles fit whatever is short and smooth, to what looks like noise; the rows that follow have none."""
    random = np.random.default_rng(4)
    k = np.arange(300)
    smooth = np.where(k < 40, white(random, 1e-6, 300), 0.0) + 1e-4 * geometric(300, 0.6) + np.exp(-k / 500)
    assert fit_in_noise(smooth, order=8) is None
    ends = np.where(k < 30, white(random, 1e-6, 300), 0.0)  # nothing at all is left over of the rest
    assert fit_in_noise(ends, order=8) is None


def test_of_several_responses_the_one_that_shows_the_pole_best_counts() -> None:
    random = np.random.default_rng(5)
    shape = two_poles(200, 0.8, 0.6, 0.3, 0.0)
    alone = 1e3 * shape + white(random, 1.0, 200)
    both = np.stack([shape + white(random, 0.01, 200), alone], axis=1)
    found = probed_pole(both, 0 * both)
    assert found.pole is not None
    assert found.pole == probed_pole(alone, 0 * alone).pole
