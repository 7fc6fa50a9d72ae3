//! How far the shards are, and which are submitted again.

use super::Cluster;

#[test]
fn status_tells_ranges_and_its_exit_code_whether_all_are_there() {
    let cluster = Cluster::new("status");
    let status = || cluster.run(&["status", "o"]);
    assert!(status().expect(1).stderr.contains("holds no shards"));
    cluster.shards("o", 20, &[1, 2, 3, 9, 20], &[3, 4, 6, 7]);
    let said = status().expect(3).stdout;
    assert_eq!(
        said,
        "complete      5 (1-3,9,20)\n\
         in work       3 (4,6-7)\n\
         not begun     12 (5,8,10-19)\n\
         15 of 20 shards are missing\n\
         a shard whose task was killed counts as in work, too: squeue tells which tasks run\n"
    );
    cluster.shards("o", 20, &(1..=20).collect::<Vec<_>>(), &[]);
    let said = status().expect(0).stdout;
    assert_eq!(
        said,
        "complete      20 (1-20)\nall 20 shards are complete; to make the table: jointsweep merge o\n"
    );
    cluster.shards("o", 21, &[4], &[]);
    assert!(status().expect(1).stderr.contains("there are shards of 20 and shards of 21"));
}

#[test]
fn before_any_shard_has_begun_the_scripts_tell_how_many_there_will_be() {
    let cluster = Cluster::new("not-begun");
    cluster.run(&["submit", "big.toml", "--shards", "20", "--dry-run", "--out", "o"]).expect(0);
    let said = cluster.run(&["status", "o"]).expect(3).stdout;
    assert!(said.starts_with("not begun     20 (1-20)\n20 of 20 shards are missing\n"), "{said}");
    assert!(said.ends_with("jointsweep resubmit o --missing\n"), "{said}");
    cluster.shards("o", 19, &[4], &[]);
    let said = cluster.run(&["status", "o"]).expect(1).stderr;
    assert!(said.contains("shards of a sweep in 19, and scripts for 20"), "{said}");
}

#[test]
fn only_the_missing_shards_are_submitted_again() {
    let cluster = Cluster::new("resubmit");
    let resubmit = |more: &[&str]| cluster.run(&[&["resubmit", "o"], more].concat());
    assert!(resubmit(&["--missing"]).expect(1).stderr.contains("holds no shards"));
    cluster.run(&["submit", "big.toml", "--shards", "20", "--out", "o", "--", "--time=5"]).expect(0);
    assert!(resubmit(&[]).expect(1).stderr.contains("--missing"));
    cluster.shards("o", 20, &[1, 2, 6, 7, 8, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20], &[5]);
    resubmit(&["--missing", "--", "--mem=8G"]).expect(0);
    let calls = &cluster.calls()[2..];
    assert_eq!(
        calls,
        [
            "[--mem=8G][--parsable][--requeue][--array=3-5,9][DIR/o/slurm/array.sh]",
            "[--mem=8G][--parsable][--requeue][--dependency=afterok:103][--kill-on-invalid-dep=yes]\
             [DIR/o/slurm/merge.sh]",
        ]
    );
    // What submit was given is still in the scripts.
    assert!(cluster.work.read("o/slurm/array.sh").contains("\"--time=5\""));

    cluster.shards("o", 20, &[3, 4, 5, 9], &[]);
    resubmit(&["--missing"]).expect(0);
    assert_eq!(cluster.calls()[4..], ["[--parsable][--requeue][DIR/o/slurm/merge.sh]"]);
    cluster.work.write("o/table.csv", "");
    cluster.work.write("o/manifest.json", "");
    let said = resubmit(&["--missing"]).expect(0).stdout;
    assert_eq!(said, "all 20 shards are complete and merged: there is nothing to submit\n");
    assert_eq!(cluster.calls().len(), 5);
}

#[test]
fn a_folder_that_was_moved_is_not_submitted_again() {
    let cluster = Cluster::new("moved");
    cluster.run(&["submit", "big.toml", "--shards", "20", "--dry-run", "--out", "it's o"]).expect(0);
    cluster.run(&["resubmit", "it's o", "--missing"]).expect(0);
    std::fs::rename(cluster.path("it's o"), cluster.path("p")).unwrap();
    let said = cluster.run(&["resubmit", "p", "--missing"]).expect(1).stderr;
    assert!(said.contains("its scripts write to") && said.contains("was it moved?"), "{said}");
    cluster.shards("q", 20, &[4], &[]);
    let said = cluster.run(&["resubmit", "q", "--missing"]).expect(1).stderr;
    assert!(said.contains("cannot read the script of `jointsweep submit`"), "{said}");
    assert_eq!(cluster.calls().len(), 2);
}
