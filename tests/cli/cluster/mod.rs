//! A sweep on a Slurm cluster, with `sbatch` and `scontrol` that only write down what they are asked. A real Slurm is in tests/slurm.

mod scripts;
mod shards;
mod submissions;

use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::process::Command;

use crate::common::ring_joint::ring_joint;
use crate::common::workdir::{Ended, Workdir};
use jointsweep::internals::output::shard::{file_name, pack};

/// Twenty designs.
fn config() -> String {
    ring_joint("{ from = \"0.01 mm\", to = \"0.1 mm\", count = 20 }", "\"0.001 mm\"")
}

/// A folder with a config and programs that stand for Slurm's.
struct Cluster {
    work: Workdir,
}

impl Cluster {
    fn new(name: &str) -> Cluster {
        let work = Workdir::new(name);
        work.write("big.toml", &config());
        let cluster = Cluster { work };
        // Each call has a line of words in brackets; the number of a job is that of the call, from 101 on.
        cluster.fake(
            "sbatch",
            "for word in \"$@\"; do printf '[%s]' \"$word\" >> \"$FAKES/calls\"; done\n\
             echo >> \"$FAKES/calls\"\n\
             echo $((100 + $(wc -l < \"$FAKES/calls\")))\n",
        );
        cluster.scontrol("1001");
        cluster
    }

    /// A program that stands for one of Slurm's.
    fn fake(&self, name: &str, script: &str) {
        self.work.write(&format!("bin/{name}"), &format!("#!/bin/sh\nPATH=/usr/bin:/bin\n{script}"));
        let path = self.work.path(&format!("bin/{name}"));
        std::fs::set_permissions(path, PermissionsExt::from_mode(0o755)).unwrap();
    }

    fn scontrol(&self, array_size: &str) {
        self.fake(
            "scontrol",
            &format!(
                "[ \"$*\" = 'show config' ] || exit 1\n\
                 printf 'MaxArrayTasks           = 7\\nMaxArraySize            = {array_size}\\nMaxDBDMsgs = 2\\n'\n"
            ),
        );
    }

    fn without(&self, name: &str) {
        std::fs::remove_file(self.work.path(&format!("bin/{name}"))).unwrap();
    }

    /// A command that finds the fakes, and what else is on `more`.
    fn with_fakes(&self, mut command: Command, more: &str) -> Ended {
        let fakes = self.work.path("bin");
        command.env("PATH", format!("{}{more}", fakes.display())).env("FAKES", fakes);
        Ended::new(command.output().unwrap())
    }

    /// The program, which finds no other Slurm than the fakes.
    fn run(&self, arguments: &[&str]) -> Ended {
        self.with_fakes(self.work.command(arguments), "")
    }

    fn run_shell(&self, command: Command) -> Ended {
        self.with_fakes(command, ":/usr/bin:/bin")
    }

    /// What sbatch was asked, a line a call, with `DIR` for the folder of the tests.
    fn calls(&self) -> Vec<String> {
        let calls = std::fs::read_to_string(self.work.path("bin/calls")).unwrap_or_default();
        calls.lines().map(|line| line.replace(&self.here(), "DIR")).collect()
    }

    fn here(&self) -> String {
        self.work.path("").to_str().unwrap().trim_end_matches('/').to_string()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.work.path(name)
    }

    /// Files as shards leave them, without a row.
    fn shards(&self, dir: &str, of: u64, complete: &[u64], started: &[u64]) {
        let width = of.to_string().len();
        for shard in complete {
            self.work.write(&format!("{dir}/table"), "");
            let manifest = format!(
                r#"{{"config": {{"path": "", "text": ""}}, "version": "", "header_bytes": [], "part":
                    {{"shard": {shard}, "of": {of}, "designs": {{"start": 0, "end": 1}}, "sweep_designs": 1}}}}"#
            );
            let to = self.path(&format!("{dir}/{}", file_name(*shard, of)));
            pack(&[self.path(&format!("{dir}/table"))], manifest.as_bytes(), &to).unwrap();
        }
        for shard in started {
            std::fs::create_dir_all(self.path(&format!("{dir}/shard-{shard:0width$}-of-{of}.partial")))
                .unwrap();
        }
    }
}
