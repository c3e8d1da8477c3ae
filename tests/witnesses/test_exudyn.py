"""Exudyn: its integrators on c'' + 2 alpha c' + beta^2 c = 0, a mass on a spring and damper of its own elements."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from bezstab.methods.registry import lookup
from bezstab.runs.linear_prediction import fit_dominant_pole
from bezstab.stability.closed_loop import dominant_pole, spectral_radius
from bezstab.stability.margins import stability_margins

exudyn: Any = pytest.importorskip("exudyn")

H = 0.01
MASS = 2.0
POINTS = ((0.5, 0.3), (1.0, 4.0), (0.2, 10.0))
"""Whose dominant poles are complex, and decay slowly enough to be measured under the implicit integrators."""


def positions(alpha_hat: float, beta_hat: float, solver: str, rho_inf: float, newmark: bool, steps: int) -> Any:
    """Return the position of the mass after each step, from 1 at rest."""
    from exudyn import itemInterface as items  # noqa: N813

    system = exudyn.SystemContainer().AddSystem()
    ground = system.AddNode(items.NodePointGround(referenceCoordinates=[0, 0, 0]))
    node = system.AddNode(items.Node1D(referenceCoordinates=[0.0], initialCoordinates=[1.0], initialVelocities=[0.0]))
    system.AddObject(items.Mass1D(nodeNumber=node, mass=MASS))
    ends = [system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=one, coordinate=0)) for one in (ground, node)]
    system.AddObject(
        items.CoordinateSpringDamper(markerNumbers=ends, stiffness=MASS * beta_hat / H**2, damping=MASS * alpha_hat / H)
    )
    sensor = system.AddSensor(
        items.SensorNode(
            nodeNumber=node,
            storeInternal=True,
            writeToFile=False,
            outputVariableType=exudyn.OutputVariableType.Coordinates,
        )
    )
    system.Assemble()
    settings = exudyn.SimulationSettings()
    integration = settings.timeIntegration
    integration.numberOfSteps, integration.endTime = steps, steps * H
    integration.newton.relativeTolerance, integration.newton.absoluteTolerance = 1e-12, 1e-14
    integration.generalizedAlpha.spectralRadius = rho_inf
    integration.generalizedAlpha.useNewmark = newmark
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = H
    system.SolveDynamic(settings, solverType=getattr(exudyn.DynamicSolverType, solver))
    found: NDArray[np.float64] = system.GetSensorStoredData(sensor)[:, 1]
    return found


@pytest.mark.parametrize(
    ("solver", "rho_inf", "newmark", "method"),
    [
        ("GeneralizedAlpha", 0.8, False, "generalized-alpha(0.8)"),
        ("GeneralizedAlpha", 0.5, False, "generalized-alpha(0.5)"),
        ("GeneralizedAlpha", 0.7, False, "generalized-alpha(0.7)"),
        ("GeneralizedAlpha", 1.0, True, "newmark(1/4,1/2)"),
        ("TrapezoidalIndex2", 1.0, False, "implicit-midpoint"),
    ],
)
@pytest.mark.parametrize("point", POINTS)
def test_an_implicit_integrator_has_the_pole_of_its_map(
    solver: str, rho_inf: float, newmark: bool, method: str, point: tuple[float, float]
) -> None:
    """It has no limit, so its pole is measured: to 1e-9, from some forty steps."""
    found, _ = fit_dominant_pole(positions(*point, solver, rho_inf, newmark, 40)[:, np.newaxis], order=3)
    assert found
    expected = complex(dominant_pole(lookup(method), *point))
    assert abs(found.pole - expected) < 1e-9
    assert abs(expected) < 1


@pytest.mark.parametrize(
    ("solver", "method"),
    [
        ("ExplicitEuler", "AB1"),
        ("ExplicitMidpoint", "RK2"),
        ("RK33", "RK3"),
        ("RK44", "RK4"),
        ("VelocityVerlet", "verlet-half"),
    ],
)
def test_an_explicit_integrator_settles_inside_its_limit_and_grows_outside(solver: str, method: str) -> None:
    """At 0.9 and 1.1 of the step at which |z_p| is one, along zeta = 1/2: alpha_hat = s, beta_hat = s^2."""
    end = stability_margins(lookup(method), 0.01, 0.0001).h * 0.01
    for times in (0.9, 1.1):
        point = (times * end, (times * end) ** 2)
        z_abs = float(spectral_radius(lookup(method), *point))
        assert (z_abs < 1) == (times < 1)
        found = positions(*point, solver, 1.0, False, 60)
        assert bool(np.abs(found[-3:]).max() < 1) == (times < 1)
        # The last two thirds are a recursion of two terms: z^2 - c_1 z - c_0
        before = np.stack([found[20:-2], found[21:-1]], axis=1) / np.abs(found[22:, np.newaxis])
        after = found[22:] / np.abs(found[22:])
        coefficients = np.linalg.lstsq(before, after, rcond=None)[0]
        measured = np.abs(np.roots([1.0, -coefficients[1], -coefficients[0]])).max()
        assert measured == pytest.approx(z_abs, rel=1e-7)
