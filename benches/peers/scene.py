"""The joint that every program models, and the mesh that GetFEM and CalculiX share.

Half of the joint, in units of the hole's radius R2. The origin is the hole's centre, the load points along -y, angles run
from the load line. The plate reaches from radius 1 to `outer_ratio` and is held there, or it is a block that is held at its
base. The pin's held part, the flat face of a half disc or the core of a disc, moves along -y: with clearance from where the
pin touches the hole at angle 0, its centre at (0, -dR); of press fits from where pin and hole are concentric.

A peer script reads a job as JSON, {"elements", "growth", "coarsest": see `mesh`, "penalty": CalculiX's contact
stiffness in Young's moduli, of the softer material at the contact, per mm, "settled": see calculix_joint.py, "joints": [the
fields of `Joint`]}, and answers with a line of JSON, {"unknowns": at most, "forces": N by joint and step, "problems": [what is
wrong with them], "work_seconds": without the start of the script}.
"""

import json
import sys
import time
from math import acos, atan2, cos, inf, log, pi, sin
from typing import NamedTuple

HOLE_RADIUS = 100.0  # mm
THICKNESS = 1.0  # mm
YOUNGS_MODULUS = 200e3  # MPa
POISSONS_RATIO = 0.3
STEEL = (None, YOUNGS_MODULUS, POISSONS_RATIO)
# Rows of elements in a layer at least, as a share of the elements along the contact.
ROWS_SHARE = 0.1
# A stiff sleeve on a soft layer bends around the pin: contact beyond where rigid bodies would overlap.
BENDING = 1.15


class Joint(NamedTuple):
    outer_ratio: float  # of an annulus
    core_ratio: float  # of the pin's radius; 0 is the half disc under a rigid plane
    clearance: float  # radial; of press fits below zero
    descents: list  # of the held part of the pin
    # From the contact inwards: thickness (in hole radii; None: what is left), Young's modulus in MPa, Poisson's ratio.
    pin: list = [STEEL]
    plate: list = [STEEL]
    plane: str = "stress"
    block: list = None  # instead of an annulus: half width, depth below the hole's centre, height above it

    def is_press_fit(self):
        return self.clearance < 0.0

    def widest_angle(self):
        """Contact ends before it: where rigid bodies would overlap at the last step, wider if there are layers."""
        if self.is_press_fit():
            return pi
        overlap = acos(self.clearance / (self.clearance + max(self.descents)))
        return overlap * (BENDING if len(self.pin) + len(self.plate) > 2 else 1.0)

    def softest_contact(self):
        """The lower Young's modulus of the two materials that touch."""
        return min(self.pin[0][1], self.plate[0][1])


class Body(NamedTuple):
    points: list  # (x, y)
    quads: list  # corners, then middles of sides, counter-clockwise; the first side faces the other body
    triangles: list
    layers: list  # of each quad, then of each triangle: which material it is of
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


def from_both_ends(start, end, first, last, growth, largest):
    """As `graded`, with steps that grow from both ends to the middle."""
    middle = 0.5 * (start + end)
    return graded(start, middle, first, growth, largest) + graded(end, middle, last, growth, largest)[-2::-1]


def corner_angles(block):
    """Where rays meet the corners: at the base and at the top."""
    half_width, depth, height = block
    return [atan2(half_width, depth), pi - atan2(half_width, height)]


def to_edge(block, angle):
    """The distance from the hole's centre to the block's edge."""
    half_width, depth, height = block
    along = depth / cos(angle) if cos(angle) > 1e-12 else -height / cos(angle) if cos(angle) < -1e-12 else inf
    return min(along, half_width / sin(angle) if sin(angle) > 1e-12 else inf)


def mesh(joint, job):
    """Pin and plate, with so many `elements` along the widest contact, a little finer at the load line; in press fits evenly.

    Layers of elements beneath are as thick as elements are long, and thinner where a layer of material needs it. Away from
    the contact both grow, to `coarsest` times the radius. Where the base of a block ends they are as small as at the contact.
    """
    elements, growth, coarsest = job["elements"], job["growth"], job["coarsest"]
    widest = joint.widest_angle()
    contact = [widest * (i / elements) ** (1.0 if joint.is_press_fit() else 1.3) for i in range(elements)]
    half_disc = joint.core_ratio == 0.0
    pin_radius = 1.0 - joint.clearance
    length = widest / elements

    def largest_angle(_):
        return coarsest / 1.2

    def angles(end, block):
        if joint.is_press_fit():
            return [*contact, end]
        if not block:
            return contact + graded(widest, end, widest - contact[-1], growth, largest_angle)
        base, top = corner_angles(block)
        if widest > base - length:
            raise ValueError("contact may reach the ray to the corner of the base")
        below = from_both_ends(widest, base, widest - contact[-1], length, growth, largest_angle)
        beside = graded(base, top, length, growth, largest_angle)
        return contact + below + beside[1:] + graded(top, end, coarsest / 1.2, growth, largest_angle)[1:]

    def radii(ring, end, materials, block):
        """Of the arcs, from the contact inwards, and how many rows of elements each material has."""
        positions, rows, towards = [ring], [], 1.0 if end > ring else -1.0
        step = ring * length
        for thickness, *_ in materials:
            start = positions[-1]
            if thickness:
                stop = start + towards * thickness
                step = min(step, thickness / (ROWS_SHARE * elements))
            else:
                stop = end
            if block and not thickness:
                more = from_both_ends(start, stop, step, length, growth, lambda radius: coarsest * radius)
            else:
                more = graded(start, stop, step, growth, lambda radius: coarsest * radius)
            positions += more[1:]
            rows.append(len(more) - 1)
            step = growth * abs(more[-1] - more[-2])
        return positions, rows

    pin_radii, pin_rows = radii(pin_radius, pin_radius * (joint.core_ratio or coarsest / 1.5), joint.pin, None)
    if half_disc:
        pin_radii.append(0.0)
        pin_rows[-1] += 1
    centre = min(0.0, -joint.clearance)
    far = min(joint.block) if joint.block else joint.outer_ratio
    plate_radii, plate_rows = radii(1.0, far, joint.plate, joint.block)
    pin_angles = angles(pi / 2 if half_disc else pi, None)
    return (
        polar_mesh(pin_angles, pin_radii, pin_rows, centre, elements, half_disc, None),
        polar_mesh(angles(pi, joint.block), plate_radii, plate_rows, 0.0, elements, False, joint.block),
    )


def polar_mesh(angles, radii, rows, centre, contact_count, last_ray_held, block):
    """Eight-node elements between rays and arcs; around the centre, where the last radius is 0, six-node triangles.

    The last arc is held, and the last ray if asked. In a `block` the arcs of the last material turn by and by into its edges,
    of which the base is held.
    """
    rays, arcs = 2 * (len(angles) - 1), 2 * (len(radii) - 1)  # counted in halves of elements, as i and j below
    numbers, points = {}, []
    last_interface = radii[sum(rows[:-1])]

    def halfway(values, half):
        return 0.5 * (values[half // 2] + values[(half + 1) // 2])

    def number(i, j):
        angle, radius = halfway(angles, i), halfway(radii, j)
        i = 0 if radius == 0.0 else i
        if block and radius > last_interface:
            share = log(radius / last_interface) / log(radii[-1] / last_interface)
            radius = last_interface * (to_edge(block, angle) / last_interface) ** share
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
    base = corner_angles(block)[0] + 1e-9 if block else pi
    return Body(
        points,
        quads,
        triangles,
        [layer for layer, count in enumerate(rows) for _ in range(count * rays // 2)],
        range(contact_count),
        [numbers[i, 0] for i in range(2 * contact_count + 1)],
        held=[
            n
            for (i, j), n in numbers.items()
            if (j == arcs and halfway(angles, i) <= base) or (last_ray_held and i == rays)
        ],
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
