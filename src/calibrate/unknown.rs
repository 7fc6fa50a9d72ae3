//! What of a joint may be fitted to measured points.

use crate::error::{Error, shortened, suggest};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknown {
    PlateYoungsModulus,
    PinYoungsModulus,
    RadialClearance,
    /// Of what the joint is mounted on, in series with it.
    SupportCompliance,
    /// What the measured indentation says at first touch.
    ZeroOffset,
}

impl Unknown {
    pub const ALL: [Unknown; 5] = [
        Unknown::PlateYoungsModulus,
        Unknown::PinYoungsModulus,
        Unknown::RadialClearance,
        Unknown::SupportCompliance,
        Unknown::ZeroOffset,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Unknown::PlateYoungsModulus => "plate_youngs_modulus",
            Unknown::PinYoungsModulus => "pin_youngs_modulus",
            Unknown::RadialClearance => "radial_clearance",
            Unknown::SupportCompliance => "support_compliance",
            Unknown::ZeroOffset => "zero_offset",
        }
    }

    pub fn unit(self) -> &'static str {
        match self {
            Unknown::PlateYoungsModulus | Unknown::PinYoungsModulus => "MPa",
            Unknown::RadialClearance | Unknown::ZeroOffset => "mm",
            Unknown::SupportCompliance => "mm/N",
        }
    }

    /// The dotted key of configs; `None` for what is no part of the joint.
    pub fn key(self) -> Option<&'static str> {
        match self {
            Unknown::PlateYoungsModulus => Some("joint.plate.youngs_modulus"),
            Unknown::PinYoungsModulus => Some("joint.pin.youngs_modulus"),
            Unknown::RadialClearance => Some("joint.radial_clearance"),
            Unknown::SupportCompliance | Unknown::ZeroOffset => None,
        }
    }

    /// By their names, each once.
    pub fn list(names: &[String]) -> Result<Vec<Unknown>, Error> {
        let all = Unknown::ALL.map(Unknown::name);
        let mut list = Vec::new();
        for name in names {
            let name = name.trim();
            let problem = match all.iter().position(|own| *own == name) {
                Some(place) if list.contains(&Unknown::ALL[place]) => "it is named twice".to_string(),
                Some(place) => {
                    list.push(Unknown::ALL[place]);
                    continue;
                }
                None => format!("nothing that can be fitted; {}", suggest(name, &all)),
            };
            return Err(Error::Calibration { problem: format!("`{}`: {problem}", shortened(name)) });
        }
        Ok(list)
    }
}
