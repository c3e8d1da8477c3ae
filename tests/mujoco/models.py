"""Models as MJCF: random ones by their seeds, and those of which a closed form is known."""

import numpy as np

WEIGHTLESS = 'contype="0" conaffinity="0"'
FLAT = 'solimp="0.9 0.9 0.001"'  # d = 0.9 everywhere
UNSAFE = 'refsafe="disable"'
INTEGRATORS = ("Euler", "RK4", "implicit", "implicitfast")


def mjcf(
    world: str, more: str = "", *, integrator: str = "Euler", h: float = 0.004, gravity: float = 0.0, flags: str = ""
) -> str:
    """Return a model as text; gravity along z."""
    return f"""<mujoco><compiler angle="radian"/>
    <option timestep="{h!r}" integrator="{integrator}" gravity="0 0 {gravity}" tolerance="0">
      <flag {flags} autoreset="disable"/>
    </option><worldbody>{world}</worldbody>{more}</mujoco>"""


def random_model(rng: np.random.Generator) -> str:
    """Return free bodies and arms of ball and hinge joints, closed by connects and welds of any solref, with drives."""
    bodies = ""
    names = [f"b{number}" for number in range(int(rng.integers(2, 5)))]
    for number, name in enumerate(names):
        joint = (
            "<freejoint/>",
            '<joint type="ball" damping=".01"/>',
            f'<joint name="h{number}" axis="0 1 .3" damping="{_size(rng, -4, 0)}" stiffness="{_size(rng, -2, 1)}"/>',
        )[int(rng.integers(3))]
        mass = f'mass="{_size(rng, -1, 1)}"'
        bodies += (
            f'<body name="{name}" pos="{number} 0 0">{joint}'
            f'<geom type="box" size=".1 .2 .3" pos="{rng.uniform(-0.2, 0.2):.3f} 0 .3" {mass} {WEIGHTLESS}/></body>'
        )
    equalities = "".join(
        f'<{rng.choice(["connect", "weld"])} body1="{first}" {second} '
        f'solref="{_size(rng, -2.3, -1)} {_size(rng, -0.5, 0.3)}" {FLAT}/>'.replace(
            "<connect ", '<connect anchor=".5 0 .1" '
        )
        for first, second in [(names[0], f'body2="{names[1]}"'), (names[-1], "")]
    )
    drives = "".join(
        f'<position joint="h{number}" kp="{_size(rng, 0, 4)}" kv="{_size(rng, -1, 2)}"/>'
        for number in range(len(names))
        if f'"h{number}"' in bodies
    )
    integrator, flags = str(rng.choice(INTEGRATORS)), str(rng.choice(["", UNSAFE]))
    more = f"<equality>{equalities}</equality><actuator>{drives}</actuator>"
    return mjcf(bodies, more, integrator=integrator, flags=flags, h=float(_size(rng, -3, -2)))


def _size(rng: np.random.Generator, low: float, high: float) -> str:
    return f"{10 ** rng.uniform(low, high):.6g}"
