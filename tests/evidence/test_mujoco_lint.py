"""What lint says of each kind of row is what MuJoCo does: a little inside and a little outside of every limit."""

from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bezstab.evidence import Linted, linted_model, model_data
from bezstab.methods import lookup
from bezstab.stability import spectral_radius
from tests.evidence.samples import of_campaign
from tests.reference.mujoco_steps import grown, settled, step_moduli

mujoco: Any = pytest.importorskip("mujoco")


@pytest.fixture(autouse=True)
def _away_from_here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo writes its warnings, of what diverges, into a file of the current directory."""
    monkeypatch.chdir(tmp_path)


H = 0.004
FLAT = 'solimp="0.9 0.9 0.001"'  # d = 0.9 everywhere
UNSAFE = 'refsafe="disable"'
WEIGHTLESS = 'contype="0" conaffinity="0"'
SLIDE = f'<body><joint name="x" type="slide" axis="0 0 1" {{}}/><geom size=".1" mass="2" {WEIGHTLESS}/></body>'
FREE = f'<body name="b"><freejoint/><geom size=".1" mass="2" pos="{{}} 0 0" {WEIGHTLESS}/></body>'
TWO = (
    f'<body><joint name="x" type="slide" axis="0 0 1"/><geom size=".1" mass="2" {WEIGHTLESS}/>'
    f'<body><joint name="y" type="slide" axis="1 0 .5"/><geom size=".1" mass="3" {WEIGHTLESS}/></body></body>'
)
TENDON = '<tendon><fixed name="t" {}><joint joint="x" coef="2"/><joint joint="y" coef="-1"/></fixed></tendon>'
DROP = (
    '<geom type="plane" size="1 1 .1" {0}/>'
    '<body pos="0 0 .1"><joint type="slide" axis="0 0 1"/><geom type="{1}" size=".1 .1 .1" mass="2" {0}/></body>'
)
CONTACT = f'condim="1" solref=".01 .7" {FLAT}'


@dataclass(frozen=True)
class Case:
    """A small model whose first row is of the kind that is looked at, at a step inside its limit."""

    kind: str
    world: str
    more: str = ""
    flags: str = ""
    gravity: float = 0.0
    settle: int = 0  # small steps

    def model(self, integrator: str, h: float = H) -> Any:
        return mujoco.MjModel.from_xml_string(
            f"""<mujoco><compiler angle="radian"/>
            <option timestep="{h!r}" integrator="{integrator}" gravity="0 0 {self.gravity}" tolerance="0">
              <flag {self.flags} autoreset="disable"/>
            </option><worldbody>{self.world}</worldbody>{self.more}</mujoco>"""
        )


def actuator(text: str) -> str:
    return f"<actuator>{text}</actuator>"


def equality(text: str) -> str:
    return f"<equality>{text}</equality>"


JOINT = f'<joint joint1="x" solref=".01 .7" {FLAT}/>'
DIRECT = f'<joint joint1="x" solref="-9000 -150" {FLAT}/>'
CONNECT = f'<connect body1="b" anchor=".2 0 0" solref=".01 .7" {FLAT}/>'
WELD = f'<weld body1="b" solref=".01 .7" {FLAT}/>'
ALIKE = f'<tendon tendon1="t" solref="-9000 -150" {FLAT}/>'
LOW = f'<joint joint1="x" solref=".05 .3" {FLAT}/>'  # zeta so low that refsafe's floor is unsafe
EQUALITIES = {
    "joint": Case("joint equality", SLIDE.format(""), equality(JOINT), UNSAFE),
    "direct": Case("joint equality", SLIDE.format(""), equality(DIRECT), UNSAFE),
    "connect": Case("connect equality", FREE.format(0), equality(CONNECT), UNSAFE),
    "weld": Case("weld equality", FREE.format(".1"), equality(WELD), UNSAFE),
    "tendon": Case("tendon equality", TWO, TENDON.format("") + equality(ALIKE), UNSAFE),
    "refsafe": Case("joint equality", SLIDE.format(""), equality(LOW)),
}
FLEX = (
    '<flexcomp name="f" type="grid" {} spacing=".1 .1 .1" radius=".001" mass="2">'
    f'<edge equality="{{}}" solref=".01 .7" {FLAT}/><contact selfcollide="none" {WEIGHTLESS}/></flexcomp>'
)
FLEXES = {
    "rope": Case("flex equality", FLEX.format('dim="1" count="4 1 1"', "true"), flags=UNSAFE),
    "cloth": Case("flex equality", FLEX.format('dim="2" count="3 3 1"', "true"), flags=UNSAFE),
    "solid": Case("flex equality", FLEX.format('dim="3" count="2 2 2"', "true"), flags=UNSAFE),
    "strained": Case(
        "flexstrain equality", FLEX.format('dim="3" dof="trilinear" count="3 3 3"', "strain"), flags=UNSAFE
    ),
}
LIMIT = 'limited="true" range="0 1" solreflimit=".01 .7" solimplimit="0.9 0.9 0.001"'
OTHERS = {
    "joint limit": Case("joint limit", SLIDE.format(LIMIT), flags=UNSAFE, gravity=-10, settle=4000),
    "tendon limit": Case("tendon limit", TWO, TENDON.format(LIMIT), UNSAFE, gravity=-1, settle=2000),
    "joint friction": Case("joint friction", SLIDE.format('frictionloss="100" solreffriction=".01 1"'), flags=UNSAFE),
    "tendon friction": Case(
        "tendon friction", TWO, TENDON.format('frictionloss="100" solreffriction=".01 1"'), flags=UNSAFE
    ),
}
DRIVES = {
    "position": Case("position drive", SLIDE.format(""), actuator('<position joint="x" kp="3000" kv="100"/>')),
    "geared": Case("position drive", SLIDE.format(""), actuator('<position joint="x" kp="90" kv="4" gear="5"/>')),
    "split": Case(  # one actuator for each gain, on a damped joint with an armature
        "position drive",
        SLIDE.format('damping="50" armature="1"'),
        actuator('<position joint="x" kp="3000"/><velocity joint="x" kv="100"/>'),
    ),
    "velocity": Case("velocity drive", SLIDE.format(""), actuator('<velocity joint="x" kv="100" gear="2"/>')),
    "own damping": Case(
        "position drive", SLIDE.format(""), actuator('<position joint="x" kp="3000" damping="40" gear="2"/>')
    ),
    "on a tendon": Case("position drive", TWO, TENDON.format("") + actuator('<position tendon="t" kp="3e3" kv="99"/>')),
    "spring": Case("joint spring", SLIDE.format('damping="100" stiffness="4000"')),
    "explicit": Case("joint spring", SLIDE.format('damping="100" stiffness="4000"'), flags='eulerdamp="disable"'),
    "tendon spring": Case("tendon spring", TWO, TENDON.format('stiffness="3000" damping="100"')),
}
CASES = {**EQUALITIES, **FLEXES, **OTHERS, **DRIVES}
QUICK = {("joint", "Euler"), ("weld", "implicit"), ("joint limit", "implicitfast"), ("position", "implicitfast")}
QUICK |= {("rope", "Euler"), ("joint friction", "Euler"), ("split", "Euler"), ("tendon", "RK4"), ("explicit", "Euler")}
INTEGRATORS = ("Euler", "RK4", "implicit", "implicitfast")
ALL = list(product(CASES, INTEGRATORS))
EACH_TIME = {pair for number, pair in enumerate(ALL) if (number + number // 4) % of_campaign(1, 2) == 0} | QUICK
"""Of each kind two integrators: Euler and implicit, then RK4 and implicitfast; all of them in the campaign."""


def lint(model: Any) -> list[Linted]:
    return list(linted_model(model_data(mujoco, model)))


@pytest.mark.promise(
    "`lint`: every kind of row of a MuJoCo model, flexes too, under each of its four integrators",
    measured=(
        "|z| of MuJoCo's own step to 1e-5, at 0.97 and 1.03 of the limit; runs settle and grow there. Springs and"
        " contacts of a flex are not judged, and it says so. A contact's limit is that of contacts that share all"
        " of their reference, up to 11 % inside that of one alone. In a closed loop all together decide"
    ),
)
@pytest.mark.parametrize(
    ("name", "integrator"),
    [pytest.param(*pair, marks=[] if pair in QUICK else pytest.mark.slow) for pair in ALL if pair in EACH_TIME],
)
def test_every_kind_of_row_is_what_mujoco_does(name: str, integrator: str) -> None:
    """Equal |z| to 1e-5, the error of differences, at 0.97 and 1.03 of the limit; runs settle and grow there."""
    version = tuple(map(int, mujoco.__version__.split(".")[:2]))
    if version < (3, 9) and name in ("connect", "weld") and integrator.startswith("implicit"):
        pytest.skip("this version moves free bodies by the midpoint rule, which is stable further out")
    if name == "strained" and not hasattr(mujoco.mjtEq, "mjEQ_FLEXSTRAIN"):
        pytest.skip("this version knows no strain of flexes")
    case = CASES[name]
    row = lint(case.model(integrator))[0]
    assert (row.kind, row.verdict, row.unsafe) == (case.kind, "converges", False)
    for times in (0.97, 1.03) if row.h_factor else (1.0, 10.0):
        model = case.model(integrator, H * times * (row.h_factor or 1))
        found = lint(model)[0]
        assert found.verdict == ("diverges" if row.h_factor and times > 1 else "converges")
        assert found.unsafe is (found.verdict == "diverges")
        data = settled(mujoco, model, case.settle)
        moduli = step_moduli(mujoco, model, data)
        away_from_one = moduli[np.abs(moduli - 1) > 1e-4]  # what nothing holds stays where it is
        assert away_from_one[0] == pytest.approx(found.z_abs, abs=1e-5)
        growth = grown(mujoco, model, data, kick=1e-9, steps=100)
        drifts = len(away_from_one) < len(moduli)  # what nothing holds keeps its velocity
        assert growth > 50 if found.unsafe else growth < (10 if drifts else 0.1)


@pytest.mark.promise("`lint`: every kind of row of a MuJoCo model, flexes too, under each of its four integrators")
@pytest.mark.parametrize("integrator", ["Euler", pytest.param("RK4", marks=pytest.mark.slow)])
def test_a_contact_is_judged_by_the_most_that_contacts_share(integrator: str) -> None:
    """One sphere gets d of the reference, a box on four corners nearly all of it: it diverges beyond the limit."""
    sphere, box = (
        Case("contact", DROP.format(CONTACT, shape), flags=UNSAFE, gravity=-10, settle=4000)
        for shape in ("sphere", "box")
    )
    (row,) = lint(sphere.model(integrator))
    assert row.h_factor is not None
    for times in (0.97, 1.04):
        h = H * times * row.h_factor
        (found,) = lint(box.model(integrator, h))
        assert found.verdict == ("converges" if times < 1 else "diverges")
        model = box.model(integrator, h)
        box_moduli = step_moduli(mujoco, model, settled(mujoco, model, 4000))
        assert bool(box_moduli[0] < 1) is (times < 1)
        model = sphere.model(integrator, h)
        alpha_hat = 2 * h / 0.01  # r = 1
        beta_hat = (h / (0.01 * 0.7)) ** 2
        nominal = spectral_radius(lookup({"Euler": "SYM"}.get(integrator, integrator)), alpha_hat, beta_hat)
        assert step_moduli(mujoco, model, settled(mujoco, model, 4000))[0] == pytest.approx(float(nominal), abs=1e-5)


def joint_equality(solref: str, more: str = FLAT, **changes: Any) -> Linted:
    """Return what lint says, under Euler, of a body on a rail that is held so."""
    held = replace(EQUALITIES["joint"], more=equality(f'<joint joint1="x" solref="{solref}" {more}/>'))
    return lint(replace(held, **changes).model("Euler"))[0]


def direct(a: float, b: float) -> str:
    """Return the solref with alpha_hat = a and beta_hat = b where d = 1."""
    return f"{-b / H**2!r} {-a / H!r}"


def test_the_default_solimp_scales_by_0_947() -> None:
    row = joint_equality("0.04 1", more="")
    assert [row.alpha_hat, row.beta_hat] == pytest.approx([0.2 * 0.9 / 0.95, 0.01 * (0.9 / 0.95) ** 2])


def test_where_r_is_one_a_large_error_grows_though_a_small_one_settles() -> None:
    """Past solimp's width r = 1: b = 2.2 at a = 1 is outside, 0.947 of it inside; all together are judged there too."""
    row = joint_equality(direct(1.0, 2.2), more="")
    assert (row.verdict, row.unsafe) == ("diverges", True)
    assert [row.alpha_hat, row.beta_hat] == pytest.approx([1, 2.2])
    assert "d = 0.95 past solimp's width" in row.judged
    held = f'<joint joint1="x" solref="{direct(1.0, 2.2)}"/>'
    model = replace(EQUALITIES["joint"], more=equality(held)).model("Euler")
    data = mujoco.MjData(model)
    assert grown(mujoco, model, data, kick=1e-6, steps=300) < 1e-3
    assert grown(mujoco, model, data, kick=1e-2, steps=300) > 1e3
    drive = actuator('<position joint="y" kp="3" kv="1"/>')
    *_, together = lint(Case("", TWO.replace("1 0 .5", "1 0 0"), equality(held) + drive).model("Euler"))
    assert (together.kind, together.verdict) == ("together", "diverges")
    assert together.z_abs == pytest.approx(row.z_abs, rel=1e-6)


def test_implicit_damping_divides_the_point() -> None:
    """By 1 + h d / m: with 1 + 1 the limit 4 - 2a of b becomes 8 - 2a."""
    for b, verdict in ((5.8, "converges"), (6.2, "diverges")):
        row = joint_equality(direct(1.0, b), world=SLIDE.format(f'damping="{2 / H!r}"'))
        assert [row.alpha_hat, row.beta_hat] == pytest.approx([1 / 2, b / 2])
        assert row.verdict == verdict


@pytest.mark.promise("`lint`: every kind of row of a MuJoCo model, flexes too, under each of its four integrators")
@pytest.mark.parametrize("integrator", ["Euler", "implicitfast", "RK4"])
def test_what_is_safe_alone_may_be_unsafe_together(integrator: str) -> None:
    """Two drives along a chain: each sees the other joint free, both together see less inertia."""
    arm = (
        '<body><joint name="x" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03"/>'
        '<body pos=".3 0 0"><joint name="y" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".02"/>'
        "</body></body>"
    ).replace("size=", f"{WEIGHTLESS} size=")
    drives = '<position joint="x" kp="30" kv="0.1"/><position joint="y" kp="30" kv="0.1"/>'
    case = Case("position drive", arm, actuator(drives))
    together = lint(case.model(integrator))[-1]
    assert together.kind == "together"
    assert together.h_factor is not None
    for times, verdict in ((0.97, "converges"), (1.03, "diverges")):
        model = case.model(integrator, H * times * together.h_factor)
        *alone, found = lint(model)
        assert found.verdict == verdict
        assert found.z_abs == pytest.approx(step_moduli(mujoco, model, mujoco.MjData(model))[0], abs=1e-5)
    assert all(row.verdict == "converges" for row in alone)
    assert "timestep" in found.advice


FOUR_BAR = f"""<body><joint name="crank" axis="0 1 0"/>
  <geom type="capsule" fromto="0 0 0 .05 0 -.0866" size=".005" mass=".02" {WEIGHTLESS}/>
  <body name="coupler" pos=".05 0 -.0866"><joint name="coupler" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 .3 0 0" size=".01" mass="1" {WEIGHTLESS}/></body></body>
<body name="rocker" pos=".35 0 -.2"><joint name="rocker" axis="0 1 0"/>
  <geom type="capsule" fromto="0 0 0 0 0 .1134" size=".01" mass=".5" {WEIGHTLESS}/></body>"""
LOOP = f'<connect name="loop" body1="coupler" body2="rocker" anchor=".3 0 0" solref=".02 1" {FLAT}/>'
SERVO = '<position name="servo" joint="rocker" kp="100" kv="4"/>'


@pytest.mark.promise("`lint`: every kind of row of a MuJoCo model, flexes too, under each of its four integrators")
def test_a_drive_in_a_closed_loop_is_decided_by_the_loop() -> None:
    """It moves the coupler too: MuJoCo's step has |z| = 0.8936 there, and diverges once the loop is opened."""
    closed = Case("position drive", FOUR_BAR, equality(LOOP) + actuator(SERVO))
    model = closed.model("RK4")
    _, servo, together = lint(model)
    assert (servo.kind, servo.verdict, servo.unsafe) == ("position drive", "diverges", False)
    assert "last row" in servo.advice
    assert (together.kind, together.verdict, together.unsafe) == ("together", "converges", False)
    data = mujoco.MjData(model)
    assert step_moduli(mujoco, model, data)[0] == pytest.approx(together.z_abs, abs=1e-5)
    assert grown(mujoco, model, data, kick=1e-9, steps=100) < 0.1
    opened = replace(closed, more=actuator(SERVO)).model("RK4")
    (alone,) = lint(opened)
    assert alone.unsafe
    moduli = step_moduli(mujoco, opened, mujoco.MjData(opened))
    assert moduli[0] == pytest.approx(alone.z_abs, rel=1e-5)


def test_a_drive_counts_for_itself_where_its_loop_diverges_or_need_not_be_closed() -> None:
    for loop, h, unsafe in (
        (LOOP, 4 * H, [True, True]),
        (LOOP.replace("name=", 'active="false" name='), H, [False, True]),
    ):
        rows = lint(Case("", FOUR_BAR, equality(loop) + actuator(SERVO)).model("RK4", h))
        assert [row.unsafe for row in rows[-2:]] == unsafe


def test_the_line_to_write_is_safe_and_it_is_said_why() -> None:
    """What is unsafe, relies on refsafe, is soft or mixes signs: the advised solref has no advice left."""
    for solref, flags, advised, judged in (
        (".002 1", UNSAFE, "write", ""),
        ("-900000 -100", UNSAFE, "write", ""),
        (".002 1", "", "relies on refsafe", f'solref="{2 * H:g} 1" by refsafe, d = 0.9 at the constraint'),
        (".5 1", "", "needlessly soft", ""),
        (".02 -1", "", "signs differ", 'solref="0.02 1" as the signs differ, d = 0.9'),
        ("0 -50", "", "no stiffness", ""),
    ):
        before = joint_equality(solref, more="", flags=flags)
        assert advised in before.advice
        assert judged in before.judged
        line = before.advice.split('solref="')[1].split('"')[0]
        after = joint_equality(line, more="", flags=flags)
        assert (after.verdict, after.unsafe, after.advice) == ("converges", False, "")


def test_a_constraint_that_hardly_holds_small_errors_is_told_so() -> None:
    for hold, told in ((0.05, True), (0.2, False)):
        row = joint_equality(".02 1", more=f'solimp="{hold} .9 .001"')
        assert row.advice.startswith(f"solimp leaves small errors alone: d = {hold}") == told


def test_friction_without_stiffness_has_no_timeconst_to_be_raised() -> None:
    case = Case("joint friction", SLIDE.format('frictionloss="1" solreffriction="0 -50"'))
    (row,) = lint(case.model("Euler"))
    assert (row.verdict, row.advice) == ("converges", "")


def test_a_drive_is_told_which_gain_uses_up_its_limit_and_what_to_write() -> None:
    case = replace(DRIVES["position"], more=actuator('<position joint="x" kp="1000" kv="1400"/>'))
    row = lint(case.model("Euler"))[0]
    assert row.advice.startswith("kv takes 140% of the limit, kp 0%")
    assert row.advice.endswith('write integrator="implicitfast"')
    assert lint(case.model("implicitfast"))[0].unsafe is False
    stiff = replace(case, more=actuator('<position joint="x" kp="1e6" kv="100"/>'))
    row = lint(stiff.model("Euler"))[0]
    h = float(row.advice.split('timestep="')[1].split('"')[0])
    assert h < H * (row.h_factor or 0)
    assert lint(stiff.model("Euler", h))[0].unsafe is False


def test_what_has_no_damping_rings_on_and_is_not_called_unsafe() -> None:
    case = replace(DRIVES["spring"], world=SLIDE.format('stiffness="4000"'))
    row = lint(case.model("Euler"))[0]
    assert (row.verdict, row.unsafe, row.advice) == ("marginal", False, "undamped")
    assert row.h_factor == pytest.approx(2 / (H * (4000 / 2) ** 0.5), rel=1e-6)  # b = 4


def test_a_gain_of_the_wrong_sign_is_unsafe_at_any_step() -> None:
    case = replace(
        DRIVES["position"], more=actuator('<general joint="x" gainprm="1" biastype="affine" biasprm="0 9 -1"/>')
    )
    row = lint(case.model("Euler"))[0]
    assert row.unsafe
    assert "wrong sign" in row.advice


@pytest.mark.promise("`lint`: every kind of row of a MuJoCo model, flexes too, under each of its four integrators")
def test_springs_and_contacts_of_a_flex_are_not_judged() -> None:
    start = '<flexcomp name="f" type="grid" spacing=".1 .1 .1" radius=".001" mass="2" dim='
    (row,) = lint(Case("", f'{start}"1" count="3 1 1"><edge stiffness="9"/></flexcomp>').model("Euler"))
    assert (row.element, row.kind, row.verdict) == ("flex 'f'", "flex", None)
    assert row.advice.startswith("not judged: springs and contacts")
    assert [row.kind for row in lint(FLEXES["rope"].model("Euler"))] == ["flex equality", "flex"]


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
    return Case("", world, tendon + actuator(drives) + equality(equalities), str(flags))


@pytest.mark.promise("`lint`: every kind of row of a MuJoCo model, flexes too, under each of its four integrators")
@pytest.mark.slow
@pytest.mark.parametrize("integrator", of_campaign(INTEGRATORS, ("RK4", "implicitfast")))
def test_all_together_is_mujocos_own_step_on_random_arms(integrator: str) -> None:
    """Verdicts agree, and |z| to 1e-4: differences are as exact as that where steps are ill-conditioned."""
    rng = np.random.default_rng(16)
    verdicts = set()
    for _ in range(of_campaign(25, 15)):
        model = random_arm(rng).model(integrator)
        together = lint(model)[-1]
        moduli = step_moduli(mujoco, model, mujoco.MjData(model))
        assert together.z_abs == pytest.approx(moduli[0], rel=1e-4)
        if abs(moduli[0] - 1) > 1e-4:
            assert together.verdict == ("diverges" if moduli[0] > 1 else "converges")
            verdicts.add(together.verdict)
    assert verdicts == {"converges", "diverges"}


def test_what_is_no_constant_gain_is_not_judged() -> None:
    drives = '<damper joint="x" kv="2" ctrlrange="0 1"/><muscle joint="x" lengthrange="0 1"/>'
    case = replace(DRIVES["position"], more=actuator(drives))
    rows = lint(case.model("Euler"))
    assert [row.verdict for row in rows] == [None, None]
    assert all(row.advice.startswith("not judged") and not row.unsafe for row in rows)
