"""A window on the plane: the region and |z_p| map, and beside them what the point under the mouse means."""

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial
from shlex import quote

import numpy as np
from matplotlib.backend_bases import KeyEvent, MouseEvent
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from bezstab.errors import InputError
from bezstab.methods import Method
from bezstab.questions import kick_response
from bezstab.show import plot
from bezstab.show.fields import formatted
from bezstab.show.style import ACCENT, COLOURS, styled
from bezstab.stability import poles, region, useful_window, verdict
from bezstab.units import alpha_and_beta

POINTS = 150  # per axis of the map: it appears at once
STEPS = 100  # of the decay
KEYS = "move: look    click: prove    n: next method    p: print the point"


class Explorer:
    """What the window shows and does, on a figure with any canvas: events in, artists out.

    The map is on the left, poles and decay are on the right, and below is a line of numbers.
    `print_line` takes the text that the key p prints; h is the step in s.
    """

    def __init__(self, figure: Figure, methods: Sequence[Method], h: float, print_line: Callable[[str], None]) -> None:
        self.figure, self.methods, self.h, self.print_line = figure, methods, h, print_line
        self.method = methods[0]
        self.typed = ("0.5", "0.1")
        panels = figure.subplot_mosaic([["map", "poles"], ["map", "decay"]], width_ratios=(3, 2))
        self.map, circle, decay = panels["map"], panels["poles"], panels["decay"]
        circle.add_patch(Circle((0, 0), 1, fill=False, edgecolor="0.6"))
        circle.set(xlim=(-1.6, 1.6), ylim=(-1.6, 1.6), aspect="equal", title="poles z")
        (self.poles,) = circle.plot([], [], "o", color=ACCENT, markersize=4, animated=True)
        decay.set(xlim=(0, STEPS), ylim=(1e-6, 1e3), yscale="log", xlabel="step", title="|c| after a unit kick")
        (self.decay,) = decay.plot([], [], color=COLOURS[0], animated=True)
        self.text = figure.text(0.01, 0.02, "", linespacing=1.5, animated=True)
        figure.suptitle(KEYS, fontsize=8)
        figure.subplots_adjust(left=0.09, right=0.97, top=0.88, bottom=0.22, wspace=0.25, hspace=0.55)
        self.background: object = None  # all that does not move, as pixels: to draw it anew takes four times as long
        figure.canvas.mpl_connect("draw_event", self._remember_background)
        figure.canvas.mpl_connect("motion_notify_event", self._follow_mouse)
        figure.canvas.mpl_connect("button_press_event", partial(self._follow_mouse, prove=True))
        figure.canvas.mpl_connect("key_press_event", self._answer_key)
        self._draw_map()

    def _draw_map(self) -> None:
        """Draw the map of the current method anew."""
        axes, stable = self.map, region(self.method)
        alpha_range, beta_range = useful_window(stable)
        axes.clear()
        plot.spectral_radius(self.method, alpha_range, beta_range, POINTS, axes)
        plot.region(stable, axes, color="black", linestyle="-", label="")
        axes.set(xlim=alpha_range, ylim=beta_range, facecolor="0.93", title=self.method.name)
        (self.cross,) = axes.plot([], [], "+", color="white", markeredgecolor="red", markersize=10, animated=True)
        self.look(float(self.typed[0]), float(self.typed[1]))
        self.figure.canvas.draw_idle()

    def look(self, alpha_hat: float, beta_hat: float, prove: bool = False) -> None:
        """Show what a point means: poles, the linear recursion's answer to a unit kick, and the numbers.

        The point is that of the six digits that the key p prints; with `prove` its verdict is exact.
        """
        self.typed = f"{alpha_hat:.6g}", f"{beta_hat:.6g}"
        point = Fraction(self.typed[0]), Fraction(self.typed[1])
        alpha, beta = alpha_and_beta(*point, self.h)
        z = poles(self.method, *map(float, point))
        unproven = "stable" if abs(z[0]) < 1 else "unstable"
        judgement = f"{verdict(self.method, *point)} (proven)" if prove else unproven
        self.poles.set_data(z.real, z.imag)
        self.decay.set_data(range(STEPS + 1), abs(kick_response(z, STEPS)))
        self.cross.set_data([[float(number)] for number in point])
        self.text.set_text(
            rf"$\hat\alpha$ = {self.typed[0]}   $\hat\beta$ = {self.typed[1]}   "
            f"α = {formatted(alpha)}   β = {formatted(beta)} 1/s at h = {self.h:g} s\n"
            f"$|z_p|$ = {abs(z[0]):.6f}   ∠$z_p$ = {np.angle(z[0], deg=True):.2f}°   {judgement}"
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

    def _answer_key(self, event: KeyEvent) -> None:
        if event.key == "n":
            following = self.methods.index(self.method) + 1
            self.method = self.methods[following % len(self.methods)]
            self._draw_map()
        elif event.key == "p":
            name = quote(self.method.name)  # newmark(1/4,1/2) means something else to a shell
            self.print_line(f"--method {name} --alpha {self.typed[0]} --beta {self.typed[1]}")


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
