//! Writes what docs/config.md and docs/table.md have from the code: every key of a config, every column of a table.
//!
//! ```sh
//! cargo run --example documentation
//! ```

use std::path::Path;

use jointsweep::internals::output::schema;
use jointsweep::internals::study::keys;

/// The end of what is written by hand.
const MARK: &str = "from here on. -->\n";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    for (name, made) in
        [("config.md", keys::documentation()), ("table.md", format!("\n{}", schema::documentation()))]
    {
        let path = docs.join(name);
        let text = std::fs::read_to_string(&path)?;
        let (by_hand, _) =
            text.split_once(MARK).ok_or(format!("{name} has no line that ends with {MARK}"))?;
        std::fs::write(path, format!("{by_hand}{MARK}{made}"))?;
    }
    Ok(())
}
