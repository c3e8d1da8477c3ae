"""What lint says of each kind of row is what MuJoCo does: a little inside and a little outside of every limit."""

from dataclasses import dataclass, replace
from itertools import cycle, product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bezstab.evidence import linted_model, model_data
from bezstab.evidence.mujoco_lint import Linted
from bezstab.stability import Timing
from tests.evidence.samples import of_campaign
from tests.reference.mujoco_steps import grown, settled, step_moduli

mujoco: Any = pytest.importorskip("mujoco")


@pytest.fixture(autouse=True)
def _away_from_here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo writes its warnings, of what diverges, into a file of the current directory."""
    monkeypatch.chdir(tmp_path)


H = 0.004
FLAT = 'solimp="0.9 0.9 0.001"'  # d = 0.9 everywhere
HELD = f'solref=".01 .7" {FLAT}'
UNSAFE = 'refsafe="disable"'
WEIGHTLESS = 'contype="0" conaffinity="0"'
SLIDE = f'<body><joint name="x" type="slide" axis="0 0 1" {{}}/><geom size=".1" mass="2" {WEIGHTLESS}/></body>'
FREE = f'<body name="b"><freejoint/><geom size=".1" mass="2" pos="{{}} 0 0" {WEIGHTLESS}/></body>'
TWO = (
    f'<body><joint name="x" type="slide" axis="0 0 1"/><geom size=".1" mass="2" {WEIGHTLESS}/>'
    f'<body><joint name="y" type="slide" axis="1 0 .5"/><geom size=".1" mass="3" {WEIGHTLESS}/></body></body>'
)
TENDON = '<tendon><fixed name="t" {}><joint joint="x" coef="2"/><joint joint="y" coef="-1"/></fixed></tendon>'
FLEX = (
    '<flexcomp name="f" type="grid" {} spacing=".1 .1 .1" radius=".001" mass="2">'
    f'<edge equality="{{}}" {HELD}/><contact selfcollide="none" {WEIGHTLESS}/></flexcomp>'
)
LIMIT = 'limited="true" range="0 1" solreflimit=".01 .7" solimplimit="0.9 0.9 0.001"'
RUBS = 'frictionloss="100" solreffriction=".01 1"'
DROP = (
    '<geom type="plane" size="1 1 .1" {0}/>'
    '<body pos="0 0 .1"><joint type="slide" axis="0 0 1"/><geom type="{1}" size=".1 .1 .1" mass="2" {0}/></body>'
)


@dataclass(frozen=True)
class Case:
    """A small model whose first row is of the kind that is looked at, at a step inside its limit."""

    kind: str
    world: str
    more: str = ""
    flags: str = ""
    gravity: float = 0.0
    settle: int = 0  # small steps

    def model(self, integrator: str = "Euler", h: float = H) -> Any:
        return mujoco.MjModel.from_xml_string(
            f"""<mujoco><compiler angle="radian"/>
            <option timestep="{h!r}" integrator="{integrator}" gravity="0 0 {self.gravity}" tolerance="0">
              <flag {self.flags} autoreset="disable"/>
            </option><worldbody>{self.world}</worldbody>{self.more}</mujoco>"""
        )


def lint(case: Case, integrator: str = "Euler", h: float = H) -> list[Linted]:
    return list(linted_model(model_data(mujoco, case.model(integrator, h)), (), Timing()))


def modulus(case: Case, integrator: str, h: float = H) -> float:
    """Return the largest |z| of MuJoCo's own step."""
    model = case.model(integrator, h)
    return float(step_moduli(mujoco, model, settled(mujoco, model, case.settle))[0])


def drive(text: str, joint: str = "", kind: str = "position drive") -> Case:
    """Return a body on a rail with actuators, and with what else its joint has."""
    return Case(kind, SLIDE.format(joint), f"<actuator>{text}</actuator>")


def equality(text: str, world: str = SLIDE.format(""), flags: str = UNSAFE) -> Case:
    """Return bodies that an equality holds."""
    return Case(f"{text[1:].split(maxsplit=1)[0]} equality", world, f"<equality>{text}</equality>", flags)


def held(solref: str, solimp: str = "", flags: str = UNSAFE, joint: str = "") -> Case:
    """Return a body on a rail that is held so."""
    return equality(f'<joint joint1="x" solref="{solref}" {solimp}/>', SLIDE.format(joint), flags)


def direct(a: float, b: float) -> str:
    """Return the solref with alpha_hat = a and beta_hat = b where d = 1."""
    return f"{-b / H**2!r} {-a / H!r}"


CASES = {
    "joint": equality(f'<joint joint1="x" {HELD}/>'),
    "direct": held("-9000 -150", FLAT),
    "connect": equality(f'<connect body1="b" anchor=".2 0 0" {HELD}/>', FREE.format(0)),
    "weld": equality(f'<weld body1="b" {HELD}/>', FREE.format(".1")),
    "tendon": Case(
        "tendon equality",
        TWO,
        TENDON.format("") + f'<equality><tendon tendon1="t" solref="-9000 -150" {FLAT}/></equality>',
        UNSAFE,
    ),
    "refsafe": held(".05 .3", FLAT, flags=""),  # zeta so low that refsafe's floor is unsafe
    "rope": Case("flex equality", FLEX.format('dim="1" count="4 1 1"', "true"), flags=UNSAFE),
    "cloth": Case("flex equality", FLEX.format('dim="2" count="3 3 1"', "true"), flags=UNSAFE),
    "strained": Case(
        "flexstrain equality", FLEX.format('dim="3" dof="trilinear" count="3 3 3"', "strain"), flags=UNSAFE
    ),
    "joint limit": Case("joint limit", SLIDE.format(LIMIT), flags=UNSAFE, gravity=-10, settle=4000),
    "tendon limit": Case("tendon limit", TWO, TENDON.format(LIMIT), UNSAFE, gravity=-1, settle=2000),
    "joint friction": Case("joint friction", SLIDE.format(RUBS), flags=UNSAFE),
    "tendon friction": Case("tendon friction", TWO, TENDON.format(RUBS), UNSAFE),
    "position": drive('<position joint="x" kp="3000" kv="100"/>'),
    "geared": drive('<position joint="x" kp="3000" kv="10" damping="40" gear="2"/>'),
    # one actuator for each gain, on a damped joint with an armature
    "split": drive('<position joint="x" kp="3000"/><velocity joint="x" kv="100"/>', 'damping="50" armature="1"'),
    "velocity": drive('<velocity joint="x" kv="100" gear="2"/>', kind="velocity drive"),
    "on a tendon": Case(
        "position drive", TWO, TENDON.format("") + '<actuator><position tendon="t" kp="3e3" kv="99"/></actuator>'
    ),
    "spring": Case("joint spring", SLIDE.format('damping="100" stiffness="4000"')),
    "explicit": Case("joint spring", SLIDE.format('damping="100" stiffness="4000"'), flags='eulerdamp="disable"'),
    "tendon spring": Case("tendon spring", TWO, TENDON.format('stiffness="3000" damping="100"')),
}
INTEGRATORS = ("Euler", "RK4", "implicit", "implicitfast")
IN_TURN = list(zip(CASES, cycle(INTEGRATORS), strict=False))
"""Of each kind one integrator."""


@pytest.mark.parametrize(
    ("name", "integrator"),
    [
        *IN_TURN[::2],
        *(
            pytest.param(*pair, marks=pytest.mark.slow)
            for pair in of_campaign(list(product(CASES, INTEGRATORS)), IN_TURN[1::2])
        ),
    ],
)
def test_every_kind_of_row_is_what_mujoco_does(name: str, integrator: str) -> None:
    """Equal |z| to 1e-5, the error of differences, at 0.97 and 1.03 of the limit; runs settle and grow there."""
    version = tuple(map(int, mujoco.__version__.split(".")[:2]))
    if version < (3, 9) and name in ("connect", "weld") and integrator.startswith("implicit"):
        pytest.skip("this version moves free bodies by the midpoint rule, which is stable further out")
    if name == "strained" and not hasattr(mujoco.mjtEq, "mjEQ_FLEXSTRAIN"):
        pytest.skip("this version knows no strain of flexes")
    case = CASES[name]
    row = lint(case, integrator)[0]
    assert (row.kind, row.verdict, row.unsafe) == (case.kind, "converges", False)
    for times in (0.97, 1.03) if row.h_factor else (1.0, 10.0):
        h = H * times * (row.h_factor or 1)
        found, model = lint(case, integrator, h)[0], case.model(integrator, h)
        assert found.verdict == ("diverges" if row.h_factor and times > 1 else "converges")
        assert found.unsafe is (found.verdict == "diverges")
        data = settled(mujoco, model, case.settle)
        moduli = step_moduli(mujoco, model, data)
        away_from_one = moduli[np.abs(moduli - 1) > 1e-4]  # what nothing holds stays where it is
        assert away_from_one[0] == pytest.approx(found.z_abs, abs=1e-5)
        growth = grown(mujoco, model, data, kick=1e-9, steps=100)
        drifts = len(away_from_one) < len(moduli)  # what nothing holds keeps its velocity
        assert growth > 50 if found.unsafe else growth < (10 if drifts else 0.1)


@pytest.mark.parametrize("integrator", ["Euler", pytest.param("RK4", marks=pytest.mark.slow)])
def test_a_contact_is_judged_by_the_most_that_contacts_share(integrator: str) -> None:
    """One sphere gets d of the reference, a box on four corners nearly all of it: it diverges beyond the limit."""
    sphere, box = (
        Case("contact", DROP.format(f'condim="1" {HELD}', shape), flags=UNSAFE, gravity=-10, settle=4000)
        for shape in ("sphere", "box")
    )
    (row,) = lint(sphere, integrator)
    assert row.h_factor is not None
    for times in (0.97, 1.04):
        h = H * times * row.h_factor
        (found,) = lint(box, integrator, h)
        assert found.verdict == ("converges" if times < 1 else "diverges")
        assert (modulus(box, integrator, h) < 1) is (times < 1)
        assert modulus(sphere, integrator, h) < 1


def test_where_r_is_one_a_large_error_grows_though_a_small_one_settles() -> None:
    """Past solimp's width r = 1: b = 2.2 at a = 1 is outside, 0.947 of it inside; all together are judged there too."""
    case = held(direct(1.0, 2.2), flags="")
    (row,) = lint(case)
    assert (row.verdict, row.unsafe) == ("diverges", True)
    assert [row.alpha_hat, row.beta_hat] == pytest.approx([1, 2.2])
    assert "d = 0.95 past solimp's width" in row.judged
    data = mujoco.MjData(case.model())
    assert grown(mujoco, case.model(), data, kick=1e-6, steps=300) < 1e-3
    assert grown(mujoco, case.model(), data, kick=1e-2, steps=300) > 1e3
    beside = '<actuator><position joint="y" kp="3" kv="1"/></actuator>'
    *_, together = lint(replace(case, world=TWO.replace("1 0 .5", "1 0 0"), more=case.more + beside))
    assert (together.kind, together.verdict) == ("together", "diverges")
    assert together.z_abs == pytest.approx(row.z_abs, rel=1e-6)


FOUR_BAR = f"""<body><joint name="crank" axis="0 1 0"/>
  <geom type="capsule" fromto="0 0 0 .05 0 -.0866" size=".005" mass=".02" {WEIGHTLESS}/>
  <body name="coupler" pos=".05 0 -.0866"><joint name="coupler" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 .3 0 0" size=".01" mass="1" {WEIGHTLESS}/></body></body>
<body name="rocker" pos=".35 0 -.2"><joint name="rocker" axis="0 1 0"/>
  <geom type="capsule" fromto="0 0 0 0 0 .1134" size=".01" mass=".5" {WEIGHTLESS}/></body>"""
LOOP = f'<connect name="loop" body1="coupler" body2="rocker" anchor=".3 0 0" solref=".02 1" {FLAT}/>'
SERVO = replace(drive('<position name="servo" joint="rocker" kp="100" kv="4"/>'), world=FOUR_BAR)


@pytest.mark.parametrize(
    ("loop", "times", "alone", "together"),
    [
        (LOOP, 1, False, False),  # it moves the coupler too: MuJoCo's step has |z| = 0.8936
        (LOOP, 4, True, True),
        (LOOP.replace("name=", 'active="false" name='), 1, True, None),  # the loop need not be closed
    ],
)
def test_a_drive_in_a_closed_loop_is_decided_by_the_loop(
    loop: str, times: float, alone: bool, together: bool | None
) -> None:
    case = replace(SERVO, more=f"<equality>{loop}</equality>{SERVO.more}")
    by_kind = {row.kind: row for row in lint(case, "RK4", times * H)}
    servo, all_of_it = by_kind["position drive"], by_kind.get("together")
    assert (servo.verdict, servo.unsafe) == ("diverges", alone)
    assert ("last row" in servo.advice) is not alone
    assert (all_of_it and all_of_it.unsafe) is together
    assert modulus(case, "RK4", times * H) == pytest.approx((all_of_it or servo).z_abs, rel=1e-5)


@pytest.mark.parametrize(
    ("solref", "solimp", "flags", "advised", "judged"),
    [
        (".002 1", "", UNSAFE, "write", ""),
        ("-900000 -100", "", UNSAFE, "write", ""),
        (".002 1", "", "", "relies on refsafe", f'solref="{2 * H:g} 1" by refsafe, d = 0.9 at the constraint'),
        (".5 1", "", "", "needlessly soft", ""),
        (".02 -1", "", "", "signs differ", 'solref="0.02 1" as the signs differ, d = 0.9'),
        ("0 -50", "", "", "no stiffness", ""),
        (".02 1", 'solimp=".05 .9 .001"', "", "solimp leaves small errors alone: d = 0.05", ""),
        (".02 1", 'solimp=".2 .9 .001"', "", "", ""),
    ],
)
def test_the_line_to_write_is_safe_and_it_is_said_why(
    solref: str, solimp: str, flags: str, advised: str, judged: str
) -> None:
    """What is unsafe, relies on refsafe, is soft or mixes signs: the advised solref has no advice left."""
    (before,) = lint(held(solref, solimp, flags))
    assert advised in before.advice
    assert bool(before.advice) is bool(advised)
    assert judged in before.judged
    if 'solref="' in before.advice:
        (after,) = lint(held(before.advice.split('solref="')[1].split('"')[0], solimp, flags))
        assert (after.verdict, after.unsafe, after.advice) == ("converges", False, "")


def test_a_drive_is_told_which_gain_uses_up_its_limit_and_what_to_write() -> None:
    damped, stiff = drive('<position joint="x" kp="1000" kv="1400"/>'), drive('<position joint="x" kp="1e6" kv="100"/>')
    (row,) = lint(damped)
    assert row.advice.startswith("kv takes 140% of the limit, kp 0%")
    assert row.advice.endswith('write integrator="implicitfast"')
    assert lint(damped, "implicitfast")[0].unsafe is False
    (row,) = lint(stiff)
    h = float(row.advice.split('timestep="')[1].split('"')[0])
    assert h < H * (row.h_factor or 0)
    assert lint(stiff, h=h)[0].unsafe is False


@pytest.mark.parametrize(
    ("case", "verdict", "unsafe", "advice"),
    [
        (Case("", SLIDE.format('stiffness="4000"')), "marginal", False, "undamped"),  # it rings on
        (
            drive('<general joint="x" gainprm="1" biastype="affine" biasprm="0 9 -1"/>'),
            "diverges",
            True,
            "pushes away at any step: a gain has the wrong sign",
        ),
        # friction has no timeconst that refsafe could raise
        (Case("", SLIDE.format('frictionloss="1" solreffriction="0 -50"')), "converges", False, ""),
        *(
            (drive(text), None, False, "not judged: its force is no constant stiffness and damping")
            for text in ('<damper joint="x" kv="2" ctrlrange="0 1"/>', '<muscle joint="x" lengthrange="0 1"/>')
        ),
    ],
)
def test_what_is_no_feedback_that_decays_is_told_so(case: Case, verdict: str | None, unsafe: bool, advice: str) -> None:
    (row,) = lint(case)
    assert (row.verdict, row.unsafe, row.advice) == (verdict, unsafe, advice)
    if verdict == "marginal":
        assert row.h_factor == pytest.approx(2 / (H * (4000 / 2) ** 0.5), rel=1e-6)  # b = 4


def test_springs_and_contacts_of_a_flex_are_not_judged() -> None:
    start = '<flexcomp name="f" type="grid" spacing=".1 .1 .1" radius=".001" mass="2" dim='
    (row,) = lint(Case("", f'{start}"1" count="3 1 1"><edge stiffness="9"/></flexcomp>'))
    assert (row.element, row.kind, row.verdict) == ("flex 'f'", "flex", None)
    assert row.advice.startswith("not judged: springs and contacts")
    assert [row.kind for row in lint(CASES["rope"])] == ["flex equality", "flex"]


def random_arm(rng: np.random.Generator) -> Case:
    """Return a chain of links with springs, dampers, drives, a tendon and equalities of any strength."""
    links = int(rng.integers(2, 5))
    names = [f"j{number}" for number in range(links)]

    def strength(low: float, high: float) -> str:
        return f"{10 ** rng.uniform(low, high):.6g}"

    world = ""
    for name in reversed(names):
        axis = " ".join(f"{value:.3f}" for value in rng.normal(size=3))
        passive = f'damping="{strength(-4, 0)}" stiffness="{strength(-2, 1)}" armature="{strength(-4, -2)}"'
        joint = f'<joint name="{name}" type="{rng.choice(["hinge", "slide"])}" axis="{axis}" {passive}/>'
        shape = f'<geom type="capsule" fromto="0 0 0 .3 0 0" size=".02" {WEIGHTLESS}/>'
        world = f'<body pos=".3 0 0">{joint}{shape}{world}</body>'
    first, second = (str(name) for name in rng.choice(names, 2, replace=False))
    coupled = f'<joint joint="{first}" coef="2"/><joint joint="{second}" coef="-1"/>'
    tendon = (
        f'<tendon><fixed name="t" stiffness="{strength(-1, 2)}" damping="{strength(-2, 0)}">{coupled}</fixed></tendon>'
    )
    drives = "".join(
        f'<position joint="{name}" kp="{strength(0, 3)}" kv="{strength(-2, 1)}" gear="{strength(-0.5, 0.5)}"/>'
        for name in names
        if rng.random() < 0.7
    )
    solref = f'solref="{strength(-2.5, -1)} {strength(-0.3, 0.3)}" {FLAT}'
    equalities = f'<joint joint1="{first}" joint2="{second}" {solref}/>' if rng.random() < 0.5 else ""
    flags = rng.choice(["", UNSAFE, 'eulerdamp="disable"'])
    more = f"{tendon}<actuator>{drives}</actuator><equality>{equalities}</equality>"
    return Case("", world, more, str(flags))


@pytest.mark.parametrize(
    ("integrator", "count"),
    [("Euler", 5), *(pytest.param(each, of_campaign(25, 15), marks=pytest.mark.slow) for each in INTEGRATORS)],
)
def test_all_together_is_mujocos_own_step_on_random_arms(integrator: str, count: int) -> None:
    """Verdicts agree, and |z| to 1e-4: differences are as exact as that where steps are ill-conditioned.

    What is safe alone may be unsafe together: each sees the other joints free, all together see less inertia.
    """
    rng = np.random.default_rng(16)
    seen = set()  # verdicts together, and whether all are safe alone
    for _ in range(count):
        arm = random_arm(rng)
        *alone, together = lint(arm, integrator)
        found = modulus(arm, integrator)
        assert together.z_abs == pytest.approx(found, rel=1e-4)
        if abs(found - 1) > 1e-4:
            assert together.verdict == ("diverges" if found > 1 else "converges")
            seen.add((together.verdict, all(row.verdict == "converges" for row in alone)))
    assert {verdict for verdict, _ in seen} == {"converges", "diverges"}
    assert integrator != "Euler" or ("diverges", True) in seen
