//! The command line of jointsweep; everything that prints is here.

mod cli;

fn main() -> std::process::ExitCode {
    cli::main()
}
