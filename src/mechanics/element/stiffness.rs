//! The element stiffness: K_e = integral of B^T D B = sum over 2 x 2 points of w |J| B^T D B.

use super::quadrature::TWO_POINT;
use super::{ElementKind, MAX_NODES, ShapeFunctions};
use crate::mechanics::material::Idealization;
use crate::mechanics::real::Real;

/// Isotropic elasticity in the plane for Young's modulus 1: sigma_xx = direct exx + cross eyy, sigma_xy = shear gxy.
#[derive(Clone, Copy, Debug)]
pub struct Elasticity<T> {
    pub direct: T,
    pub cross: T,
    pub shear: T,
}

impl<T: Real> Elasticity<T> {
    /// For Young's modulus 1 and Poisson's ratio in (-1, 0.5).
    pub fn new(idealization: Idealization, poissons_ratio: T) -> Self {
        let one = T::from_f64(1.0);
        let nu = poissons_ratio;
        let shear = T::from_f64(0.5) / (one + nu);
        match idealization {
            Idealization::PlaneStress => {
                let direct = one / (one - nu * nu);
                Elasticity { direct, cross: nu * direct, shear }
            }
            Idealization::PlaneStrain => {
                let scale = one / ((one + nu) * (one - nu - nu));
                Elasticity { direct: (one - nu) * scale, cross: nu * scale, shear }
            }
        }
    }

    /// For so many times the Young's modulus.
    #[inline(always)]
    pub fn times(self, modulus: T) -> Self {
        let Elasticity { direct, cross, shear } = self;
        Elasticity { direct: modulus * direct, cross: modulus * cross, shear: modulus * shear }
    }
}

impl Elasticity<f64> {
    /// What a strain (xx, yy, engineering xy) puts on a cut with a normal.
    pub fn traction(&self, [xx, yy, xy]: [f64; 3], [x, y]: [f64; 2]) -> [f64; 2] {
        let shear = self.shear * xy;
        let [along_x, along_y] = [self.direct * xx + self.cross * yy, self.cross * xx + self.direct * yy];
        [along_x * x + shear * y, shear * x + along_y * y]
    }
}

/// Shape functions at the 2 x 2 points, evaluated once per topology.
pub struct ElementRule {
    pub kind: ElementKind,
    pub points: [ShapeFunctions; 4],
    centre: ShapeFunctions,
}

impl ElementRule {
    pub fn new(kind: ElementKind) -> ElementRule {
        let [a, b] = TWO_POINT;
        let at = |xi, eta| ShapeFunctions::at(kind, xi, eta);
        ElementRule { kind, points: [at(a, a), at(b, a), at(b, b), at(a, b)], centre: at(0.0, 0.0) }
    }
}

/// Element stiffness, row-major `[2 * MAX_NODES][2 * MAX_NODES]`, the upper triangle of the first
/// `2 * node_count` rows filled.
pub struct ElementStiffness<T> {
    pub values: [[T; 2 * MAX_NODES]; 2 * MAX_NODES],
    /// The least |J| over the points: at most zero, or NaN, where the values mean nothing.
    pub smallest_jacobian: T,
}

impl<T: Real> ElementStiffness<T> {
    /// Room for one.
    #[inline(always)]
    pub fn room() -> ElementStiffness<T> {
        ElementStiffness {
            values: [[T::zero(); 2 * MAX_NODES]; 2 * MAX_NODES],
            smallest_jacobian: T::from_f64(f64::INFINITY),
        }
    }
}

/// Gradients of the shape functions by x and y, and |J|, at one point of one element.
#[inline(always)]
fn gradients<T: Real>(
    shape: &ShapeFunctions,
    nodes: &[[T; 2]; MAX_NODES],
    count: usize,
) -> ([[T; 2]; MAX_NODES], T) {
    let mut jacobian = [[T::zero(); 2]; 2];
    for (node, place) in nodes.iter().enumerate().take(count) {
        let (by_xi, by_eta) = (T::from_f64(shape.by_xi[node]), T::from_f64(shape.by_eta[node]));
        for axis in 0..2 {
            jacobian[0][axis] += by_xi * place[axis];
            jacobian[1][axis] += by_eta * place[axis];
        }
    }
    let determinant = jacobian[0][0] * jacobian[1][1] - jacobian[0][1] * jacobian[1][0];
    let inverse = T::from_f64(1.0) / determinant;
    let mut gradient = [[T::zero(); 2]; MAX_NODES];
    for (node, [by_x, by_y]) in gradient.iter_mut().enumerate().take(count) {
        let (by_xi, by_eta) = (T::from_f64(shape.by_xi[node]), T::from_f64(shape.by_eta[node]));
        *by_x = (jacobian[1][1] * by_xi - jacobian[0][1] * by_eta) * inverse;
        *by_y = (jacobian[0][0] * by_eta - jacobian[1][0] * by_xi) * inverse;
    }
    (gradient, determinant)
}

/// The strain (xx, yy, engineering xy) at a point of a Q8 whose nodes have moved so.
pub fn strain(
    shape: &ShapeFunctions,
    nodes: &[[f64; 2]; MAX_NODES],
    moved: &[[f64; 2]; MAX_NODES],
) -> [f64; 3] {
    let (gradient, _) = gradients(shape, nodes, ElementKind::Quad8.node_count());
    gradient.iter().zip(moved).fold([0.0; 3], |[xx, yy, xy], ([by_x, by_y], [u, v])| {
        [xx + by_x * u, yy + by_y * v, xy + by_y * u + by_x * v]
    })
}

/// The sum of w |J| B^T D B over all points; Q4 replaces its dilatation by the one at the centre (B-bar, Hughes 1980).
///
/// `nodes` are the coordinates in the order of `ElementKind`, oriented so that |J| > 0.
#[inline(always)]
pub fn element_stiffness<T: Real>(
    rule: &ElementRule,
    elasticity: &Elasticity<T>,
    nodes: &[[T; 2]; MAX_NODES],
) -> ElementStiffness<T> {
    let mut stiffness = ElementStiffness::room();
    element_stiffness_in_room(rule, elasticity, nodes, &mut stiffness);
    stiffness
}

/// The same in the room of another one: what lies there of many bodies takes longer to copy than to compute.
#[inline(always)]
pub fn element_stiffness_in_room<T: Real>(
    rule: &ElementRule,
    elasticity: &Elasticity<T>,
    nodes: &[[T; 2]; MAX_NODES],
    ElementStiffness { values, smallest_jacobian }: &mut ElementStiffness<T>,
) {
    let count = rule.kind.node_count();
    let mean = gradients(&rule.centre, nodes, count).0;
    let half = T::from_f64(0.5);
    *smallest_jacobian = T::from_f64(f64::INFINITY);
    for (point, shape) in rule.points.iter().enumerate() {
        // The first one finds nothing there.
        let before = |value: T| if point == 0 { T::zero() } else { value };
        let (gradient, determinant) = gradients(shape, nodes, count);
        *smallest_jacobian = smallest_jacobian.least(determinant);
        let minus = -determinant;
        let (direct, cross, shear) =
            (elasticity.direct * minus, elasticity.cross * minus, elasticity.shear * minus);
        if rule.kind == ElementKind::Quad8 {
            for j in 0..count {
                let [x, y] = gradient[j];
                let (dx, cx, sx) = (direct * x, cross * x, shear * x);
                let (dy, cy, sy) = (direct * y, cross * y, shear * y);
                for i in 0..=j {
                    let [p, q] = gradient[i];
                    let added = [[[dx, sy], [cy, sx]], [[sy, cx], [sx, dy]]];
                    for (row, added) in values[2 * i..].iter_mut().zip(added) {
                        for (value, [of_x, of_y]) in row[2 * j..].iter_mut().zip(added) {
                            *value = before(*value).minus_product(p, of_x).minus_product(q, of_y);
                        }
                    }
                }
            }
        } else {
            // Columns (exx, eyy, gxy) of B-bar for displacement along x and y of each node.
            let mut strain = [[T::zero(); 3]; 2 * MAX_NODES];
            for node in 0..count {
                let [x, y] = gradient[node];
                let shift = [half * (mean[node][0] - x), half * (mean[node][1] - y)];
                strain[2 * node] = [x + shift[0], shift[0], y];
                strain[2 * node + 1] = [shift[1], y + shift[1], x];
            }
            for j in 0..2 * count {
                let [xx, yy, xy] = strain[j];
                let stress = [direct * xx + cross * yy, cross * xx + direct * yy, shear * xy];
                for (i, row) in strain.iter().enumerate().take(j + 1) {
                    values[i][j] = before(values[i][j]);
                    for (row, stress) in row.iter().zip(stress) {
                        values[i][j] = values[i][j].minus_product(*row, stress);
                    }
                }
            }
        }
    }
}

/// Floating-point operations of `element_stiffness`.
pub fn stiffness_operations(kind: ElementKind) -> u64 {
    let count = kind.node_count() as u64;
    let gradients = 16 * count + 4;
    let at_point = match kind {
        // Six products a node; four entries of four a pair of nodes.
        ElementKind::Quad8 => 6 * count + 8 * count * (count + 1),
        // Six a node for its strain, seven a column for its stress, six an entry.
        ElementKind::Quad4 => 20 * count + 6 * count * (2 * count + 1),
    };
    gradients + 4 * (gradients + 3 + at_point)
}
