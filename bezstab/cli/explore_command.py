"""The command that opens a window on the plane: explore."""

from collections.abc import Sequence
from fractions import Fraction

import click

from bezstab import show
from bezstab.cli.options import USUAL_METHODS, changed, command
from bezstab.methods import Method


@command(changed("methods", default=USUAL_METHODS), changed("h", default="0.001"))
def explore(methods: Sequence[Method], h: Fraction) -> None:
    """Open a window: point at the region, see poles and decay.

    A click proves the verdict; n shows the next method; p prints the point as options for the other commands.

    Example: bezstab explore --method B4 --method AB4
    """
    show.open_explorer(methods, float(h), click.echo)
