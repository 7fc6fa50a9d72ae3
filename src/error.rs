//! One error type. Each variant carries the values that explain it: what, where, which value, what is allowed.

use std::path::PathBuf;

#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("cannot {action} {path}: {source}", path = path.display())]
    Io { action: &'static str, path: PathBuf, source: std::io::Error },

    #[error("cannot write to standard output: {source}")]
    Output { source: std::io::Error },

    /// `threads` is how many were asked for at once.
    #[error("cannot start {threads} more thread{}: {problem}", if *threads == 1 { "" } else { "s" })]
    Threads { threads: usize, problem: String },

    /// Something a person wrote in a config or a list of designs. `key` is the dotted key or the column, empty
    /// when the whole line is meant; `line` counts from 1.
    #[error("{}{}", place(file, *line, key), problem)]
    Input { file: PathBuf, line: Option<u64>, key: String, problem: String },

    /// `occupant` is what an earlier run, or somebody else, left in the folder.
    #[error("{} holds {occupant}", dir.display())]
    FolderTaken { dir: PathBuf, occupant: String },

    /// `problem` is whose unfinished result is there, and who wants to go on with it.
    #[error("{} holds {problem}", dir.display())]
    CannotGoOn { dir: PathBuf, problem: String },

    /// `holder` in the words of the run that has it; empty where they cannot be read.
    #[error("{} is in use by another run{}", dir.display(), in_brackets(holder))]
    FolderInUse { dir: PathBuf, holder: String },

    /// A folder whose shards cannot be put together.
    #[error("{}: {problem}", dir.display())]
    NoShards { dir: PathBuf, problem: String },

    #[error("{} is damaged: {problem}", path.display())]
    DamagedShard { path: PathBuf, problem: String },

    #[error("{} is the list of designs and would be overwritten", path.display())]
    DesignsInTheWay { path: PathBuf },

    /// Something that a command reads stands where it would write.
    #[error("{} is read and would be overwritten", path.display())]
    InputInTheWay { path: PathBuf },

    /// Measured points that cannot be fitted as asked.
    #[error("{problem}")]
    Calibration { problem: String },

    #[error("none of {looked_for} is here: name the configs to measure")]
    NothingToMeasure { looked_for: String },

    #[error("none of the designs can be compared: {reason}")]
    NothingToCompare { reason: String },

    #[error("{}: the run to measure failed: {problem}", config.display())]
    MeasuredRun { config: PathBuf, problem: String },

    /// What was asked does not go together.
    #[error("{problem}")]
    Asked { problem: String },

    /// Jobs that cannot be submitted, or not as asked.
    #[error("{problem}")]
    Slurm { problem: String },

    /// A GPU that does not answer as the processor does: no figure of it is worth anything.
    #[error("{adapter} is wrong in {precision}: {problem}")]
    WrongAnswer { adapter: String, precision: &'static str, problem: String },

    #[error("{adapter} is not measured in {precision}: {problem}")]
    NotMeasured { adapter: String, precision: &'static str, problem: String },

    #[error("{problem}")]
    Adapter { problem: String },

    /// `design` as in the table.
    #[error("there is no design {design}: the sweep has {count}, counted from 0")]
    NoSuchDesign { design: u64, count: u64 },

    #[error("{} is there already", path.display())]
    FileTaken { path: PathBuf },

    /// A folder that holds no result of a finished run.
    #[error("{}: {problem}", dir.display())]
    NoResult { dir: PathBuf, problem: String },

    #[error("{asked} designs are too many for one report: {most} at most")]
    TooManyDesigns { asked: usize, most: usize },

    /// A joint that cannot be, or has no answer; the quantity is empty where the whole joint is meant.
    #[error("{}{problem}", if quantity.is_empty() { String::new() } else { format!("{quantity}: ") })]
    Joint { quantity: String, problem: String },

    /// A table for another simulator that cannot be made as asked; `what` is the option or the part of the result.
    #[error("{what}: {problem}")]
    Export { what: String, problem: String },

    #[error("cannot draw the plot: {problem}")]
    Plot { problem: String },
}

fn in_brackets(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!(" ({text})") }
}

/// `file:line: key: `, without the parts that are not known.
fn place(file: &std::path::Path, line: Option<u64>, key: &str) -> String {
    let line = line.map_or(String::new(), |line| format!("{line}:"));
    let key = if key.is_empty() { String::new() } else { format!("{key}: ") };
    format!("{}:{line} {key}", file.display())
}

/// What is echoed of a text that a person has written: its beginning, and that it goes on.
pub fn shortened(text: &str) -> String {
    shortened_to(text, LONGEST_ECHO)
}

/// The beginning of a text, of as many characters.
pub fn shortened_to(text: &str, length: usize) -> String {
    match text.char_indices().nth(length) {
        None => text.to_string(),
        Some((end, _)) => format!("{}...", &text[..end]),
    }
}

/// Characters.
const LONGEST_ECHO: usize = 80;

/// "did you mean `x`? Allowed: `x`, `y`", or only what is allowed when nothing is near `word`.
pub fn suggest(word: &str, allowed: &[&str]) -> String {
    suggest_from(word, allowed, &quoted(allowed))
}

/// The same, what is allowed being `listed` in fewer words.
pub fn suggest_from(word: &str, allowed: &[&str], listed: &str) -> String {
    match nearest(word, allowed) {
        Some(near) => format!("did you mean `{near}`? Allowed: {listed}"),
        None => format!("allowed: {listed}"),
    }
}

/// "`x`, `y`".
pub fn quoted(words: &[&str]) -> String {
    words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ")
}

/// The word a person most likely meant: at least 60 % alike whatever the case, or one part of the other.
fn nearest<'a>(word: &str, allowed: &[&'a str]) -> Option<&'a str> {
    // No slip of the pen is as long as this, and likeness takes time.
    if word.len() > LONGEST_ECHO {
        return None;
    }
    let word = word.to_lowercase();
    let likeness = |candidate: &str| {
        let candidate = candidate.to_lowercase();
        let alike = strsim::normalized_damerau_levenshtein(&word, &candidate);
        let part = word.len() >= 3 && (candidate.contains(&word) || word.contains(&candidate));
        if part { alike.max(0.6) } else { alike }
    };
    let scored = allowed.iter().map(|&candidate| (candidate, likeness(candidate)));
    let best = scored.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (best.1 >= 0.6).then_some(best.0)
}
