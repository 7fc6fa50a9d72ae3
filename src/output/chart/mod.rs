//! Charts as small SVG texts: lines, points, bars and maps with named axes, a legend below, and colours for light and dark.
//!
//! They are written here and not by a plotting library because their colours are classes of a style sheet: one picture
//! serves a light page, a dark page and paper.

pub mod style;
pub mod text;
pub mod axis;
pub mod frame;
pub mod line_chart;
pub mod map_chart;
pub mod bar_chart;

pub use axis::{Axis, Spacing};
pub use bar_chart::{Bar, BarChart, BarGroup, BarPanel};
pub use line_chart::{LineChart, Marking, Series};
pub use map_chart::{Cell, MapAxis, MapChart};
