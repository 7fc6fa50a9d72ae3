//! What `sbatch` is asked.

use super::Cluster;

#[test]
fn an_array_of_all_shards_and_a_merge_after_it() {
    let cluster = Cluster::new("submit");
    let ended = cluster.run(&["submit", "big.toml", "--shards", "20", "--", "--time=1:00:00", "-p", "short"]);
    let ended = ended.expect(0);
    assert_eq!(
        cluster.calls(),
        [
            "[--time=1:00:00][-p][short][--parsable][--requeue][--array=1-20][DIR/out/big/slurm/array.sh]",
            "[--time=1:00:00][-p][short][--parsable][--requeue][--dependency=afterok:101]\
             [--kill-on-invalid-dep=yes][DIR/out/big/slurm/merge.sh]",
        ]
    );
    assert!(ended.stdout.contains("job 101: 20 shards\njob 102: the merge"), "{}", ended.stdout);
    assert!(ended.stdout.contains("jointsweep status out/big"), "{}", ended.stdout);
}

/// Slurm's default of MaxArraySize allows numbers up to 1000; this one up to 8.
#[test]
fn more_shards_than_an_array_may_have_are_several_arrays() {
    let cluster = Cluster::new("offset");
    cluster.scontrol("9");
    cluster.run(&["submit", "big.toml", "--shards", "20", "--out", "o"]).expect(0);
    let calls = cluster.calls();
    let array = "[--parsable][--requeue][--array=1-8][DIR/o/slurm/array.sh]";
    assert_eq!(calls[..2], [array.to_string(), format!("{array}[8]")]);
    assert_eq!(calls[2], "[--parsable][--requeue][--array=1-4][DIR/o/slurm/array.sh][16]");
    assert!(calls[3].contains("[--dependency=afterok:101:102:103]"), "{}", calls[3]);
    assert_eq!(calls.len(), 4);

    cluster.shards("o", 20, &[1, 2, 8, 9, 10, 11, 12, 13, 14, 15, 16, 18], &[3]);
    cluster.run(&["resubmit", "o", "--missing"]).expect(0);
    let calls = &cluster.calls()[4..];
    assert_eq!(calls[0], "[--parsable][--requeue][--array=3-7][DIR/o/slurm/array.sh]");
    assert_eq!(calls[1], "[--parsable][--requeue][--array=1,3-4][DIR/o/slurm/array.sh][16]");
    assert!(calls[2].contains("[--dependency=afterok:105:106]"), "{}", calls[2]);
    assert_eq!(calls.len(), 3);
}

#[test]
fn a_cluster_that_cannot_be_asked_is_taken_for_one_with_slurms_defaults() {
    let cluster = Cluster::new("defaults");
    cluster.without("scontrol");
    let config = super::config().replace("count = 20", "count = 2000");
    cluster.work.write("many.toml", &config);
    cluster.run(&["submit", "many.toml", "--shards", "1001", "--out", "o"]).expect(0);
    let calls = cluster.calls();
    assert!(calls[0].contains("[--array=1-1000]") && calls[0].ends_with("array.sh]"), "{calls:?}");
    assert!(calls[1].contains("[--array=1]") && calls[1].ends_with("array.sh][1000]"), "{calls:?}");
    cluster.scontrol("0");
    let said = cluster.run(&["submit", "many.toml", "--shards", "3", "--out", "p"]).expect(1).stderr;
    assert!(said.contains("takes no job arrays"), "{said}");
}

#[test]
fn nothing_is_submitted_of_what_cannot_be_run() {
    let cluster = Cluster::new("refused");
    cluster.work.write("bad.toml", &super::config().replace("0.33", "0.7"));
    let refused = |arguments: &[&str], words: &str| {
        let said = cluster.run(arguments).expect(1).stderr;
        assert!(said.contains(words), "{arguments:?}: {said}");
        assert_eq!(cluster.calls(), [""; 0], "{arguments:?}");
        assert!(!cluster.path("out").exists(), "{arguments:?}");
    };
    refused(&["submit", "bad.toml", "--shards", "2"], "joint.plate.poissons_ratio");
    refused(&["submit", "big.toml", "--shards", "2", "--set", "joint.plate.poissons_ratio=0.7"], "0.7");
    refused(&["submit", "big.toml", "--shards", "0"], "from 1 on");
    refused(&["submit", "big.toml"], "--shards");
    refused(&["submit", "big.toml", "--shards", "21"], "20 at most, one for each design");
    refused(&["submit", "big.toml", "--shards", "2", "--", "--array=1-7"], "sbatch's --array is set by");
    refused(&["submit", "big.toml", "--shards", "2", "--", "-a1-7"], "is set by");
    refused(&["submit", "big.toml", "--shards", "2", "--", "--wrap", "x"], "sbatch's --wrap is set by");
    refused(&["submit", "big.toml", "--shards", "2", "--", "--comment=a\nb"], "line break");
}

#[test]
fn a_dry_run_submits_nothing_and_says_how_it_would() {
    let cluster = Cluster::new("dry");
    cluster.without("sbatch");
    for option in ["--dry-run", "--no-submit"] {
        let arguments = ["submit", "big.toml", "--shards", "20", option, "--", "--comment=two words"];
        let said = cluster.run(&arguments).expect(0).stdout.replace(&cluster.here(), "DIR");
        assert_eq!(
            said,
            "sbatch '--comment=two words' --parsable --requeue --array=1-20 DIR/out/big/slurm/array.sh\n\
             sbatch '--comment=two words' --parsable --requeue --dependency=afterok:JOB1 --kill-on-invalid-dep=yes \
             DIR/out/big/slurm/merge.sh\n"
        );
    }
    assert!(
        cluster.path("out/big/slurm/array.sh").exists() && cluster.path("out/big/slurm/merge.sh").exists()
    );
}

/// The line that is told is run, too: with a `parallel` that only says what it got.
#[test]
fn without_slurm_the_same_shards_run_with_gnu_parallel() {
    let cluster = Cluster::new("parallel");
    cluster.without("sbatch");
    let said = cluster.run(&["submit", "big.toml", "--shards", "3", "--out", "a 'b"]).expect(1).stderr;
    assert!(said.starts_with("error: there is no sbatch here"), "{said}");
    let line = said.lines().find(|line| line.contains("parallel -q")).unwrap();
    cluster.fake("parallel", "cat; printf '[%s]' \"$@\"\n");
    let mut shell = std::process::Command::new("sh");
    shell.args(["-c", line]);
    let got = cluster.run_shell(shell).expect(0).stdout.replace(&cluster.here(), "DIR");
    assert_eq!(got, "1\n2\n3\n[-q][env][SLURM_ARRAY_TASK_ID={}][sh][DIR/a 'b/slurm/array.sh]");
}

#[test]
fn what_sbatch_refuses_is_told_with_what_is_already_submitted() {
    let cluster = Cluster::new("sbatch-refuses");
    let refusing = "case \"$*\" in *merge.sh) echo 'Invalid partition' >&2; exit 1;; esac\necho '12;north'\n";
    cluster.fake("sbatch", refusing);
    let said = cluster.run(&["submit", "big.toml", "--shards", "3"]).expect(1).stderr;
    assert!(said.contains("Invalid partition") && said.contains("`scancel 12`"), "{said}");
    cluster.fake("sbatch", "echo 'all is well'\n");
    let said = cluster.run(&["submit", "big.toml", "--shards", "3"]).expect(1).stderr;
    assert!(said.contains("has not told the job's number but \"all is well\""), "{said}");
}

#[test]
fn another_submission_in_the_same_folder_is_refused() {
    let cluster = Cluster::new("another");
    let submit = |config: &str, shards: &str, more: &[&str]| {
        cluster.run(&[&["submit", config, "--shards", shards, "--out", "o"], more].concat())
    };
    submit("big.toml", "3", &[]).expect(0);
    // The same once more, with another time.
    submit("big.toml", "3", &["--", "--time=5"]).expect(0);
    assert!(cluster.work.read("o/slurm/array.sh").contains("--time=5"));
    let before = cluster.calls().len();
    cluster.work.write("other.toml", &super::config());
    for (config, shards, more) in
        [("big.toml", "4", &[][..]), ("other.toml", "3", &[]), ("big.toml", "3", &["--set", "title=x"])]
    {
        let said = submit(config, shards, more).expect(1).stderr;
        assert!(said.contains("holds the scripts of another submission"), "{said}");
    }
    std::fs::remove_dir_all(cluster.path("o/slurm")).unwrap();
    cluster.shards("o", 7, &[1], &[]);
    let said = submit("big.toml", "3", &[]).expect(1).stderr;
    assert!(said.contains("holds shards of a sweep in 7"), "{said}");
    cluster.run(&["run", "other.toml", "--out", "p", "--quiet"]).expect(0);
    let said = cluster.run(&["submit", "big.toml", "--shards", "3", "--out", "p", "--set", "title=x"]);
    assert!(said.expect(1).stderr.contains("p holds the result of another config"));
    assert_eq!(cluster.calls().len(), before);
    // A result that is there already needs no jobs.
    let said = cluster.run(&["submit", "other.toml", "--shards", "3", "--out", "p"]).expect(0).stdout;
    assert!(said.contains("p/table.csv") && cluster.calls().len() == before, "{said}");
}
