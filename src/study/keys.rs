//! Every key of a config, documented: docs/config.md is made from this, and `tests/repository/documentation.rs` holds it to what the reader
//! takes and refuses.

mod answers;

use crate::mechanics::body::{Shape, ShapeParameter, Side, cored_disc};
use crate::mechanics::material::Idealization;
use crate::study::columns::side_name;
use crate::study::config::{MAX_STEPS, MethodChoice};
use crate::study::design::Limits;
use crate::study::layers::MOST_LAYERS;
use crate::study::output_options::{Format, Inputs};
use crate::study::sampling::{MAX_DESIGNS, Scheme};
use crate::study::tube;
use crate::study::units::Dimension;
use crate::study::values::MAX_RANGE;

/// A key with what a person must know to use it.
#[derive(Clone, Debug)]
pub struct ConfigKey {
    /// Of the table it stands in, dotted; empty for the root.
    pub table: String,
    pub name: String,
    pub about: String,
    /// Of its values; "-" where they have none.
    pub unit: &'static str,
    pub allowed: String,
    /// As TOML; `None` where the key must be given, or another one in its place.
    pub default: Option<String>,
    /// Said where there is no default.
    pub needed: &'static str,
    /// As TOML.
    pub example: String,
}

const NEEDED: &str = "needed";
const LENGTH: &str = "length";
const STRESS: &str = "stress";

/// A key that has no default.
fn key(table: &str, name: &str, about: &str, unit: &'static str, allowed: &str, example: &str) -> ConfigKey {
    ConfigKey {
        table: table.into(),
        name: name.into(),
        about: about.into(),
        unit,
        allowed: allowed.into(),
        default: None,
        needed: NEEDED,
        example: example.into(),
    }
}

impl ConfigKey {
    fn default(self, default: &str) -> ConfigKey {
        ConfigKey { default: Some(default.into()), ..self }
    }

    fn needed(self, needed: &'static str) -> ConfigKey {
        ConfigKey { needed, ..self }
    }

    /// The whole dotted key.
    pub fn dotted(&self) -> String {
        if self.table.is_empty() { self.name.clone() } else { format!("{}.{}", self.table, self.name) }
    }
}

/// All keys, in the order of the page. Those of ranges stand in the table `{ }`.
pub fn config_keys() -> Vec<ConfigKey> {
    let mut keys = vec![
        key("", "title", "what manifests and pictures call the sweep", "-", "text", "\"Clevis\"")
            .needed("the file's name"),
        key(
            "joint",
            "idealization",
            "thin parts, or parts long along the axis",
            "-",
            &words(&Idealization::ALL.map(|one| one.name())),
            "\"plane-stress\"",
        ),
        key("joint", "hole_radius", "radius of the hole, R2", LENGTH, &range(Limits::POSITIVE), "\"10 mm\""),
        key(
            "joint",
            "radial_clearance",
            "hole radius less pin radius, dR; 0 is a neat fit, less a press fit",
            LENGTH,
            "of a size below the hole radius",
            "\"0.05 mm\"",
        )
        .needed("needed, or `diametral_clearance`"),
        key(
            "joint",
            "diametral_clearance",
            "hole diameter less pin diameter: twice the radial clearance",
            LENGTH,
            "of a size below the hole diameter",
            "\"0.1 mm\"",
        )
        .needed("instead of `radial_clearance`"),
        key(
            "joint",
            "fit",
            "an ISO 286 fit in the place of a clearance, which then sweeps from the least to the greatest: in a grid both and their mean; \
             `hole_radius` is half the nominal diameter",
            "-",
            "holes H5 to H11 with shafts c, d, e, f, g, h, js, k, m, n, p, r, s or u of the grades 5 to 11, up to 500 mm",
            "\"H7/f7\"",
        )
        .needed("instead of `radial_clearance`"),
        key(
            "joint",
            "thickness",
            "length of the joint along its axis, t",
            LENGTH,
            &range(Limits::POSITIVE),
            "\"8 mm\"",
        ),
    ];
    for side in [Side::Pin, Side::Plate] {
        keys.extend(part_keys(side));
        let part = side_name(side);
        keys.extend(layer_keys(&format!("joint.{part}"), &format!("from the contact into the {part}")));
        if side == Side::Pin {
            keys.extend(inner_keys());
            keys.extend(layer_keys(INNER, "from the bore into the inner part"));
        }
    }
    let schemes = words(&Scheme::NAMES);
    let counts = format!("whole numbers from 1 to {MAX_DESIGNS}");
    let steps = format!("0 or more; at most {MAX_STEPS} steps");
    keys.extend([
        key("load", "indentation", "steps of the pin's descent after first touch", LENGTH, &steps, "[\"1 um\", \"2 um\"]")
            .needed("needed, or `offset` or `force`; press fits have none"),
        key("load", "offset", "steps of the pin's way from where pin and hole are concentric, of a press fit from where it is at rest: the clearance and the indentation", LENGTH, &steps, "[\"0 um\", \"20 um\"]")
            .needed("instead of `indentation`"),
        key("load", "force", "steps of the force of the whole joint", "force", &steps, "{ from = \"10 N\", to = \"10 kN\", count = 20, spacing = \"log\" }")
            .needed("instead of `indentation`"),
        key("designs", "file", "a CSV list of designs, one load case a row, in the place of [joint], [load] and [sampling]; \
             relative to the config's folder", "-", "a file", "\"designs-example.csv\"")
            .needed("needed in [designs]"),
        key("sampling", "method", "how the lists and ranges of [joint] combine: every combination, the first with the first and so on, or \
             as many samples as `count` says", "-", &schemes, "\"sobol\"")
            .default("\"grid\""),
        key("sampling", "count", "designs of the samplers", "-", &counts, "1000").needed("needed for the samplers, and only there"),
        key("sampling", "seed", "another seed, other samples; the same seed, the same ones on every machine", "-", "whole numbers from 0", "1")
            .default("0"),
        key("solve", "accuracy", "of the force, relative; a design that cannot have it says so in its status", "-", "above 0 and below 1 (100 %)", "\"0.3 %\"")
            .default("\"1 %\""),
        key("solve", "method", "the cheapest that is accurate enough, or always this one", "-", &words(&MethodChoice::ALL.map(MethodChoice::name)), "\"fe\"")
            .default("\"auto\""),
        key("solve", "interpolation", "whether large sweeps may interpolate between bodies where that is cheaper", "-", &words(&["auto", "off"]), "\"off\"")
            .default("\"auto\""),
        key("output", "laws", "whether laws are fitted to each design, into laws.csv", "-", "true or false", "false")
            .needed("`true` up to 1,000 designs"),
        key("output", "table", "whether the rows themselves are written, into table.csv", "-", "true or false", "false")
            .needed("`true`; `false` beside [reduce]"),
        key("output", "columns", "columns that the table has; they stand in the order of docs/table.md whatever the order here", "-",
             "a list of columns of docs/table.md", "[\"design\", \"radial_clearance_mm\", \"force_n\"]")
            .needed("all"),
        key("output", "inputs", "which inputs the table has: all, or those that are not the same in all designs; the manifest has the \
             others as `constants`", "-", &words(&Inputs::ALL.map(Inputs::name)), "\"varying\"")
            .default("\"all\""),
        key("output", "format", "the file of the table: table.csv, table.csv.zst or table.parquet", "-", &words(&Format::ALL.map(Format::name)), "\"parquet\"")
            .default("\"csv\""),
    ]);
    keys.extend(answers::answer_keys());
    keys.extend([
        key(RANGE, "from", "the first value", "as the key", "what the key allows", "\"10 N\""),
        key(RANGE, "to", "the last value", "as the key", "what the key allows, above `from`", "\"10 kN\""),
        key(
            RANGE,
            "count",
            "values, both ends included",
            "-",
            &format!("whole numbers from 2 to {MAX_RANGE}"),
            "20",
        )
        .needed("needed; with a sampler there is none, but in [load]"),
        key(
            RANGE,
            "spacing",
            "even steps of the value, or of its logarithm",
            "-",
            &words(&["linear", "log"]),
            "\"log\"",
        )
        .default("\"linear\""),
    ]);
    keys
}

/// The table of ranges, which stand where values stand.
pub const RANGE: &str = "{ }";

fn part_keys(side: Side) -> Vec<ConfigKey> {
    let table = format!("joint.{}", side_name(side));
    let shapes: Vec<&'static Shape> = Shape::of_side(side).collect();
    let mut names: Vec<&str> = shapes.iter().map(|shape| shape.name).collect();
    let example = names[names.len() - 1];
    let (about, of) = match side {
        Side::Pin => (
            "the lower half of a disc, moved by its rigid diameter; or the whole disc, moved by a rigid core; or a hollow pin",
            "pin",
        ),
        Side::Plate => ("a ring, fixed along its outer circle; or a rectangle around the hole", "hole"),
    };
    names.extend((side == Side::Pin).then_some(tube::NAME));
    let mut keys = vec![key(&table, "model", about, "-", &words(&names), &format!("\"{example}\""))];
    for shape in shapes {
        for parameter in shape.parameters {
            let ShapeParameter { name, default, .. } = parameter;
            let about = format!(
                "of `{}`: {} over the {of} radius",
                shape.name,
                name.trim_end_matches("_ratio").replace('_', " ")
            );
            let example = default.map_or("3.0".to_string(), |default| format!("{}", 2.0 * default));
            let needed = key(&table, name, &about, "-", &range(Limits::of_parameter(parameter)), &example);
            keys.push(match default {
                Some(default) => needed.default(&default.to_string()),
                None => ConfigKey { needed: "needed for this model", ..needed },
            });
        }
        if let [first, ..] = shape.supports {
            let about = format!(
                "of `{}`: which of its outer edges are fixed: the bottom, or the bottom, sides and top",
                shape.name
            );
            keys.push(
                key(
                    &table,
                    "support",
                    &about,
                    "-",
                    &words(shape.supports),
                    &format!("\"{}\"", shape.supports[shape.supports.len() - 1]),
                )
                .default(&format!("\"{first}\"")),
            );
        }
    }
    if side == Side::Pin {
        let about = format!(
            "of `{}`: radius of its bore over the pin radius; the bore is held, or has the part of [{INNER}] bonded into it",
            tube::NAME
        );
        let allowed = range(Limits::of_parameter(&cored_disc::SHAPE.parameters[0]));
        keys.push(
            key(&table, "bore_radius_ratio", &about, "-", &allowed, "0.6").needed("needed for this model"),
        );
    }
    keys.extend(material_keys(&table));
    keys
}

fn material_keys(table: &str) -> [ConfigKey; 3] {
    [
        key(table, "youngs_modulus", "Young's modulus, E", STRESS, &range(Limits::POSITIVE), "\"70 GPa\""),
        key(table, "poissons_ratio", "Poisson's ratio, nu", "-", &range(Limits::POISSONS_RATIO), "0.33"),
        yield_stress(table),
    ]
}

/// The table of what is bonded into a tube.
const INNER: &str = "joint.pin.inner";

/// Of it, but for its layers.
fn inner_keys() -> Vec<ConfigKey> {
    let core = &cored_disc::SHAPE.parameters[0];
    let about = format!(
        "what is bonded into the bore of a `{}` and moves it by a rigid core: radius of the core over the pin radius, below that of \
         the bore",
        tube::NAME
    );
    let default = core.default.unwrap_or_default();
    let example = format!("{}", 2.0 * default);
    let core = key(INNER, core.name, &about, "-", &range(Limits::of_parameter(core)), &example)
        .default(&default.to_string());
    std::iter::once(core).chain(material_keys(INNER)).collect()
}

fn yield_stress(table: &str) -> ConfigKey {
    let about = "what von Mises' stress may reach: only for remarks on press fits and for `jointsweep stresses`; one value, which does not sweep";
    key(table, "yield_stress", about, STRESS, &range(Limits::POSITIVE), "\"250 MPa\"").needed("none")
}

/// Of a table of `layers`.
fn layer_keys(part: &str, order: &str) -> Vec<ConfigKey> {
    let table = format!("{part}.layers");
    let about = format!(
        "thickness of a layer, bonded to the next; [[{table}]] stands once for each layer, {order}, at most {MOST_LAYERS} times"
    );
    vec![
        key(&table, "thickness", &about, LENGTH, &range(Limits::POSITIVE), "\"1 mm\"")
            .needed("needed, or `thickness_ratio`"),
        key(
            &table,
            "thickness_ratio",
            "the same over the radius at the contact",
            "-",
            &range(Limits::POSITIVE),
            "0.1",
        )
        .needed("instead of `thickness`"),
        key(&table, "youngs_modulus", "of the layer", STRESS, &range(Limits::POSITIVE), "\"3 GPa\""),
        key(&table, "poissons_ratio", "of the layer", "-", &range(Limits::POISSONS_RATIO), "0.4"),
        yield_stress(&table),
    ]
}

fn words(words: &[&str]) -> String {
    words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ")
}

/// As complaints say it.
fn range(limits: Limits) -> String {
    let problem = limits.refuse(f64::NAN).err().unwrap_or_default();
    problem.trim_start_matches("must be ").to_string()
}

/// As a section with a table for each table of the config, in Markdown.
pub fn documentation() -> String {
    let mut text = String::new();
    let mut last = None;
    for key in config_keys() {
        if last.as_ref() != Some(&key.table) {
            let heading = match key.table.as_str() {
                "" => "At the top".to_string(),
                RANGE => "In a range `{ }`".to_string(),
                table if table.ends_with("layers") => format!("`[[{table}]]`"),
                table => format!("`[{table}]`"),
            };
            text += &format!(
                "\n## {heading}\n\n| key | meaning | unit | allowed | default | example |\n|---|---|---|---|---|---|\n"
            );
            last = Some(key.table.clone());
        }
        let default = key.default.map_or(key.needed.to_string(), |default| format!("`{default}`"));
        let ConfigKey { name, about, unit, allowed, example, .. } = key;
        text += &format!("| `{name}` | {about} | {unit} | {allowed} | {default} | `{example}` |\n");
    }
    text += "\n## Units\n\n| of | written as | in tables |\n|---|---|---|\n";
    for dimension in Dimension::ALL {
        // The micro sign is also the Greek letter, which looks the same.
        let mut units = dimension.unit_names();
        units.retain(|unit| !unit.contains('\u{3bc}'));
        text += &format!("| {} | {} | {} |\n", dimension.name(), words(&units), dimension.unit());
    }
    text
}
