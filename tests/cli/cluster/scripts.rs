//! The scripts run as a task would run them, with a program that only says what it was given.

use std::process::Command;

use jointsweep::internals::output::slurm::{Array, Job, arrays, quoted, read_array};
use jointsweep::internals::output::survey::ranges;

use super::Cluster;
use crate::common::workdir::Ended;

/// What a careless person calls a folder.
const ODD: &str = "it's \"my\" $HOME `x` #1 %A \\n é";

impl Cluster {
    /// The scripts of a job whose program ends with an exit code, in a folder of an odd name.
    fn scripts(&self, code: i32) -> [String; 2] {
        self.fake("it's a program", &format!("printf '[%s]' \"$@\"; exit {code}\n"));
        let text = |name: &str| self.path(name).to_str().unwrap().to_string();
        let job = Job {
            program: &text("bin/it's a program"),
            config: &text(ODD),
            name: ODD,
            settings: &["title=it's".into(), "a.b=\"$x\"".into()],
            dir: &text(&format!("{ODD}/o")),
            shards: 2000,
            sbatch: &["--comment=it's".into(), "--time".into(), "5".into()],
        };
        job.check().unwrap();
        [job.array(), job.merge()]
    }

    fn shell(&self, shell: &str, script: &str, arguments: &[&str], variables: &[(&str, &str)]) -> Ended {
        self.work.write("script.sh", script);
        let mut command = Command::new(shell);
        command.current_dir("/").arg(self.path("script.sh")).args(arguments);
        for name in ["SLURM_ARRAY_TASK_ID", "SLURM_CPUS_PER_TASK", "SLURM_CPUS_ON_NODE"] {
            command.env_remove(name);
        }
        command.envs(variables.iter().copied());
        self.run_shell(command)
    }
}

#[test]
fn each_task_runs_its_shard_whatever_the_names() {
    let cluster = Cluster::new("scripts");
    let [array, merge] = cluster.scripts(0);
    let given = |arguments: &[&str], variables: &[(&str, &str)]| {
        let words = ["sh", "bash"].map(|shell| {
            let ended = cluster.shell(shell, &array, arguments, variables).expect(0);
            assert_eq!(ended.stderr, "");
            ended.stdout.replace(&cluster.here(), "DIR").replace(ODD, "ODD")
        });
        assert_eq!(words[0], words[1]);
        words[0].clone()
    };
    let expected = |shard: u64, threads: u64| {
        format!(
            "[run][DIR/ODD][--set=title=it's][--set=a.b=\"$x\"][--shard][{shard}/2000][--out][DIR/ODD/o][--threads][{threads}]"
        )
    };
    assert_eq!(given(&[], &[("SLURM_ARRAY_TASK_ID", "7")]), expected(7, 1));
    let on_node = [("SLURM_ARRAY_TASK_ID", "7"), ("SLURM_CPUS_ON_NODE", "16")];
    assert_eq!(given(&["1000"], &on_node), expected(1007, 16));
    let asked = [on_node[0], on_node[1], ("SLURM_CPUS_PER_TASK", "4")];
    assert_eq!(given(&["1000"], &asked), expected(1007, 4));
    let said = cluster.shell("sh", &merge, &[], &[]).expect(0);
    assert_eq!(said.stdout.replace(&cluster.here(), "DIR").replace(ODD, "ODD"), "[merge][DIR/ODD/o]");
}

/// Some designs failed: the shard is complete, and the merge may begin.
#[test]
fn slurm_takes_failed_designs_for_a_success_and_all_else_for_what_it_is() {
    let cluster = Cluster::new("codes");
    for (code, told) in [(0, 0), (2, 0), (1, 1), (130, 130)] {
        for script in cluster.scripts(code) {
            cluster.shell("sh", &script, &[], &[("SLURM_ARRAY_TASK_ID", "1")]).expect(told);
        }
    }
}

/// As Slurm reads these lines: words between double quotes, where a backslash takes the next character as it is and a `#` without one
/// ends the line; `%%` is a percent sign in a file's name. tests/slurm/run asks Slurm itself.
#[test]
fn what_sbatch_is_given_stands_in_lines_that_it_reads() {
    let cluster = Cluster::new("directives");
    let [array, merge] = cluster.scripts(0);
    let lines = |text: &str| -> Vec<String> {
        text.lines().filter_map(|line| line.strip_prefix("#SBATCH ").map(String::from)).collect()
    };
    let name = r#"it\'s \"my\" \$HOME \`x\` \#1 %A \\n é"#;
    let folder = format!("{}/{}", cluster.here(), name.replace('%', "%%"));
    let more = r#""--comment=it\'s" "--time" "5""#;
    let expected = |suffix: &str, output: &str| {
        vec![
            format!("--job-name=\"{name}{suffix}\""),
            format!("--output=\"{folder}/o/slurm/{output}\" --open-mode=append"),
            "--requeue".into(),
            more.into(),
        ]
    };
    assert_eq!(lines(&array), expected("", "task-%A_%a.out"));
    assert_eq!(lines(&merge), expected("-merge", "merge-%j.out"));
    // Slurm looks for them before the first command only.
    for script in [&array, &merge] {
        let first_command = script.lines().position(|line| !line.starts_with('#')).unwrap();
        assert_eq!(script.lines().take(first_command).filter(|line| line.starts_with("#SBATCH")).count(), 4);
    }
}

/// The program's own names, in scripts that it has written.
#[test]
fn the_scripts_of_submit_name_the_program_the_config_and_the_folder_from_the_root_on() {
    let cluster = Cluster::new("absolute");
    cluster.work.write(&format!("{ODD}/big.toml"), &super::config());
    let config = format!("{ODD}/big.toml");
    let arguments =
        ["submit", &config, "--shards", "20", "--out", "./o u'", "--set", "title=it's", "--dry-run"];
    cluster.run(&arguments).expect(0);
    let array = cluster.work.read("o u'/slurm/array.sh");
    let has = |line: &str| array.lines().filter(|other| *other == line).count() == 1;
    assert!(has(&format!("program={}", quoted(env!("CARGO_BIN_EXE_jointsweep")))), "{array}");
    assert!(has(&format!("config={}", quoted(&format!("{}/{config}", cluster.here())))), "{array}");
    assert!(has(&format!("dir={}", quoted(&format!("{}/o u'", cluster.here())))), "{array}");
    assert!(has("shards=20"), "{array}");
    assert!(array.contains(r"--set='title=it'\''s'"), "{array}");
    for (shell, script) in
        ["sh", "bash"].into_iter().flat_map(|shell| [(shell, "array.sh"), (shell, "merge.sh")])
    {
        let mut command = Command::new(shell);
        command.arg("-n").arg(cluster.path(&format!("o u'/slurm/{script}")));
        assert_eq!(cluster.run_shell(command).expect(0).stderr, "");
    }
}

#[test]
fn ranges_and_arrays_have_every_number_once() {
    assert_eq!(ranges(&[]), "");
    assert_eq!(ranges(&[3]), "3");
    assert_eq!(ranges(&[1, 2, 3, 5, 7, 8]), "1-3,5,7-8");
    let array = |offset, tasks: &str, count| Array { offset, tasks: tasks.into(), count };
    assert_eq!(arrays(&[], 10), []);
    assert_eq!(
        arrays(&[10, 11, 20, 21, 35], 10),
        [array(0, "10", 1), array(10, "1,10", 2), array(20, "1", 1), array(30, "5", 1)]
    );
    assert_eq!(arrays(&[1, 2, 3], 1), [array(0, "1", 1), array(1, "1", 1), array(2, "1", 1)]);
    // However large a cluster's arrays, an argument of Linux ends at 128 KiB.
    let odd: Vec<u64> = (0..50_000).map(|half| 2 * half + 1).collect();
    let many = arrays(&odd, 4_000_000);
    assert!(many.iter().all(|array| array.tasks.len() < 100_000), "{}", many.len());
    assert_eq!(many.iter().map(|array| array.count).sum::<usize>(), 50_000);
}

/// As many numbers as a script says would have to be listed.
#[test]
fn a_script_for_more_shards_than_are_allowed_is_none() {
    let [array, _] = Cluster::new("script-counts").scripts(0);
    for (shards, expected) in [
        ("2000", Some(2000)),
        ("100000", Some(100_000)),
        ("100001", None),
        ("18446744073709551615", None),
        ("0", None),
        ("-1", None),
    ] {
        let changed = array.replace("shards=2000", &format!("shards={shards}"));
        assert_eq!(read_array(&changed).map(|(shards, _)| shards), expected, "{shards}");
    }
}
