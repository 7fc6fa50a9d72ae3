//! `block`: a rectangular plate around the hole, held at its bottom edge (`base`) or at its bottom, sides and top
//! (`outer`).
//!
//! ```text
//!        +-----------+  ^
//!        |           |  | height_ratio
//!        |    ( )    |  v       all over the hole's radius,
//!        |           |  ^       from the hole's centre
//!        |           |  | depth_ratio
//!        +-----------+  v
//!              <-----> half_width_ratio
//! ```

use std::f64::consts::PI;

use super::{Shape, ShapeParameter, Side};

const fn ratio(name: &'static str) -> ShapeParameter {
    ShapeParameter { name, default: None, above: 1.0, below: f64::INFINITY }
}

pub static SHAPE: Shape = Shape {
    name: "block",
    side: Side::Plate,
    parameters: &[ratio("half_width_ratio"), ratio("depth_ratio"), ratio("height_ratio")],
    supports: &["base", "outer"],
    end_angle: PI,
    end_face_held: false,
    depth: |&[half_width, depth, height], angle| {
        let (sine, cosine) = angle.sin_cos();
        let to_side = if sine > 0.0 { half_width / sine } else { f64::INFINITY };
        let to_end = if cosine > 0.0 { depth / cosine } else { -height / cosine };
        to_side.min(to_end.abs()).ln()
    },
    concentric: false,
    reaches_centre: false,
    corners: |&[half_width, depth, height]| vec![half_width.atan2(depth), PI - half_width.atan2(height)],
    straight_boundary: true,
    boundary_held: |support, side| support == 1 || side == 0,
    depth_range: |&[half_width, depth, height]| {
        let to_corner = half_width.hypot(depth.max(height));
        (half_width.min(depth).min(height).ln(), to_corner.ln())
    },
};
