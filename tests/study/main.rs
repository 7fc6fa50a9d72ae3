//! From a config on disk to designs: what sweeps and lists contain, and what each kind of bad input is told.

mod sweeps;
mod lists;
mod refusals;
mod layers;
mod press_fits;

use std::fs;
use std::path::PathBuf;

use jointsweep::internals::study::columns::{Cell, FORCE, joint_columns};
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::design::DesignCase;

const BASE: &str = r#"title = "Test"
[joint]
idealization     = "plane-stress"
hole_radius      = "100 mm"
radial_clearance = "0.1 mm"
thickness        = "1 mm"
[joint.pin]
model          = "rigid-core"
youngs_modulus = "200 GPa"
poissons_ratio = 0.3
[joint.plate]
model              = "annulus"
outer_radius_ratio = 2.0
youngs_modulus     = "200 GPa"
poissons_ratio     = 0.3
[load]
indentation = ["0.1 mm", "0.2 mm"]
[solve]
accuracy = "1 %"
"#;

/// A folder of its own for one test, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("jointsweep-study-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        fs::write(&path, content).unwrap();
        path
    }

    fn study(&self, config: &str) -> Study {
        Study::load(&self.write("config.toml", config)).unwrap_or_else(|error| panic!("{error}\n{config}"))
    }

    /// What a config is refused with, without the folder.
    fn refusal(&self, config: impl AsRef<[u8]>) -> String {
        let path = self.write("config.toml", config.as_ref());
        let shown = String::from_utf8_lossy(config.as_ref()).into_owned();
        match Study::load(&path) {
            Ok(_) => panic!("accepted:\n{shown}"),
            Err(error) => error.to_string().replace(&format!("{}/", self.0.display()), ""),
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// `BASE` with one text replaced by another.
fn with(old: &str, new: &str) -> String {
    assert_eq!(BASE.matches(old).count(), 1, "{old}");
    BASE.replace(old, new)
}

/// `BASE` with [sampling] and other values for the line of some key of [joint].
fn sampled(sampling: &str, lines: &[(&str, &str)]) -> String {
    let mut config = format!("{BASE}[sampling]\n{sampling}\n");
    for (old, new) in lines {
        assert_eq!(config.matches(old).count(), 1, "{old}");
        config = config.replace(old, new);
    }
    config
}

const RADIUS: &str = r#"hole_radius      = "100 mm""#;
const CLEARANCE: &str = r#"radial_clearance = "0.1 mm""#;
const IDEALIZATION: &str = r#"idealization     = "plane-stress""#;
const STEPS: &str = r#"indentation = ["0.1 mm", "0.2 mm"]"#;

fn all(study: &Study) -> Vec<DesignCase> {
    study.cases().unwrap().collect::<Result<_, _>>().unwrap()
}

/// A list of designs, their cells apart by a text, each under this force.
fn written(cases: &[DesignCase], apart: &str, force: &str) -> String {
    let columns = joint_columns(cases[0].joint.layer_counts());
    let names = columns.iter().map(|column| column.name()).chain([FORCE.to_string()]);
    let mut text = names.collect::<Vec<_>>().join(",");
    for case in cases {
        let cells = row(case).into_iter().map(|cell| match cell {
            Cell::Number(number) => number.to_string(),
            Cell::Word(word) => word.to_string(),
            Cell::Empty => String::new(),
        });
        let cells = cells.chain([force.to_string()]).collect::<Vec<_>>();
        text += &format!("\n{}", cells.join(apart));
    }
    text
}

/// A joint as the cells of its row, which compare with ==.
fn row(case: &DesignCase) -> Vec<Cell> {
    joint_columns(case.joint.layer_counts()).iter().map(|column| column.cell(&case.joint)).collect()
}
