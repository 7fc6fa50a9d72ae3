"""GetFEM: quadratic elements, nodal contact by an augmented Lagrangian, Newton's method; a model for each joint.

Not its integral contact brick, which loses the contact where the gap is wider than the box around an edge of the target;
and without units, as the solver's tolerances and the augmentation parameter expect. Nodes of the pin meet the hole along
its normal; in press fits, where the outlines overlap, nodes of the same angle meet.
"""

import getfem
import numpy

import scene

# The orders in which GetFEM counts the points of a square and of a triangle: row by row.
SQUARE = [0, 4, 1, 7, 5, 3, 6, 2]
TRIANGLE = [0, 3, 1, 5, 4, 2]
CONTACT, HELD, AXIS, MATERIAL = 1, 2, 3, 4  # and on, one for each material


def mesh_of(body):
    """The mesh, and GetFEM's numbers of the body's points: it numbers them itself."""
    mesh = getfem.Mesh("empty", 2)
    points = numpy.array(body.points)
    elements = []
    for shape, order, corners in (
        ("GT_Q2_INCOMPLETE(2)", SQUARE, body.quads),
        ("GT_PK(2,2)", TRIANGLE, body.triangles),
    ):
        if corners:
            added = mesh.add_convex(getfem.GeoTrans(shape), points[numpy.array(corners)[:, order]].transpose(2, 1, 0))
            elements.extend(added)
    for material in set(body.layers):
        own = [[element for element, layer in zip(elements, body.layers, strict=True) if layer == material]]
        mesh.set_region(MATERIAL + material, own)
    identifiers = dict(zip(map(tuple, mesh.pts().T.round(9)), mesh.pid()))
    numbers = [identifiers[tuple(point)] for point in points.round(9)]
    for region, chosen in ((CONTACT, body.contact_points), (HELD, body.held), (AXIS, body.axis)):
        mesh.set_region(region, mesh.faces_from_pid([numbers[n] for n in chosen]))
    return mesh


def radial_rows(space, body):
    """A row for each contact point, that takes its displacement along the hole's normal."""
    place = {}
    for dof in space.basic_dof_on_region(CONTACT):
        place.setdefault(tuple(space.basic_dof_nodes(dof)[:, 0].round(9)), []).append(int(dof))
    rows = getfem.Spmat("empty", len(body.contact_points), space.nbdof())
    for row, point in enumerate(body.contact_points):
        position = numpy.array(body.points[point])
        across, along = sorted(place[tuple(position.round(9))])
        normal = position / numpy.hypot(*position)
        rows.add([row], [across], [[normal[0]]])
        rows.add([row], [along], [[normal[1]]])
    return rows


def solve(joint, job):
    unit = joint.softest_contact()
    model = getfem.Model("real")
    model.add_initialized_data("augmentation", [1.0])
    model.add_initialized_data("descent", [0.0, 0.0])
    model.add_initialized_data("nothing", [0.0, 0.0])
    model.add_initialized_data("across", [[1.0, 0.0], [0.0, 0.0]])
    bodies, integrations, pairs = {}, [], []
    for name, given, materials, body in zip(
        ("pin", "plate"), ("descent", "nothing"), (joint.pin, joint.plate), scene.mesh(joint, job)
    ):
        mesh = mesh_of(body)
        space = getfem.MeshFem(mesh, 2)
        space.set_classical_fem(2)
        integration = getfem.MeshIm(mesh, 5)
        model.add_fem_variable(name, space)
        add_elasticity = {
            "stress": model.add_isotropic_linearized_elasticity_pstress_brick,
            "strain": model.add_isotropic_linearized_elasticity_pstrain_brick,
        }[joint.plane]
        elastic = []
        for layer, (_, modulus, poissons_ratio) in enumerate(materials):
            model.add_initialized_data(f"{name}_modulus{layer}", [modulus / unit])
            model.add_initialized_data(f"{name}_poissons_ratio{layer}", [poissons_ratio])
            constants = f"{name}_modulus{layer}", f"{name}_poissons_ratio{layer}"
            elastic.append(add_elasticity(integration, name, *constants, MATERIAL + layer))
        # 1e8 times the contact's modulus: as good as held, and no multipliers to clash with those of the held points.
        model.add_generalized_Dirichlet_condition_with_penalization(
            integration, name, 1e8, AXIS, "nothing", "across"
        )
        model.add_Dirichlet_condition_with_simplification(name, HELD, given)
        bodies[name] = (elastic, space.basic_dof_on_region(HELD)[1::2])
        integrations.append(integration)
        pairs.append((space, body))
    if joint.is_press_fit():
        pin_rows, plate_rows = (radial_rows(space, body) for space, body in pairs)
        plate_rows.scale(-1.0)
        model.add_variable("pressure", pin_rows.size()[0])
        model.add_initialized_data("gap", [joint.clearance] * pin_rows.size()[0])
        model.add_basic_contact_brick_two_deformable_bodies(
            "pin", "plate", "pressure", "augmentation", pin_rows, plate_rows, "gap"
        )
    else:
        model.add_nodal_contact_between_nonmatching_meshes_brick(
            *integrations, "pin", "plate", "pressure", "augmentation", CONTACT, CONTACT
        )

    def reaction(name):
        elastic, held = bodies[name]
        force = 2 * unit * scene.HOLE_RADIUS * scene.THICKNESS
        return force * sum(model.matrix_term(brick, 0).mult(model.variable(name))[held].sum() for brick in elastic)

    forces, problems = [], []
    for descent in joint.descents:
        model.set_variable("descent", [0.0, -descent])
        _, converged = model.solve("max_iter", 50, "max_res", 1e-9)
        forces.append(-reaction("pin"))
        multipliers = model.variable("pressure")  # compression is negative
        if not converged:
            problems.append(f"not converged at {descent}")
        if multipliers.max() > 1e-9 * -multipliers.min():
            problems.append(f"tensile contact at {descent}")
        if abs(reaction("plate") / forces[-1] - 1) > 1e-6:
            problems.append(f"no equilibrium at {descent}")
    return model.nbdof(), forces, problems


getfem.util_trace_level(0)
scene.answer(solve)
