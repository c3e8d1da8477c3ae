"""Every scheme written as a second-order one: the same steps, as equations for x, v and a. So one runner serves all.

The state is y = (x, v) and its slope f = (v, a): what a scheme does with y and f it does with x and v, and with v and
a.
"""

from collections.abc import Iterable
from fractions import Fraction
from functools import cache

from bezstab.methods.plane_polynomials import ONE
from bezstab.methods.schemes import LinearMultistep, PredictorCorrector, RungeKutta, Scheme
from bezstab.methods.second_order import (
    ACCELERATION,
    POSITION,
    VELOCITY,
    Assignment,
    Combination,
    Equation,
    Evaluation,
    Quantity,
    SecondOrder,
)

PREDICTED = {POSITION: "predicted_x", VELOCITY: "predicted_v", ACCELERATION: "predicted_a"}


@cache
def second_order_form(scheme: Scheme) -> SecondOrder:
    """Return the scheme as a second-order one, with h = 1; the same P(z; alpha_hat, beta_hat) up to powers of z.

    Exact. Theory: the docstring of this file.
    """
    match scheme:
        case SecondOrder():
            return scheme
        case LinearMultistep():
            return SecondOrder(tuple(_multistep(scheme)))
        case PredictorCorrector(predictor, corrector):
            return SecondOrder(tuple(_predictor_corrector(predictor, corrector)))
        case RungeKutta():
            return SecondOrder(tuple(_runge_kutta(scheme)))


def _at(name: str, step: int) -> Quantity:
    return Quantity(name, step)


def _one(name: str, step: int) -> Combination:
    return ((ONE, Quantity(name, step)),)


def _sum(terms: Iterable[tuple[Fraction, Quantity]]) -> Combination:
    return tuple((coefficient, quantity) for coefficient, quantity in terms if coefficient)


def _multistep(scheme: LinearMultistep) -> list[Equation]:
    """Return the equations of rho(E) y = h sigma(E) f; the acceleration is that at the newest point f is needed at."""
    step = 1 if scheme.implicit else 0
    evaluation = Evaluation(_at(ACCELERATION, step), _one(POSITION, step), _one(VELOCITY, step))
    updates = _updates(scheme, {POSITION: POSITION, VELOCITY: VELOCITY}, _past_slopes(scheme))
    return [*updates, evaluation] if scheme.implicit else [evaluation, *updates]


def _past_slopes(scheme: LinearMultistep) -> dict[str, Combination]:
    """Return h sigma(E) f for either part of y."""
    slope_of = {POSITION: VELOCITY, VELOCITY: ACCELERATION}
    return {part: _sum((b, _at(slope, 1 - j)) for j, b in enumerate(scheme.sigma)) for part, slope in slope_of.items()}


def _updates(scheme: LinearMultistep, names: dict[str, str], slopes: dict[str, Combination]) -> list[Equation]:
    """Return the assignments to both parts of y, so called, at the end of the step."""
    updates: list[Equation] = []
    for part, name in names.items():
        past = [(-a, _at(part, -j)) for j, a in enumerate(scheme.rho[1:])]
        updates.append(Assignment(_at(name, 1), _sum([*past, *slopes[part]])))
    return updates


def _predictor_corrector(predictor: LinearMultistep, corrector: LinearMultistep) -> list[Equation]:
    """Return the equations of PECE: evaluate, predict, evaluate, correct."""
    evaluation = Evaluation(_at(ACCELERATION, 0), _one(POSITION, 0), _one(VELOCITY, 0))
    predicted = _updates(
        predictor,
        {POSITION: PREDICTED[POSITION], VELOCITY: PREDICTED[VELOCITY]},
        _past_slopes(predictor),
    )
    at_predicted = Evaluation(
        _at(PREDICTED[ACCELERATION], 1), _one(PREDICTED[POSITION], 1), _one(PREDICTED[VELOCITY], 1)
    )
    new_slope = {_at(VELOCITY, 1): _at(PREDICTED[VELOCITY], 1), _at(ACCELERATION, 1): _at(PREDICTED[ACCELERATION], 1)}
    slopes = {
        part: tuple((b, new_slope.get(quantity, quantity)) for b, quantity in combination)
        for part, combination in _past_slopes(corrector).items()
    }
    corrected = _updates(corrector, {POSITION: POSITION, VELOCITY: VELOCITY}, slopes)
    return [evaluation, *predicted, at_predicted, *corrected]


def _runge_kutta(scheme: RungeKutta) -> list[Equation]:
    """Return the equations of the stages, V_i = v + sum_j a_ij A_j and X_i = x + sum_j a_ij V_j, and of the step."""
    stages = range(len(scheme.weights))
    velocity = [_at(f"stage_v_{i + 1}", 1) for i in stages]
    acceleration = [_at(f"stage_a_{i + 1}", 1) for i in stages]
    equations: list[Equation] = []
    for i, row in enumerate(scheme.tableau):
        equations.append(Assignment(velocity[i], _sum([(ONE, _at(VELOCITY, 0)), *zip(row, acceleration, strict=True)])))
        position = _sum([(ONE, _at(POSITION, 0)), *zip(row, velocity, strict=True)])
        equations.append(Evaluation(acceleration[i], position, ((ONE, velocity[i]),)))
    weighted_velocities = zip(scheme.weights, velocity, strict=True)
    weighted_accelerations = zip(scheme.weights, acceleration, strict=True)
    equations.append(Assignment(_at(POSITION, 1), _sum([(ONE, _at(POSITION, 0)), *weighted_velocities])))
    equations.append(Assignment(_at(VELOCITY, 1), _sum([(ONE, _at(VELOCITY, 0)), *weighted_accelerations])))
    return equations
