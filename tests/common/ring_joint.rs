//! The config of a small sweep that tests of several programs run.

/// A steel pin around a rigid core in an aluminium ring, by `series`; clearance and load as a config has them.
pub fn ring_joint(radial_clearance: &str, indentation: &str) -> String {
    format!(
        r#"
[joint]
idealization = "plane-stress"
hole_radius = "10 mm"
radial_clearance = {radial_clearance}
thickness = "5 mm"
[joint.pin]
model = "rigid-core"
core_radius_ratio = 0.2
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
[joint.plate]
model = "annulus"
outer_radius_ratio = 3.0
youngs_modulus = "70 GPa"
poissons_ratio = 0.33
[load]
indentation = {indentation}
[solve]
method = "series"
"#
    )
}
