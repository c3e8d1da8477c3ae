"""What is known of a method: its order and its cost, and, of one that is named, its formulas and its region."""

from dataclasses import dataclass
from fractions import Fraction

from bezstab.methods.aliases import NAMES
from bezstab.methods.schemes import Method, evaluations, implicit, steps
from bezstab.regions.answer import RegionAnswer, region_answer


@dataclass(frozen=True)
class MethodAnswer:
    """What a list says of a method; computed from its coefficients.

    `evaluations` of the right-hand side in a step, of an implicit method in an iteration. The second order is that
    where forces depend on positions alone.
    """

    method: Method
    name: str
    steps: int
    evaluations: int
    implicit: bool
    order: int
    error_constant: Fraction
    order_position_forces: int
    other_names: str
    added_damping: str


@dataclass(frozen=True)
class Formulas:
    """A method's recursion, s→z mapping and characteristic polynomial (paper Tables 1 and 2), as text or LaTeX.

    And its steady errors, the torque of its stages, on what its multipliers
    do work, and the order that is left to the forced error where alpha_hat and beta_hat are held.
    """

    recursion: str
    mapping: str
    characteristic_polynomial: str
    steady_error: str
    steady_velocity_error: str
    stage_torque: str
    multiplier_law: str
    order_left: int | None


@dataclass(frozen=True)
class WholeMethod:
    """All that is known of a method."""

    about: MethodAnswer
    formulas: Formulas
    region: RegionAnswer


def method_answer(method: Method, name: str = "", *, latex: bool = False) -> MethodAnswer:
    """Return what a list says of a method, called by its own name unless told another."""
    from bezstab.methods.formulas import added_damping_text
    from bezstab.methods.orders import accuracy, accuracy_by_force  # loads sympy

    order, constant = accuracy(method)
    return MethodAnswer(
        method=method,
        name=name or method.name,
        steps=steps(method),
        evaluations=evaluations(method),
        implicit=implicit(method),
        order=order,
        error_constant=constant,
        order_position_forces=accuracy_by_force(method).position[0],
        other_names=NAMES["same"].get(method.name, "").replace(" ", ", "),
        added_damping=added_damping_text(method, latex),
    )


def whole_method(method: Method, *, latex: bool) -> WholeMethod:
    """Return all that is known of a method; errors as `region_answer`."""
    from bezstab.methods.formulas import (
        characteristic_text,
        mapping_text,
        multiplier_law_text,
        recursion_text,
        stage_torque_text,
        steady_error_text,
    )
    from bezstab.stability.feedback_costs import order_left

    formulas = Formulas(
        recursion=recursion_text(method, latex),
        mapping=mapping_text(method, latex),
        characteristic_polynomial=characteristic_text(method, latex),
        steady_error=steady_error_text(method, "x", latex),
        steady_velocity_error=steady_error_text(method, "v", latex),
        stage_torque=stage_torque_text(method, latex),
        multiplier_law=multiplier_law_text(method, latex),
        order_left=order_left(method),
    )
    return WholeMethod(method_answer(method, latex=latex), formulas, region_answer(method))
