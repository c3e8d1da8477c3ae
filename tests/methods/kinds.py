"""Names of built-in methods by kind, for tests that hold for some kinds only."""

from collections.abc import Sequence
from typing import Any

import pytest

from bezstab.methods.registry import REGISTRY, lookup
from bezstab.methods.schemes import implicit
from bezstab.methods.second_order import SecondOrder

SECOND_ORDER = [name for name in REGISTRY if isinstance(lookup(name).scheme, SecondOrder)]
"""Equations for positions, velocities and accelerations: P(z; alpha_hat, beta_hat), but no pi(z, mu)."""

MU_METHODS = [name for name in REGISTRY if name not in SECOND_ORDER]
"""Methods with pi(z, mu), explicit or implicit."""

EXPLICIT = [name for name in MU_METHODS if not implicit(lookup(name))]
"""Methods with pi(z, mu) that solve no equations."""

IMPLICIT = [name for name in MU_METHODS if implicit(lookup(name))]
"""Methods with pi(z, mu) that solve equations in each step."""

SAMPLE = ("B1", "B2", "B4", "B6", "AB2", "AB4", "AB8", "ABM3", "RK1", "RK4", "SIE", "dopri5")
"""Of the explicit methods some of each family, the smallest and the largest among them."""

FEW = ("B4", "AB4", "ABM3", "RK4", "SIE")
"""One explicit method of each family, for what takes long."""

SOLVED = ("trapezoid", "bdf2", "am3", "sdirk2", "radau3", "SYM", "verlet-half", "verlet-implicit", "hht", "rkn4")
"""Some of each family of the methods that solve equations or that treat velocities differently."""


BETWEEN = {"B5", "B7", "B8", "B9", "B10", "B11", "AB5", "AB6", "AB7", "bdf4", "bdf5", "am4", "am5"}
"""Between members of their family that are looked at, and like them."""


def sampled(names: Sequence[str], quick: Sequence[str] = SAMPLE) -> list[Any]:
    """Return the names as parameters, all but a few marked as slow: `make test-slow` runs these."""
    looked_at = [name for name in names if name in quick or name not in BETWEEN]
    return [pytest.param(name, marks=[] if name in quick else [pytest.mark.slow]) for name in looked_at]
