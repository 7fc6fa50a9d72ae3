//! Linear elasticity in the plane: which of the two plane states, and the moduli that follow from it.

/// The state of the plane. Everything that depends on it asks this type; nothing else branches on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Idealization {
    PlaneStress,
    PlaneStrain,
}

impl Idealization {
    pub const ALL: [Idealization; 2] = [Idealization::PlaneStress, Idealization::PlaneStrain];

    /// The name in configs and tables.
    pub fn name(self) -> &'static str {
        match self {
            Idealization::PlaneStress => "plane-stress",
            Idealization::PlaneStrain => "plane-strain",
        }
    }

    /// E'/E: 1 in plane stress, 1/(1 - nu^2) in plane strain.
    pub fn plane_modulus_ratio(self, poissons_ratio: f64) -> f64 {
        match self {
            Idealization::PlaneStress => 1.0,
            Idealization::PlaneStrain => 1.0 / (1.0 - poissons_ratio * poissons_ratio),
        }
    }

    /// What keeps the elasticity from being singular: 1 + nu in plane stress, 1 - 2 nu in plane strain. The elasticity
    /// follows from it to its own rounding, where a rounded Poisson's ratio would lose the difference from -1 or 1/2.
    pub fn margin(self, poissons_ratio: f64) -> f64 {
        match self {
            Idealization::PlaneStress => 1.0 + poissons_ratio,
            Idealization::PlaneStrain => 1.0 - 2.0 * poissons_ratio,
        }
    }

    /// The stress along the axis over the sum of those in the plane.
    pub fn axial_share(self, poissons_ratio: f64) -> f64 {
        match self {
            Idealization::PlaneStress => 0.0,
            Idealization::PlaneStrain => poissons_ratio,
        }
    }

    /// The shear modulus over the bulk modulus of the plane, mu/(lambda + mu) in plane strain: (1 - nu)/(1 + nu) in plane stress, 1 - 2 nu
    /// in plane strain. Bodies of either state that have the same are as compliant as each other, beside their shear moduli.
    pub fn shear_to_bulk(self, poissons_ratio: f64) -> f64 {
        match self {
            Idealization::PlaneStress => (1.0 - poissons_ratio) / (1.0 + poissons_ratio),
            Idealization::PlaneStrain => 1.0 - 2.0 * poissons_ratio,
        }
    }

    /// The state and Poisson's ratio of a body with this ratio of moduli: plane strain as far as that goes without a negative one.
    pub fn of_shear_to_bulk(ratio: f64) -> (Idealization, f64) {
        if ratio > 1.0 {
            (Idealization::PlaneStress, (1.0 - ratio) / (1.0 + ratio))
        } else {
            (Idealization::PlaneStrain, 0.5 * (1.0 - ratio))
        }
    }

    /// Kolosov's constant: (3 - nu)/(1 + nu) in plane stress, 3 - 4 nu in plane strain.
    pub fn kolosov(self, poissons_ratio: f64) -> f64 {
        match self {
            Idealization::PlaneStress => (3.0 - poissons_ratio) / (1.0 + poissons_ratio),
            Idealization::PlaneStrain => 3.0 - 4.0 * poissons_ratio,
        }
    }
}

/// Poisson's ratio as meshes feel it, in either plane state from the softest on. Every threshold of it is here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Compressibility {
    /// Plane stress close to -1: nearly without shear.
    NearlyConformal,
    /// Plane stress, the other negative ones.
    Auxetic,
    /// Plane stress, the positive ones.
    Positive,
    /// Plane strain, the negative ones.
    Negative,
    /// Plane strain, most of the positive ones.
    Moderate,
    /// Plane strain: corners between held and free sides feel it.
    Stiff,
    VeryStiff,
    /// Plane strain close to 1/2: meshes are about to lock.
    NearlyIncompressible,
    /// So close that they do.
    Locking,
}

impl Compressibility {
    /// Below it a mesh in plane stress resists shear as one in plane strain does compression close to 1/2.
    pub const NEARLY_CONFORMAL: f64 = -0.75;
    /// Above it, in plane strain.
    pub const STIFF: f64 = 0.42;
    pub const VERY_STIFF: f64 = 0.45;
    pub const NEARLY_INCOMPRESSIBLE: f64 = 0.47;
    pub const LOCKING: f64 = 0.49;
    /// Of 1 + nu in plane stress and of 1 - 2 nu in plane strain: below them the errors of meshes change no more.
    pub const LEAST_SHEAR: f64 = 1e-3;
    pub const LEAST: f64 = 1e-5;

    pub fn of(poissons_ratio: f64, idealization: Idealization) -> Compressibility {
        use Compressibility::*;
        match idealization {
            Idealization::PlaneStress if poissons_ratio < Self::NEARLY_CONFORMAL => NearlyConformal,
            Idealization::PlaneStress if poissons_ratio < 0.0 => Auxetic,
            Idealization::PlaneStress => Positive,
            Idealization::PlaneStrain if poissons_ratio < 0.0 => Negative,
            Idealization::PlaneStrain if poissons_ratio <= Self::STIFF => Moderate,
            Idealization::PlaneStrain if poissons_ratio <= Self::VERY_STIFF => Stiff,
            Idealization::PlaneStrain if poissons_ratio <= Self::NEARLY_INCOMPRESSIBLE => VeryStiff,
            Idealization::PlaneStrain if poissons_ratio <= Self::LOCKING => NearlyIncompressible,
            Idealization::PlaneStrain => Locking,
        }
    }
}

/// An isotropic, linear elastic material: Young's modulus in any one unit, Poisson's ratio in (-1, 0.5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    pub youngs_modulus: f64,
    pub poissons_ratio: f64,
}

impl Material {
    /// E' = E (plane stress) or E/(1 - nu^2) (plane strain), in the unit of `youngs_modulus`.
    pub fn plane_modulus(&self, idealization: Idealization) -> f64 {
        self.youngs_modulus * idealization.plane_modulus_ratio(self.poissons_ratio)
    }
}

/// E* of a pair, 1/E* = 1/E1' + 1/E2', in the unit of the two moduli.
pub fn effective_modulus(pin: &Material, plate: &Material, idealization: Idealization) -> f64 {
    1.0 / (1.0 / pin.plane_modulus(idealization) + 1.0 / plate.plane_modulus(idealization))
}
