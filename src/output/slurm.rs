//! Two scripts for a Slurm cluster: one task of an array for each shard of a sweep, and a job that merges them.
//!
//! What a user gives to `sbatch` stands in their `#SBATCH` lines, so that the scripts can be submitted again, by hand too.

use crate::error::Error;
use crate::output::shard::MOST_SHARDS;
use crate::output::survey::ranges;

/// The folder of the scripts and of what their jobs print, below the folder of the shards.
pub const FOLDER: &str = "slurm";
pub const ARRAY: &str = "array.sh";
pub const MERGE: &str = "merge.sh";

/// What the scripts are made from; all paths are absolute.
#[derive(Clone, Debug)]
pub struct Job<'a> {
    pub program: &'a str,
    pub config: &'a str,
    /// Of the sweep, for the names of the jobs.
    pub name: &'a str,
    /// `key=value`, each as it was given.
    pub settings: &'a [String],
    /// The folder of the shards.
    pub dir: &'a str,
    pub shards: u64,
    /// What `sbatch` is given, for both scripts.
    pub sbatch: &'a [String],
}

impl Job<'_> {
    /// Refuses what cannot stand in a script, or would change what its tasks are.
    pub fn check(&self) -> Result<(), Error> {
        let refuse = |problem: String| Err(Error::Slurm { problem });
        let paths = [("the program", self.program), ("the config", self.config), ("the folder", self.dir)];
        for (what, text) in
            paths.into_iter().chain(self.sbatch.iter().map(|text| ("an argument", text.as_str())))
        {
            if text.contains(char::is_control) {
                return refuse(format!("{what} {text:?} has a line break or another control character"));
            }
        }
        for argument in self.sbatch {
            let name = argument.split('=').next().unwrap_or_default();
            let is = |long: &str| name.len() >= "--ar".len() && long.starts_with(name);
            if is("--array") || is("--wrap") || (name.starts_with("-a") && !name.starts_with("--")) {
                return refuse(format!(
                    "sbatch's {name} is set by jointsweep: --shards says how many tasks there are"
                ));
            }
        }
        Ok(())
    }

    /// One shard: the number of the task plus the script's argument.
    pub fn array(&self) -> String {
        let settings: String = self.settings.iter().map(|text| format!(" --set={}", quoted(text))).collect();
        let Job { program, config, dir, shards, .. } = self;
        format!(
            "{header}\
             # One shard of a sweep: number SLURM_ARRAY_TASK_ID, plus the first argument where there is one.\n\
             program={program}\n\
             config={config}\n\
             dir={dir}\n\
             shards={shards}\n\
             \n\
             shard=$((SLURM_ARRAY_TASK_ID + ${{1:-0}}))\n\
             \"$program\" run \"$config\"{settings} --shard \"$shard/$shards\" --out \"$dir\" \\\n\
             \x20   --threads \"${{SLURM_CPUS_PER_TASK:-${{SLURM_CPUS_ON_NODE:-1}}}}\"\n\
             {ENDING}",
            header = self.header("", "task-%A_%a.out"),
            program = quoted(program),
            config = quoted(config),
            dir = quoted(dir),
        )
    }

    /// The table, from all shards.
    pub fn merge(&self) -> String {
        format!(
            "{header}\
             # All shards into one table.\n\
             program={program}\n\
             dir={dir}\n\
             \n\
             \"$program\" merge \"$dir\"\n\
             {ENDING}",
            header = self.header("-merge", "merge-%j.out"),
            program = quoted(self.program),
            dir = quoted(self.dir),
        )
    }

    fn header(&self, suffix: &str, output: &str) -> String {
        let name: String = self.name.chars().filter(|letter| !letter.is_control()).collect();
        let name = directive_quoted(&format!("{name}{suffix}"));
        // A folder's own % is no placeholder.
        let output = directive_quoted(&format!("{}/{FOLDER}/{output}", self.dir.replace('%', "%%")));
        let more: String = self.sbatch.iter().map(|text| format!(" {}", directive_quoted(text))).collect();
        let more = if more.is_empty() { more } else { format!("{DIRECTIVE}{more}\n") };
        format!(
            "#!/bin/sh\n\
             {DIRECTIVE} --job-name={name}\n\
             {DIRECTIVE} --output={output} --open-mode=append\n\
             {DIRECTIVE} --requeue\n\
             {more}"
        )
    }
}

const DIRECTIVE: &str = "#SBATCH";

/// Slurm counts a task as failed unless its exit code is 0.
const ENDING: &str = "code=$?\n\
    # 2: all is computed, but some designs failed; their rows say why.\n\
    if [ \"$code\" -eq 2 ]; then exit 0; fi\n\
    exit \"$code\"\n";

/// A word for a shell.
pub fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', r"'\''"))
}

/// A word for a `#SBATCH` line, where `#` ends the line even between quotes.
fn directive_quoted(text: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || " -_=,.:/%@+".contains(letter);
    let escaped: String = text
        .chars()
        .flat_map(|letter| (!is_plain(letter)).then_some('\\').into_iter().chain([letter]))
        .collect();
    format!("\"{escaped}\"")
}

/// Whether two scripts do the same; what `sbatch` is given may differ.
pub fn does_the_same(one: &str, other: &str) -> bool {
    let commands =
        |text: &str| text.lines().filter(|line| !line.starts_with(DIRECTIVE)).map(String::from).collect();
    let [one, other]: [Vec<String>; 2] = [commands(one), commands(other)];
    one == other
}

/// How many shards an array's script is for, and in which folder; `None` where it is no such script.
pub fn read_array(text: &str) -> Option<(u64, String)> {
    let value = |name: &str| text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix('='));
    let dir = value("dir")?.strip_prefix('\'')?.strip_suffix('\'')?.replace(r"'\''", "'");
    let shards = value("shards")?.parse().ok()?;
    (1..=MOST_SHARDS).contains(&shards).then_some((shards, dir))
}

/// Tasks that are submitted together: their shards are `offset` plus these numbers, `3-5,9`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Array {
    pub offset: u64,
    pub tasks: String,
    pub count: usize,
}

/// More tasks in one array would make an argument that is too long for Linux where no two numbers are neighbours.
const MOST_TASKS: u64 = 10_000;

/// Arrays for shards, ascending, none of which has a task above `largest`, which is at least 1.
pub fn arrays(shards: &[u64], largest: u64) -> Vec<Array> {
    let length = largest.clamp(1, MOST_TASKS);
    let offset = |shard: u64| (shard - 1) / length * length;
    let together = shards.chunk_by(|one, next| offset(*one) == offset(*next));
    let array = |shards: &[u64]| {
        let offset = offset(shards[0]);
        let tasks: Vec<u64> = shards.iter().map(|shard| shard - offset).collect();
        Array { offset, tasks: ranges(&tasks), count: tasks.len() }
    };
    together.map(array).collect()
}
