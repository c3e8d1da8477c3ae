"""Exudyn: its integrators on c'' + 2 alpha c' + beta^2 c = 0, a mass on a spring and damper of its own elements."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from bezstab.methods.registry import lookup
from bezstab.stability.closed_loop import dominant_pole
from bezstab.stability.path_ends import stability_margins
from tests.witnesses.growths import largest_pole

exudyn: Any = pytest.importorskip("exudyn")

H = 0.01
MASS = 2.0


def positions(alpha_hat: float, beta_hat: float, solver: str, rho_inf: float, newmark: bool) -> NDArray[np.float64]:
    """Return the position of the mass after each step, from 1 at rest."""
    from exudyn import itemInterface as items  # noqa: N813

    system = exudyn.SystemContainer().AddSystem()
    ground = system.AddNode(items.NodePointGround(referenceCoordinates=[0, 0, 0]))
    node = system.AddNode(items.Node1D(referenceCoordinates=[0.0], initialCoordinates=[1.0], initialVelocities=[0.0]))
    system.AddObject(items.Mass1D(nodeNumber=node, mass=MASS))
    ends = [system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=one, coordinate=0)) for one in (ground, node)]
    spring = {"stiffness": MASS * beta_hat / H**2, "damping": MASS * alpha_hat / H}
    system.AddObject(items.CoordinateSpringDamper(markerNumbers=ends, **spring))
    shown = {"outputVariableType": exudyn.OutputVariableType.Coordinates, "storeInternal": True, "writeToFile": False}
    sensor = system.AddSensor(items.SensorNode(nodeNumber=node, **shown))
    system.Assemble()
    settings = exudyn.SimulationSettings()
    integration = settings.timeIntegration
    integration.numberOfSteps, integration.endTime = 40, 40 * H
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
        ("GeneralizedAlpha", 1.0, True, "newmark(1/4,1/2)"),
        ("TrapezoidalIndex2", 1.0, False, "implicit-midpoint"),
        ("ExplicitEuler", 1.0, False, "AB1"),
        ("ExplicitMidpoint", 1.0, False, "RK2"),
        ("RK33", 1.0, False, "RK3"),
        ("RK44", 1.0, False, "RK4"),
        ("VelocityVerlet", 1.0, False, "verlet-half"),
    ],
)
def test_an_integrator_has_the_pole_of_its_map(solver: str, rho_inf: float, newmark: bool, method: str) -> None:
    """To 1e-8: implicit ones, which have no limit, at three points; others at 0.9 and 1.1 of theirs, zeta = 1/2."""
    integrator = lookup(method)
    points = [(0.5, 0.3), (1.0, 4.0), (0.2, 10.0)]
    end = stability_margins(integrator, 0.01, 0.0001).h
    if np.isfinite(end):
        points = [(times * end * 0.01, (times * end * 0.01) ** 2) for times in (0.9, 1.1)]
    for point in points:
        expected = complex(dominant_pole(integrator, *point))
        found = largest_pole(positions(*point, solver, rho_inf, newmark), 3 if rho_inf < 1 else 2)
        assert abs(found - expected) < 1e-8 * abs(expected)
    assert (abs(expected) > 1) is bool(np.isfinite(end))
