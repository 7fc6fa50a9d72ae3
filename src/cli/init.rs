//! `jointsweep init`: a config to start from.

use std::path::PathBuf;

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::output::whole_file::write_whole;

use super::{Ending, print};

#[derive(Args)]
pub struct InitArgs {
    /// The config to write
    #[arg(default_value = "joint.toml")]
    file: PathBuf,
    /// Overwrite a file that is there
    #[arg(long)]
    force: bool,
}

const CONFIG: &str = include_str!("init.toml");

pub fn init(args: &InitArgs) -> Result<Ending, Error> {
    // A link that leads nowhere is somebody's, too.
    if !args.force && args.file.symlink_metadata().is_ok() {
        return Err(Error::FileTaken { path: args.file.clone() });
    }
    write_whole(&args.file, CONFIG.as_bytes())?;
    let file = args.file.display();
    print(&format!("{file}\nnext: edit it, then jointsweep run {file}\n"))?;
    Ok(Ending::Complete)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use jointsweep::internals::study::config::Study;

    use super::*;

    /// What stands in a comment must hold, too: each alternative is put in the place of what it is for.
    #[test]
    fn the_config_and_its_alternatives_are_read() {
        let study = |text: &str| Study::from_text(Path::new("joint.toml"), text.into());
        let designs =
            |text: String| study(&text).map(|study| (study.design_count(), study.steps_per_design()));
        assert_eq!(designs(CONFIG.into()).unwrap(), (2, 20));
        let block = CONFIG
            .replace("model              = \"annulus\"", "# model =")
            .replace("outer_radius_ratio = 3.0", "# outer_radius_ratio =")
            .replace("# model            = \"block\"", "model = \"block\"");
        let block = ["half_width_ratio", "depth_ratio     ", "height_ratio    ", "support         "]
            .iter()
            .fold(block, |text, key| text.replace(&format!("# {key}"), key));
        assert_eq!(designs(block.clone()).unwrap(), (2, 20));
        assert!(block.contains("\nsupport "));
        let indentation = CONFIG.replace("\nforce =", "\n# force =").replace("# indentation", "indentation");
        assert_eq!(designs(indentation).unwrap(), (2, 2));
        let sobol = ["# [sampling]", "# method = \"sobol\"", "# count  =", "# seed   ="]
            .iter()
            .fold(CONFIG.to_string(), |text, line| text.replace(line, line.trim_start_matches("# ")));
        assert_eq!(designs(sobol).unwrap(), (1000, 20));
        let solve = CONFIG.replace("# method = \"series\"", "method = \"series\"");
        assert_eq!(designs(solve.replace("# interpolation", "interpolation")).unwrap(), (2, 20));
    }
}
