"""Logs: a CSV with a header is read, anything else is refused with its line."""

import io
from pathlib import Path

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.probes.logs import Log, read_log


def read(text: str, row_step: float | None = None) -> Log:
    return read_log(io.BytesIO(text.encode()), row_step)


@pytest.mark.parametrize(
    "text",
    [
        "t,c\n0,1\n0.5,-0.25\n1,0.0625\n",
        "# t,c\n0,1\n5e-1,-2.5E-1\n1,+.0625\n",  # as numpy writes it
        "t;c\n0;1\n0,5;-0,25\n1;0,0625\n",
        "t\tc\r\n0\t1\r\n\r\n0.5\t-0.25\r\n1\t0.0625\r\n",
        '\ufeff"Time [s]", "c"\n0, 1\n0.5, -0.25\n1, 0.0625\n',
    ],
)
def test_a_log_is_the_same_however_it_is_written(text: str) -> None:
    log = read(text, 0.5)
    assert log.row_step == 0.5
    assert list(log.errors) == ["c"]
    assert log.column("c").tolist() == [1.0, -0.25, 0.0625]


def test_every_column_but_that_of_times_holds_an_error_and_a_run_that_breaks_down_may_log_no_number() -> None:
    log = read("c_t,ts,T,x\n1,2,3,nan\n1,2,4,-inf\n")
    assert list(log.errors) == ["c_t", "ts", "x"]
    assert log.errors["x"].tolist() == pytest.approx([np.nan, -np.inf], nan_ok=True)
    with pytest.raises(InputError, match=r"no column 'T' \(columns: c_t, ts, x\)"):
        log.column("T")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "line 1: '': expected a name for each column"),
        ("0,1\n1,2\n", "line 1: '0,1': expected a name"),
        ("t,c\n", "expected rows of numbers"),
        ("t\n0\n1\n", "expected rows of numbers, and a column that is not of times"),
        ("c,c\n1,2\n", "line 1: 'c,c': expected a name"),
        ("t,c\n0,1\n1,one\n", "line 3: '1,one': expected a number for each column"),
        ("t,c\n0,1\n\n1,2,3\n", "line 4: '1,2,3': expected a number for each column"),
        ("t,c\n0,1\n1\n", "line 3: '1': expected a number for each column"),
        ("t,c\n0,1\n1,2\n3,4\n", "do not rise by equal steps"),
        ("t,c\n0,1\n0,2\n", "do not rise by equal steps"),
        ("t,c\n0,1\nnan,2\n", "do not rise by equal steps"),
        ("t,c\n0,1\n0.2,2\n", r"rows every 0.2 s, expected every 0.1 s"),
    ],
)
def test_what_is_no_log_is_refused_with_its_line(text: str, said: str) -> None:
    with pytest.raises(InputError, match=f"log <stdin>.*{said}"):
        read(text, 0.1)


def test_what_is_no_text_is_refused(tmp_path: Path) -> None:
    picture = tmp_path / "picture.png"
    picture.write_bytes(b"\x89PNG\xff")
    with picture.open("rb") as file, pytest.raises(InputError, match=r"picture\.png: is not text"):
        read_log(file)


def test_times_may_be_rounded_but_no_row_may_be_left_out() -> None:
    rows = [f"{k / 240:.3f},1\n" for k in range(50)]
    assert read("t,c\n" + "".join(rows), 1 / 240).row_step == pytest.approx(1 / 240, rel=1e-2)
    with pytest.raises(InputError, match="do not rise by equal steps"):
        read("t,c\n" + "".join(rows[:20] + rows[21:]))
