from typing import Any

import numpy as np
import pytest
from matplotlib.backend_bases import KeyEvent, MouseButton, MouseEvent
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from bezstab.errors import InputError
from bezstab.methods import lookup
from bezstab.show.explorer import Explorer, open_explorer
from bezstab.stability import dominant_pole, poles


def window(*names: str) -> tuple[Explorer, Any, list[str]]:
    figure = Figure(figsize=(9, 5))
    printed: list[str] = []
    canvas: Any = FigureCanvasAgg(figure)
    explorer = Explorer(figure, [lookup(name) for name in names], 0.001, printed.append)
    canvas.draw()
    return explorer, canvas, printed


def mouse(explorer: Explorer, canvas: Any, name: str, alpha_hat: float, beta_hat: float) -> None:
    x, y = explorer.map.transData.transform((alpha_hat, beta_hat))
    canvas.callbacks.process(name, MouseEvent(name, canvas, x, y, MouseButton.LEFT if "button" in name else None))


def key(canvas: Any, letter: str) -> None:
    canvas.callbacks.process("key_press_event", KeyEvent("key_press_event", canvas, letter))


def test_moving_shows_poles_decay_and_numbers() -> None:
    explorer, canvas, _ = window("B4")
    before = bytes(canvas.buffer_rgba())
    mouse(explorer, canvas, "motion_notify_event", 1.2345, 0.3456)
    assert bytes(canvas.buffer_rgba()) != before
    point = [float(number) for number in explorer.typed]
    assert point == pytest.approx([1.2345, 0.3456], rel=1e-5)
    z = poles(lookup("B4"), *point)
    assert np.array(explorer.poles.get_xydata()) == pytest.approx(np.stack([z.real, z.imag], axis=1))
    decay = np.array(explorer.decay.get_ydata())
    slope = (decay[90:].max() / decay[40:50].max()) ** (1 / 50)
    assert slope == pytest.approx(abs(complex(dominant_pole(lookup("B4"), *point))), rel=0.01)
    assert explorer.typed[0] in explorer.text.get_text()


def test_a_click_proves() -> None:
    explorer, canvas, _ = window("SYM")
    for beta_hat, verdict in ((0.5, "converges"), (3.0, "diverges")):
        mouse(explorer, canvas, "motion_notify_event", 1.0, beta_hat)
        assert "proven" not in explorer.text.get_text()
        assert explorer.text.get_text().endswith("  stable" if verdict == "converges" else "unstable")
        mouse(explorer, canvas, "button_press_event", 1.0, beta_hat)
        assert f"{verdict} (proven)" in explorer.text.get_text()


def test_keys_switch_the_method_and_print_what_can_be_typed_into_a_shell() -> None:
    explorer, canvas, printed = window("B4", "newmark(1/4,1/2)")
    key(canvas, "n")
    assert explorer.map.get_title() == explorer.method.name == "newmark(beta=1/4,gamma=1/2)"
    assert len(explorer.map.images) == 1
    key(canvas, "p")
    assert printed == ["--method 'newmark(beta=1/4,gamma=1/2)' --alpha 0.5 --beta 0.1"]
    key(canvas, "n")
    assert explorer.method == lookup("B4")


def test_without_a_window_one_line_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MPLBACKEND", "Agg")
    with pytest.raises(InputError, match="window"):
        open_explorer([lookup("B4")], 0.001, print)
