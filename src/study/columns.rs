//! The columns of CSV files, in their order: written once, for the lists of designs that are read, for the tables that are
//! written and for configs that name them. What shapes add to them comes from the registry of shapes.

use serde::{Deserialize, Serialize};

use crate::error::{quoted, suggest_from};
use crate::mechanics::body::{Shape, Side};
use crate::mechanics::material::Idealization;
use crate::study::design::{JointDesign, Part};
use crate::study::layers::{Layer, LayerCounts, MOST_LAYERS};

/// One input of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    HoleRadius,
    RadialClearance,
    Thickness,
    Idealization,
    Model(Side),
    /// A ratio of one or more shapes of this side.
    Parameter(Side, &'static str),
    Support(Side),
    YoungsModulus(Side),
    PoissonsRatio(Side),
    /// Of a layer, counted from 0.
    Layer(Side, usize, LayerQuantity),
}

/// What a layer is told by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerQuantity {
    Thickness,
    YoungsModulus,
    PoissonsRatio,
}

impl LayerQuantity {
    pub const ALL: [LayerQuantity; 3] =
        [LayerQuantity::Thickness, LayerQuantity::YoungsModulus, LayerQuantity::PoissonsRatio];

    /// In columns, with its unit.
    pub fn name(self) -> &'static str {
        match self {
            LayerQuantity::Thickness => "thickness_mm",
            LayerQuantity::YoungsModulus => "youngs_modulus_mpa",
            LayerQuantity::PoissonsRatio => "poissons_ratio",
        }
    }

    pub fn of(self, layer: &Layer) -> f64 {
        match self {
            LayerQuantity::Thickness => layer.thickness,
            LayerQuantity::YoungsModulus => layer.material.youngs_modulus,
            LayerQuantity::PoissonsRatio => layer.material.poissons_ratio,
        }
    }
}

/// The columns that only some sweeps have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Extras {
    pub layers: LayerCounts,
    /// Whether joints are loaded by an offset, or may be press fits.
    pub offset: bool,
    /// Whether joints may press most beside the load line.
    pub peak_angle: bool,
}

impl Extras {
    pub const NONE: Extras = Extras { layers: LayerCounts::NONE, offset: false, peak_angle: false };
    /// All that there can be.
    pub const MOST: Extras = Extras { layers: LayerCounts::MOST, offset: true, peak_angle: true };
}

/// What to say of a word that is none of `all` columns. Those with the columns of one layer a part are enough to know the others by:
/// columns of eight would hide what is looked for.
pub fn suggest_column(word: &str, all: &[&str], of_one_layer: &[&str]) -> String {
    let listed = format!("{}; of `layer2` to `layer{MOST_LAYERS}` as of `layer1`", quoted(of_one_layer));
    suggest_from(word, all, &listed)
}

/// How many layers columns of these names are for.
pub fn layers_in<'a>(names: impl Iterator<Item = &'a str>) -> LayerCounts {
    let of_name = |name: &str, side: Side| {
        let number = name.strip_prefix(side_name(side))?.strip_prefix(LAYER)?.split_once('_')?.0;
        number.parse().ok()
    };
    names.fold(LayerCounts::NONE, |counts, name| {
        let [pin, plate] = [Side::Pin, Side::Plate].map(|side| of_name(name, side).unwrap_or(0));
        counts.and(LayerCounts { pin, plate })
    })
}

/// Between the side and the number of a layer in names of columns.
const LAYER: &str = "_layer";

/// The columns of the loads; a row of a list of designs fills one of them.
pub const INDENTATION: &str = "indentation_mm";
pub const OFFSET: &str = "offset_mm";
pub const FORCE: &str = "force_n";

/// The number of a row's design.
pub const DESIGN: &str = "design";

/// What a row of the table tells of a load step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    Indentation,
    Offset,
    Force,
    TangentStiffness,
    ContactHalfAngle,
    PeakPressure,
    PeakPressureAngle,
    Energy,
    ForceError,
    LinearityError,
    Method,
    Backend,
    Status,
}

impl Quantity {
    /// In the order of the table.
    pub const ALL: [Quantity; 13] = [
        Quantity::Indentation,
        Quantity::Offset,
        Quantity::Force,
        Quantity::TangentStiffness,
        Quantity::ContactHalfAngle,
        Quantity::PeakPressure,
        Quantity::PeakPressureAngle,
        Quantity::Energy,
        Quantity::ForceError,
        Quantity::LinearityError,
        Quantity::Method,
        Quantity::Backend,
        Quantity::Status,
    ];

    /// Those in tables with these columns.
    pub fn of_tables(extras: Extras) -> impl Iterator<Item = Quantity> {
        let is_there = move |quantity: &Quantity| match quantity {
            Quantity::Offset => extras.offset,
            Quantity::PeakPressureAngle => extras.peak_angle,
            _ => true,
        };
        Quantity::ALL.into_iter().filter(is_there)
    }

    /// The column's header, with its unit.
    pub fn name(self) -> &'static str {
        self.documented().0
    }

    /// "-" for ratios and words.
    pub fn unit(self) -> &'static str {
        self.documented().1
    }

    /// What it means.
    pub fn about(self) -> &'static str {
        self.documented().2
    }

    /// Whether there are numbers in the column, not words.
    pub fn is_number(self) -> bool {
        !matches!(self, Quantity::Method | Quantity::Backend | Quantity::Status)
    }

    /// The words of a column of words; a status has one or more of its own.
    pub fn words(self) -> &'static [&'static str] {
        match self {
            Quantity::Method => &["closed-form", "series", "interpolated", "fe"],
            Quantity::Backend => &["cpu", "gpu"],
            Quantity::Status => &[
                "ok",
                "failed",
                "clearance beyond the model",
                "large displacement",
                "pressure not positive everywhere",
                "accuracy not met",
                "plate extent not modelled",
                "yields at rest",
                "no contact",
            ],
            _ => &[],
        }
    }

    fn documented(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Quantity::Indentation => (
                INDENTATION,
                "mm",
                "descent of the pin's rigid part after first touch, from where the plate is held; of press fits the offset and the overlap",
            ),
            Quantity::Offset => (
                OFFSET,
                "mm",
                "of the pin's rigid part from where pin and hole are concentric, of press fits from where they are at rest: the clearance and \
                 the indentation; only in tables of sweeps with that load or with press fits",
            ),
            Quantity::Force => (FORCE, "N", "of the whole joint, both halves"),
            Quantity::TangentStiffness => {
                ("tangent_stiffness_n_per_mm", "N/mm", "slope of the force over the indentation")
            }
            Quantity::ContactHalfAngle => (
                "contact_half_angle_deg",
                "deg",
                "where the pressure ends, at the hole's centre, from the load line",
            ),
            Quantity::PeakPressure => {
                ("peak_pressure_mpa", "MPa", "greatest contact pressure, per area of the hole")
            }
            Quantity::PeakPressureAngle => (
                "peak_pressure_angle_deg",
                "deg",
                "where that is, at the hole's centre, from the load line: 0 but for stiff layers on soft ones and press fits in blocks; only \
                 in tables of such press fits and of joints with layers",
            ),
            Quantity::Energy => ("energy_mj", "mJ", "strain energy of both bodies"),
            Quantity::ForceError => {
                ("force_error", "-", "estimated relative error of the force, displacements being small")
            }
            Quantity::LinearityError => (
                "linearity_error",
                "-",
                "estimated relative difference of the force from laws of finite displacement",
            ),
            Quantity::Method => (
                "method",
                "-",
                "`series`, `interpolated`, `fe` or `closed-form`; empty where there is no answer",
            ),
            Quantity::Backend => {
                ("backend", "-", "what has computed: `cpu` or `gpu`; empty where there is no answer")
            }
            Quantity::Status => ("status", "-", "`ok`, or remarks on the answer, or `failed: ` and why"),
        }
    }
}

/// What stands in a column for one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    Number(f64),
    Word(&'static str),
    /// The joint's shapes do not use the column.
    Empty,
}

/// The columns of a joint with so many layers at most, in their order; the load follows them.
pub fn joint_columns(layers: LayerCounts) -> Vec<Column> {
    let mut columns =
        vec![Column::HoleRadius, Column::RadialClearance, Column::Thickness, Column::Idealization];
    for side in [Side::Pin, Side::Plate] {
        columns.push(Column::Model(side));
        for parameter in Shape::of_side(side).flat_map(|shape| shape.parameters) {
            let column = Column::Parameter(side, parameter.name);
            if !columns.contains(&column) {
                columns.push(column);
            }
        }
        if Shape::of_side(side).any(|shape| !shape.supports.is_empty()) {
            columns.push(Column::Support(side));
        }
        columns.extend([Column::YoungsModulus(side), Column::PoissonsRatio(side)]);
        for layer in 0..layers.of(side) {
            columns.extend(LayerQuantity::ALL.map(|quantity| Column::Layer(side, layer, quantity)));
        }
    }
    columns
}

/// The name of a side in keys and columns.
pub fn side_name(side: Side) -> &'static str {
    match side {
        Side::Pin => "pin",
        Side::Plate => "plate",
    }
}

impl Column {
    /// The column's header, with its unit.
    pub fn name(&self) -> String {
        match *self {
            Column::HoleRadius => "hole_radius_mm".to_string(),
            Column::RadialClearance => "radial_clearance_mm".to_string(),
            Column::Thickness => "thickness_mm".to_string(),
            Column::Idealization => "idealization".to_string(),
            Column::Model(side) => format!("{}_model", side_name(side)),
            Column::Parameter(_, name) => name.to_string(),
            Column::Support(side) => format!("{}_support", side_name(side)),
            Column::YoungsModulus(side) => format!("{}_youngs_modulus_mpa", side_name(side)),
            Column::PoissonsRatio(side) => format!("{}_poissons_ratio", side_name(side)),
            Column::Layer(side, layer, quantity) => {
                format!("{}{LAYER}{}_{}", side_name(side), layer + 1, quantity.name())
            }
        }
    }

    /// Whether there are numbers in the column, not words.
    pub fn is_number(&self) -> bool {
        !matches!(self, Column::Idealization | Column::Model(_) | Column::Support(_))
    }

    /// "-" for ratios and words.
    pub fn unit(&self) -> &'static str {
        match self {
            Column::HoleRadius | Column::RadialClearance | Column::Thickness => "mm",
            Column::Layer(_, _, LayerQuantity::Thickness) => "mm",
            Column::YoungsModulus(_) | Column::Layer(_, _, LayerQuantity::YoungsModulus) => "MPa",
            _ => "-",
        }
    }

    /// What it means.
    pub fn about(&self) -> String {
        match *self {
            Column::HoleRadius => "radius of the hole, R2".into(),
            Column::RadialClearance => {
                "hole radius less pin radius, dR (not the diametral clearance); of press fits below zero"
                    .into()
            }
            Column::Thickness => "length of the joint along its axis, t".into(),
            Column::Idealization => {
                let names = Idealization::ALL.map(|one| format!("`{}`", one.name()));
                names.join(" or ")
            }
            Column::Model(side) => {
                let names: Vec<String> =
                    Shape::of_side(side).map(|shape| format!("`{}`", shape.name)).collect();
                names.join(" or ")
            }
            Column::Parameter(side, name) => {
                let shapes = Shape::of_side(side);
                let of = shapes.filter(|shape| shape.parameters.iter().any(|own| own.name == name));
                let of: Vec<String> = of.map(|shape| format!("`{}`", shape.name)).collect();
                let radius = match side {
                    Side::Pin => "pin",
                    Side::Plate => "hole",
                };
                format!("of {}: over the {radius} radius", of.join(" and "))
            }
            Column::Support(side) => {
                let shapes = Shape::of_side(side);
                let names: Vec<String> =
                    shapes.flat_map(|shape| shape.supports).map(|support| format!("`{support}`")).collect();
                format!("how it is held: {}", names.join(" or "))
            }
            Column::YoungsModulus(side) => format!("Young's modulus of the {}", side_name(side)),
            Column::PoissonsRatio(side) => format!("Poisson's ratio of the {}", side_name(side)),
            Column::Layer(side, layer, quantity) => {
                let what = match quantity {
                    LayerQuantity::Thickness => "thickness",
                    LayerQuantity::YoungsModulus => "Young's modulus",
                    LayerQuantity::PoissonsRatio => "Poisson's ratio",
                };
                format!("{what} of layer {} of the {}, counted from the contact", layer + 1, side_name(side))
            }
        }
    }

    /// What stands in this column for `joint`.
    pub fn cell(&self, joint: &JointDesign) -> Cell {
        let part = |side: Side| -> &Part {
            match side {
                Side::Pin => &joint.pin,
                Side::Plate => &joint.plate,
            }
        };
        match *self {
            Column::HoleRadius => Cell::Number(joint.hole_radius),
            Column::RadialClearance => Cell::Number(joint.radial_clearance),
            Column::Thickness => Cell::Number(joint.thickness),
            Column::Idealization => Cell::Word(joint.idealization.name()),
            Column::Model(side) => Cell::Word(part(side).shape.name),
            Column::Parameter(side, name) => part(side).parameter(name).map_or(Cell::Empty, Cell::Number),
            Column::Support(side) => part(side).support_name().map_or(Cell::Empty, Cell::Word),
            Column::YoungsModulus(side) => Cell::Number(part(side).material.youngs_modulus),
            Column::PoissonsRatio(side) => Cell::Number(part(side).material.poissons_ratio),
            Column::Layer(side, layer, quantity) => {
                let layer = part(side).layers.list().get(layer);
                layer.map_or(Cell::Empty, |layer| Cell::Number(quantity.of(layer)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_those_of_the_contract() {
        let names: Vec<String> = joint_columns(LayerCounts::NONE).iter().map(Column::name).collect();
        assert_eq!(
            names.join(","),
            "hole_radius_mm,radial_clearance_mm,thickness_mm,idealization,pin_model,core_radius_ratio,\
             pin_youngs_modulus_mpa,pin_poissons_ratio,plate_model,outer_radius_ratio,half_width_ratio,\
             depth_ratio,height_ratio,plate_support,plate_youngs_modulus_mpa,plate_poissons_ratio"
        );
    }

    /// A pin and a plate shape that name a ratio alike would share a header.
    #[test]
    fn no_two_columns_share_a_name() {
        let mut names: Vec<String> = joint_columns(LayerCounts::MOST).iter().map(Column::name).collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
