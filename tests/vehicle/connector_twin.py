"""A twin of the coach from Exudyn's own rigid bodies, markers and connectors, to hold the compiled forces against.

It is built from the parameters alone. Where the compiled suspension differs from a plain connector, the twin follows it
with means of its own: a connector pulls each body at its own marker, the compiled one both at the lower point, so that
the moment of the distance goes to the upper body; and its deflection is that of the lower point in the turning axes of
the upper body. Wheels stand on springs to the ground instead of rails.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from vehicle import CoachParameters
from vehicle.characteristics import Characteristic
from vehicle.exudyn_system import load_exudyn
from vehicle.parameters import Stage

exu = load_exudyn()  # the build that the coach runs with: the other one's results differ in the last bit
MarkerBodyRigid = exu.itemInterface.MarkerBodyRigid
NodeRigidBodyRotVecLG = exu.itemInterface.NodeRigidBodyRotVecLG
ObjectConnectorCartesianSpringDamper = exu.itemInterface.ObjectConnectorCartesianSpringDamper
ObjectConnectorRigidBodySpringDamper = exu.itemInterface.ObjectConnectorRigidBodySpringDamper
ObjectGround = exu.itemInterface.ObjectGround
ObjectRigidBody = exu.itemInterface.ObjectRigidBody

GRAVITY = np.array([0.0, 0.0, -9.81])
Curve = Callable[[np.ndarray], np.ndarray]


@dataclass
class Link:
    """A spring with dampers between two points that coincide at rest; axes of the upper body."""

    upper: int
    lower: int
    point: np.ndarray
    stiffness: np.ndarray = field(default_factory=lambda: np.zeros(3))
    damping: np.ndarray = field(default_factory=lambda: np.zeros(3))
    twist: np.ndarray = field(default_factory=lambda: np.zeros(3))
    twist_damping: np.ndarray = field(default_factory=lambda: np.zeros(3))
    preload_n: float = 0.0
    over_speed: list[tuple[int, Characteristic]] = field(default_factory=list)
    over_deflection: list[tuple[int, Characteristic]] = field(default_factory=list)

    def force(self, deflection: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """On the upper body, towards the lower point."""
        total = self.stiffness * deflection + self.damping * rate
        for curves, x in ((self.over_speed, rate), (self.over_deflection, deflection)):
            for axis, curve in curves:
                total[axis] += on_curve(curve, float(x[axis]))
        total[2] += self.preload_n
        return total


def on_curve(curve: Characteristic, x: float) -> float:
    """Through its points, its first and last slope going on; one that starts at 0 is odd."""
    at, force = np.array(curve.over), np.array(curve.force_n)
    if at[0] == 0.0:
        at, force = np.concatenate([-at[:0:-1], at]), np.concatenate([-force[:0:-1], force])
    above = max(x - at[-1], 0.0) * (force[-1] - force[-2]) / (at[-1] - at[-2])
    below = min(x - at[0], 0.0) * (force[1] - force[0]) / (at[1] - at[0])
    return float(np.interp(x, at, force) + above + below)


def places(p: CoachParameters) -> np.ndarray:
    """Centres of body, bogies and wheelsets, (7, 3), from the rails below the body's middle."""
    half, axle = 0.5 * p.bogie_distance_m, 0.5 * p.wheelbase_m
    radius = 0.5 * p.wheelset.wheel_diameter_m
    along = [half + axle, half - axle, -half + axle, -half - axle]
    return np.array(
        [(0.0, 0.0, p.laden_body.height_m), (half, 0.0, p.bogie.height_m), (-half, 0.0, p.bogie.height_m)]
        + [(x, 0.0, radius) for x in along]
    )


def links(p: CoachParameters) -> list[Link]:
    """All elements of the suspension."""
    found = []
    weight = 9.81 * (p.laden_body.mass_kg + 2.0 * p.bogie.mass_kg) / 8.0

    def spring(upper: int, lower: int, x: float, side: int, stage: Stage, preload_n: float) -> Link:
        linear = p.primary_at_axle if stage is p.primary else map(
            np.array,
            (stage.stiffness_npm, stage.damping_nspm, stage.rotational_stiffness_nmprad,
             stage.rotational_damping_nmsprad),
        )  # fmt: skip
        over_speed, over_deflection = (
            [(axis, p.characteristics[name]) for axis in range(3) for name in stage.named(axis, *kinds)]
            for kinds in (("damper", "friction"), ("spring", "stop"))
        )
        return Link(
            upper, lower, np.array([x, side * stage.half_spacing_m, stage.height_m]), *linear, preload_n, over_speed,
            over_deflection,
        )  # fmt: skip

    for wheelset, (x, _, _) in enumerate(places(p)[3:]):
        found += [spring(1 + wheelset // 2, 3 + wheelset, x, side, p.primary, weight) for side in (1, -1)]
    for bogie, x in ((1, 0.5 * p.bogie_distance_m), (2, -0.5 * p.bogie_distance_m)):
        for side in (1, -1):
            found.append(spring(0, bogie, x, side, p.secondary, 9.81 * p.laden_body.mass_kg / 4.0))
            if yaw := p.yaw_dampers:
                curve = [(0, p.characteristics[yaw.damper])]
                found.append(Link(0, bogie, np.array([x, side * yaw.half_spacing_m, yaw.height_m]), over_speed=curve))
        if rod := p.traction_rod:
            found.append(
                Link(
                    0, bogie, np.array([x, 0.0, rod.height_m]), np.array([rod.stiffness_npm, 0.0, 0.0]),
                    np.array([rod.damping_nspm, 0.0, 0.0]),
                    over_speed=[(0, p.characteristics[name]) for name in (rod.damper,) if name],
                    over_deflection=[(0, p.characteristics[name]) for name in (rod.spring,) if name],
                )
            )  # fmt: skip
        if stop := p.lateral_stop:
            curve = [(1, p.characteristics[stop.stop])]
            found.append(Link(0, bogie, np.array([x, 0.0, stop.height_m]), over_deflection=curve))
        bar = np.array([p.anti_roll_bar_nmprad, 0.0, 0.0])
        found.append(Link(0, bogie, np.array([x, 0.0, p.secondary.height_m]), twist=bar))
    return found


class Twin:
    """Exudyn system of the coach; coordinates (42,): place and rotation vector of each body, velocities (42,): of its
    centre in the world and angular in its own axes."""

    def __init__(self, p: CoachParameters, support_npm: float = 0.0, support_nspm: float = 0.0) -> None:
        self.container = exu.SystemContainer()
        self.mbs = mbs = self.container.AddSystem()
        self.centres = places(p)
        self.supports_n = p.static_wheel_load_n
        inertias = [p.laden_body, p.bogie, p.bogie]
        boxed = p.wheelset
        rows = [(b.mass_kg, b.roll_inertia_kgm2, b.pitch_inertia_kgm2, b.yaw_inertia_kgm2) for b in inertias]
        pitch = 2.0 * p.axle_box.pitch_inertia_kgm2  # the boxes do not spin
        rows += [(boxed.mass_kg, boxed.roll_inertia_kgm2, pitch, boxed.yaw_inertia_kgm2)] * 4
        self.nodes, self.bodies = [], []
        for (mass, *inertia), centre in zip(rows, self.centres, strict=True):
            node = mbs.AddNode(NodeRigidBodyRotVecLG(referenceCoordinates=[*centre, 0.0, 0.0, 0.0]))
            self.nodes.append(node)
            body = ObjectRigidBody(mass=mass, inertia=[*inertia, 0.0, 0.0, 0.0], nodeNumber=node)
            self.bodies.append(mbs.AddObject(body))
            marker = mbs.AddMarker(MarkerBodyRigid(bodyNumber=self.bodies[-1]))
            mbs.AddLoad(exu.itemInterface.LoadForceVector(markerNumber=marker, loadVector=mass * GRAVITY))
        self.ground = mbs.AddObject(ObjectGround())
        self.origin = mbs.AddMarker(MarkerBodyRigid(bodyNumber=self.ground))
        for link in links(p):
            self._add(link)
        if support_npm > 0.0:
            self._stand(support_npm, support_nspm)
        mbs.Assemble()

    def _add(self, link: Link) -> None:
        mbs = self.mbs
        ends = [
            mbs.AddMarker(
                MarkerBodyRigid(bodyNumber=self.bodies[body], localPosition=list(link.point - self.centres[body]))
            )
            for body in (link.upper, link.lower)
        ]
        node = self.nodes[link.upper]
        twists = bool(link.twist.any() or link.twist_damping.any())
        moment = np.zeros(3)  # of the distance between the two markers, which the upper body takes

        def pull(
            _mbs: Any, _t: float, _item: int, displacement: Any, rotation: Any, velocity: Any, turning: Any, *_: Any
        ) -> list[float]:
            deflection = np.array(displacement)
            own = np.array(mbs.GetNodeOutput(node, exu.OutputVariableType.AngularVelocityLocal))
            force = link.force(deflection, np.array(velocity) - np.cross(own, deflection))
            torque = np.zeros(3)
            if twists:
                relative = Rotation.from_euler("XYZ", np.array(rotation)).as_matrix()
                skew = 0.5 * (relative - relative.T)
                angle = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
                torque = link.twist * angle + link.twist_damping * np.array(turning)
            axes = np.array(mbs.GetNodeOutput(node, exu.OutputVariableType.RotationMatrix)).reshape(3, 3)
            moment[:] = axes @ np.cross(deflection, force)
            return [*force, *torque]

        def turn_upper(*_: Any) -> list[float]:
            return [0.0, 0.0, 0.0, *-moment]

        mbs.AddObject(ObjectConnectorRigidBodySpringDamper(markerNumbers=ends, springForceTorqueUserFunction=pull))
        if link.preload_n or link.stiffness.any() or link.over_speed or link.over_deflection:
            # from the ground: what it puts on the ground with one sign it puts on the body with the other
            mbs.AddObject(
                ObjectConnectorRigidBodySpringDamper(
                    markerNumbers=[self.origin, ends[0]], springForceTorqueUserFunction=turn_upper
                )
            )

    def _stand(self, stiffness_npm: float, damping_nspm: float) -> None:
        """Springs between ground and axle ends at both sides, alike in all directions, that bear the static load."""
        for wheelset in range(3, 7):
            for side in (0.75, -0.75):
                at = self.centres[wheelset] + np.array([0.0, side, 0.0])
                foot = MarkerBodyRigid(bodyNumber=self.ground, localPosition=list(at))
                wheel = MarkerBodyRigid(bodyNumber=self.bodies[wheelset], localPosition=[0.0, side, 0.0])
                below, above = self.mbs.AddMarker(foot), self.mbs.AddMarker(wheel)
                self.mbs.AddObject(
                    ObjectConnectorCartesianSpringDamper(
                        markerNumbers=[below, above],
                        stiffness=[stiffness_npm] * 3,
                        damping=[damping_nspm] * 3,
                        # stretched at rest by what the wheel bears
                        offset=[0.0, 0.0, self.supports_n / stiffness_npm],
                    )
                )

    def forces(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Right-hand side (42,) of M q'' = f: forces in the world and moments in body axes."""
        self._begin_at(q, v)
        solver = exu.MainSolverExplicit()
        settings = exu.SimulationSettings()
        settings.solution.file.write = False
        settings.timeIntegration.solverType = exu.DynamicSolverType.RK44
        solver.InitializeSolver(self.mbs, settings)
        solver.ComputeODE2RHS(self.mbs)
        return np.array(solver.GetSystemResidual())[: len(q)]

    def run(self, q: np.ndarray, v: np.ndarray, step_s: float, duration_s: float) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates and velocities after a swing of `duration_s`, by Runge and Kutta's fourth order."""
        self._begin_at(q, v)
        settings = exu.SimulationSettings()
        settings.timeIntegration.numberOfSteps = round(duration_s / step_s)
        settings.timeIntegration.endTime = duration_s
        settings.timeIntegration.verboseMode = 0
        settings.solution.file.write = False
        settings.solution.sensors.active = False
        exu.config.printToConsole = False
        self.mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.RK44)
        data = self.mbs.systemData
        return np.array(data.GetODE2Coordinates()), np.array(data.GetODE2Coordinates_t())

    def _begin_at(self, q: np.ndarray, v: np.ndarray) -> None:
        self.mbs.systemData.SetODE2Coordinates(q, exu.ConfigurationType.Initial)
        self.mbs.systemData.SetODE2Coordinates_t(v, exu.ConfigurationType.Initial)
