//! Manufactured solutions: the error falls at the order the elements promise.
//!
//! The body force is that of a chosen smooth displacement, which the boundary is given. After kinnala/scikit-fem,
//! tests/test_convergence.py: the order of convergence is the assertion.

use std::f64::consts::FRAC_PI_2;

use crate::common::meshes::{ELEMENTS, PlaneMesh, order};
use jointsweep::internals::mechanics::element::ElementKind;
use jointsweep::internals::mechanics::element::quadrature::gauss_legendre;
use jointsweep::internals::mechanics::element::stiffness::Elasticity;
use jointsweep::internals::mechanics::material::Idealization;

/// One component of a displacement: amplitude sin(a x + p) sin(b y + q).
#[derive(Clone, Copy)]
struct Wave {
    amplitude: f64,
    a: f64,
    p: f64,
    b: f64,
    q: f64,
}

impl Wave {
    /// The derivative of orders `by_x`, `by_y`: each turns the sine by a quarter.
    fn derivative(&self, by_x: i32, by_y: i32, [x, y]: [f64; 2]) -> f64 {
        self.amplitude
            * self.a.powi(by_x)
            * self.b.powi(by_y)
            * (self.a * x + self.p + FRAC_PI_2 * f64::from(by_x)).sin()
            * (self.b * y + self.q + FRAC_PI_2 * f64::from(by_y)).sin()
    }
}

/// A displacement of the plane.
type Field = [Wave; 2];

const GENERAL: Field = [
    Wave { amplitude: 1.0, a: 2.0, p: 0.3, b: 1.5, q: 0.1 },
    Wave { amplitude: 0.8, a: 1.7, p: 1.8, b: 2.2, q: 0.4 },
];

/// u = (d/dy, -d/dx) of sin(2 x + 0.3) sin(1.5 y + 0.1): no volume changes.
const ISOCHORIC: Field = [
    Wave { amplitude: 1.5, a: 2.0, p: 0.3, b: 1.5, q: 0.1 + FRAC_PI_2 },
    Wave { amplitude: -2.0, a: 2.0, p: 0.3 + FRAC_PI_2, b: 1.5, q: 0.1 },
];

/// b = -div sigma, with sigma of the displacement.
fn body_force([u, v]: &Field, elasticity: &Elasticity<f64>, at: [f64; 2]) -> [f64; 2] {
    let Elasticity { direct, cross, shear } = *elasticity;
    let mixed = cross + shear;
    [
        -(direct * u.derivative(2, 0, at) + shear * u.derivative(0, 2, at) + mixed * v.derivative(1, 1, at)),
        -(direct * v.derivative(0, 2, at) + shear * v.derivative(2, 0, at) + mixed * u.derivative(1, 1, at)),
    ]
}

struct Errors {
    /// L2 norm of u - u_h over that of u.
    displacement: f64,
    /// L2 norm of grad (u - u_h) over that of grad u: the H1 seminorm, which the energy norm is equivalent to.
    gradient: f64,
}

/// Solves on `cells` x `cells` elements of a square that is smoothly bent, its boundary moved by the field.
fn solve(field: &Field, element: ElementKind, elasticity: &Elasticity<f64>, cells: usize) -> Errors {
    let mesh = PlaneMesh::new(element, (cells, cells), |x, y| {
        [x + 0.12 * (3.0 * y).sin() * (0.5 + x), y + 0.1 * (2.5 * x + y).sin()]
    });
    // Five points: exact for the load to degree 9, far beyond the error of the elements.
    let rule = gauss_legendre(5);
    let place = |nodes: &[u32], shape: &[f64]| {
        let mut place = [0.0; 2];
        for (&node, shape) in nodes.iter().zip(shape) {
            place.iter_mut().zip(mesh.coordinates[node as usize]).for_each(|(sum, x)| *sum += shape * x);
        }
        place
    };
    let mut load = vec![0.0; 2 * mesh.node_count()];
    mesh.integrate(&rule, |nodes, shape, _, weight| {
        let force = body_force(field, elasticity, place(nodes, shape));
        for (&node, shape) in nodes.iter().zip(shape) {
            for component in 0..2 {
                load[2 * node as usize + component] += weight * shape * force[component];
            }
        }
    });
    let supported = |dof: usize| mesh.on_boundary(dof / 2);
    let prescribed: Vec<f64> = (0..load.len())
        .map(|dof| match supported(dof) {
            true => field[dof % 2].derivative(0, 0, mesh.coordinates[dof / 2]),
            false => 0.0,
        })
        .collect();
    let (displacement, _) = mesh.solve(elasticity, supported, &prescribed, &load);
    // [value, by x, by y] of squared error and squared field.
    let (mut errors, mut sizes) = ([0.0; 3], [0.0; 3]);
    mesh.integrate(&rule, |nodes, shape, gradients, weight| {
        let at = place(nodes, shape);
        for (component, wave) in field.iter().enumerate() {
            let mut found = [0.0; 3];
            for (i, &node) in nodes.iter().enumerate() {
                let u = displacement[2 * node as usize + component];
                let [by_x, by_y] = gradients[i];
                found.iter_mut().zip([shape[i], by_x, by_y]).for_each(|(sum, factor)| *sum += factor * u);
            }
            for (i, (by_x, by_y)) in [(0, 0), (1, 0), (0, 1)].into_iter().enumerate() {
                let exact = wave.derivative(by_x, by_y, at);
                errors[i] += weight * (found[i] - exact) * (found[i] - exact);
                sizes[i] += weight * exact * exact;
            }
        }
    });
    Errors {
        displacement: (errors[0] / sizes[0]).sqrt(),
        gradient: ((errors[1] + errors[2]) / (sizes[1] + sizes[2])).sqrt(),
    }
}

/// Goal: gradients converge as h (Q4), h^2 (Q8), displacements one order faster.
/// Mesh: 16 and 32 elements a side of a bent square; supports: the whole boundary; nu = 0.3.
#[test]
fn errors_fall_at_the_order_of_the_element() {
    for (element, gradient_order) in [(ElementKind::Quad4, 1.0), (ElementKind::Quad8, 2.0)] {
        for idealization in Idealization::ALL {
            let elasticity = Elasticity::new(idealization, 0.3);
            let [coarse, fine] = [16, 32].map(|cells| solve(&GENERAL, element, &elasticity, cells));
            let by_gradient = order(coarse.gradient, fine.gradient);
            let by_displacement = order(coarse.displacement, fine.displacement);
            println!(
                "{element:?} {idealization:?}: gradient {:.2e} order {by_gradient:.3}, displacement \
                 {:.2e} order {by_displacement:.3}",
                fine.gradient, fine.displacement
            );
            // Measured within 0.001; 0.1 tells the orders apart and allows for other compilers' rounding.
            assert!((by_gradient - gradient_order).abs() < 0.1);
            assert!((by_displacement - gradient_order - 1.0).abs() < 0.1);
        }
    }
}

/// Goal: no volumetric locking: at nu = 0.499 in plane strain a motion that keeps its volume is found as well as at
/// nu = 0.3. A locking element would lose a factor of about 1/(1 - 2 nu) = 500.
#[test]
fn a_nearly_incompressible_body_does_not_lock() {
    for element in ELEMENTS {
        let [soft, stiff] = [0.3, 0.499].map(|poissons_ratio| {
            solve(&ISOCHORIC, element, &Elasticity::new(Idealization::PlaneStrain, poissons_ratio), 16)
        });
        println!(
            "{element:?}: nu 0.3 gradient {:.2e} displacement {:.2e}, \
             nu 0.499 gradient {:.2e} displacement {:.2e}",
            soft.gradient, soft.displacement, stiff.gradient, stiff.displacement
        );
        // Measured: equal within 0.2 % and 2.2 %.
        assert!((stiff.gradient / soft.gradient - 1.0).abs() < 0.003);
        assert!((stiff.displacement / soft.displacement - 1.0).abs() < 0.03);
    }
}
