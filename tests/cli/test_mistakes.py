"""Every mistake on the command line takes one line and status two, and no file is written.

mistakes.txt has each command above the line it is answered with; … stands for the rest of a line that depends on what
is installed, or that lists many names. The files that commands name are those of data/.
"""

import re
import shutil
from pathlib import Path

import pytest

from tests.cli.running import DATA, run

TABLE = (Path(__file__).parent / "mistakes.txt").read_text(encoding="utf-8")
MISTAKES = re.findall(r"^\$ bezstab (.+)\n(.+)$", TABLE, re.MULTILINE)


@pytest.mark.parametrize(("command", "said"), MISTAKES)
def test_a_mistake_takes_one_line_status_two_and_no_file(command: str, said: str, tmp_path: Path) -> None:
    shutil.copytree(DATA, tmp_path, dirs_exist_ok=True)
    before = set(tmp_path.rglob("*"))
    result = run(command)
    assert (result.exit_code, result.stdout, result.stderr.count("\n")) == (2, "", 1)
    begin, more, _ = f"bezstab: {said}".partition("…")
    assert result.stderr.startswith(begin) if more else result.stderr == f"{begin}\n"
    assert set(tmp_path.rglob("*")) == before
