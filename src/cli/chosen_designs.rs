//! Verbs that write a table of chosen designs of a config, made anew and not read from a result.

use std::path::PathBuf;

use clap::Args;
use jointsweep::internals::output::whole_file;
use jointsweep::{DesignCase, Error, MethodChoice, Options};

use super::arguments::SettingArgs;
use super::explain::nth;
use super::{Ending, print};

#[derive(Args)]
pub struct ChosenDesigns {
    /// The sweep, a TOML file
    config: PathBuf,
    #[command(flatten)]
    settings: SettingArgs,
    /// A design, by its number in the table; may be repeated [default: the only one]
    #[arg(long, value_name = "N")]
    design: Vec<u64>,
    /// The file [default: the terminal]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Overwrite the file
    #[arg(long)]
    force: bool,
}

impl ChosenDesigns {
    /// Writes a header and the lines that `add` makes of each design; `add` says whether all its loads have an answer. `what` closed forms have none of.
    pub fn write(
        &self,
        header: &str,
        what: &str,
        mut add: impl FnMut(&mut String, DesignCase, Options) -> Result<bool, Error>,
    ) -> Result<Ending, Error> {
        let study = self.settings.load(&self.config)?;
        if let Some(path) = self.out.as_ref().filter(|path| !self.force && path.exists()) {
            return Err(Error::FileTaken { path: path.clone() });
        }
        if study.solve.method == MethodChoice::ClosedForm {
            let problem = format!("closed-form: has no {what} of the joint; take auto, series or fe");
            return Err(Error::Joint { quantity: "solve.method".into(), problem });
        }
        let designs = match &self.design[..] {
            [] if study.design_count() == 1 => &[0],
            [] => {
                let problem = format!("one of the {} designs is needed, by its number", study.design_count());
                return Err(Error::Joint { quantity: "--design".into(), problem });
            }
            designs => designs,
        };
        let (mut text, mut ending) = (header.to_string(), Ending::Complete);
        for &design in designs {
            let Some(case) = nth(&study, design)? else {
                return Err(Error::NoSuchDesign { design, count: study.design_count() });
            };
            if !add(&mut text, case, study.solve)? {
                ending = Ending::SomeDesignsFailed;
            }
        }
        match &self.out {
            Some(path) => whole_file::write_whole(path, text.as_bytes())?,
            None => print(&text)?,
        }
        Ok(ending)
    }
}
