"""A window on the plane: the region and |z_p| map, and beside them what the point under the mouse means."""

from collections.abc import Callable, Sequence
from fractions import Fraction

import numpy as np
from matplotlib.backend_bases import KeyEvent, MouseEvent
from matplotlib.figure import Figure

from bezstab.errors import InputError
from bezstab.methods import Method
from bezstab.show.style import cells, curves, styled
from bezstab.stability import FloatArray, dominant_pole, poles, region, spectral_radius, verdict, window
from bezstab.units import feedback_gains

POINTS = 150  # per axis of the map
STEPS = 100  # of the decay
KEYS = "move: look    click: prove    n: next method    p: print the point"


class Explorer:
    """What the window shows and does, on a figure with any canvas: events in, artists out."""

    def __init__(self, figure: Figure, methods: Sequence[Method], h: float, say: Callable[[str], None]) -> None:
        self.figure, self.methods, self.h, self.say = figure, methods, h, say
        self.method, self.point = methods[0], (0.5, 0.1)
        grid = figure.add_gridspec(2, 2, width_ratios=(3, 2))
        self.map = figure.add_subplot(grid[:, 0])
        circle, decay = figure.add_subplot(grid[0, 1]), figure.add_subplot(grid[1, 1])
        turn = np.linspace(0, 2 * np.pi, 200)
        circle.plot(np.cos(turn), np.sin(turn), color="0.6")
        circle.set(xlim=(-1.6, 1.6), ylim=(-1.6, 1.6), aspect="equal", title="poles z")
        decay.set(xlim=(0, STEPS), ylim=(1e-6, 1e3), yscale="log", xlabel="step", title="|c| after a unit kick")
        self.text = figure.text(0.01, 0.02, "", linespacing=1.5, animated=True)
        (self.poles,) = circle.plot([], [], "o", color="#d55e00", markersize=4, animated=True)
        (self.decay,) = decay.plot([], [], color="#00395c", animated=True)
        figure.suptitle(KEYS, fontsize=8)
        figure.subplots_adjust(left=0.09, right=0.97, top=0.88, bottom=0.22, wspace=0.25, hspace=0.55)
        self.background: object = None
        figure.canvas.mpl_connect("draw_event", self._drawn)
        figure.canvas.mpl_connect("motion_notify_event", self._moved)
        figure.canvas.mpl_connect("button_press_event", self._clicked)
        figure.canvas.mpl_connect("key_press_event", self._pressed)
        self._redraw()

    def _redraw(self) -> None:
        """Draw the map of the current method anew."""
        axes, stable = self.map, region(self.method)
        axes.clear()
        (left, right), (bottom, top) = window(stable)
        a, b = (low + (high - low) * (np.arange(POINTS) + 0.5) / POINTS for low, high in ((left, right), (bottom, top)))
        z_abs = spectral_radius(self.method, a, b[:, np.newaxis])
        cells(axes, a, b, np.ma.masked_greater_equal(z_abs, 1), cmap="cividis", vmax=1)
        curves(axes, stable, None, label="", color="black")
        axes.set(xlim=(left, right), ylim=(bottom, top), facecolor="0.93", title=self.method.name)
        axes.set(xlabel=r"$\hat\alpha = 2\alpha h$", ylabel=r"$\hat\beta = \beta^2 h^2$")
        (self.mark,) = axes.plot([], [], "+", color="white", markeredgecolor="red", markersize=10, animated=True)
        self.look(*self.point)
        self.figure.canvas.draw_idle()

    def look(self, alpha_hat: float, beta_hat: float, prove: bool = False) -> None:
        """Show what a point means: poles, the linear recursion's answer to a unit kick, and the numbers."""
        self.point = round(float(alpha_hat), 6), round(float(beta_hat), 6)
        z, (two_alpha, beta_squared) = poles(self.method, *self.point), feedback_gains(*self.point, self.h)
        self.poles.set_data(z.real, z.imag)
        self.decay.set_data(np.arange(STEPS + 1), np.abs(_answer(np.poly(z).real.astype(float))))
        self.mark.set_data([self.point[0]], [self.point[1]])
        z_p = complex(dominant_pole(self.method, *self.point))
        word = "stable" if abs(z_p) < 1 else "unstable"
        if prove:
            word = f"{verdict(self.method, *map(Fraction, map(repr, self.point)))} (proven)"
        beta = f"{beta_squared**0.5:.6g}" if beta_squared >= 0 else "-"
        self.text.set_text(
            rf"$\hat\alpha$ = {self.point[0]:.6f}   $\hat\beta$ = {self.point[1]:.6f}   "
            f"α = {two_alpha / 2:.6g}   β = {beta} 1/s at h = {self.h:g} s\n"
            f"$|z_p|$ = {abs(z_p):.6f}   ∠$z_p$ = {np.degrees(np.angle(z_p)):.2f}°   {word}"
        )

    def _show(self) -> None:
        """Draw what moves over what does not."""
        canvas = self.figure.canvas
        if self.background is not None:
            canvas.restore_region(self.background)  # type: ignore[attr-defined]  # every Agg canvas has it
            for artist in (self.mark, self.poles, self.decay, self.text):
                self.figure.draw_artist(artist)
            canvas.blit(self.figure.bbox)

    def _drawn(self, _: object) -> None:
        self.background = self.figure.canvas.copy_from_bbox(self.figure.bbox)  # type: ignore[attr-defined]
        self._show()

    def _moved(self, event: MouseEvent, prove: bool = False) -> None:
        if event.inaxes is self.map and event.xdata is not None and event.ydata is not None:
            self.look(event.xdata, event.ydata, prove)
            self._show()

    def _clicked(self, event: MouseEvent) -> None:
        self._moved(event, prove=True)

    def _pressed(self, event: KeyEvent) -> None:
        if event.key == "n":
            self.method = self.methods[(self.methods.index(self.method) + 1) % len(self.methods)]
            self._redraw()
        elif event.key == "p":
            self.say(f"--method {self.method.name} --alpha {self.point[0]!r} --beta {self.point[1]!r}")


def _answer(polynomial: FloatArray) -> FloatArray:
    """Return c_0 = 1, c_1, ... of the linear recursion with this characteristic polynomial, at rest before the kick."""
    c = np.zeros(len(polynomial) - 1 + STEPS + 1)
    c[len(polynomial) - 1] = 1
    for k in range(len(polynomial), len(c)):
        c[k] = -polynomial[1:] @ c[k - 1 : k - len(polynomial) : -1]
    return c[len(polynomial) - 1 :]


def show(methods: Sequence[Method], h: float, say: Callable[[str], None]) -> None:
    """Open the window and return once it is closed; InputError if matplotlib has no window to open."""
    from matplotlib import pyplot

    with styled():
        try:
            figure = pyplot.figure("bezstab explore", figsize=(9, 5))
        except ImportError as error:
            raise InputError(f"explore: no window: {error}") from None
        if figure.canvas.required_interactive_framework is None:
            pyplot.close(figure)
            raise InputError("explore: matplotlib found no window system here (try another MPLBACKEND, or a screen)")
        manager = figure.canvas.manager
        if manager and manager.key_press_handler_id is not None:
            figure.canvas.mpl_disconnect(manager.key_press_handler_id)  # p is matplotlib's key for panning
        explorer = Explorer(figure, methods, h, say)
        pyplot.show()
        del explorer
