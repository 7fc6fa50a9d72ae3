//! The colours of charts: one style sheet for pages and for pictures by themselves.

use std::fmt::Write as _;

/// Colours of series, light and dark: told apart by most eyes, at least 3:1 against the paper.
const SERIES: [(&str, &str); 8] = [
    ("#0b62b0", "#6cb2f5"),
    ("#c2410c", "#fb9a63"),
    ("#1a7f4b", "#5fd39a"),
    ("#8b3fa8", "#d59bee"),
    ("#8a6a00", "#e3c04a"),
    ("#b3124a", "#ff85a8"),
    ("#0f7c86", "#5ccfda"),
    ("#57606a", "#b3bcc6"),
];

/// How many colours of series there are.
pub const COLOURS: usize = SERIES.len();

const PAPER: (&str, &str) = ("#ffffff", "#14181d");
const INK: (&str, &str) = ("#1f2328", "#e6e9ec");
const FAINT: (&str, &str) = ("#59636e", "#a3adb8");
const GRID: (&str, &str) = ("#dfe3e8", "#333b45");

/// Classes: `s1` ... are strokes and `f1` ... fills of series; the others are named by what they colour.
pub fn style_sheet() -> String {
    let (light, dark) = (classes(|pair| pair.0), classes(|pair| pair.1));
    format!(
        "svg.chart text{{font-family:system-ui,\"Segoe UI\",Helvetica,Arial,sans-serif;font-size:13px}}\n\
         svg.chart .line{{fill:none;stroke-width:2;stroke-linejoin:round}}\n\
         svg.chart .dashed{{stroke-dasharray:6 4;stroke-width:1.6}}\n\
         svg.chart .dotted{{stroke-dasharray:2 3;stroke-width:1.6}}\n\
         svg.chart .dot{{stroke-width:1.6}}\n\
         svg.chart .bar{{stroke:none}}\n\
         svg.chart rect{{shape-rendering:crispEdges}}\n\
         {light}@media screen and (prefers-color-scheme:dark){{\n{dark}}}\n"
    )
}

fn classes(choose: impl Fn((&'static str, &'static str)) -> &'static str) -> String {
    let mut css = String::new();
    let mut rule = |name: &str, what: &str, colour: &str| {
        _ = writeln!(css, "svg.chart .{name}{{{what}:{colour}}}");
    };
    rule("paper", "fill", choose(PAPER));
    rule("ink", "fill", choose(INK));
    rule("faint", "fill", choose(FAINT));
    rule("axis", "stroke", choose(FAINT));
    rule("grid", "stroke", choose(GRID));
    rule("dot", "fill", choose(PAPER));
    rule("limit", "stroke", choose(INK));
    for (place, pair) in SERIES.iter().enumerate() {
        rule(&format!("s{}", place + 1), "stroke", choose(*pair));
        rule(&format!("f{}", place + 1), "fill", choose(*pair));
    }
    css
}

/// Colours of a page around its charts, as variables.
pub fn page_variables() -> String {
    let set = |choose: fn((&'static str, &'static str)) -> &'static str| {
        let mut css = format!(
            "--paper:{};--ink:{};--faint:{};--line:{};",
            choose(PAPER),
            choose(INK),
            choose(FAINT),
            choose(GRID)
        );
        for (place, pair) in SERIES.iter().enumerate() {
            _ = write!(css, "--s{}:{};", place + 1, choose(*pair));
        }
        css
    };
    format!(
        ":root{{{}}}\n@media screen and (prefers-color-scheme:dark){{:root{{{}}}}}\n",
        set(|pair| pair.0),
        set(|pair| pair.1)
    )
}

/// Corners of a scale from dark to bright that eyes read evenly, without red against green (viridis).
const SCALE: [[f64; 3]; 6] = [
    [68.0, 1.0, 84.0],
    [65.0, 68.0, 135.0],
    [42.0, 120.0, 142.0],
    [34.0, 168.0, 132.0],
    [122.0, 209.0, 81.0],
    [253.0, 231.0, 37.0],
];

/// The colour of a share from 0 to 1.
pub fn scale_colour(share: f64) -> String {
    // NaN counts as zero.
    let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
    let place = share * (SCALE.len() - 1) as f64;
    let below = (place as usize).min(SCALE.len() - 2);
    let between = place - below as f64;
    let [r, g, b] = [0, 1, 2]
        .map(|c| (SCALE[below][c] + between * (SCALE[below + 1][c] - SCALE[below][c])).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_goes_from_end_to_end() {
        assert_eq!(scale_colour(0.0), "#440154");
        assert_eq!(scale_colour(1.0), "#fde725");
        assert_eq!(scale_colour(-3.0), scale_colour(0.0));
        assert_eq!(scale_colour(f64::NAN), scale_colour(0.0));
        assert_eq!(scale_colour(0.4), "#2a788e");
    }

    /// Contrast by WCAG 2: (L1 + 0.05)/(L2 + 0.05).
    #[test]
    fn lines_and_words_are_seen_on_their_paper() {
        let luminance = |colour: &str| {
            let part = |at: usize| {
                let c = f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap()) / 255.0;
                if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
            };
            0.2126 * part(1) + 0.7152 * part(3) + 0.0722 * part(5)
        };
        let contrast = |one: &str, other: &str| {
            let (a, b) = (luminance(one), luminance(other));
            (a.max(b) + 0.05) / (a.min(b) + 0.05)
        };
        let mut seen = 0;
        for (light, dark) in SERIES.into_iter().chain([INK, FAINT]) {
            assert!(contrast(light, PAPER.0) > 4.5, "{light}: {}", contrast(light, PAPER.0));
            assert!(contrast(dark, PAPER.1) > 4.5, "{dark}: {}", contrast(dark, PAPER.1));
            seen += 1;
        }
        assert_eq!(seen, 10);
    }
}
