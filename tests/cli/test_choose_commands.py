import json
import re
from fractions import Fraction
from pathlib import Path

import pytest

import bezstab
from bezstab.engines import ENGINES
from bezstab.methods import lookup
from bezstab.stability import verdict
from tests.cli.running import rows, run


def test_choose_prints_what_to_set() -> None:
    (row,) = rows("choose", "--method", "B4", "--h", "0.001", "--goal", "fastest")
    keys = "method h goal alpha_hat beta_hat alpha beta z_abs z_angle_deg settle_steps settle_seconds h_limit"
    assert set(keys.split()) <= set(row)
    assert row["z_abs"] == pytest.approx(0.625883502027, abs=1e-7)  # a double mu: half the digits
    assert row["alpha"] == pytest.approx(1000 * 1.0126978003 / 2)
    assert row["beta"] == pytest.approx(1000 * 0.2563892087**0.5)
    assert row["h_limit"] == pytest.approx(0.0015683, rel=1e-4)
    (gentle,) = rows("choose", "--method", "B4", "--h", "0.001", "--goal", "gentle", "--settle", "0.5")
    assert gentle["settle_steps"] == 500
    assert gentle["alpha"] == pytest.approx(gentle["beta"])
    (finer,) = rows("choose", "--h", "0.001", "--h-max", "0.002", "--method", "SYM")
    (coarse,) = rows("choose", "--h", "0.002", "--method", "SYM")
    assert (finer["alpha"], finer["beta"], finer["h_limit"]) == pytest.approx(
        (coarse["alpha"], coarse["beta"], coarse["h_limit"])
    )


@pytest.mark.slow
def test_an_engines_own_words_are_read_and_printed(tmp_path: Path) -> None:
    (given, _) = rows("check", "--engine", "mujoco=0.004,1", "--h", "0.002", "--as-typed")
    assert (given["alpha_hat"], given["beta_hat"], given["z_abs"]) == (1, 0.25, 0.75)
    (row,) = rows("choose", "--engine", "mujoco", "--h", "0.002")
    assert row["method"] == "SYM"
    k, c = re.findall(r"-([\d.]+)", str(row["setting"]))
    assert (float(c) * 0.002, float(k) * 0.002**2) == pytest.approx((row["alpha_hat"], row["beta_hat"]))
    listed = {str(row["engine"]): row for row in rows("engines", "--alpha", "1", "--beta", "0.2", "--h", "0.002")}
    assert listed["ode"]["setting"] == "ERP = 0.2"
    assert "dampingRatio = 2" in str(listed["box2d"]["setting"])
    assert "α̂ = β̂" in str(listed["pbd"]["setting"])
    assert all(row["excludes"] and row["source"] for row in listed.values())
    rows("region", "--method", "SYM", "--engine", "mujoco", "--h", "0.002", "--figure", "svg", "--table", "none")
    assert "timeconst" in (tmp_path / "region_SYM.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "verdict"),
    [
        *(("RK2", "converges"), ("RK1", "marginal"), ("SYM", "diverges")),
        *(pytest.param(name, "diverges", marks=pytest.mark.slow) for name in ("AB2", "AB3", "AB4")),
    ],
)
def test_check_judges_the_textbook_rule(name: str, verdict: str) -> None:
    rule = ("--h", "0.001", "--alpha", "1000", "--beta", "1414.2135623730951", "--physical")  # alpha = 1/h, sqrt(2)/h
    assert rows("check", "--method", "RK2", *rule)[0]["z_abs"] == pytest.approx(0, abs=1e-6)  # as above
    result = run("check", "--method", name, "--alpha", "2", "--beta", "2", "--format", "json")
    assert result.exit_code == (0 if verdict == "converges" else 1)
    given, instead = json.loads(result.stdout)
    assert given["verdict"] == verdict
    assert (given["h_factor"] is None) == (verdict != "converges")
    assert (instead["goal"], instead["verdict"]) == ("accurate", "converges")


@pytest.mark.parametrize(
    "name", [name for name, engine in ENGINES.items() if engine.method and name != "chrono-explicit"]
)
def test_what_choose_prints_for_an_engine_that_engine_reads_as_the_point(name: str) -> None:
    h = Fraction(1, 240)
    (row,) = rows("choose", "--engine", name, "--h", "1/240", "--goal", "fastest")
    point = row["alpha_hat"], row["beta_hat"]
    engine = ENGINES[name]
    values = engine.values((Fraction(str(point[0])), Fraction(str(point[1]))), h)
    assert all(value in str(row["setting"]) for value in values)
    read = engine.applied(tuple(map(Fraction, values)), h)
    assert not read.notes
    assert tuple(map(float, read.point)) == pytest.approx(point, rel=1e-7, abs=1e-9)
    assert row["safe"] is True
    assert row["sweeps"] is engine.sweeps


def test_check_offers_what_the_engine_can_express_with_the_line_to_paste() -> None:
    """Box2D is alpha_hat = 1; of all its points that decay as fast at worst, the mildest."""
    given, instead = rows("check", "--engine", "box2d=60,2", "--h", "1/240")
    assert (given["role"], given["setting"]) == ("given", None)
    assert (instead["role"], instead["alpha_hat"]) == ("instead", 1)
    assert re.fullmatch(r"hertz = [\d.]+, dampingRatio = [\d.]+", str(instead["setting"]))
    # the slowest of all smaller steps, with alpha down by a tenth, decays like e^(-0.45) however large beta is
    assert instead["worst"] == pytest.approx(2.718281828459045 ** (-0.45), rel=1e-6)


def test_an_engine_that_sweeps_is_safe_for_one_constraint_alone() -> None:
    swept = ("chipmunk=0.5", "box2d=60,2", "bullet=0.2", "ode=0.2", "rapier=1000,1", "jolt=0.2", "physx-drive=100,20")
    for words in swept:
        assert ENGINES[words.partition("=")[0]].sweeps
    for words in ("bullet=0.2", "physx-drive=100,20"):
        result = run("check", "--engine", words, "--h", "1/240")
        assert result.stdout.startswith("One constraint alone: safe. Each step multiplies")
        assert "chains of them may diverge all the same" in result.stderr
    assert run("check", "--engine", "kamino=0.01", "--h", "1/240").stdout.startswith(
        "Safe. Each step multiplies the error by"
    )
    assert run("check", "--engine", "bullet=2.1", "--h", "1/240").stdout.startswith(
        "One constraint alone: not safe. Each step multiplies the error by"
    )


@pytest.mark.parametrize("name", ["unity", "Unity", "avian", "newton"])
def test_an_engine_that_runs_another_is_answered_with_that(name: str) -> None:
    for options in (("choose", "--engine", name), ("check", "--engine", f"{name}=1")):
        result = run(*options, "--h", "1/60")
        assert result.exit_code == 2
        assert "ask about" in result.stderr
    assert f"{name.lower()}: " in run("engines").stdout


def test_a_method_without_region_is_not_safe(tmp_path: Path) -> None:
    """The explicit leapfrog, y1 = y[-1] + 2 h f0: its root -1 grows with every damping."""
    leapfrog = tmp_path / "leapfrog.toml"
    leapfrog.write_text('rho = ["1", "0", "-1"]\nsigma = ["0", "2", "0"]\n', encoding="utf-8")
    asked = ("check", "--method", str(leapfrog), "--alpha", "0.1", "--beta", "0.01")
    result = run(*asked)
    assert result.exit_code == 1
    assert result.stdout.startswith("Not safe. Each step multiplies the error by")
    assert "nothing instead: leapfrog is not stable with any α and β" in result.stderr
    as_json = run(*asked, "--format", "json")
    (given,) = json.loads(as_json.stdout)
    assert (as_json.exit_code, given["role"], given["safe"]) == (1, "given", False)
    assert bezstab.check(str(leapfrog), alpha_hat=0.1, beta_hat=0.01).verdict == "diverges"


@pytest.mark.slow
def test_which_integrator_is_asked_in_one_line() -> None:
    for command in ("check --alpha 1 --beta 1", "choose --h 0.01"):
        result = run(*command.split())
        assert (result.exit_code, result.stdout, len(result.stderr.splitlines())) == (2, "", 1)
        assert all(name in result.stderr for name in ("--method", "SYM", "RK4", "rk45", "--engine", "--pd"))
    assert rows("poles", "--alpha", "0.5", "--beta", "0.1")  # which keeps its default


def test_what_was_typed_is_shown_as_typed() -> None:
    given, _ = rows("check", "--method", "SYM", "--h", "1/240", "--alpha", "60", "--beta", "60.1", "--physical")
    assert (given["alpha"], given["beta"]) == (60, 60.1)
    given, _ = rows("check", "--engine", "maplesim=60,60.1", "--method", "SYM", "--h", "0.003")
    assert (given["alpha"], given["beta"]) == (60, 60.1)
    given = rows("check", "--pd", "1000,80.1,0.3", "--method", "stable-pd", "--h", "1/239")[0]
    assert (given["kp"], given["kd"]) == (1000, 80.1)


@pytest.mark.parametrize("name", ["SYM", "rk45", "AB4"])
def test_without_a_step_the_largest_safe_one_is_the_answer(name: str) -> None:
    asked = ("check", "--method", name, "--alpha", "60", "--beta", "55", "--physical")
    (row,) = rows(*asked)
    limit = Fraction(str(row["h_limit"]))
    for factor, expected in (("0.001", "converges"), ("0.5", "converges"), ("0.999999", "converges"), ("1.000001", "")):
        h = limit * Fraction(factor)
        assert verdict(lookup(name), 120 * h, 55**2 * h**2) == (expected or "diverges")
    said = run(*asked).stdout.splitlines()[0]
    shown = Fraction(re.fullmatch(r"Safe up to h = ([\d.]+) s\.", said)[1])  # type: ignore[index]
    assert limit * Fraction("0.999") < shown <= limit  # rounded down: what is copied is safe


def test_without_a_step_some_are_safe_at_any_and_some_at_none() -> None:
    assert run("check", "--method", "implicit-euler", "--alpha", "1", "--beta", "1", "--physical").stdout.startswith(
        "Safe at any h."
    )
    undamped = run("check", "--method", "SYM", "--alpha", "0", "--beta", "1", "--physical")
    assert undamped.stdout.startswith("Not safe at small steps.")
    assert undamped.exit_code == 1


CHIPMUNK = ("--engine", f"chipmunk={0.9**60!r}", "--h", "1/60")


@pytest.mark.slow
def test_chipmunks_defaults_come_apart_in_a_chain_of_ten() -> None:
    result = run("check", *CHIPMUNK, "--chain", "10", "--mass-ratio", "10")
    assert result.exit_code == 1
    assert result.stdout.startswith(
        "Not safe in a chain of 10 with the last body 10 times as heavy: each step multiplies the error by 1.0049 (one "
        "constraint alone: 0.90). Stable from 12 sweeps."
    )
    in_json = run("check", *CHIPMUNK, "--chain", "10", "--mass-ratio", "10", "--format", "json")
    given, instead = json.loads(in_json.stdout)
    assert (given["safe"], given["verdict"], given["swept_iterations"]) == (False, "converges", 10)
    assert given["swept_z_abs"] == pytest.approx(1.0049430, abs=1e-7)
    assert given["swept"] == instead["swept"] == "a chain of 10 with the last body 10 times as heavy"
    assert instead["safe"] is True  # weaker than what is best for one constraint, which is worse for a chain
    assert instead["beta_hat"] < given["beta_hat"]
    assert run("check", *CHIPMUNK, "--chain", "10", "--mass-ratio", "10", "--iterations", "12").exit_code == 0
    assert run("check", *CHIPMUNK).stdout.startswith("One constraint alone: safe.")


@pytest.mark.slow
def test_choose_gives_the_strongest_that_a_chain_allows() -> None:
    """What it prints is stable there, and nearly a tenth more is; more than that is not."""
    asked = ("--engine", "chipmunk", "--h", "1/60", "--chain", "10", "--mass-ratio", "10")
    (row,) = rows("choose", *asked)
    assert row["safe"]
    assert row["stable_iterations"] == 10
    left = float(str(row["setting"]).removeprefix("errorBias = ")) ** (1 / 60)
    for share, status in ((1 - left, 0), (1.09 * (1 - left), 0), (1.11 * (1 - left), 1)):
        values = f"chipmunk={(1 - share) ** 60!r}"
        assert (
            run("check", "--engine", values, *CHIPMUNK[2:], "--chain", "10", "--mass-ratio", "10").exit_code == status
        )


def test_choose_says_how_many_sweeps_the_goals_own_answer_would_take() -> None:
    """With a tenth to spare: so many sweeps are stable at 1.1 times its share, one fewer is not."""
    chain = ("--chain", "10", "--mass-ratio", "10")
    result = run("choose", "--engine", "chipmunk", "--h", "1/60", *chain)
    (line,) = (line for line in result.stdout.splitlines() if line.startswith("One constraint alone would get"))
    error_bias, sweeps = re.fullmatch(r".* errorBias = (\S+): .* that takes (\d+) sweeps\.", line).groups()  # type: ignore[union-attr]
    share = 1.1 * (1 - float(error_bias) ** (1 / 60))
    values = f"chipmunk={(1 - share) ** 60!r}"
    for count, status in ((int(sweeps), 0), (int(sweeps) - 1, 1)):
        asked = ("check", "--engine", values, "--h", "1/60", *chain, "--iterations", str(count))
        assert run(*asked).exit_code == status


def test_choose_keeps_the_goals_own_answer_where_a_chain_allows_it() -> None:
    alone, chained = (
        rows("choose", "--engine", "bullet", "--h", "1/60", *chain)[0] for chain in ((), ("--chain", "3"))
    )
    assert chained["setting"] == alone["setting"]
    assert (alone["swept"], chained["swept"]) == ("one constraint alone", "a chain of 3")


def test_the_constraints_of_a_scene_are_swept_in_an_engine_that_sweeps() -> None:
    """The sentence says which constraints; at rest at the start they are those of a run; mujoco has no such keys."""
    asked = ("--engine", "chipmunk=0.5", "--h", "1/240", "--scene", "driven_four_bar", "--speed", "0.1")
    result = run("check", *asked)
    assert result.stdout.startswith(
        "Safe in driven_four_bar at its start, with its 5 constraints: each step multiplies"
    )
    assert "Solved exactly, over the motion each step multiplies the error by" in result.stdout
    assert "chipmunk: sweeps are its iterations" in result.stderr
    one_sweep = rows("check", *asked, "--iterations", "1")[0]
    assert (one_sweep["swept_constraints"], one_sweep["swept_iterations"]) == (5, 1)
    exactly = rows("check", "--engine", "mujoco=0.02,1", *asked[2:])[0]
    assert exactly["swept"] is None
    assert "swept_z_abs" not in exactly


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--engine", "chipmunk=0.1", "--chain", "0"), "--chain 0: expected 1 to 100 bodies"),
        (("--engine", "chipmunk=0.1", "--chain", "3", "--mass-ratio", "0"), "--mass-ratio 0: expected 1e-06 to 1e+06"),
        (("--engine", "chipmunk=0.1", "--chain", "3", "--mass-ratio", "-2"), "--mass-ratio -2: expected"),
        (("--engine", "chipmunk=0.1", "--chain", "3", "--iterations", "0"), "--iterations 0: expected 1 to 10000"),
        (("--engine", "mujoco=0.02,1", "--chain", "3"), "--chain: mujoco solves all constraints together"),
        (("--engine", "brax-contact=0.1", "--chain", "3"), "--chain: how brax-contact sweeps"),
        (("--engine", "chipmunk=0.1", "--mass-ratio", "3"), "--mass-ratio needs --chain"),
        (("--engine", "chipmunk=0.1", "--iterations", "3"), "--iterations needs --chain or --scene"),
        (
            ("--engine", "chipmunk=0.1", "--scene", "four_bar", "--iterations", "0"),
            "--iterations 0: expected 1 to 10000",
        ),
        (("--engine", "chipmunk=0.1", "--scene", "pendulum", "--iterations", "3"), "pendulum has one constraint alone"),
        (("--engine", "chipmunk=0.1", "--scene", "four_bar", "--chain", "3"), "--chain and --scene are two mechanisms"),
        (("--engine", "mujoco=0.02,1", "--scene", "four_bar", "--iterations", "3"), "--iterations: mujoco solves all"),
        (("--pd", "1,1,1", "--scene", "four_bar", "--iterations", "3"), "--iterations needs --engine"),
        (("--engine", "chipmunk=0.1", "--scene", "humanoid"), "unknown scene 'humanoid'"),
        (("--pd", "1,1,1", "--chain", "3"), "--chain needs --engine"),
    ],
)
def test_what_no_chain_can_be_asked_of_is_one_line(options: tuple[str, ...], said: str) -> None:
    result = run("check", *options, "--h", "1/60")
    assert (result.exit_code, result.stdout) == (2, "")
    assert said in result.stderr.replace("\n", " ")
