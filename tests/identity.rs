//! A machine without errors changes no byte, or refuses.

use std::path::{Path, PathBuf};

use crate::common::{SAMPLES, files, messages, root, run};

fn same_or_refused(path: &Path, dialect: &str) -> bool {
    let text = std::fs::read(path).expect("readable");
    let ran =
        run(&[path.to_str().expect("a plain path"), "-m", "machine-profiles/perfect.toml", "-d", dialect]);
    match ran.status.code() {
        Some(0) => {
            assert!(ran.stdout == text, "{} was changed", path.display());
            true
        }
        Some(1) => {
            assert!(ran.stdout.is_empty(), "{}: refused, yet something was written", path.display());
            let said = messages(&ran);
            assert!(said.contains("error[VP") && said.contains("help:"), "{}: {said}", path.display());
            false
        }
        code => panic!("{}: exit status {code:?}\n{}", path.display(), messages(&ran)),
    }
}

#[test]
fn samples_come_out_byte_for_byte() {
    for (sample, dialect) in SAMPLES {
        assert!(same_or_refused(&root().join(sample), dialect), "{sample} was refused");
    }
}

#[test]
fn programs_of_other_people_come_out_byte_for_byte_or_are_refused() {
    fn under(folder: &Path, found: &mut Vec<PathBuf>) {
        found.extend(files(folder, &["ngc", "nc"]));
        let Ok(entries) = std::fs::read_dir(folder) else { return };
        let mut folders: Vec<PathBuf> =
            entries.filter_map(|e| e.ok().map(|e| e.path())).filter(|p| p.is_dir()).collect();
        folders.sort();
        folders.iter().for_each(|folder| under(folder, found));
    }
    let mut programs = Vec::new();
    under(Path::new("/usr/share/linuxcnc/ncfiles"), &mut programs);
    if programs.is_empty() {
        assert!(std::env::var_os("CI").is_none(), "linuxcnc-uspace must be installed where CI is set");
        println!("skipped: linuxcnc-uspace is not installed");
        return;
    }
    let same = programs.iter().filter(|path| same_or_refused(path, "linuxcnc")).count();
    println!("{same} of {} came out byte for byte, the others were refused", programs.len());
    assert!(programs.len() > 150 && same > 0);
}
