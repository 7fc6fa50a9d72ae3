//! `jointsweep completions` and `jointsweep man`: what shells and manuals are told of the command line.

use std::path::PathBuf;

use clap::{Args, Command, CommandFactory};
use clap_mangen::Man;
use jointsweep::Error;
use jointsweep::internals::output::whole_file::{create_dir, write_whole};

use super::{Cli, Ending, print};

#[derive(Args)]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    shell: clap_complete::Shell,
}

#[derive(Args)]
pub struct ManArgs {
    /// Write the pages of all commands into this folder instead
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Overwrite pages that are there
    #[arg(long, requires = "out")]
    force: bool,
}

pub fn completions(args: &CompletionsArgs) -> Result<Ending, Error> {
    let mut script = Vec::new();
    let mut command = Cli::command();
    let name = command.get_name().to_string();
    clap_complete::generate(args.shell, &mut command, name, &mut script);
    print(&String::from_utf8_lossy(&script))?;
    Ok(Ending::Complete)
}

pub fn man(args: &ManArgs) -> Result<Ending, Error> {
    let mut command = Cli::command().disable_help_subcommand(true);
    command.build();
    let Some(dir) = &args.out else {
        let (_, text) = page(&command)?;
        print(&String::from_utf8_lossy(&text))?;
        return Ok(Ending::Complete);
    };
    let mut pages = vec![page(&command)?];
    for subcommand in command.get_subcommands() {
        pages.push(page(subcommand)?);
    }
    if !args.force
        && let Some(path) = pages.iter().map(|(name, _)| dir.join(name)).find(|path| path.exists())
    {
        return Err(Error::FileTaken { path });
    }
    create_dir(dir)?;
    for (name, text) in &pages {
        write_whole(&dir.join(name), text)?;
    }
    print(&format!("{} pages in {}\n", pages.len(), dir.display()))?;
    Ok(Ending::Complete)
}

/// The file name and the text of a command's page.
fn page(command: &Command) -> Result<(String, Vec<u8>), Error> {
    let man = Man::new(command.clone());
    let mut text = Vec::new();
    man.render(&mut text).map_err(|source| Error::Output { source })?;
    Ok((man.get_filename(), text))
}
