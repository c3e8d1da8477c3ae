"""Commands about the plane: poles, methods, family."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from bezstab.cli.asking import (
    asked,
    given_point_options,
    moving_scene_options,
    omega_option,
    show_below,
)
from bezstab.cli.options import METHOD, USUAL_METHODS, Rule, format_option, methods_option, ruled
from bezstab.cli.output import Files, picture_options, show_blocks, show_groups, show_rows, show_text
from bezstab.errors import InputError
from bezstab.methods import GROUPS, STEP_FAMILIES, Method, lookup
from bezstab.show import (
    LISTED_METHODS,
    MEMBERS,
    NAMED_METHODS,
    POLES,
    PROPERTIES,
    Column,
    Format,
    Row,
    column,
    one_pole_sentence,
    render,
    transposed,
    with_unbounded,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@click.command()
@methods_option(*USUAL_METHODS)
@given_point_options
@click.option("--all-poles", is_flag=True, help="Print every pole, not only the dominant one.")
@omega_option
@moving_scene_options("Also say what the motion of this mechanism does to the poles; needs --h.")
@format_option
@ruled(Rule("--h", "α̂ and β̂ have no unit", needs=("--physical", "--engine", "--pd", "--scene", "--omega")))
def poles(all_poles: bool, form: Format, **typed: Any) -> None:
    """Print each method's dominant pole at one point, and the verdict.

    converges: every |z| < 1, so errors shrink. marginal: errors stay bounded but do not shrink. diverges: errors
    grow. The verdict is proven in exact arithmetic on the numbers as typed (Schur-Cohn test).

    Feedback also makes errors of its own on a mechanism that moves. "error" is that error as a share of the
    motion's amplitude. "× least" is how many times as large it is as with `choose --goal accurate`.

    Example: bezstab poles --alpha 0.5 --beta 0.1
    """
    from bezstab import stability
    from bezstab.questions import answers
    from bezstab.show import added_cells, engine_cells, pole_rows

    question = asked(**typed)
    poles_of = stability.poles if all_poles else stability.dominant_pole
    margins = question.drive is not None
    at_point = [each for each in answers(question, margins=margins) if each.goal == "as given"]
    rows: list[Row] = []
    for each in at_point:
        z = poles_of(each.method, each.alpha_hat, each.beta_hat).reshape(-1)
        added = {**engine_cells(each), **added_cells(each)}
        rows += [{**row, **added} for row in pole_rows(each, z)]
    costs_shown = not (all_poles or question.drive)
    kind = replace(POLES, sentence=one_pole_sentence) if all_poles else POLES
    alpha_hat, beta_hat = map(float, question.given.point)
    without = () if costs_shown else ("total_error", "times_least")
    show_rows(kind, rows, form, without, f"α̂ = {alpha_hat:.10g}, β̂ = {beta_hat:.10g}")
    show_below(question, at_point, form, motion=costs_shown)


@click.command()
@click.argument("methods", metavar="[NAME]...", type=METHOD, nargs=-1)
@click.option("--latex", is_flag=True, help="Formulas as LaTeX.")
@format_option
def methods(methods: Sequence[Method], latex: bool, form: Format) -> None:
    """List the methods, or show all about those you name.

    Prints the number of steps, the evaluations of f in a step (of an implicit method in an iteration), the order of
    accuracy and the error constant. They are computed from the coefficients. In parentheses is the order if forces
    depend on positions alone.

    For a method that you name it also prints the recursion, s→z mapping, characteristic polynomial and stability region
    (the paper's Tables 1 and 2), the source, and the error that the method makes on a constraint that moves, as a share
    of that motion.

    SIE is the paper's "Euler semi-implicit". It is not what engines call semi-implicit Euler: that is SYM.

    Example: bezstab methods B4
    """
    from bezstab.questions import region_answer
    from bezstab.show import method_row, whole_row

    if not methods:
        listed = [
            (group, [method_row(lookup(name), name, group.heading) for name in group.methods]) for group in GROUPS
        ]
        if form == "text":
            show_groups(
                [("\n".join(filter(None, (group.heading, group.note))), rows) for group, rows in listed],
                LISTED_METHODS.columns([row for _, rows in listed for row in rows], ("source",)),
                LISTED_METHODS.sentence,
            )
        else:
            rows = [row for _, of_group in listed for row in of_group]
            show_rows(LISTED_METHODS, rows, form)
        return
    rows = [whole_row(region_answer(method), latex=latex) for method in methods]
    if form in ("json", "csv"):
        show_rows(NAMED_METHODS, rows, form)
        return
    for number, row in enumerate(rows):
        if form == "markdown":
            click.echo(render(transposed(with_unbounded(row)), PROPERTIES, form))
            continue
        if number:
            click.echo()
        shown = with_unbounded(row)
        show_blocks([shown], [property_column(key, shown) for key in shown], NAMED_METHODS.sentence)
    if form == "text":
        show_text("\nSteady errors are shares of a motion of ω rad/s, to leading order in θ = iωh.")


def property_column(key: str, row: Row) -> Column:
    """Return the column of a key as a row is read from top to bottom: numbers to ten digits."""
    return column(key.replace("_", " "), key, ".10g" if isinstance(row[key], float) else "")


@click.command()
@click.argument("name", metavar="|".join(STEP_FAMILIES), type=click.Choice(list(STEP_FAMILIES)))
@click.option("--from", "first", type=click.IntRange(min=1), default=2, help="Smallest n.")
@click.option("--to", "last", type=click.IntRange(min=1), help="Largest n [12 for bezier, 8 for adams-bashforth].")
@picture_options
@format_option
def family(name: str, first: int, last: int | None, files: Files, form: Format) -> None:
    """Show how a family of methods changes with its number of steps n.

    Prints the area of each region, the least |z_p| and the error constant. The Bézier methods tend to a limit, which
    has a region of its own. The regions of the Adams-Bashforth methods shrink to nothing, but each step more gains an
    order. The figure shows both.

    Example: bezstab family bezier --from 2 --to 5
    """
    from bezstab import show
    from bezstab.stability import bezier_limit, family_members

    largest = STEP_FAMILIES[name].largest
    last = largest if last is None else last
    if not first <= last <= largest:
        raise InputError(f"--from {first} --to {last}: expected 1 <= from <= to <= {largest} for {name}")
    files.check_output()
    members = family_members(name, first, last)
    limit = bezier_limit() if name == "bezier" else None
    rows: list[Row] = [MEMBERS.row(member) for member in members]
    if limit:
        rows.append(show.limit_row(limit))
    show_rows(MEMBERS, rows, form)

    def draw() -> "Figure":
        families = {
            each: members if each == name else family_members(each, 2, family.largest)
            for each, family in STEP_FAMILIES.items()
        }
        return show.family_figure(families, name, limit)

    files.write(files.path("family", name), draw)
