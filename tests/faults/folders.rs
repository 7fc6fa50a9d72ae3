//! Folders that are full, read-only or on another file system, and a process that may open little.

use std::os::unix::process::CommandExt;
use std::process::Command;

use crate::common::workdir::{Ended, Workdir};
use crate::config;

/// A script in the folder of the test, with the program as `$P`.
fn script(work: &Workdir, shell: &[&str], text: &str) -> Ended {
    let mut command = Command::new(shell[0]);
    command.args(&shell[1..]).args(["-c", text]).env("P", env!("CARGO_BIN_EXE_jointsweep"));
    Ended::new(command.current_dir(work.path("")).output().unwrap())
}

/// A disk of two megabytes, of which another process makes more when it is full. Where no such disk may be made, a limit on the size of
/// a file stands for it.
#[test]
fn a_full_disk_loses_nothing_and_the_run_goes_on_when_there_is_room() {
    let work = Workdir::new("full");
    work.write("sweep.toml", &config(5_000));
    work.run(&["run", "sweep.toml", "--out", "whole"]).expect(0);
    let own_disks: &[&str] = &["unshare", "-rm", "sh"];
    let may_mount =
        Command::new("unshare").args(["-rm", "true"]).status().is_ok_and(|status| status.success());
    let (shell, small, large) = if may_mount {
        (own_disks, "mount -t tmpfs -o size=2m none disk", "mount -o remount,size=100m disk")
    } else {
        println!("no disk may be made here: a limit on the size of files stands for it");
        (&["sh"][..], "ulimit -S -f 4000", "ulimit -S -f unlimited")
    };
    std::fs::create_dir(work.path("disk")).unwrap();
    let text = format!(
        "{small}; \"$P\" run sweep.toml --out disk/result; echo \"ended with $?\"; cp -r disk/result found; {large}
         \"$P\" run sweep.toml --out disk/result && cp -r disk/result result"
    );
    let ended = script(&work, shell, &text).expect(0);
    assert!(ended.stdout.starts_with("ended with 1\n"), "{}{}", ended.stdout, ended.stderr);
    let told = "error: cannot write disk/result/table.csv.partial: ";
    assert!(ended.stderr.contains(told), "{}", ended.stderr);
    let table = work.read("whole/table.csv");
    let found = work.read("found/table.csv.partial");
    assert!(found.len() > 100_000 && table.starts_with(&found) && found.ends_with('\n'), "{}", found.len());
    assert!(ended.stderr.contains("of 5000 designs were done before; going on"), "{}", ended.stderr);
    assert!(work.read("result/table.csv") == table);
}

#[test]
fn a_folder_that_may_not_be_written_is_an_error_at_once() {
    let work = Workdir::new("read-only");
    work.write("sweep.toml", &config(100));
    std::fs::create_dir(work.path("out")).unwrap();
    let mut permissions = std::fs::metadata(work.path("out")).unwrap().permissions();
    std::os::unix::fs::PermissionsExt::set_mode(&mut permissions, 0o555);
    std::fs::set_permissions(work.path("out"), permissions).unwrap();
    for arguments in [&["run", "sweep.toml"][..], &["run", "sweep.toml", "--shard", "1/2"]] {
        let mut command = work.command(arguments);
        // Who may do everything does it as somebody else.
        if std::process::Command::new("id").arg("-u").output().is_ok_and(|id| id.stdout == b"0\n") {
            command.uid(65534).gid(65534);
        }
        let ended = Ended::new(command.output().unwrap()).expect(1);
        assert!(ended.stderr.starts_with("error: cannot create out/sweep"), "{}", ended.stderr);
    }
    assert_eq!(work.files(), ["sweep.toml"]);
}

/// Nothing is renamed across the borders of file systems.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_on_another_file_system_is_as_good() {
    let work = Workdir::new("elsewhere");
    work.write("sweep.toml", &config(100));
    work.run(&["run", "sweep.toml", "--out", "whole"]).expect(0);
    let elsewhere = format!("/dev/shm/jointsweep-{}", std::process::id());
    for shard in ["1/2", "2/2"] {
        work.run(&["run", "sweep.toml", "--out", &elsewhere, "--shard", shard]).expect(0);
    }
    work.run(&["merge", &elsewhere]).expect(0);
    let table = std::fs::read_to_string(format!("{elsewhere}/table.csv")).unwrap();
    std::fs::remove_dir_all(&elsewhere).unwrap();
    assert!(table == work.read("whole/table.csv"));
}

#[test]
fn twelve_open_files_are_enough() {
    let work = Workdir::new("files");
    work.write("sweep.toml", &config(200));
    work.run(&["run", "sweep.toml", "--out", "whole"]).expect(0);
    let shards =
        "for i in $(seq 30); do \"$P\" run sweep.toml --out parts --shard $i/30 --quiet || exit; done";
    let text =
        format!("ulimit -n 12; \"$P\" run sweep.toml --out one --quiet && {shards} && \"$P\" merge parts");
    script(&work, &["sh"], &text).expect(0);
    for folder in ["one", "parts"] {
        assert!(work.read(&format!("{folder}/table.csv")) == work.read("whole/table.csv"), "{folder}");
    }
}

/// Who hears nothing has his result all the same.
#[test]
fn closed_outputs_are_no_reason_to_lose_a_result() {
    let work = Workdir::new("closed");
    work.write("sweep.toml", &config(200));
    let text = "\"$P\" run sweep.toml --out one >&- 2>&-; \"$P\" run sweep.toml --out two <&- 2>&-";
    script(&work, &["sh"], text);
    work.run(&["run", "sweep.toml", "--out", "whole"]).expect(0);
    for folder in ["one", "two"] {
        assert!(work.read(&format!("{folder}/table.csv")) == work.read("whole/table.csv"), "{folder}");
    }
}
