//! `exudyn`: the Python module with a user function for Exudyn's `CartesianSpringDamper`
//! (ObjectConnectorCartesianSpringDamper, `springForceUserFunction`: Exudyn's documentation, chapter "Objects
//! (Connector)"). The plain SpringDamper fails at zero length.

use super::hermite_text::damping;
use super::python::module;
use super::sheet::{Format, Sheet};

pub static FORMAT: Format = Format {
    name: "exudyn",
    suffix: "_exudyn.py",
    about: "a Python module with a user function for Exudyn's CartesianSpringDamper",
    write,
    ..Format::HERMITE
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let (clearance, pass) = match sheet.is_family() {
        true => ("radial_clearance_mm", ", radial_clearance_mm"),
        false => ("radial_clearance_mm=RADIAL_CLEARANCE_MM", ""),
    };
    let gap = if sheet.goes_below_zero() { "max(radial_clearance_mm, 0.0)" } else { "radial_clearance_mm" };
    let mut function = USER_FUNCTION.replace("@clearance@", clearance).replace("@pass@", pass);
    function = function.replace("@gap@", gap);
    let factor = match damping(sheet) {
        Some(factor) => DAMPED.replace("@factor@", &factor),
        None => String::new(),
    };
    function = function.replace("@damping@", &factor);
    if !sheet.is_family() {
        function += "\n\n#: For models in m and N.\nUF = make_user_function()\n";
    }
    vec![("", module(sheet) + &function)]
}

const USER_FUNCTION: &str = "

def make_user_function(@clearance@, mm_per_unit=1000.0):
    \"\"\"For CartesianSpringDamper(..., springForceUserFunction=make_user_function()): the joint in the plane x, y of marker 0.
    The markers are the centres of hole and pin. `mm_per_unit`: 1000 for models in m, 1 for models in mm.\"\"\"

    def user_function(mbs, t, itemNumber, displacement, velocity, stiffness, damping, offset):
        x, y = displacement[0] - offset[0], displacement[1] - offset[1]
        distance = (x * x + y * y) ** 0.5
        indentation = distance * mm_per_unit - @gap@
        if indentation <= 0.0:
            return [0.0, 0.0, 0.0]
        magnitude = force(indentation@pass@)
@damping@        return [magnitude * x / distance, magnitude * y / distance, 0.0]

    return user_function
";

const DAMPED: &str = "        speed = (velocity[0] * x + velocity[1] * y) / distance * mm_per_unit
        magnitude *= max(0.0, 1.0 + @factor@ * speed)
";
