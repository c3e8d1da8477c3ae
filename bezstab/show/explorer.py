"""A window on the plane: the region and |z_p| map, and beside them what the point under the mouse means."""

from collections.abc import Callable, Sequence
from shlex import quote

import numpy as np
from matplotlib.backend_bases import KeyEvent, MouseEvent
from matplotlib.figure import Figure

from bezstab.errors import InputError
from bezstab.methods import Method
from bezstab.rationals import exact
from bezstab.show import plot
from bezstab.show.style import styled
from bezstab.stability import dominant_pole, kick_response, poles, region, useful_window, verdict
from bezstab.units import alpha_and_beta

POINTS = 150  # per axis of the map: it appears at once
STEPS = 100  # of the decay
KEYS = "move: look    click: prove    n: next method    p: print the point"


class Explorer:
    """What the window shows and does, on a figure with any canvas: events in, artists out.

    `print_line` takes the text that the key p prints; h is the step in s.
    """

    def __init__(self, figure: Figure, methods: Sequence[Method], h: float, print_line: Callable[[str], None]) -> None:
        self.figure, self.methods, self.h, self.print_line = figure, methods, h, print_line
        self.method = methods[0]
        self.point = (0.5, 0.1)
        self._lay_out()
        figure.suptitle(KEYS, fontsize=8)
        figure.subplots_adjust(left=0.09, right=0.97, top=0.88, bottom=0.22, wspace=0.25, hspace=0.55)
        self.background: object = None  # all that does not move, as pixels
        figure.canvas.mpl_connect("draw_event", self._remember_background)
        figure.canvas.mpl_connect("motion_notify_event", self._follow_mouse)
        figure.canvas.mpl_connect("button_press_event", self._prove_clicked)
        figure.canvas.mpl_connect("key_press_event", self._answer_key)
        self._draw_map()

    def _lay_out(self) -> None:
        """Make the map on the left, poles and decay on the right, and the line of numbers below."""
        grid = self.figure.add_gridspec(2, 2, width_ratios=(3, 2))
        self.map = self.figure.add_subplot(grid[:, 0])
        circle = self.figure.add_subplot(grid[0, 1])
        turn = np.linspace(0, 2 * np.pi, 200)
        circle.plot(np.cos(turn), np.sin(turn), color="0.6")
        circle.set(xlim=(-1.6, 1.6), ylim=(-1.6, 1.6), aspect="equal", title="poles z")
        (self.poles,) = circle.plot([], [], "o", color="#d55e00", markersize=4, animated=True)
        decay = self.figure.add_subplot(grid[1, 1])
        decay.set(xlim=(0, STEPS), ylim=(1e-6, 1e3), yscale="log", xlabel="step", title="|c| after a unit kick")
        (self.decay,) = decay.plot([], [], color="#00395c", animated=True)
        self.text = self.figure.text(0.01, 0.02, "", linespacing=1.5, animated=True)

    def _draw_map(self) -> None:
        """Draw the map of the current method anew."""
        axes, stable = self.map, region(self.method)
        alpha_range, beta_range = useful_window(stable)
        axes.clear()
        plot.spectral_radius(self.method, alpha_range, beta_range, POINTS, axes)
        plot.region(stable, axes, color="black", linestyle="-", label="")
        axes.set(xlim=alpha_range, ylim=beta_range, facecolor="0.93", title=self.method.name)
        (self.cross,) = axes.plot([], [], "+", color="white", markeredgecolor="red", markersize=10, animated=True)
        self.look(*self.point)
        self.figure.canvas.draw_idle()

    def look(self, alpha_hat: float, beta_hat: float, prove: bool = False) -> None:
        """Show what a point means: poles, the linear recursion's answer to a unit kick, and the numbers."""
        self.point = round(float(alpha_hat), 6), round(float(beta_hat), 6)
        alpha_hat, beta_hat = self.point
        z = poles(self.method, alpha_hat, beta_hat)
        self.poles.set_data(z.real, z.imag)
        response = kick_response(z, STEPS)
        self.decay.set_data(np.arange(STEPS + 1), np.abs(response))
        self.cross.set_data([alpha_hat], [beta_hat])
        self.text.set_text(self._numbers(prove))

    def _numbers(self, prove: bool) -> str:
        """Return what there is to say of the point; with `prove` its verdict is exact."""
        alpha_hat, beta_hat = self.point
        z_p = complex(dominant_pole(self.method, alpha_hat, beta_hat))
        if prove:
            judgement = f"{verdict(self.method, exact(alpha_hat), exact(beta_hat))} (proven)"
        else:
            judgement = "stable" if abs(z_p) < 1 else "unstable"
        alpha, beta = alpha_and_beta(alpha_hat, beta_hat, self.h)
        beta_text = "-" if beta is None else f"{beta:.6g}"
        return (
            rf"$\hat\alpha$ = {alpha_hat:.6f}   $\hat\beta$ = {beta_hat:.6f}   "
            f"α = {alpha:.6g}   β = {beta_text} 1/s at h = {self.h:g} s\n"
            f"$|z_p|$ = {abs(z_p):.6f}   ∠$z_p$ = {np.degrees(np.angle(z_p)):.2f}°   {judgement}"
        )

    def _show(self) -> None:
        """Draw what moves over what does not."""
        canvas = self.figure.canvas
        if self.background is not None:
            canvas.restore_region(self.background)  # type: ignore[attr-defined]  # every Agg canvas has it
            for artist in (self.cross, self.poles, self.decay, self.text):
                self.figure.draw_artist(artist)
            canvas.blit(self.figure.bbox)

    def _remember_background(self, _: object) -> None:
        self.background = self.figure.canvas.copy_from_bbox(self.figure.bbox)  # type: ignore[attr-defined]
        self._show()

    def _follow_mouse(self, event: MouseEvent, prove: bool = False) -> None:
        if event.inaxes is self.map and event.xdata is not None and event.ydata is not None:
            self.look(event.xdata, event.ydata, prove)
            self._show()

    def _prove_clicked(self, event: MouseEvent) -> None:
        self._follow_mouse(event, prove=True)

    def _answer_key(self, event: KeyEvent) -> None:
        if event.key == "n":
            following = self.methods.index(self.method) + 1
            self.method = self.methods[following % len(self.methods)]
            self._draw_map()
        elif event.key == "p":
            alpha_hat, beta_hat = self.point
            name = quote(self.method.name)  # newmark(1/4,1/2) means something else to a shell
            self.print_line(f"--method {name} --alpha {alpha_hat!r} --beta {beta_hat!r}")


def open_explorer(methods: Sequence[Method], h: float, print_line: Callable[[str], None]) -> None:
    """Open the window and return once it is closed; InputError if matplotlib has no window to open."""
    from matplotlib import pyplot

    with styled():
        try:
            figure = pyplot.figure("bezstab explore", figsize=(9, 5))
        except ImportError as error:
            raise InputError(f"explore cannot open a window: {error}") from None
        if figure.canvas.required_interactive_framework is None:
            pyplot.close(figure)
            raise InputError("explore: matplotlib found no window system here (try another MPLBACKEND, or a screen)")
        manager = figure.canvas.manager
        if manager and manager.key_press_handler_id is not None:
            figure.canvas.mpl_disconnect(manager.key_press_handler_id)  # p is matplotlib's key for panning
        explorer = Explorer(figure, methods, h, print_line)
        pyplot.show()
        del explorer  # matplotlib holds its callbacks weakly: it had to live until here
