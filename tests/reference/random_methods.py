"""Random methods of every kind with rational coefficients: consistent and zero-stable by construction."""

import random
from contextlib import suppress
from fractions import Fraction

from bezstab.errors import InputError
from bezstab.methods.recipes import recipe
from bezstab.methods.schemes import LinearMultistep, Method, PredictorCorrector, RungeKutta
from tests.methods.random_recipes import random_recipe
from tests.reference.known_roots import product

Polynomial = list[Fraction]  # descending powers of z


def small(rng: random.Random, size: Fraction) -> Fraction:
    """Return a random fraction in [-size, size] with a small denominator."""
    denominator = rng.randint(2, 40)
    return size * Fraction(rng.randint(-denominator, denominator), denominator)


def random_rho(rng: random.Random, steps: int) -> Polynomial:
    """Return rho with the root 1 and the others inside the unit circle, some of them zero."""
    factors: list[Polynomial] = [[Fraction(1), Fraction(-1)]]
    degree = 1
    adams = rng.random() < 0.25
    while degree < steps:
        kind = rng.random()
        if adams or kind < 0.2:
            factors.append([Fraction(1), Fraction(0)])
            degree += 1
        elif kind < 0.6 or degree == steps - 1:
            factors.append([Fraction(1), small(rng, Fraction(19, 20))])
            degree += 1
        else:  # z^2 + p z + q with |q| < 1 and |p| < 1 + q
            q = small(rng, Fraction(9, 10))
            p = small(rng, Fraction(19, 20)) * (1 + q)
            factors.append([Fraction(1), p, q])
            degree += 2
    return product(factors)


def random_sigma(rng: random.Random, rho: Polynomial, explicit: bool) -> Polynomial:
    """Return sigma with sigma(1) = rho'(1), explicit or not."""
    steps = len(rho) - 1
    slope = sum(((steps - i) * a for i, a in enumerate(rho)), Fraction(0))
    size = Fraction(rng.choice([1, 1, 2, 4]), 2)
    while True:
        sigma = [small(rng, size) for _ in rho]
        if rng.random() < 0.3:
            sigma[-1] = Fraction(0)
        if explicit:
            sigma[0] = Fraction(0)
        place = rng.randint(1, steps)
        sigma[place] += slope - sum(sigma)
        if explicit or sigma[0]:
            return sigma


def random_multistep(rng: random.Random, steps: int, explicit: bool = True) -> LinearMultistep:
    return with_sigma(rng, random_rho(rng, steps), explicit)


def with_sigma(rng: random.Random, rho: Polynomial, explicit: bool) -> LinearMultistep:
    """Return a method with this rho and a random sigma that shares no factor with it."""
    while True:
        with suppress(InputError):
            return LinearMultistep(tuple(rho), tuple(random_sigma(rng, rho, explicit)))


def random_runge_kutta(rng: random.Random, stages: int) -> RungeKutta:
    """Return an explicit tableau: full, or low-storage (only the sub-diagonal), with weights that sum to one."""
    low_storage = rng.random() < 0.4
    rows = []
    for i in range(stages):
        row = [
            small(rng, Fraction(1)) if (j < i and (not low_storage or j == i - 1)) else Fraction(0)
            for j in range(stages)
        ]
        if low_storage and i:
            row[i - 1] = abs(row[i - 1]) or Fraction(1, 3)
        rows.append(tuple(row))
    if low_storage and rng.random() < 0.6:
        weights = [Fraction(0)] * (stages - 1) + [Fraction(1)]
    else:
        weights = [small(rng, Fraction(1)) for _ in range(stages)]
        weights[rng.randrange(stages)] += 1 - sum(weights)
    return RungeKutta(tuple(rows), tuple(weights))


KINDS = [("LMM", n) for n in range(2, 7)] + [("RK", n) for n in range(2, 7)] + [("PECE", n) for n in range(2, 7)]


def random_method(number: int) -> Method:
    """Return method number 0, 1, 2, ... of a fixed sequence that goes round the kinds; the same on every machine."""
    rng = random.Random(f"method {number}")
    kind, size = KINDS[number % len(KINDS)]
    scheme: LinearMultistep | RungeKutta | PredictorCorrector
    if kind == "LMM":
        scheme = random_multistep(rng, size)
    elif kind == "RK":
        scheme = random_runge_kutta(rng, size)
    else:
        rho = random_rho(rng, size)
        predictor = with_sigma(rng, rho, explicit=True)
        if rng.random() < 0.5:
            rho = random_rho(rng, size)
        scheme = PredictorCorrector(predictor, with_sigma(rng, rho, explicit=False))
    return Method(f"{kind}{size}-{number}", scheme, "random")


OTHER_KINDS = [("implicit", 1), ("recipe", 0), ("implicit", 2), ("recipe", 0), ("implicit", 3), ("recipe", 0)]


def other_random_method(number: int) -> Method:
    """Return method number 0, 1, 2, ... of a second sequence: implicit multistep methods and second-order recipes."""
    rng = random.Random(f"other method {number}")
    kind, size = OTHER_KINDS[number % len(OTHER_KINDS)]
    name = f"{kind}{size or ''}-{number}"
    if kind == "implicit":
        return Method(name, random_multistep(rng, size, explicit=False), "random")
    while True:
        try:
            return Method(name, recipe(random_recipe(rng)), "random")
        except InputError:  # equations that determine no step, or one whose evaluations do not wait in any order
            continue


def random_implicit_runge_kutta(number: int) -> Method:
    """Return method number 0, 1, 2, ... of a fixed sequence: two or three stages, small rationals."""
    rng = random.Random(f"implicit Runge-Kutta {number}")

    def small() -> Fraction:
        denominator = rng.randint(1, 4)
        return Fraction(rng.randint(-2 * denominator, 2 * denominator), denominator)

    stages = 2 + number % 2
    rows = [[small() if rng.random() < 0.8 else Fraction(0) for _ in range(stages)] for _ in range(stages)]
    rows[0][stages - 1] += 1  # never explicit
    weights = [small() for _ in range(stages - 1)]
    weights.append(1 - sum(weights, Fraction(0)))
    return Method(f"implicit RK {number}", RungeKutta(tuple(map(tuple, rows)), tuple(weights)), "random")
