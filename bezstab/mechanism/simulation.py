"""A run together with what its constraints did: what `simulate` on the command line and in Python shows."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import get_args

from bezstab.errors import InputError
from bezstab.mechanism.compiled import Mechanism
from bezstab.mechanism.energies import NODES, EnergyBalance, energy_balance
from bezstab.mechanism.observation import FloatArray, Observation, observe, singular_passages
from bezstab.mechanism.runner import Start, Trajectory, simulate
from bezstab.mechanism.start import perturbed_state
from bezstab.methods import Method
from bezstab.stabilising import NOTHING, AfterStep, Stabilise, held_by
from bezstab.units import check_step, feedback_gains

MOST_STEPS = 10**8
"""Of one run, which keeps its whole history: 10 GB and an hour for the slider-crank."""


@dataclass(frozen=True, eq=False, repr=False)
class Simulation:
    """A run at one point of the plane, with steps of h (s), and the constraint errors along it; SI units.

    t has shape (times,), q and v (times, coordinates), c, cdot and multipliers (times, constraints), energy and the
    work of drivers and forces, with their balance, (times,). `failure` says when and why the run ended early; None if
    it did not.
    """

    trajectory: Trajectory
    observation: Observation
    balance: EnergyBalance
    h: float
    alpha_hat: float
    beta_hat: float

    @property
    def t(self) -> FloatArray:
        """The times (s)."""
        return self.trajectory.t

    @property
    def q(self) -> FloatArray:
        """The coordinates (m, rad), in the order of `scene.coordinates`."""
        return self.trajectory.q

    @property
    def v(self) -> FloatArray:
        """Their derivatives (m/s, rad/s)."""
        return self.trajectory.v

    @property
    def c(self) -> FloatArray:
        """The constraint errors (m; rad for a driven angle)."""
        return self.observation.c

    @property
    def cdot(self) -> FloatArray:
        """Their derivatives."""
        return self.observation.cdot

    @property
    def multipliers(self) -> FloatArray:
        """The Lagrange multipliers (N; N m for a driven angle)."""
        return self.observation.multipliers

    @property
    def energy(self) -> FloatArray:
        """Kinetic and potential energy (J)."""
        return self.observation.energy

    @property
    def driver_work(self) -> FloatArray:
        """What the drivers have put in since the start (J)."""
        return self.balance.driver_work

    @property
    def force_work(self) -> FloatArray:
        """What constant forces and torques have put in and dampers taken out since the start (J)."""
        return self.balance.force_work

    @property
    def energy_drift(self) -> FloatArray:
        """The change of energy since the start that no work explains (J): an error."""
        return self.balance.drift

    @property
    def singular_times(self) -> FloatArray:
        """The times (s) nearest to singular configurations that the run went through, where a motion can branch."""
        return self.t[singular_passages(self.observation.pivots)]

    @property
    def stabilise(self) -> Stabilise:
        """What holds the constraints."""
        return held_by(self.trajectory.after, feedback=bool(self.alpha_hat or self.beta_hat))

    @property
    def failure(self) -> str | None:
        """When and why the run ended early."""
        return self.trajectory.failure

    def __repr__(self) -> str:
        point = f"alpha_hat {self.alpha_hat:g}, beta_hat {self.beta_hat:g}"
        run = f"{self.trajectory.mechanism.scene.name}, {self.trajectory.method.name}"
        ended = ", failed" if self.failure else ""
        return f"Simulation({run}, {point}, {len(self.t)} times, to t = {self.t[-1]:.6g} s{ended})"


def check_duration(duration: float, whole_step: float) -> None:
    """Raise InputError unless a duration (s) is a number of a method's own steps (s) that a run can take."""
    if not whole_step / 2 < duration < math.inf:
        raise InputError(f"--time {duration:g} s: expected at least one step of {whole_step:g} s")
    if duration > MOST_STEPS * whole_step:
        raise InputError(f"--time {duration:g} s: expected at most {MOST_STEPS:g} steps of {whole_step:g} s")


def simulated(
    mechanism: Mechanism,
    method: Method,
    *,
    h: float,
    duration: float,
    alpha_hat: float,
    beta_hat: float,
    perturb: float = 0.0,
    start: Start = "rk4",
    after: AfterStep = NOTHING,
) -> Simulation:
    """Return a run over `duration` (s) from the scene's initial state, its first constraint off by `perturb` (m).

    h (s) is the user's step, a method's own is its step multiple of that. What is done `after` each step goes with
    alpha_hat = beta_hat = 0. InputError for a scene that cannot start, an h outside 1e-100 to 1e100 s, a duration below
    a step or above 1e8 of them, another `start`, and as `memory`; NumericalError where the scene cannot be
    perturbed; what goes wrong on the way is the run's `failure`. Paper Eqs 6 to 9.
    """
    check_step(h)
    if start not in get_args(Start):
        raise InputError(f"start {start!r}: expected {', '.join(get_args(Start))}")
    check_duration(duration, h * float(method.step_multiple))
    gains = feedback_gains(alpha_hat, beta_hat, h)
    state = perturbed_state(mechanism, perturb)
    trajectory = simulate(mechanism, method, h, duration, gains, state, start, after=after)
    return seen_run(trajectory, gains, h * float(method.step_multiple), h, alpha_hat, beta_hat)


def seen_run(
    trajectory: Trajectory,
    gains: Iterable[float | FloatArray],
    steps: float | FloatArray,
    h: float,
    alpha_hat: float,
    beta_hat: float,
    nodes: int = NODES,
) -> Simulation:
    """Return a run with what its constraints did, for the gains at its times and its own `steps` (s).

    Powers are integrated as by `running_integral`, with so many nodes.
    """
    observation = observe(trajectory.mechanism, trajectory.t, trajectory.q, trajectory.v, *gains)
    balance = energy_balance(observation, steps, nodes)
    return Simulation(trajectory, observation, balance, h, alpha_hat, beta_hat)
