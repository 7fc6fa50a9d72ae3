//! Slurm's own programs, which are started from here only, and what they are asked.

use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use jointsweep::Error;
use jointsweep::internals::output::slurm::{ARRAY, FOLDER, MERGE, arrays, quoted};

use super::report::plural;
use super::{print, say};

/// What is to be submitted, with the scripts that are in the folder.
pub struct Submission<'a> {
    /// The folder of the shards, absolute.
    pub dir: &'a Path,
    /// Ascending; none when only the merge is left.
    pub shards: &'a [u64],
    /// For array and merge alike.
    pub arguments: &'a [String],
    pub dry_run: bool,
}

impl Submission<'_> {
    /// Submits the shards and, after them, the merge; says what was submitted.
    pub fn submit(&self) -> Result<(), Error> {
        let arrays = arrays(self.shards, largest_task()?);
        let mut jobs = Vec::new();
        for array in &arrays {
            let mut own = vec!["--parsable".into(), "--requeue".into(), format!("--array={}", array.tasks)];
            own.push(self.script(ARRAY));
            if array.offset > 0 {
                own.push(array.offset.to_string());
            }
            let job = self.sbatch(&own, &jobs)?;
            self.tell(&job, &plural(array.count as u64, "shard", "shards"))?;
            jobs.push(job);
        }
        let mut own = vec!["--parsable".to_string(), "--requeue".into()];
        if !jobs.is_empty() {
            own.push(format!("--dependency=afterok:{}", jobs.join(":")));
            own.push("--kill-on-invalid-dep=yes".into());
        }
        own.push(self.script(MERGE));
        let job = self.sbatch(&own, &jobs)?;
        self.tell(
            &job,
            if jobs.is_empty() { "the merge" } else { "the merge, when all of them are complete" },
        )
    }

    fn tell(&self, job: &str, what: &str) -> Result<(), Error> {
        if self.dry_run { Ok(()) } else { print(&format!("job {job}: {what}\n")) }
    }

    fn script(&self, name: &str) -> String {
        self.dir.join(FOLDER).join(name).display().to_string()
    }

    /// Submits one job and returns its number; in a dry run only says how it would be submitted.
    fn sbatch(&self, own: &[String], before: &[String]) -> Result<String, Error> {
        // The last of two equal options counts: jobs depend on what they must, whatever the user says.
        let arguments: Vec<&str> = self.arguments.iter().chain(own).map(String::as_str).collect();
        if self.dry_run {
            let words = arguments.iter().map(|word| shell_word(word)).collect::<Vec<_>>().join(" ");
            print(&format!("sbatch {words}\n"))?;
            return Ok(format!("JOB{}", before.len() + 1));
        }
        let refuse = |problem: String| Error::Slurm { problem: problem + &taken_back(before) };
        let output = match output("sbatch", &arguments) {
            Ok(output) => output,
            Err(error) if error.kind() == ErrorKind::NotFound => return Err(refuse(self.without_slurm())),
            Err(error) => return Err(refuse(format!("cannot start sbatch: {error}"))),
        };
        let [said, complaints] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
        let complaints = complaints.trim();
        if !output.status.success() {
            return Err(refuse(format!("sbatch has refused the job ({}): {complaints}", output.status)));
        }
        if !complaints.is_empty() {
            say(complaints);
        }
        // The number, and the cluster where there are several.
        let job = said.lines().next_back().unwrap_or_default().split(';').next().unwrap_or_default().trim();
        if job.is_empty() || !job.chars().all(|letter| letter.is_ascii_digit()) {
            return Err(refuse(format!("sbatch has not told the job's number but {:?}", said.trim())));
        }
        Ok(job.into())
    }

    /// What to do on a machine that has no Slurm.
    fn without_slurm(&self) -> String {
        // Between the first and the last may be complete ones, which end at once.
        let numbers = match (self.shards.first(), self.shards.last()) {
            (Some(first), Some(last)) => format!("seq {first} {last}"),
            _ => return format!("{WITHOUT}? Here `jointsweep merge` makes the table"),
        };
        let [array, merge] = [ARRAY, MERGE].map(|name| quoted(&self.script(name)));
        let folder = self.dir.join(FOLDER);
        format!(
            "{WITHOUT}? The scripts are in {}. The same shards on this machine, with GNU parallel:\n  {numbers} | parallel -q env SLURM_ARRAY_TASK_ID={{}} sh {array}\n  sh {merge}",
            folder.display(),
        )
    }
}

const WITHOUT: &str = "there is no sbatch here: is this a machine of the cluster";

/// A word as a person would write it.
pub fn shell_word(word: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "-_=,.:/%@+".contains(letter);
    if !word.is_empty() && word.chars().all(is_plain) { word.into() } else { quoted(word) }
}

/// What becomes of jobs that were submitted before an error.
fn taken_back(jobs: &[String]) -> String {
    match jobs {
        [] => String::new(),
        jobs => {
            format!("; submitted before that, without a merge: `scancel {}` takes it back", jobs.join(" "))
        }
    }
}

fn output(program: &str, arguments: &[&str]) -> std::io::Result<Output> {
    Command::new(program).args(arguments).stdin(Stdio::null()).output()
}

/// Slurm's own default of `MaxArraySize`, where it cannot be asked.
const ARRAY_SIZE: u64 = 1001;

/// The largest number that a task of an array may have here.
fn largest_task() -> Result<u64, Error> {
    let asked = output("scontrol", &["show", "config"]).ok().filter(|output| output.status.success());
    let size = asked.and_then(|output| {
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let value = text
            .lines()
            .find_map(|line| line.split_once('=').filter(|(name, _)| name.trim() == "MaxArraySize"));
        value.and_then(|(_, value)| value.trim().parse().ok())
    });
    match size.unwrap_or(ARRAY_SIZE) {
        0 | 1 => Err(Error::Slurm { problem: "this cluster takes no job arrays (MaxArraySize)".into() }),
        size => Ok(size - 1),
    }
}
