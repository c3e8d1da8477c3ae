"""Names of built-in methods by kind, for tests that hold for some kinds only."""

from bezstab.methods import (
    REGISTRY,
    LinearMultistep,
    Partitioned,
    PredictorCorrector,
    RungeKutta,
    SecondOrder,
    implicit,
    lookup,
)

SECOND_ORDER = [name for name in REGISTRY if isinstance(lookup(name).scheme, SecondOrder)]
"""Equations for positions, velocities and accelerations: P(z; alpha_hat, beta_hat), but no pi(z, mu)."""

MU_METHODS = [name for name in REGISTRY if name not in SECOND_ORDER]
"""Methods with pi(z, mu), explicit or implicit."""

EXPLICIT = [name for name in MU_METHODS if not implicit(lookup(name))]
"""Methods with pi(z, mu) that solve no equations."""

IMPLICIT = [name for name in MU_METHODS if implicit(lookup(name))]
"""Methods with pi(z, mu) that solve equations in each step."""

MULTISTEP = [name for name in MU_METHODS if isinstance(lookup(name).scheme, LinearMultistep)]
RUNGE_KUTTA = [name for name in MU_METHODS if isinstance(lookup(name).scheme, RungeKutta)]
PARTITIONED = [name for name in MU_METHODS if isinstance(lookup(name).scheme, Partitioned)]
PECE = [name for name in MU_METHODS if isinstance(lookup(name).scheme, PredictorCorrector)]
