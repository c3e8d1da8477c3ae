"""Results as rows: what a command prints in JSON and CSV, and what the columns of its table show."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from bezstab.engines.engine_list import WITNESSES
from bezstab.errors import InputError
from bezstab.show.fields import Row
from bezstab.show.row_kinds import (
    ENGINES_LISTED,
)

if TYPE_CHECKING:  # so that a small row does not load what makes the large ones
    from bezstab.engines.conversions import Engine


def engine_row(
    engine: Engine, point: tuple[Fraction, Fraction] | None, h: Fraction, omega: Fraction | None = None
) -> Row:
    """Return an engine's words, and its setting for (alpha_hat, beta_hat) at a step h (s), or why it has none.

    With a rate omega (1/s) also what that, or else its defaults, do to the energy of a motion.
    """
    from bezstab.questions.energy import engine_energy_rate

    setting = None
    if point:
        try:
            setting = engine.setting(point, h)
        except InputError as error:
            setting = str(error)
    units = tuple(engine.units.values())
    rate = None if omega is None else engine_energy_rate(engine, point, h, omega)
    known = {"units": units, "witness": WITNESSES.get(engine.name), "setting": setting, "energy_rate": rate}
    return ENGINES_LISTED.row(engine, **known)
