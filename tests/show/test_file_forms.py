import io

import matplotlib as mpl
import pytest

from bezstab.show import FIGURE_FORMS, save
from tests.show.test_plane_figures import drawn_map


@pytest.mark.parametrize("form", FIGURE_FORMS)
@pytest.mark.slow
def test_equal_figures_are_equal_bytes_whatever_the_users_settings(form: str) -> None:
    outputs = []
    for settings in ({}, {"font.size": 20, "lines.linewidth": 9, "savefig.dpi": 10, "svg.hashsalt": "x"}):
        with mpl.rc_context(settings):  # type: ignore[arg-type,unused-ignore]
            save(drawn_map()[0], form, file := io.BytesIO())
        outputs.append(file.getvalue())
    assert outputs[0] == outputs[1]
