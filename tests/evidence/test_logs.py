"""Logs as people write them: what is read, what is refused, and with which words."""

import io
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import ArrayLike

from bezstab.errors import InputError
from bezstab.evidence import Log, error_columns, log_from, looks_absolute, read_log, row_step, time_column
from bezstab.evidence.logs import parse_log

ROWS = [[0.0, 1.0], [0.5, -0.25], [1.0, 0.0625]]


@pytest.mark.parametrize(
    "text",
    [
        "t,c\n0,1\n0.5,-0.25\n1,0.0625\n",
        "t;c\n0;1\n0,5;-0,25\n1;0,0625\n",
        "# made by numpy\n# t c\n0 1\n5e-1 -2.5e-1\n1 6.25e-2\n",
        '"t", "c"\r\n0, 1\r\n\r\n0.5, -0.25\r\n# a remark\r\n1, 0.0625\r\n',
        "\ufefft,c\n0,1\n0.5,-0.25\n1,0.0625\n",
    ],
)
def test_a_log_is_the_same_however_it_is_written(text: str) -> None:
    log = log_from(io.BytesIO(text.encode()), "run")
    assert log.columns == ("t", "c")
    assert log.values.tolist() == ROWS


def test_columns_without_names_are_numbered() -> None:
    log = parse_log("0 1\n0.5 -0.25\n1 0.0625\n", "log")
    assert log.columns == ("1", "2")
    assert (time_column(log), error_columns(log, (), 0)) == (0, [1])
    assert time_column(parse_log("0.004 1\n0.008 2\n0.013 3\n0.017 4\n", "log")) == 0  # 1/240 s, to three decimals
    assert time_column(parse_log("1 1\n0.5 2\n0.25 3\n", "log")) is None


def test_numbers_have_many_spellings() -> None:
    log = parse_log("1;+2,5;.5;3.;-1E-3;1e+05;NaN;;-inf\n", "log")
    assert log.values[0].tolist() == pytest.approx([1, 2.5, 0.5, 3, -1e-3, 1e5, np.nan, np.nan, -np.inf], nan_ok=True)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("\n  \n# nothing\n", "is empty"),
        ("t,c\n", "no rows of numbers"),
        ("t,c\n0,1\n1,one\n", "line 3: 'one' is not a number"),
        ("t,c\n0,1\n\n# remark\n1,2,3\n", "line 5: 3 cells, expected 2"),
    ],
)
def test_what_is_no_log_is_refused_with_its_line(text: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        parse_log(text, "log")


def test_files_that_cannot_be_read_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="directory"):
        read_log(tmp_path)
    (tmp_path / "picture.png").write_bytes(b"\x89PNG\xff")
    with pytest.raises(InputError, match="not text"):
        read_log(tmp_path / "picture.png")
    monkeypatch.setattr("bezstab.evidence.logs.LARGEST", 10)
    with pytest.raises(InputError, match="more than"):
        log_from(io.BytesIO(b"0,1\n" * 10), "endless")


def log_of(**columns: ArrayLike) -> Log:
    """Return a log with these columns."""
    values = np.stack(np.broadcast_arrays(*columns.values()), axis=-1)
    return Log("log", tuple(columns), np.atleast_2d(values).astype(float))


def test_columns_are_found_by_name_and_number() -> None:
    log = log_of(**{"Time [s]": 0, "step": 0, "c1": 0, "3": 0})
    assert time_column(log) == 0
    assert error_columns(log, (), 0) == [2, 3]
    assert error_columns(log, ("c1", "1", "3"), 0) == [2, 0, 3]  # a name before a number
    assert time_column(log, "2") == 1
    assert time_column(log_of(a=0, b=0)) is None
    for chosen in ("c", "0", "5", "²"):
        with pytest.raises(InputError, match="no column"):
            error_columns(log, (chosen,), None)
    with pytest.raises(InputError, match="2 columns are called 'c'"):
        Log("log", ("c", "c"), np.zeros((3, 2))).number_of("c")
    with pytest.raises(InputError, match="no column holds an error"):
        error_columns(log_of(t=0, k=0), (), 0)


USUAL_NAMES = [
    *("t", "T", "time", "Time [s]", "time in s", "seconds", "timestamp", "sim_time", "simTime", "sim.time", "t_sec"),
    *("simulation time (s)", "elapsed", "elapsed_time", "world_time", "header.stamp", "clock", "wall time", "Zeit"),
]


@pytest.mark.parametrize("name", USUAL_NAMES)
def test_a_time_by_any_usual_name_is_no_error(name: str) -> None:
    log = log_of(**{"c": 0, name: 0})
    assert (time_column(log), error_columns(log, (), None)) == (1, [0])


@pytest.mark.parametrize("name", ["c_t", "time_error", "t1", "s", "contact", "settle_time", "x"])
def test_a_name_with_more_in_it_is_no_time(name: str) -> None:
    assert time_column(log_of(**{name: 0})) is None


@given(angle=st.floats(0.3, 2.8), modulus=st.floats(0.8, 1.02), offset=st.floats(-3, 3))
def test_absolute_values_are_told_from_what_has_a_sign(angle: float, modulus: float, offset: float) -> None:
    assume(abs(angle - np.pi / 2) > 0.01)  # there every other sample may be zero
    k = np.arange(150.0)
    c = modulus**k * np.cos(angle * k + offset)
    assert not looks_absolute(c)
    assert not looks_absolute(3.0 * modulus**150 + 20 + c)  # about another value
    assert not looks_absolute(modulus**k)
    assert looks_absolute(np.abs(c))


def test_the_step_is_that_of_the_times_but_for_their_rounding_in_the_unit_that_their_name_says() -> None:
    for decimals in (3, 4, 12):
        t = 7 + np.arange(240) / 240
        assert row_step(log_of(t=np.round(t, decimals)), 0) == pytest.approx(1 / 240, rel=10.0**-decimals)
    units = {"Time [ms]": 1e-3, "time (us)": 1e-6, "t/s": 1.0, "t [\u00b5s]": 1e-6, "t [\u03bcs]": 1e-6, "t_ms": 1e-3}
    for name, seconds in units.items():
        log = log_of(**{name: np.arange(5) * 2.0})
        assert row_step(log, 0) == pytest.approx(2 * seconds)
        assert time_column(log) == 0


@pytest.mark.parametrize(
    ("t", "said"),
    [
        (np.delete(np.arange(20) / 100, 9), r"uneven times: row \d+ is"),
        ([0.0, 0.0, 0.0], "do not rise"),
        ([0.0, np.nan, 2.0], "no time in every row"),
        ([0.0], "one row only"),
    ],
)
def test_times_that_are_uneven_are_refused(t: ArrayLike, said: str) -> None:
    with pytest.raises(InputError, match=said):
        row_step(log_of(t=t), 0)
