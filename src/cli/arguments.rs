//! Arguments that several commands share, and how they are read.

use std::path::Path;
use std::str::FromStr;

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::setting::Setting;

use super::say;

#[derive(Args)]
pub struct SettingArgs {
    /// Another value than the config's, like joint.plate.youngs_modulus="70 GPa" or solve.accuracy=0.1%; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

impl SettingArgs {
    /// The same, and says what of it does nothing.
    pub fn load_and_warn(&self, config: &Path) -> Result<Study, Error> {
        let study = self.load(config)?;
        for useless in study.without_effect() {
            say(&format!("warning: {useless}"));
        }
        Ok(study)
    }

    /// The config with these values.
    pub fn load(&self, config: &Path) -> Result<Study, Error> {
        let settings =
            self.set.iter().map(|text| Setting::parse(text, "--set")).collect::<Result<Vec<_>, _>>()?;
        Study::load_with(config, &settings)
    }
}

/// More threads than any machine of today has processors.
const MOST_THREADS: usize = 1024;

pub fn thread_count(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if (1..=MOST_THREADS).contains(&count) => Ok(count),
        _ => Err(format!("a whole number from 1 to {MOST_THREADS} is needed")),
    }
}

/// A count of things to do, at least one.
pub fn count<T: FromStr + PartialOrd + From<u8>>(text: &str) -> Result<T, String> {
    let number = text.parse().ok().filter(|number| *number >= T::from(1));
    number.ok_or("a whole number from 1 on is needed".into())
}

/// Threads that compute: as asked, or one a processor.
pub fn threads(asked: Option<usize>) -> usize {
    asked.or(std::thread::available_parallelism().ok().map(usize::from)).unwrap_or(1)
}
