"""Exudyn with the exported module: forces at unseen indentations by the static solver, and a slider-crank with clearance.

The crank turns about the origin. The rod's crank end surrounds the crank's pin with clearance: that is the joint. The rod's
other end is the slider on the x axis, where the rod has its centre of mass; three degrees of freedom, no damping, no gravity.
"""

import math
import os
import sys
import time

sys.path.insert(0, os.getcwd())
import exudyn as exu
import exudyn.itemInterface as eii

import joint_exudyn as joint
from truth import rows

CLEARANCE = 1e-3 * joint.RADIAL_CLEARANCE_MM


def unseen_forces():
    """A pin at the end of the joint under a force: how deep is it pressed in?"""
    worst, count = 0.0, 0
    for x, force, _ in rows()[100::25]:
        system = exu.SystemContainer()
        mbs = system.AddSystem()
        ground = mbs.AddObject(eii.ObjectGround())
        start = CLEARANCE + 0.8e-3 * x
        node = mbs.AddNode(eii.NodePoint(referenceCoordinates=[start, 0, 0]))
        mbs.AddObject(eii.MassPoint(nodeNumber=node, mass=1.0))
        hole = mbs.AddMarker(eii.MarkerBodyPosition(bodyNumber=ground))
        pin = mbs.AddMarker(eii.MarkerNodePosition(nodeNumber=node))
        mbs.AddObject(
            eii.CartesianSpringDamper(
                markerNumbers=[hole, pin], stiffness=[1e3] * 3, damping=[0] * 3, springForceUserFunction=joint.UF
            )
        )
        fixed = mbs.AddMarker(eii.MarkerBodyPosition(bodyNumber=ground))
        for coordinate in (1, 2):
            own = mbs.AddMarker(eii.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
            zero = mbs.AddNode(eii.NodePointGround())
            other = mbs.AddMarker(eii.MarkerNodeCoordinate(nodeNumber=zero, coordinate=0))
            mbs.AddObject(eii.CoordinateConstraint(markerNumbers=[other, own]))
        mbs.AddLoad(eii.Force(markerNumber=pin, loadVector=[force, 0, 0]))
        mbs.Assemble()
        settings = exu.SimulationSettings()
        settings.staticSolver.newton.relativeTolerance = 1e-10
        settings.staticSolver.newton.maxIterations = 100
        settings.solution.file.write = False
        settings.staticSolver.verboseMode = 0
        mbs.SolveStatic(settings)
        place = start + mbs.GetNodeOutput(node, exu.OutputVariableType.Displacement)[0]
        worst = max(worst, abs(1e3 * (place - CLEARANCE) / x - 1.0))
        count += 1
    # 0.1 % of the force is at most as much of the indentation.
    print(f"indentations under {count} unseen forces: within {100 * worst:.3g} %")
    assert count > 10 and worst < 1e-3, worst


def energy_table():
    """Elastic energy, J, of an indentation in m: the integral of each segment's cubic."""
    xs, fs, ks = joint.INDENTATIONS, joint.FORCES[0], joint.STIFFNESSES[0]
    sums = [0.0]
    for i in range(len(xs) - 1):
        h = xs[i + 1] - xs[i]
        sums.append(sums[-1] + h * (fs[i] + fs[i + 1]) / 2 + h * h * (ks[i] - ks[i + 1]) / 12)

    def energy(x_m):
        x = 1e3 * x_m
        if x <= 0:
            return 0.0
        assert x <= xs[-1], "beyond the table"
        i = max(i for i in range(len(xs) - 1) if xs[i] <= x)
        h = xs[i + 1] - xs[i]
        s, m = (x - xs[i]) / h, (fs[i + 1] - fs[i]) / h
        a, b = 3 * m - 2 * ks[i] - ks[i + 1], ks[i] + ks[i + 1] - 2 * m
        return 1e-3 * (sums[i] + h * s * fs[i] + h * h * s * s * (ks[i] / 2 + s * (a / 3 + s * b / 4)))

    return energy


def slider_crank(turns=100, speed=100.0, step=2.5e-6):
    radius, length, slider_mass, rod_inertia, crank_inertia = 0.05, 0.2, 0.5, 2e-3, 0.05
    system = exu.SystemContainer()
    mbs = system.AddSystem()
    ground = mbs.AddNode(eii.NodePointGround())
    zero = mbs.AddMarker(eii.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
    # From a crank that stands upright; its pin touches the hole's wall.
    slider_x = math.sqrt((length + CLEARANCE) ** 2 - radius**2)
    rod_angle = math.atan2(radius, -slider_x)
    crank = mbs.AddNode(
        eii.NodeRigidBody2D(referenceCoordinates=[0, 0, math.pi / 2], initialVelocities=[0, 0, speed])
    )
    # The pin moves with -speed radius along x, and so does the rod.
    rod = mbs.AddNode(
        eii.NodeRigidBody2D(referenceCoordinates=[slider_x, 0, rod_angle], initialVelocities=[-speed * radius, 0, 0])
    )
    crank_body = mbs.AddObject(eii.RigidBody2D(nodeNumber=crank, mass=1.0, inertia=crank_inertia))
    rod_body = mbs.AddObject(eii.RigidBody2D(nodeNumber=rod, mass=slider_mass, inertia=rod_inertia))
    for node, coordinate in ((crank, 0), (crank, 1), (rod, 1)):
        own = mbs.AddMarker(eii.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
        mbs.AddObject(eii.CoordinateConstraint(markerNumbers=[zero, own]))
    pin = mbs.AddMarker(eii.MarkerBodyPosition(bodyNumber=crank_body, localPosition=[radius, 0, 0]))
    hole = mbs.AddMarker(eii.MarkerBodyPosition(bodyNumber=rod_body, localPosition=[length, 0, 0]))
    mbs.AddObject(
        eii.CartesianSpringDamper(
            markerNumbers=[hole, pin], stiffness=[1e3] * 3, damping=[0] * 3, springForceUserFunction=joint.UF
        )
    )
    mbs.Assemble()
    elastic = energy_table()
    start, worst, deepest, samples, contacts = None, 0.0, 0.0, 0, 0
    angles = []

    def look(mbs, t):
        nonlocal start, worst, deepest, samples, contacts
        (phi, omega), (x, v), (psi, rate) = state(mbs)
        pin_x, pin_y = radius * math.cos(phi), radius * math.sin(phi)
        hole_x, hole_y = x + length * math.cos(psi), length * math.sin(psi)
        depth = math.hypot(pin_x - hole_x, pin_y - hole_y) - CLEARANCE
        energy = 0.5 * (crank_inertia * omega**2 + slider_mass * v**2 + rod_inertia * rate**2) + elastic(depth)
        start = energy if start is None else start
        worst = max(worst, abs(energy / start - 1.0))
        deepest = max(deepest, depth)
        contacts += depth > 0
        samples += 1
        angles.append(phi)
        return True

    def state(mbs):
        q, v = mbs.systemData.GetODE2Coordinates(), mbs.systemData.GetODE2Coordinates_t()
        return (math.pi / 2 + q[2], v[2]), (slider_x + q[3], v[3]), (rod_angle + q[5], v[5])

    settings = exu.SimulationSettings()
    # Somewhat longer, because the crank gives speed to the slider.
    duration = 1.02 * turns * 2 * math.pi / speed
    settings.timeIntegration.endTime = duration
    settings.timeIntegration.numberOfSteps = math.ceil(duration / step)
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.explicit.computeEndOfStepAccelerations = False
    settings.solution.file.write = False
    look_every = 50

    calls = 0

    def every(mbs, t):
        nonlocal calls
        calls += 1
        return look(mbs, t) if calls % look_every == 1 else True

    mbs.SetPreStepUserFunction(every)
    began = time.time()
    mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.RK44)
    turned = (angles[-1] - math.pi / 2) / (2 * math.pi)
    print(
        f"{turned:.1f} turns, {samples} looks, in contact at {contacts}, pressed in up to {1e3 * deepest:.4f} mm: "
        f"energy within {worst:.3g}, {time.time() - began:.0f} s"
    )
    assert turned >= turns and 0 < contacts < samples and worst < 1e-4, (turned, contacts, samples, worst)


unseen_forces()
slider_crank(*(float(word) for word in sys.argv[1:]))
