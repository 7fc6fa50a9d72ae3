//! Poisson's ratio as the errors of meshes have it.

use crate::mechanics::body::Body;
use crate::mechanics::grading::STIFF;
use crate::mechanics::material::Idealization;

/// Corners between held and free sides are the worse the stiffer a body is in plane strain beside its shear modulus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stiffness {
    Ordinary,
    Stiff,
    VeryStiff,
    NearlyIncompressible,
}

impl Stiffness {
    pub const ALL: [Stiffness; 4] =
        [Stiffness::Ordinary, Stiffness::Stiff, Stiffness::VeryStiff, Stiffness::NearlyIncompressible];

    /// Least and greatest Poisson's ratio in plane strain.
    pub fn range(self) -> [f64; 2] {
        match self {
            Stiffness::Ordinary => [-1.0, STIFF],
            Stiffness::Stiff => [STIFF, 0.45],
            Stiffness::VeryStiff => [0.45, 0.47],
            Stiffness::NearlyIncompressible => [0.47, 0.49],
        }
    }

    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Stiffness::Ordinary => "ordinary",
            Stiffness::Stiff => "stiff",
            Stiffness::VeryStiff => "very stiff",
            Stiffness::NearlyIncompressible => "nearly incompressible",
        }
    }

    /// `None` where it is so little stiff, or so much, that meshes behave otherwise.
    pub fn of(body: &Body) -> Option<Stiffness> {
        match body.idealization {
            Idealization::PlaneStress => (body.poissons_ratio > -0.75).then_some(Stiffness::Ordinary),
            Idealization::PlaneStrain => {
                let is_below = |stiffness: &Stiffness| body.poissons_ratio <= stiffness.range()[1];
                Stiffness::ALL.into_iter().find(is_below)
            }
        }
    }
}
