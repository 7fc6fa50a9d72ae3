"""The joint that every program models, and the mesh that GetFEM and CalculiX share.

Half of the joint, in units of the hole's radius R2. The origin is the hole's centre, the load points along -y, angles run
from the load line. The plate reaches from radius 1 to `outer_ratio` and is held there. The pin's centre is at (0, -dR):
it touches the hole at angle 0, and its held part, the flat face of a half disc or the core of a disc, moves along -y.

A peer script reads a job as JSON, {"elements", "growth", "coarsest": see `mesh`, "penalty": CalculiX's contact
stiffness in Young's moduli per mm, "joints": [the fields of `Joint`]}, and answers with a line of JSON, {"unknowns": at
most, "forces": N by joint and step, "problems": [what is wrong with them], "work_seconds": without the start of the
script}.
"""

import json
import sys
import time
from math import acos, cos, pi, sin
from typing import NamedTuple

HOLE_RADIUS = 100.0  # mm
THICKNESS = 1.0  # mm
YOUNGS_MODULUS = 200e3  # MPa
POISSONS_RATIO = 0.3


class Joint(NamedTuple):
    outer_ratio: float
    core_ratio: float  # of the pin's radius; 0 is the half disc under a rigid plane
    clearance: float  # radial
    indentations: list

    def widest_angle(self):
        """Where rigid bodies would overlap at the last step; contact ends before it."""
        return acos(self.clearance / (self.clearance + max(self.indentations)))


class Body(NamedTuple):
    points: list  # (x, y)
    quads: list  # corners, then middles of sides, counter-clockwise; the first side faces the other body
    triangles: list
    contact_elements: range  # of `quads`, as far as contact may come
    contact_points: list
    held: list
    axis: list  # on the line of symmetry


def graded(start, end, first, growth, largest):
    """From `start` to `end` in steps that grow from `first` to at most `largest(position)`, stretched to fit."""
    positions, step, towards = [start], first, 1.0 if end > start else -1.0
    while towards * (end - positions[-1]) > 1e-9:
        positions.append(positions[-1] + towards * step)
        step = min(growth * step, largest(positions[-1]))
    if len(positions) > 2 and abs(positions[-2] - end) < abs(positions[-1] - end):
        positions.pop()
    stretch = (end - start) / (positions[-1] - start)
    return [start + stretch * (position - start) for position in positions]


def mesh(joint, job):
    """Pin and plate, with so many `elements` along the widest contact, a little finer at the load line.

    Layers beneath are as thick as elements are long. Away from the contact both grow, to `coarsest` times the radius.
    """
    elements, growth, coarsest = job["elements"], job["growth"], job["coarsest"]
    widest = joint.widest_angle()
    contact = [widest * (i / elements) ** 1.3 for i in range(elements)]
    half_disc = joint.core_ratio == 0.0
    pin_radius = 1.0 - joint.clearance

    def angles(end):
        return contact + graded(widest, end, widest - contact[-1], growth, lambda _: coarsest / 1.2)

    def radii(start, end):
        return graded(start, end, start * widest / elements, growth, lambda radius: coarsest * radius)

    pin_radii = radii(pin_radius, pin_radius * (joint.core_ratio or coarsest / 1.5)) + ([0.0] if half_disc else [])
    return (
        polar_mesh(angles(pi / 2 if half_disc else pi), pin_radii, -joint.clearance, elements, half_disc),
        polar_mesh(angles(pi), radii(1.0, joint.outer_ratio), 0.0, elements, False),
    )


def polar_mesh(angles, radii, centre, contact_count, last_ray_held):
    """Eight-node elements between rays and arcs; around the centre, where the last radius is 0, six-node triangles.

    The last arc is held, and the last ray if asked.
    """
    rays, arcs = 2 * (len(angles) - 1), 2 * (len(radii) - 1)  # counted in halves of elements, as i and j below
    numbers, points = {}, []

    def halfway(values, half):
        return 0.5 * (values[half // 2] + values[(half + 1) // 2])

    def number(i, j):
        angle, radius = halfway(angles, i), halfway(radii, j)
        i = 0 if radius == 0.0 else i
        if (i, j) not in numbers:
            numbers[i, j] = len(points)
            points.append((radius * sin(angle), centre - radius * cos(angle)))
        return numbers[i, j]

    quads, triangles = [], []
    for j in range(0, arcs, 2):
        for i in range(0, rays, 2):
            a, b = (i + 2, i) if radii[-1] > radii[0] else (i, i + 2)
            if radii[j // 2 + 1] == 0.0:
                places = [(a, j), (b, j), (b, j + 2), (i + 1, j), (b, j + 1), (a, j + 1)]
                triangles.append([number(*place) for place in places])
            else:
                corners = [(a, j), (b, j), (b, j + 2), (a, j + 2)]
                middles = [(i + 1, j), (b, j + 1), (i + 1, j + 2), (a, j + 1)]
                quads.append([number(*place) for place in corners + middles])
    return Body(
        points,
        quads,
        triangles,
        range(contact_count),
        [numbers[i, 0] for i in range(2 * contact_count + 1)],
        held=[n for (i, j), n in numbers.items() if j == arcs or (last_ray_held and i == rays)],
        axis=[n for (i, j), n in numbers.items() if i == 0 or (i == rays and not last_ray_held)],
    )


def answer(solve):
    """Reads the job, solves its joints one after the other and prints the results.

    `solve(joint, job)` gives the number of unknowns, the force of each step and a list of problems.
    """
    start = time.perf_counter()
    job = json.load(sys.stdin)
    solved = [solve(Joint(**joint), job) for joint in job["joints"]]
    unknowns, forces, problems = zip(*solved)
    result = {
        "unknowns": max(unknowns),
        "forces": forces,
        "problems": sum(problems, []),
        "work_seconds": time.perf_counter() - start,
    }
    print(json.dumps(result), flush=True)
