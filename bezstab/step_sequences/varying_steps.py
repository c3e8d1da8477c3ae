"""Whether feedback decays for every sequence of steps within a range: proven, refuted or not known.

Each step stable alone is not enough: products of different matrices may grow. In turn are tried

    one step of the range            that does not decay alone refutes, and is all that can where steps commute
    a quadratic form                 that every step makes smaller (lyapunov_quadratics)
    a sequence of steps              whose product grows (growing_sequences)

Between the two it is not known: there is no such form, and no sequence was found.

Runge-Kutta and one-step linear methods step y by R(hA) with one and the same A as long as alpha and beta stay: all
their steps commute, and any sequence of steps that decay alone decays.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

import numpy as np
from numpy.polynomial.polynomial import polyadd, polymul, polysub

from bezstab.errors import InputError
from bezstab.methods.schemes import Method
from bezstab.methods.step_matrices import StepMatrix, step_matrix
from bezstab.stability.arrays import FloatArray
from bezstab.step_sequences.growing_sequences import growing_words, grows, growth_of
from bezstab.step_sequences.lyapunov_quadratics import centred_form, determinant, proves_decay, rounded
from bezstab.step_sequences.positive_polynomials import positivity
from bezstab.units import check_step

Verdict = Literal["proven", "refuted", "not known"]
Certificate = Literal["commuting", "quadratic"]

FIGURES = 4  # significant digits of the steps in a sequence
LEAST_FRAME = 0.3  # of beta: as far as a frame for overdamped feedback is still stretched
SAMPLES = 40  # of the range, evenly spaced; the proofs are of all of it
SAMPLED_SHARE = 512  # the shortest step sampled, as a share of the longest
LONGEST_RANGE = Fraction(10**12)  # h_max / h_min: beyond, steps so short are as good as zero


@dataclass(frozen=True)
class Steps:
    """A range of steps (s). alpha and beta stay as they are while steps vary, or with `hold` alpha_hat and beta_hat do.

    InputError unless 1e-100 <= h_min <= h_max <= 1e100 and h_max <= 1e12 h_min.
    """

    h_min: Fraction
    h_max: Fraction
    hold: bool = False

    def __post_init__(self) -> None:
        check_step(self.h_min, "--h-min")
        check_step(self.h_max, "--h-max")
        if not self.h_min <= self.h_max <= LONGEST_RANGE * self.h_min:
            raise InputError(
                f"--h-min {float(self.h_min):g}, --h-max {float(self.h_max):g}: expected the longest step to be 1 to "
                f"{float(LONGEST_RANGE):g} times the shortest"
            )

    @property
    def shortest(self) -> Fraction:
        """The shortest step, as a share of the longest."""
        return self.h_min / self.h_max


@dataclass(frozen=True)
class VaryingSteps:
    """What sequences of steps do at one point of a method.

    `kind` is how it was proven: "commuting" (every single step decays, and steps commute), or "quadratic", by the rows
    of a form, the `certificate`, of the state (c, h_max cdot) or, of a method that stores an acceleration, (c, h_max
    cdot, h_max^2 cddot). `sequence` holds the steps (s) of a sequence that does not decay when repeated, and `growth`
    is by how many times errors are larger after each round of it, in float64: infinite where a step of it has no
    solution.
    """

    verdict: Verdict
    kind: Certificate | None = None
    certificate: tuple[tuple[Fraction, ...], ...] | None = None
    sequence: tuple[Fraction, ...] | None = None
    growth: float | None = None


def varying_steps(method: Method, alpha_hat: Fraction, beta_hat: Fraction, steps: Steps) -> VaryingSteps:
    """Return whether every sequence of steps in a range decays; alpha_hat and beta_hat are those of the longest step.

    InputError for a method of several steps, whose coefficients assume equal steps. Lyapunov functions: Liberzon,
    Switching in Systems and Control, chapter 2.
    """
    matrix = step_matrix(method, alpha_hat, beta_hat, steps.hold)

    def refuted(word: Sequence[Fraction]) -> VaryingSteps:
        sequence = tuple(length * steps.h_max for length in word)
        return VaryingSteps("refuted", sequence=sequence, growth=growth_of(matrix, word))

    alone = _single_step(matrix, steps.shortest)
    if isinstance(alone, Fraction):
        return refuted([alone])
    if matrix.commuting:
        return VaryingSteps("proven", "commuting") if alone else VaryingSteps("not known")
    samples = _samples(steps.shortest, down=steps.hold or matrix.size == 3)
    matrices = np.array([matrix.at(s) for s in samples], np.float64)
    form = _form(matrices, float(alpha_hat), float(beta_hat))
    if form is not None:
        exact_form = rounded(form / form[-1, -1])
        if proves_decay(exact_form, matrix, steps.shortest):
            return VaryingSteps("proven", "quadratic", tuple(map(tuple, exact_form)))
    word = _growing_word(matrix, steps)
    return refuted(word) if word else VaryingSteps("not known")


def _single_step(matrix: StepMatrix, shortest: Fraction) -> Fraction | bool:
    """Return a length whose step does not decay alone; else whether it is proven that every step does.

    For a state of two z^2 d^2 - z d t + D, with trace t / d and determinant D / d^2, has its roots inside the unit
    circle if and only if its values at 1 and -1 and d^2 - D are positive (Jury); not all of them are where d = 0 and
    the step has no solution. A state of three is tested in samples: what proves sequences proves single steps, too.
    """
    if matrix.size != 2:
        return next((length for length in _samples(shortest, down=True) if grows(matrix, [length])), True)
    square = polymul(matrix.denominator, matrix.denominator)
    trace = polymul(np.trace(matrix.numerators, axis1=1, axis2=2), matrix.denominator)
    of_roots = determinant(matrix.numerators)
    both = polyadd(square, of_roots)
    conditions = [polysub(both, trace), polyadd(both, trace), polysub(square, of_roots)]
    return positivity(conditions, shortest, Fraction(1))


def _samples(shortest: Fraction, down: bool) -> list[Fraction]:
    """Return lengths of steps from the shortest, or 1/SAMPLED_SHARE, to 1; with `down` shorter ones by halving, too."""
    low = max(shortest, Fraction(1, SAMPLED_SHARE))
    lengths = {low + (1 - low) * Fraction(k, SAMPLES - 1) for k in range(SAMPLES)}
    while down and low > shortest:
        low = max(low / 2, shortest)
        lengths.add(low)
    return sorted(lengths)


def _form(matrices: FloatArray, alpha_hat: float, beta_hat: float) -> FloatArray | None:
    """Return the quadratic form that all sampled steps make smaller by the largest share, or nearly so.

    None where what decays is lost in rounding.
    """
    radii = np.abs(np.linalg.eigvals(matrices)).max(axis=1)
    frame = np.eye(matrices.shape[1])
    rate, stiffness = alpha_hat / 2, math.sqrt(abs(beta_hat))
    turning = math.sqrt(abs(stiffness**2 - rate**2))
    frame[:2, :2] = [[max(turning, LEAST_FRAME * stiffness), 0.0], [rate, 1.0]]
    try:
        form: FloatArray = frame.T @ centred_form(frame @ matrices @ np.linalg.inv(frame), 1 - radii**2) @ frame
        np.linalg.cholesky(form)  # refuses what is not positive
    except np.linalg.LinAlgError:
        return None
    return form if np.isfinite(form).all() else None


def _growing_word(matrix: StepMatrix, steps: Steps) -> tuple[Fraction, ...] | None:
    """Return a sequence of lengths proven to grow, of few digits in s; None if none was found."""
    for word in growing_words(matrix, steps.shortest):
        rounded_steps = [Fraction(f"{float(length * steps.h_max):.{FIGURES - 1}e}") for length in word]
        within = tuple(min(max(step, steps.h_min), steps.h_max) / steps.h_max for step in rounded_steps)
        if grows(matrix, within):
            return within
    return None
