//! `jointsweep export`: from a result to a table for another simulator.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use jointsweep::Error;
use jointsweep::internals::engine::explain::percent;
use jointsweep::internals::output::export::impact::ImpactRequest;
use jointsweep::internals::output::export::source::{Reference, Selection};
use jointsweep::internals::output::export::{Export, FORMATS, Request, export, format};
use jointsweep::internals::output::results::Results;
use jointsweep::internals::study::units::{Dimension, parse_percentage, parse_quantity};

use super::{Ending, print, say};

#[derive(Args)]
pub struct ExportArgs {
    /// Folder of a finished run
    dir: PathBuf,
    /// The format; they are listed below
    #[arg(long, value_name = "FORMAT")]
    to: String,
    /// The design, by its number in the table [default: the only one]
    #[arg(long, value_name = "N", conflicts_with = "over")]
    design: Option<u64>,
    /// A table of all designs, over this quantity and the indentation; they differ in nothing else
    #[arg(long, value_enum, value_name = "QUANTITY")]
    over: Option<OverQuantity>,
    /// What the indentation is measured from
    #[arg(long, value_enum, value_name = "REFERENCE", default_value_t = ReferenceChoice::Support)]
    reference: ReferenceChoice,
    /// The file [default: DIR/NAME with the format's ending]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// How far the simulator's own interpolation may be off, relative to the force
    #[arg(long, value_name = "ERROR", default_value = "0.1 %", allow_hyphen_values = true)]
    error: String,
    /// Name of the functions, tables and files
    #[arg(long, value_name = "NAME", default_value = "joint")]
    name: String,
    /// With damping: speed after an impact over the speed before
    #[arg(long, value_name = "E", requires = "speed", allow_negative_numbers = true)]
    restitution: Option<f64>,
    /// Speed before the impact, like "100 mm/s"
    #[arg(long, value_name = "V", requires = "restitution", allow_hyphen_values = true)]
    speed: Option<String>,
    /// End of the table, like "0.1 mm" [default: the largest indentation of the designs]
    #[arg(long, value_name = "INDENTATION", allow_hyphen_values = true)]
    up_to: Option<String>,
    /// Take rows that are answered with a remark
    #[arg(long)]
    allow_warned: bool,
    /// Overwrite files
    #[arg(long)]
    force: bool,
    /// Print nothing but errors and warnings
    #[arg(long)]
    quiet: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum OverQuantity {
    RadialClearance,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ReferenceChoice {
    /// The pin's rigid part against the plate's support, as in the table
    Support,
    /// The mean motion of the pin's ring against the hole's: for bodies that are flexible themselves
    RingMean,
}

pub fn run(args: &ExportArgs) -> Result<Ending, Error> {
    let format = format(&args.to)?;
    let results = Results::open(&args.dir)?;
    let refuse = |what: &str, problem: String| Error::Export { what: what.into(), problem };
    let error = match args.error.parse::<f64>() {
        Ok(fraction) => fraction,
        Err(_) => parse_percentage(&args.error).map_err(|problem| refuse("--error", problem))?,
    };
    let up_to = match &args.up_to {
        None => None,
        Some(text) => {
            let end = parse_quantity(text, Dimension::Length);
            Some(end.map_err(|problem| refuse("--up-to", format!("`{text}`: {problem}")))?)
        }
    };
    let impact = match (args.restitution, &args.speed) {
        (Some(restitution), Some(speed)) => Some(ImpactRequest { restitution, speed: in_mm_per_s(speed)? }),
        _ => None,
    };
    let request = Request {
        format,
        selection: match (args.design, args.over) {
            (Some(number), _) => Selection::Design(number),
            (None, Some(OverQuantity::RadialClearance)) => Selection::OverRadialClearance,
            (None, None) => Selection::Only,
        },
        reference: match args.reference {
            ReferenceChoice::Support => Reference::Support,
            ReferenceChoice::RingMean => Reference::RingMean,
        },
        error,
        name: args.name.clone(),
        impact,
        up_to,
        allow_warned: args.allow_warned,
        out: args.out.clone(),
    };
    let export = export(&results, &request)?;
    export.write(&results, args.force)?;
    if !args.quiet {
        print(&told(&export))?;
    }
    if let Some(between) = export.quality.between.filter(|between| *between > error) {
        say(&format!(
            "warning: half way between clearances the force is off by up to {}: clearances nearer to each other make it less, but not across zero",
            percent(between)
        ));
    }
    Ok(Ending::Complete)
}

/// What `jointsweep help export` says of the formats.
pub fn formats() -> String {
    let mut text = String::from("Formats:\n");
    for format in FORMATS {
        let over = if format.two_dimensional { "; --over" } else { "" };
        let damping = if format.damping { "; --restitution" } else { "" };
        text += &format!("  {:<12} {}{over}{damping}\n", format.name, format.about);
    }
    text
}

fn told(export: &Export) -> String {
    let quality = &export.quality;
    let over = match export.clearances {
        1 => String::new(),
        count => format!(" for each of {count} clearances"),
    };
    let mut text = format!(
        "{} points{over}: within {} of the curve between them",
        export.points,
        percent(quality.of_force)
    );
    if let Some(impact) = &export.impact {
        text += &format!(
            "; an impact at {} mm/s rebounds with {:.3} of its speed",
            impact.asked.speed, impact.restitution
        );
    }
    text += "\n";
    for (path, _) in &export.files {
        text += &format!("{}\n", path.display());
    }
    text
}

/// "0.1 m/s", "100 mm/s", or a plain number of mm/s.
fn in_mm_per_s(text: &str) -> Result<f64, Error> {
    let trimmed = text.trim();
    let (number, factor) = match (trimmed.strip_suffix("mm/s"), trimmed.strip_suffix("m/s")) {
        (Some(number), _) => (number, 1.0),
        (None, Some(number)) => (number, 1000.0),
        (None, None) => (trimmed, 1.0),
    };
    let problem = || format!("`{text}`: a speed is written like \"100 mm/s\" or \"0.1 m/s\"");
    let value: Result<f64, _> = number.trim().parse();
    value
        .map(|value| factor * value)
        .map_err(|_| Error::Export { what: "--speed".into(), problem: problem() })
}
