//! One point of a sweep: a joint and the load steps it is run through. mm, N, MPa.

use std::fmt;
use std::sync::Arc;

use crate::error::{Error, shortened, suggest};
use crate::mechanics::body::lining::{Interface, Lining};
use crate::mechanics::body::{Body, MAX_PARAMETERS, SHAPES, Shape, ShapeParameter, Side};
use crate::mechanics::laws::{LawError, Pair};
use crate::mechanics::material::{Idealization, Material};
use crate::study::layers::{Layer, LayerCounts, Layers, MOST_LAYERS};

/// The values a quantity may take: from `low`, itself allowed or not, to below `high`.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    pub low: f64,
    pub low_allowed: bool,
    pub high: f64,
}

impl Limits {
    /// Radii, thickness, moduli.
    pub const POSITIVE: Limits = Limits::between(0.0, f64::INFINITY);
    /// Indentation, offset, force.
    pub const NOT_NEGATIVE: Limits = Limits { low: 0.0, low_allowed: true, high: f64::INFINITY };
    /// Every finite number.
    pub const ANY: Limits = Limits { low: f64::NEG_INFINITY, low_allowed: true, high: f64::INFINITY };
    /// Where plane strain has a positive energy; 0.5 itself is incompressible.
    pub const POISSONS_RATIO: Limits = Limits::between(-1.0, 0.5);

    const fn between(low: f64, high: f64) -> Limits {
        Limits { low, low_allowed: false, high }
    }

    /// The exclusive bounds of a shape's ratio.
    pub fn of_parameter(parameter: &ShapeParameter) -> Limits {
        Limits::between(parameter.above, parameter.below)
    }

    /// What is allowed, if `value` is not.
    pub fn refuse(&self, value: f64) -> Result<(), String> {
        // False for NaN, too.
        let inside = if self.low_allowed { value >= self.low } else { value > self.low } && value < self.high;
        match (inside, self.low_allowed, self.high.is_finite()) {
            (true, ..) => Ok(()),
            (_, true, false) => Err(format!("must be {} or more", self.low)),
            (_, false, false) => Err(format!("must be above {}", self.low)),
            (_, true, true) => Err(format!("must be at least {} and below {}", self.low, self.high)),
            (_, false, true) => Err(format!("must be above {} and below {}", self.low, self.high)),
        }
    }
}

/// One half of a joint: its shape with ratios to the ring's radius, and its material (MPa).
#[derive(Clone, Debug)]
pub struct Part {
    pub shape: &'static Shape,
    /// Values of `shape.parameters`, in order; the rest is zero.
    pub parameters: [f64; MAX_PARAMETERS],
    /// Index into `shape.supports`; 0 when there is only one.
    pub support: usize,
    /// Beyond all layers.
    pub material: Material,
    /// Of that material, MPa, where it is known.
    pub yield_stress: Option<f64>,
    pub layers: Layers,
}

impl Part {
    /// The value of one of the shape's ratios; `None` when the shape has no such ratio.
    pub fn parameter(&self, name: &str) -> Option<f64> {
        let position = self.shape.parameters.iter().position(|parameter| parameter.name == name)?;
        self.parameters.get(position).copied()
    }

    /// Of a layer, from 1 at the contact, or of its own material, 0; MPa.
    pub fn yield_stress(&self, layer: usize) -> Option<f64> {
        layer.checked_sub(1).map_or(self.yield_stress, |place| self.layers.list().get(place)?.yield_stress)
    }

    /// Of a layer, from 1 at the contact, or its own, 0.
    pub fn layer_material(&self, layer: usize) -> Material {
        let own = layer.checked_sub(1).and_then(|place| self.layers.list().get(place));
        own.map_or(self.material, |layer| layer.material)
    }

    /// The layer that material number so many from the contact on is, from 1; 0 is its own material, beyond all layers.
    pub fn layer_of(&self, number: usize) -> usize {
        if number < self.layers.list().len() { number + 1 } else { 0 }
    }

    /// That of the layer that touches, or its own.
    pub fn contact_material(&self) -> Material {
        self.layers.list().first().map_or(self.material, |layer| layer.material)
    }

    /// Whether its contact material is stiffer than one beyond: such a layer presses most where it bends most.
    pub fn is_stiff_on_soft(&self) -> bool {
        self.least_modulus() < self.contact_material().youngs_modulus
    }

    /// Young's modulus of its softest material, MPa.
    pub fn least_modulus(&self) -> f64 {
        let of_layers = self.layers.list().iter().map(|layer| layer.material.youngs_modulus);
        of_layers.fold(self.material.youngs_modulus, f64::min)
    }

    /// The name of the way it is held; `None` when there is only one.
    pub fn support_name(&self) -> Option<&'static str> {
        self.shape.supports.get(self.support).copied()
    }
}

impl Part {
    /// Of a model by its name, such as "annulus", with its ratios by theirs; those that have a default may be left out. E in MPa.
    pub fn new(
        model: &str,
        ratios: &[(&str, f64)],
        support: Option<&str>,
        material: Material,
    ) -> Result<Part, Error> {
        let refuse =
            |quantity: &str, problem: String| Err(Error::Joint { quantity: quantity.to_string(), problem });
        let names: Vec<&str> = SHAPES.iter().map(|shape| shape.name).collect();
        let Some(shape) = SHAPES.into_iter().find(|shape| shape.name == model) else {
            return refuse("model", format!("`{}`: not known; {}", shortened(model), suggest(model, &names)));
        };
        let allowed: Vec<&str> = shape.parameters.iter().map(|parameter| parameter.name).collect();
        for (name, _) in ratios {
            if !allowed.contains(name) {
                let hint = suggest(name, &allowed);
                return refuse(&shortened(name), format!("model `{model}` does not have this ratio; {hint}"));
            }
        }
        let mut parameters = [0.0; MAX_PARAMETERS];
        for (slot, parameter) in parameters.iter_mut().zip(shape.parameters) {
            let given = ratios.iter().find(|(name, _)| *name == parameter.name).map(|(_, value)| *value);
            let Some(value) = given.or(parameter.default) else {
                return refuse(parameter.name, format!("model `{model}` needs this ratio"));
            };
            check(parameter.name, value, Limits::of_parameter(parameter))?;
            *slot = value;
        }
        let support = match support {
            None => 0,
            Some(name) => match shape.supports.iter().position(|own| *own == name) {
                Some(place) => place,
                None => {
                    let hint = suggest(name, shape.supports);
                    return refuse("support", format!("`{}`: not known; {hint}", shortened(name)));
                }
            },
        };
        check("youngs_modulus", material.youngs_modulus, Limits::POSITIVE)?;
        check("poissons_ratio", material.poissons_ratio, Limits::POISSONS_RATIO)?;
        Ok(Part { shape, parameters, support, material, yield_stress: None, layers: Layers::NONE })
    }
}

impl Part {
    /// The same part with bonded layers, from the contact into it: mm and MPa.
    pub fn with_layers(self, layers: &[Layer]) -> Result<Part, Error> {
        let part = Part { layers: Layers::new(layers.to_vec()), ..self };
        part.check_layers()?;
        Ok(part)
    }

    /// The same part with a yield stress of its own material, MPa.
    pub fn with_yield_stress(self, yield_stress: f64) -> Result<Part, Error> {
        check("yield_stress", yield_stress, Limits::POSITIVE)?;
        Ok(Part { yield_stress: Some(yield_stress), ..self })
    }

    /// Whether there can be such layers, whatever the wall.
    fn check_layers(&self) -> Result<(), Error> {
        let layers = self.layers.list();
        let refuse = |problem: String| Err(Error::Joint { quantity: "layers".into(), problem });
        if layers.len() > MOST_LAYERS {
            return refuse(format!("{} layers; at most {MOST_LAYERS} are allowed", layers.len()));
        }
        for (number, layer) in (1..).zip(layers) {
            let of = |quantity: &str| format!("layer {number}: {quantity}");
            check(&of("thickness"), layer.thickness, Limits::POSITIVE)?;
            check(&of("youngs_modulus"), layer.material.youngs_modulus, Limits::POSITIVE)?;
            check(&of("poissons_ratio"), layer.material.poissons_ratio, Limits::POISSONS_RATIO)?;
            if let Some(yield_stress) = layer.yield_stress {
                check(&of("yield_stress"), yield_stress, Limits::POSITIVE)?;
            }
        }
        Ok(())
    }
}

fn check(quantity: &str, value: f64, limits: Limits) -> Result<(), Error> {
    let refuse = |problem| Error::Joint { quantity: quantity.into(), problem: format!("{value}: {problem}") };
    limits.refuse(value).map_err(refuse)
}

/// Why a part cannot be as it is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoRoom {
    /// Layers that leave nothing of what they are on: their thickness and that of the wall, mm.
    Layers { of: &'static str, layers: f64, wall: f64 },
    /// A core that leaves nothing of a tube's inner part: the radii of the core and of the bore, over that of the pin.
    Core { core: f64, bore: f64 },
}

impl fmt::Display for NoRoom {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match *self {
            NoRoom::Layers { of, layers, wall } => {
                let (layers, wall) = apart(layers, wall);
                write!(
                    out,
                    "the layers of the {of} are {layers} mm thick; they must be thinner than its wall, {wall} mm"
                )
            }
            NoRoom::Core { core, bore } => {
                let (core, bore) = apart(core, bore);
                write!(
                    out,
                    "core_radius_ratio of the tube's inner part is {core}; it must be below bore_radius_ratio, {bore}"
                )
            }
        }
    }
}

/// Significant digits of numbers in a refusal: few, so that a sweep has few different statuses.
const FEWEST_DIGITS: usize = 3;

/// Two numbers with so many digits that they do not read the same; equal to rounding they do.
fn apart(value: f64, limit: f64) -> (String, String) {
    const MOST_DIGITS: usize = 9;
    let of = |digits: usize| [value, limit].map(|number| with_digits(number, digits));
    let digits = (FEWEST_DIGITS..MOST_DIGITS).find(|digits| of(*digits)[0] != of(*digits)[1]);
    let [value, limit] = of(digits.unwrap_or(FEWEST_DIGITS));
    (value, limit)
}

/// As a person writes it: 25, 0.125, 3e-9.
fn with_digits(number: f64, digits: usize) -> String {
    let rounded = format!("{number:.*e}", digits - 1);
    let plain: f64 = rounded.parse().unwrap_or(number);
    if plain == 0.0 || (1e-4..1e7).contains(&plain.abs()) { format!("{plain}") } else { format!("{plain:e}") }
}

/// A pin in a hole with clearance.
#[derive(Clone, Debug)]
pub struct JointDesign {
    pub idealization: Idealization,
    /// R2, mm.
    pub hole_radius: f64,
    /// dR = R2 - R1, mm; 0 is a neat fit, less a press fit.
    pub radial_clearance: f64,
    /// mm.
    pub thickness: f64,
    pub pin: Part,
    pub plate: Part,
}

impl JointDesign {
    /// Whether such a joint can be: sizes and moduli in their ranges, a pin in a plate.
    pub fn check(&self) -> Result<(), Error> {
        check("hole_radius", self.hole_radius, Limits::POSITIVE)?;
        check("radial_clearance", self.radial_clearance, Limits::ANY)?;
        check("thickness", self.thickness, Limits::POSITIVE)?;
        let refuse =
            |quantity: &str, problem: String| Err(Error::Joint { quantity: quantity.to_string(), problem });
        if let Some(problem) = refuse_clearance(self.radial_clearance, self.hole_radius) {
            return refuse("radial_clearance", format!("{}: {problem}", self.radial_clearance));
        }
        for (part, side, what) in [(&self.pin, Side::Pin, "pin"), (&self.plate, Side::Plate, "plate")] {
            if part.shape.side != side {
                return refuse(what, format!("`{}` is not a model of a {what}", part.shape.name));
            }
            for (value, parameter) in part.parameters.into_iter().zip(part.shape.parameters) {
                check(parameter.name, value, Limits::of_parameter(parameter))?;
            }
            check("youngs_modulus", part.material.youngs_modulus, Limits::POSITIVE)?;
            check("poissons_ratio", part.material.poissons_ratio, Limits::POISSONS_RATIO)?;
            if let Some(yield_stress) = part.yield_stress {
                check("yield_stress", yield_stress, Limits::POSITIVE)?;
            }
            match self.no_room(part) {
                Some(NoRoom::Layers { of, layers, wall }) => {
                    let problem = format!("{layers} mm of the {of}: must be below its wall, {wall} mm");
                    return refuse("layers", problem);
                }
                Some(no_room) => return refuse(what, no_room.to_string()),
                None => part.check_layers()?,
            }
        }
        Ok(())
    }

    /// Whether the pin is larger than the hole.
    pub fn is_press_fit(&self) -> bool {
        self.radial_clearance < 0.0
    }

    /// Whether pin and hole are as large as each other.
    pub fn is_neat(&self) -> bool {
        self.radial_clearance == 0.0
    }

    /// Whether it is a press fit in a plate that is not concentric: it presses most anywhere on its ring.
    pub fn is_lopsided_fit(&self) -> bool {
        self.is_press_fit() && !self.plate.shape.concentric
    }

    /// The same load, an offset as the indentation that it is of a joint with clearance: 0 before the bodies touch.
    pub fn from_first_touch(&self, load: Load) -> Load {
        match load {
            Load::Offset(offset) if !self.is_press_fit() => {
                Load::Indentation((offset - self.radial_clearance).max(0.0))
            }
            load => load,
        }
    }

    /// Of the centres, mm, under a load that is answered by an indentation.
    pub fn offset(&self, load: Load, indentation: f64) -> f64 {
        match load {
            Load::Offset(offset) => offset,
            _ => self.radial_clearance + indentation,
        }
    }

    /// The joint as the closed forms see it.
    pub fn pair(&self) -> Result<Pair, LawError> {
        let JointDesign { idealization, hole_radius, radial_clearance, thickness, .. } = *self;
        let [pin, plate] = [&self.pin, &self.plate].map(Part::contact_material);
        Pair::new(hole_radius, radial_clearance, thickness, &pin, &plate, idealization)
    }

    /// The dimensionless body of one half.
    pub fn body(&self, part: &Part) -> Body {
        Body {
            shape: part.shape,
            parameters: part.parameters,
            support: part.support,
            poissons_ratio: part.contact_material().poissons_ratio,
            idealization: self.idealization,
            lining: self.lining(part),
            all_around: self.is_press_fit(),
        }
    }

    /// Of the work that goes into the bodies the pin's, as their moduli have it.
    pub fn share_of_pin(&self) -> f64 {
        let [pin, plate] =
            [&self.pin, &self.plate].map(|part| part.contact_material().plane_modulus(self.idealization));
        plate / (pin + plate)
    }

    pub fn part(&self, side: Side) -> &Part {
        if side == Side::Pin { &self.pin } else { &self.plate }
    }

    /// MPa, of a layer of a part, from 1 at the contact; 0 is the part's own material.
    pub fn youngs_modulus(&self, side: Side, layer: usize) -> f64 {
        self.part(side).layer_material(layer).youngs_modulus
    }

    pub fn layer_counts(&self) -> LayerCounts {
        LayerCounts { pin: self.pin.layers.list().len(), plate: self.plate.layers.list().len() }
    }

    /// Whether a part has layers.
    pub fn is_lined(&self) -> bool {
        !(self.pin.layers.is_empty() && self.plate.layers.is_empty())
    }

    /// What of a part leaves no room for another: its layers must leave something of the part's own material, to rounding, those of a tube
    /// something of the tube, and the core of its inner part something of that part.
    pub fn no_room(&self, part: &Part) -> Option<NoRoom> {
        let (layers, wall) = (part.layers.list(), self.wall(part));
        let is_full = |layers: f64, wall: f64| layers > 0.0 && layers >= (1.0 - 1e-9) * wall;
        let total: f64 = layers.iter().map(|layer| layer.thickness).sum();
        let Some(tube) = layers.iter().position(|layer| layer.is_tube) else {
            let of = if part.shape.side == Side::Pin { "pin" } else { "plate" };
            return is_full(total, wall).then_some(NoRoom::Layers { of, layers: total, wall });
        };
        let on_tube: f64 = layers[..tube].iter().map(|layer| layer.thickness).sum();
        let to_bore = on_tube + layers[tube].thickness;
        if is_full(on_tube, to_bore) {
            return Some(NoRoom::Layers { of: "tube", layers: on_tube, wall: to_bore });
        }
        if is_full(to_bore, wall) {
            let radius = self.contact_radius(part.shape.side);
            return Some(NoRoom::Core { core: 1.0 - wall / radius, bore: 1.0 - to_bore / radius });
        }
        let (in_bore, wall) = (total - to_bore, wall - to_bore);
        is_full(in_bore, wall).then_some(NoRoom::Layers { of: "tube's inner part", layers: in_bore, wall })
    }

    /// How deep a part is below the contact where it is thinnest, mm. Ratios are distances from the centre.
    pub fn wall(&self, part: &Part) -> f64 {
        let ratios = part.parameters.iter().take(part.shape.parameters.len()).copied();
        let of_radius = match part.shape.side {
            Side::Pin => 1.0 - ratios.fold(0.0, f64::max),
            Side::Plate => ratios.fold(f64::INFINITY, f64::min) - 1.0,
        };
        of_radius * self.contact_radius(part.shape.side)
    }

    /// The radius of a part at the contact, mm.
    pub fn contact_radius(&self, side: Side) -> f64 {
        match side {
            Side::Pin => self.hole_radius - self.radial_clearance,
            Side::Plate => self.hole_radius,
        }
    }

    /// The layers of a part without sizes. Radii are rounded to 2^-44, so that joints of another size have the same bodies.
    fn lining(&self, part: &Part) -> Lining {
        const FINENESS: f64 = (1_u64 << 44) as f64;
        let layers = part.layers.list();
        let Some(first) = layers.first() else { return Lining::NONE };
        let outward = if part.shape.side == Side::Plate { 1.0 } else { -1.0 };
        let beyond = layers[1..].iter().map(|layer| layer.material).chain([part.material]);
        let mut depth = 0.0;
        let interface = |(layer, beyond): (&Layer, Material)| {
            depth += layer.thickness;
            let radius_ratio = 1.0 + outward * depth / self.contact_radius(part.shape.side);
            Interface {
                radius_ratio: (radius_ratio * FINENESS).round() / FINENESS,
                modulus_ratio: beyond.youngs_modulus / first.material.youngs_modulus,
                poissons_ratio: beyond.poissons_ratio,
            }
        };
        Lining::new(layers.iter().zip(beyond).map(interface).collect())
    }
}

/// What is allowed of a radial clearance (mm, finite) in a hole of that radius, if it is not.
pub fn refuse_clearance(radial_clearance: f64, hole_radius: f64) -> Option<String> {
    let is_wide = radial_clearance.abs() >= hole_radius;
    is_wide.then(|| {
        let less = if radial_clearance < 0.0 { "the overlap of a press fit must be" } else { "must be" };
        format!("{less} below the hole radius, {hole_radius} mm")
    })
}

/// The quantity a load step prescribes, mm or N, >= 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// The pin's descent after first touch; press fits have none.
    Indentation(f64),
    /// Of the pin, from where pin and hole are concentric; of a press fit from where it is at rest.
    Offset(f64),
    Force(f64),
}

impl Load {
    /// mm or N.
    pub fn value(self) -> f64 {
        match self {
            Load::Indentation(value) | Load::Offset(value) | Load::Force(value) => value,
        }
    }
}

impl fmt::Display for Load {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Load::Indentation(value) => write!(out, "indentation {value} mm"),
            Load::Offset(value) => write!(out, "offset {value} mm"),
            Load::Force(value) => write!(out, "force {value} N"),
        }
    }
}

/// A design with its load steps, in the order of the config.
#[derive(Clone, Debug)]
pub struct DesignCase {
    /// Position in the sweep, from 0.
    pub index: u64,
    pub joint: JointDesign,
    /// Designs that are drawn together may share them.
    pub steps: Arc<[Load]>,
}
