"""GetFEM: quadratic elements, nodal contact by an augmented Lagrangian, Newton's method; a model for each joint.

Not its integral contact brick, which loses the contact where the gap is wider than the box around an edge of the target;
and without units, as the solver's tolerances and the augmentation parameter expect.
"""

import getfem
import numpy

import scene

# The orders in which GetFEM counts the points of a square and of a triangle: row by row.
SQUARE = [0, 4, 1, 7, 5, 3, 6, 2]
TRIANGLE = [0, 3, 1, 5, 4, 2]
CONTACT, HELD, AXIS = 1, 2, 3
FORCE = scene.YOUNGS_MODULUS * scene.HOLE_RADIUS * scene.THICKNESS


def mesh_of(body):
    mesh = getfem.Mesh("empty", 2)
    points = numpy.array(body.points)
    for shape, order, elements in (
        ("GT_Q2_INCOMPLETE(2)", SQUARE, body.quads),
        ("GT_PK(2,2)", TRIANGLE, body.triangles),
    ):
        if elements:
            mesh.add_convex(getfem.GeoTrans(shape), points[numpy.array(elements)[:, order]].transpose(2, 1, 0))
    # GetFEM numbers the points itself.
    rounded = [tuple(point) for point in points.round(9)]
    identifiers = dict(zip(map(tuple, mesh.pts().T.round(9)), mesh.pid()))
    for region, chosen in ((CONTACT, body.contact_points), (HELD, body.held), (AXIS, body.axis)):
        mesh.set_region(region, mesh.faces_from_pid([identifiers[rounded[n]] for n in chosen]))
    return mesh


def solve(joint, job):
    model = getfem.Model("real")
    model.add_initialized_data("modulus", [1.0])
    model.add_initialized_data("poissons_ratio", [scene.POISSONS_RATIO])
    model.add_initialized_data("augmentation", [1.0])
    model.add_initialized_data("descent", [0.0, 0.0])
    model.add_initialized_data("nothing", [0.0, 0.0])
    model.add_initialized_data("across", [[1.0, 0.0], [0.0, 0.0]])
    bodies, integrations = {}, []
    for name, given, body in zip(("pin", "plate"), ("descent", "nothing"), scene.mesh(joint, job)):
        mesh = mesh_of(body)
        space = getfem.MeshFem(mesh, 2)
        space.set_classical_fem(2)
        integration = getfem.MeshIm(mesh, 5)
        model.add_fem_variable(name, space)
        elasticity = model.add_isotropic_linearized_elasticity_pstress_brick(
            integration, name, "modulus", "poissons_ratio"
        )
        # 1e8 times the modulus: as good as held, and no multipliers to clash with those of the held points.
        model.add_generalized_Dirichlet_condition_with_penalization(
            integration, name, 1e8, AXIS, "nothing", "across"
        )
        model.add_Dirichlet_condition_with_simplification(name, HELD, given)
        bodies[name] = (elasticity, space.basic_dof_on_region(HELD)[1::2])
        integrations.append(integration)
    model.add_nodal_contact_between_nonmatching_meshes_brick(
        *integrations, "pin", "plate", "pressure", "augmentation", CONTACT, CONTACT
    )

    def reaction(name):
        elasticity, held = bodies[name]
        return 2 * FORCE * model.matrix_term(elasticity, 0).mult(model.variable(name))[held].sum()

    forces, problems = [], []
    for indentation in joint.indentations:
        model.set_variable("descent", [0.0, -indentation])
        _, converged = model.solve("max_iter", 50, "max_res", 1e-10)
        forces.append(-reaction("pin"))
        multipliers = model.variable("pressure")  # compression is negative
        if not converged:
            problems.append(f"not converged at {indentation}")
        if multipliers.max() > 1e-9 * -multipliers.min():
            problems.append(f"tensile contact at {indentation}")
        if abs(reaction("plate") / forces[-1] - 1) > 1e-6:
            problems.append(f"no equilibrium at {indentation}")
    return model.nbdof(), forces, problems


getfem.util_trace_level(0)
scene.answer(solve)
