"""Odd terminals and places: an answer or one line. Each command here is a process in that very environment."""

import json
from pathlib import Path

import pytest

from tests.cli.processes import files_below, finished
from tests.cli.running import run as run_here

SLOW = pytest.mark.slow
LATIN = {"PYTHONIOENCODING": "latin-1"}
OLD_LOCALE = {"LANG": "C", "LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}  # then files' names are ASCII
EULER = 'A = [["0"]]\nb = ["1"]\n'


def own_method(path: Path, name: str) -> str:
    """Write a method of that name, and return the path of its file."""
    file = path / "own.toml"
    file.write_text(f"name = {json.dumps(name, ensure_ascii=False)}\n{EULER}", encoding="utf-8")
    return str(file)


@pytest.mark.slow
def test_what_an_encoding_lacks_is_a_question_mark_and_columns_stand(tmp_path: Path) -> None:
    run = finished("poles", "--alpha", "0.5", "--beta", "0.1", cwd=tmp_path, environment=LATIN)
    assert run.returncode == 0
    heading, table, _ = run.stdout.decode("latin-1").split("\n\n")
    columns, *rows = table.splitlines()
    assert heading == "?? = 0.5, ?? = 0.1"
    starts = columns.index("verdict")
    assert {row[starts:].split()[0] for row in rows} <= {"converges", "marginal", "diverges"}
    complaint = finished("check", "--alpha", "1", "--beta", "1e300", "--method", "é中", cwd=tmp_path, environment=LATIN)
    assert complaint.returncode == 2
    assert "é" in complaint.stderr.decode("latin-1")


@pytest.mark.slow
def test_json_holds_the_same_values_in_any_encoding(tmp_path: Path) -> None:
    method = own_method(tmp_path, "naïve α̂ 中 \N{GRINNING FACE}")
    poles = ("poles", "--alpha", "1", "--beta", "1", "--method", method, "--format", "json")
    plain = finished(*poles, cwd=tmp_path, environment=LATIN)
    assert json.loads(plain.stdout.decode("ascii")) == json.loads(run_here(*poles).stdout)


@SLOW
def test_a_name_that_the_file_system_lacks_is_changed(tmp_path: Path) -> None:
    method = own_method(tmp_path, "é∞")
    run = finished(
        "region",
        "--method",
        method,
        "--grid",
        "9",
        "--table",
        "csv",
        "-o",
        "out",
        cwd=tmp_path,
        environment=OLD_LOCALE,
    )
    assert run.returncode == 0
    assert b"Traceback" not in run.stderr
    assert len(files_below(tmp_path / "out")) == 2


@SLOW
def test_no_home_and_no_place_for_matplotlib(tmp_path: Path) -> None:
    (tmp_path / "taken").touch()
    nowhere = {"HOME": None, "XDG_CONFIG_HOME": None, "XDG_CACHE_HOME": None, "MPLCONFIGDIR": str(tmp_path / "taken")}
    run = finished("region", "--method", "B2", "--grid", "9", "-o", "out", cwd=tmp_path, environment=nowhere)
    assert run.returncode == 0
    assert run.stderr.decode().splitlines() == ["wrote out/region_B2.png"]


@pytest.mark.parametrize("columns", ["20", *(pytest.param(text, marks=SLOW) for text in ("1", "0", "-3", "wide"))])
@pytest.mark.parametrize(
    "command",
    ["--help", "poles --help", "poles --alpha 1 --beta 1", pytest.param("poles --alpha 1", marks=SLOW)],
)
@pytest.mark.slow
def test_a_narrow_terminal(columns: str, command: str, tmp_path: Path) -> None:
    run = finished(*command.split(), cwd=tmp_path, environment={"COLUMNS": columns})
    complains = command == "poles --alpha 1"
    assert run.returncode == (2 if complains else 0)
    assert run.stderr.count(b"\n") == complains


@pytest.mark.parametrize(
    "name",
    [
        "line\nline",
        *(
            pytest.param(name, marks=SLOW)
            for name in ("x" * 300, "a b", "é中", "  two  spaces ", "-o", "\x1b[2J", "a\udcffb")
        ),
    ],
)
@pytest.mark.slow
def test_a_directory_of_any_name(name: str, tmp_path: Path) -> None:
    run = finished(
        "region", "--method", "B2", "--grid", "9", "--figure", "none", "--table", "csv", "-o", name, cwd=tmp_path
    )
    (line,) = run.stderr.decode().splitlines()
    if len(name) > 255:
        assert run.returncode == 2
        assert line.endswith("File name too long")
    else:
        assert run.returncode == 0
        assert line.startswith("wrote ")
        assert "\x1b" not in line
        assert [path.name for path in (tmp_path / name).iterdir()] == ["region_B2.csv"]


@pytest.mark.parametrize(
    "option",
    [("poles", "--alpha", "1", "--beta", "1", "--method"), pytest.param(("verify", "--scene"), marks=SLOW)],
)
@pytest.mark.parametrize(
    "name", ["\x1b[2J", *(pytest.param(name, marks=SLOW) for name in ("line\nline", "a  b", "x" * 300))]
)
def test_a_missing_file_of_any_name(name: str, option: tuple[str, ...], tmp_path: Path) -> None:
    run = finished(*option, f"{name}.toml", cwd=tmp_path)
    assert run.returncode == 2
    (line,) = run.stderr.decode().splitlines()
    assert "\x1b" not in line


@pytest.mark.parametrize(
    "name", [*(pytest.param(name, marks=SLOW) for name in ("../../x", "a|b", "/etc/x", "..", ".", "CON:", "a\\b"))]
)
def test_a_method_of_any_name(name: str, tmp_path: Path) -> None:
    method = own_method(tmp_path, name)
    for form in ("text", "markdown"):
        run = finished(
            "region", "--method", method, "--grid", "9", "--table", "csv", "-o", "out", "--format", form, cwd=tmp_path
        )
        assert run.returncode == 0
        assert run.stdout.decode().count("\n") == (
            13 if form == "text" else 3
        )  # a sentence above what a region has, or a table
        assert not {"\x1b", "\x07"} & set(run.stdout.decode() + run.stderr.decode())
        assert run.stderr.count(b"\n") == 2
    assert all(path.startswith("out/region_") or path in ("out", "own.toml") for path in files_below(tmp_path))
    assert len(files_below(tmp_path)) == 4


@pytest.mark.parametrize("name", ["\x1b[2J\x07", "line\nline", "\N{LINE SEPARATOR}", "\udcff"])
@pytest.mark.slow
def test_a_method_that_is_called_like_its_file(name: str, tmp_path: Path) -> None:
    (tmp_path / f"{name}.toml").write_text(EULER, encoding="utf-8")
    run = finished("poles", "--alpha", "1", "--beta", "1", "--method", f"{name}.toml", cwd=tmp_path)
    assert run.returncode == 2
    (line,) = run.stderr.decode().splitlines()
    assert line.endswith("expected one line of text")
    assert not {"\x1b", "\x07"} & set(line)


@pytest.mark.slow
def test_a_method_whose_name_is_too_long_for_a_file(tmp_path: Path) -> None:
    run = finished("region", "--method", own_method(tmp_path, "x" * 300), "--grid", "9", cwd=tmp_path)
    assert run.returncode == 2
    (line,) = run.stderr.decode().splitlines()
    assert line.endswith("File name too long")
    assert files_below(tmp_path) == ["own.toml"]
