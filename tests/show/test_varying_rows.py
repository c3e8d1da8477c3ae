from fractions import Fraction

from bezstab.show import Row, cells, sequence_text, varying_words
from bezstab.show.row_kinds import VARYING
from bezstab.stability import VaryingSteps

SHORT, LONG = Fraction("0.01"), Fraction("0.02")


def varying_row(varying: VaryingSteps) -> Row:
    return cells(VARYING, varying, {"shown_by": None})


def test_a_refutation_lists_its_steps() -> None:
    refuted = VaryingSteps("refuted", SHORT, LONG, hold=False, sequence=(LONG, SHORT, SHORT))
    assert varying_row(refuted)["sequence"] == [0.02, 0.01, 0.01]
    assert varying_row(refuted)["certificate"] is None
    assert varying_words("SYM", refuted) == (
        "SYM, α and β fixed: refuted for steps between 0.01 s and 0.02 s: 0.02 s, then 2 of 0.01 s, over and over, "
        "do not decay."
    )


def test_how_much_a_sequence_grows_is_said_where_three_digits_show_it() -> None:
    for growth, said in ((1.776, "grow 1.78-fold each time."), (1.0001, "do not decay."), (1.0, "do not decay.")):
        refuted = VaryingSteps("refuted", SHORT, LONG, hold=False, sequence=(LONG, SHORT), growth=growth)
        assert varying_words("SYM", refuted).endswith(f"0.02 s, then 0.01 s, over and over, {said}")
        assert varying_row(refuted)["growth"] == growth


def test_one_step_that_does_not_decay_is_enough() -> None:
    alone = VaryingSteps("refuted", SHORT, LONG, hold=True, sequence=(LONG,))
    assert varying_words("SYM", alone) == (
        "SYM, α̂ and β̂ held: refuted for steps between 0.01 s and 0.02 s: a step of 0.02 s alone does not decay."
    )


def test_a_certificate_is_written_as_rationals() -> None:
    half = Fraction(1, 2)
    proven = VaryingSteps("proven", SHORT, LONG, hold=False, kind="quadratic", certificate=((half, LONG), (LONG, half)))
    row = varying_row(proven)
    assert row["certificate"] == [["1/2", "1/50"], ["1/50", "1/2"]]
    assert (row["varying"], row["certificate_kind"], row["hold"]) == ("proven", "quadratic", False)
    assert (row["varying_h_min"], row["varying_h_max"]) == (0.01, 0.02)
    assert varying_words("SYM", proven) == (
        "SYM, α and β fixed: proven to decay for every sequence of steps between 0.01 s and 0.02 s "
        "(a quadratic form falls with each step)."
    )


def test_the_other_reasons() -> None:
    polygon = VaryingSteps("proven", SHORT, LONG, hold=False, kind="polygon", certificate=((SHORT, LONG),) * 4)
    commuting = VaryingSteps("proven", SHORT, LONG, hold=False, kind="commuting")
    unknown = VaryingSteps("not known", SHORT, LONG, hold=False)
    assert "each step maps a polygon of 8 corners into itself" in varying_words("SYM", polygon)
    assert "each step decays alone, and steps commute" in varying_words("RK4", commuting)
    assert "not known whether every sequence" in varying_words("SYM", unknown)


def test_steps_are_counted_as_they_come() -> None:
    assert sequence_text([SHORT, SHORT, LONG, SHORT]) == "2 of 0.01 s, then 0.02 s, then 0.01 s"
