//! `vpost watch`: a drop folder.

#![cfg(unix)]

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::common::{messages, root, vpost};
use crate::folders::{PROFILE, copy, program, temporaries, tree};

struct Shop {
    folder: tempfile::TempDir,
    machine: PathBuf,
}

impl Shop {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::create_dir(folder.path().join("in")).expect("a new folder");
        Self { folder, machine: root().join(PROFILE) }
    }

    fn input(&self, name: &str) -> PathBuf {
        self.folder.path().join("in").join(name)
    }

    fn output(&self, name: &str) -> PathBuf {
        self.folder.path().join("out").join(name)
    }

    fn save(&self, name: &str, text: &str) {
        std::fs::write(self.input(name), text).expect("writable");
    }

    fn command(&self, more: &[&str]) -> std::process::Command {
        let mut command = vpost();
        command.arg("watch").args([self.input(""), self.output("")]);
        command.arg("-m").arg(&self.machine).args(["-d", "linuxcnc"]).args(more);
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Corrects what is there, and ends.
    fn once(&self) -> (Option<i32>, String) {
        let ran = self.command(&["--settle", "0.05", "--once", "-v"]).output().expect("it starts");
        (ran.status.code(), messages(&ran))
    }

    fn watching(&self, settle: &str) -> Child {
        self.command(&["--settle", settle]).spawn().expect("it starts")
    }
}

/// Ends a watcher as a service is ended; its status, and what it said.
fn ended(watcher: Child) -> (Option<i32>, String) {
    let id = watcher.id().to_string();
    std::process::Command::new("kill").args(["-TERM", &id]).status().expect("kill is there");
    let ran = watcher.wait_with_output().expect("it ends");
    (ran.status.code(), messages(&ran))
}

/// Looks until something is so.
fn until(what: &str, is_so: impl Fn() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < Duration::from_secs(60), "{what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// What `vpost correct` makes of programs.
fn corrected(programs: &BTreeSet<String>) -> BTreeMap<String, Vec<u8>> {
    let place = tempfile::tempdir().expect("a temporary folder");
    let (input, output) = (place.path().join("in"), place.path().join("out"));
    std::fs::create_dir(&input).expect("a new folder");
    for (index, text) in programs.iter().enumerate() {
        std::fs::write(input.join(format!("{index}.nc")), text).expect("writable");
    }
    let ran =
        vpost().arg("batch").arg(&input).args(["-m", PROFILE, "-d", "linuxcnc", "-O"]).arg(&output).output();
    assert!(ran.as_ref().is_ok_and(|ran| ran.status.success()), "{ran:?}");
    let read = |index: usize| std::fs::read(output.join(format!("{index}.nc"))).expect("corrected");
    programs.iter().enumerate().map(|(index, text)| (text.clone(), read(index))).collect()
}

/// Saves as programs do: at once, slowly, to another name and renamed onto the old one.
fn save(place: &Path, text: &str, manner: u64) {
    let temporary = place.with_extension("tmp");
    let slowly = |path: &Path, pause: u64| {
        let mut file = std::fs::File::create(path).expect("a new file");
        for part in text.as_bytes().chunks(text.len() / 5 + 1) {
            file.write_all(part).expect("writable");
            std::thread::sleep(Duration::from_millis(pause));
        }
    };
    match manner {
        0 => std::fs::write(place, text).expect("writable"),
        1 => slowly(place, 30),
        2 => {
            slowly(&temporary, 5);
            std::fs::rename(&temporary, place).expect("renamed");
        }
        _ => {
            // An editor's: the old one aside, the new one in its place, a copy of its own beside.
            let _ = std::fs::rename(place, place.with_extension("nc~"));
            slowly(place, 10);
            std::fs::write(place.with_file_name(".part.nc.swp"), text).expect("writable");
        }
    }
}

/// 500 saves of 40 programs by ten writers: each output is at any time the correction of a whole save, and in the end
/// of the last.
#[test]
fn of_500_saves_none_is_lost_and_none_half() {
    const WRITERS: u64 = 10;
    let shop = Shop::new();
    let text = |writer: u64, turn: u64| program(writer * 1000 + turn, 30 + turn % 20);
    let name = |writer: u64, turn: u64| format!("part{writer}_{}.nc", turn % 4);
    let all: BTreeSet<String> = (0..WRITERS)
        .flat_map(|writer| (0..50).map(move |turn| (writer, turn)))
        .map(|(w, t)| text(w, t))
        .collect();
    assert_eq!(all.len(), 500);
    let expected = corrected(&all);
    let whole: BTreeSet<&Vec<u8>> = expected.values().collect();
    let watcher = shop.watching("0.4");
    let saving = AtomicBool::new(true);
    let looks = std::thread::scope(|scope| {
        let onlooker = scope.spawn(|| {
            let mut looks = 0;
            while saving.load(Ordering::Relaxed) {
                let there = std::fs::read_dir(shop.output("")).into_iter().flatten().flatten();
                for path in there.map(|entry| entry.path()).filter(|path| path.is_file()) {
                    let bytes = std::fs::read(&path).expect("outputs are replaced, not taken away");
                    assert!(whole.contains(&bytes), "{}", path.display());
                    looks += 1;
                }
                std::thread::sleep(Duration::from_millis(10));
            }
            looks
        });
        let writers: Vec<_> = (0..WRITERS)
            .map(|writer| {
                let shop = &shop;
                scope.spawn(move || {
                    for turn in 0..50 {
                        save(&shop.input(&name(writer, turn)), &text(writer, turn), (writer + turn) % 4);
                    }
                })
            })
            .collect();
        writers.into_iter().for_each(|writer| writer.join().expect("saved"));
        let last = |writer, part: u64| {
            (name(writer, part), text(writer, 48 + (part + 4) % 4 - if part > 1 { 4 } else { 0 }))
        };
        let last: Vec<(String, String)> =
            (0..WRITERS).flat_map(|w| (0..4).map(move |part| last(w, part))).collect();
        for (name, text) in &last {
            assert_eq!(std::fs::read_to_string(shop.input(name)).expect("saved"), *text, "{name}");
        }
        until("the last saves are corrected", || {
            last.iter()
                .all(|(name, text)| std::fs::read(shop.output(name)).is_ok_and(|out| out == expected[text]))
        });
        saving.store(false, Ordering::Relaxed);
        onlooker.join().expect("only whole outputs")
    });
    assert!(looks > 100, "{looks}");
    let (status, said) = ended(watcher);
    assert_eq!((status, temporaries(&shop.output("")).len()), (Some(143), 0), "{said}");
    assert_eq!(tree(&shop.output("")).len(), 40);
    assert!(!said.contains("error"), "{said}");
}

#[test]
fn what_is_done_is_not_done_again_and_what_changed_is() {
    let mut shop = Shop::new();
    let machines = shop.folder.path().join("machines");
    copy(&root().join("machine-profiles"), &machines);
    shop.machine = machines.join("stan_s500.toml");
    for seed in 0..3 {
        shop.save(&format!("part{seed}.nc"), &program(seed, 20));
    }
    let (status, said) = shop.once();
    assert_eq!((status, said.matches("corrected: ").count()), (Some(0), 3), "{said}");
    let before = tree(&shop.output(""));
    assert_eq!(shop.once(), (Some(0), String::new()), "all was done");
    // A save, an output that is gone, and nothing else.
    shop.save("part1.nc", &program(7, 20));
    std::fs::remove_file(shop.output("part2.nc")).expect("it was there");
    let (status, said) = shop.once();
    assert_eq!((status, said.matches("corrected: ").count()), (Some(0), 2), "{said}");
    assert_eq!(tree(&shop.output(""))[Path::new("part2.nc")], before[Path::new("part2.nc")]);
    // A table of the profile changes under a watcher.
    let watcher = shop.watching("0.1");
    let table = machines.join("stan_s500/interferometer_x.csv");
    let text = std::fs::read_to_string(&table).expect("a table");
    // 0.1 um more for each millimetre of X.
    let moved = |line: &str| match line.splitn(3, ',').collect::<Vec<_>>()[..] {
        [place, error, rest] if error != "EXX_um" => {
            let [place_mm, error_um] = [place, error].map(|cell| cell.parse::<f64>().expect("a number"));
            format!("{place},{},{rest}\n", error_um + 0.1 * place_mm)
        }
        _ => format!("{line}\n"),
    };
    let changed: String = text.lines().map(moved).collect();
    std::thread::sleep(Duration::from_millis(300));
    std::fs::write(&table, changed).expect("writable");
    let all_new = || tree(&shop.output("")).iter().all(|(name, bytes)| before.get(name) != Some(bytes));
    until("all is corrected anew", all_new);
    assert_eq!(ended(watcher).0, Some(143));
}

#[test]
fn a_refusal_lies_beside_the_output_it_concerns() {
    let shop = Shop::new();
    shop.save("part.nc", &program(1, 20));
    assert_eq!(shop.once().0, Some(0));
    let before = std::fs::read(shop.output("part.nc")).expect("corrected");
    // The post writes a variable, and the second program arrives without its end.
    shop.save("part.nc", "G21 G90\nG0 X#500\nM30\n");
    let half: String = program(2, 20).chars().take(300).collect();
    shop.save("half.nc", &half);
    std::fs::write(shop.input("empty.nc"), "").expect("writable");
    let (status, said) = shop.once();
    assert_eq!(status, Some(1), "{said}");
    let page = std::fs::read_to_string(shop.output("part.nc.refused.txt")).expect("a page");
    assert!(page.contains("EARLIER program") && page.contains("error[VP0121]"), "{page}");
    assert_eq!(std::fs::read(shop.output("part.nc")).expect("as it was"), before);
    let page = std::fs::read_to_string(shop.output("half.nc.refused.txt")).expect("a page");
    assert!(!page.contains("EARLIER") && page.contains("error[VP0245]"), "{page}");
    assert!(!shop.output("half.nc").exists() && !shop.output("empty.nc").exists());
    // Mended, the word is taken back.
    shop.save("part.nc", &program(3, 20));
    shop.save("half.nc", &program(2, 20));
    std::fs::remove_file(shop.input("empty.nc")).expect("it was there");
    assert_eq!(shop.once().0, Some(0));
    let left: Vec<PathBuf> = tree(&shop.output("")).into_keys().collect();
    assert_eq!(left, [PathBuf::from("half.nc"), PathBuf::from("part.nc")]);
}

/// A folder with a corrected program, watched while its profile was broken, and that profile's text.
fn broken() -> (Shop, Child, String) {
    let mut shop = Shop::new();
    shop.machine = shop.folder.path().join("mill.toml");
    let good = std::fs::read_to_string(root().join("machine-profiles/perfect.toml")).expect("text");
    std::fs::write(&shop.machine, &good).expect("writable");
    shop.save("part.nc", &program(1, 20));
    let watcher = shop.watching("0.1");
    until("it is corrected", || shop.output("part.nc").exists());
    std::fs::write(&shop.machine, "nonsense").expect("writable");
    until("it is said", || shop.output("vpost.refused.txt").exists());
    (shop, watcher, good)
}

#[test]
fn a_watcher_that_knows_no_machine_says_so_in_the_folder() {
    let (shop, watcher, good) = broken();
    shop.save("new.nc", &program(2, 20));
    std::fs::write(&shop.machine, &good).expect("writable");
    until("it goes on", || shop.output("new.nc").exists() && !shop.output("vpost.refused.txt").exists());
    let (status, said) = ended(watcher);
    assert_eq!((status, said.matches("error[VP0301]").count()), (Some(143), 1), "{said}");
}

#[test]
fn an_output_folder_that_went_is_made_again() {
    let shop = Shop::new();
    shop.save("part.nc", &program(1, 20));
    let watcher = shop.watching("0.1");
    let is_there = || shop.output("part.nc").exists();
    until("it is corrected", is_there);
    // What is written into it meanwhile stands in the way for a moment.
    let taken = || std::fs::remove_dir_all(shop.output("")).is_ok();
    for _ in 0..3 {
        until("it is taken away", taken);
        until("it is corrected again", is_there);
    }
    // Made again by hand before anybody looks.
    until("it is taken away", taken);
    let _ = std::fs::create_dir(shop.output(""));
    until("it is corrected again", is_there);
    let (status, said) = ended(watcher);
    assert_eq!((status, said.contains("error")), (Some(143), false), "{said}");
    assert!(said.contains("went: it is made again"), "{said}");
    assert!(temporaries(&shop.output("")).is_empty());
}

#[test]
fn an_output_folder_may_go_while_the_profile_is_broken() {
    let (shop, watcher, good) = broken();
    until("it is taken away", || std::fs::remove_dir_all(shop.output("")).is_ok());
    until("it is said again", || shop.output("vpost.refused.txt").exists());
    assert!(!shop.output("part.nc").exists());
    std::fs::write(&shop.machine, &good).expect("writable");
    until("it goes on", || shop.output("part.nc").exists() && !shop.output("vpost.refused.txt").exists());
    let (status, said) = ended(watcher);
    assert_eq!(status, Some(143), "{said}");
}

#[test]
fn who_looks_into_the_folder_reads_that_the_machine_was_never_known() {
    let mut shop = Shop::new();
    shop.machine = shop.folder.path().join("mill.toml");
    std::fs::write(&shop.machine, "nonsense").expect("writable");
    shop.save("part.nc", &program(1, 20));
    assert_ne!(shop.once().0, Some(0));
    let page = std::fs::read_to_string(shop.output("vpost.refused.txt")).expect("a page");
    assert!(page.contains("No program is corrected") && page.contains("error[VP0301]"), "{page}");
    shop.machine = root().join(PROFILE);
    assert_eq!(shop.once().0, Some(0));
    let left: Vec<PathBuf> = tree(&shop.output("")).into_keys().collect();
    assert_eq!(left, [PathBuf::from("part.nc")]);
}
