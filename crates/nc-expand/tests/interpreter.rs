//! Against LinuxCNC's interpreter: a program and what it was expanded to make the same canonical motion.
//!
//! The samples that come with LinuxCNC are run as they are; variables nobody set are 0, as they are in a
//! freshly started interpreter.

mod common;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use nc_syntax::dialect::Action;
use nc_syntax::{Block, Dialect, Reader};

use nc_expand::{Environment, Limits, Preset, expand};

const SAMPLES: &str = "/usr/share/linuxcnc/ncfiles";

fn programs(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.filter_map(|entry| entry.ok().map(|entry| entry.path())) {
        if path.is_dir() {
            programs(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "ngc") {
            found.push(path);
        }
    }
}

/// Canonical motion, without line numbers, comments and messages; `None` where the interpreter refuses.
fn canonical(program: &Path, folder: &Path) -> Option<Vec<String>> {
    let work = tempfile::tempdir().expect("a temporary folder");
    let (variables, tools, out) = (work.path().join("var"), work.path().join("tbl"), work.path().join("out"));
    std::fs::write(&variables, "").expect("writable");
    std::fs::write(&tools, "T1 P1 D0.5 Z1.0\nT2 P2 D0.25 Z2.0\nT3 P3 D0.125\nT4 P4 D0.1\nT5 P5\n")
        .expect("writable");
    let ran = Command::new("rs274")
        .current_dir(folder)
        .args(["-t".as_ref(), tools.as_os_str(), "-v".as_ref(), variables.as_os_str(), "-g".as_ref()])
        .args([program.as_os_str(), out.as_os_str()])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .output()
        .ok()?;
    let errors = String::from_utf8_lossy(&ran.stderr).into_owned();
    let text = std::fs::read(&out).ok()?;
    let lines: Vec<String> = String::from_utf8_lossy(&text)
        .lines()
        .filter_map(|line| {
            let call =
                line.split_once("N..... ").or_else(|| line.split_once(' ').map(|(_, rest)| ("", rest)))?.1;
            let call = call
                .trim_start()
                .trim_start_matches(|c: char| c.is_ascii_digit() || c == 'N' || c == '.')
                .trim();
            (!call.starts_with("COMMENT") && !call.starts_with("MESSAGE")).then(|| call.to_owned())
        })
        .collect();
    (ran.status.success() && errors.trim() == "executing").then_some(lines)
}

/// True where the plain program holds a code that correction refuses anyway: a turning cycle that reads a
/// subroutine as its contour, a modal state saved for the end of a subroutine.
fn refused_later(text: &[u8], dialect: &Dialect) -> bool {
    let (mut reader, mut block) = (Reader::new(text, dialect), Block::default());
    while reader.next(&mut block) {
        for word in block.words() {
            let row = word.g_code().and_then(|code| dialect.code(code));
            let number = word.number().and_then(nc_syntax::Number::integer);
            let m_row =
                number.filter(|_| word.letter == b'M').and_then(|n| dialect.m_code(u16::try_from(n).ok()?));
            if row.is_some_and(|row| matches!(row.action, Action::Refuse { .. }))
                || m_row.is_some_and(|row| row.refuse.is_some())
            {
                return true;
            }
        }
    }
    false
}

#[test]
fn expanded_samples_move_as_the_interpreter_moves() {
    let there = Command::new("rs274").arg("-h").stdin(Stdio::null()).output().is_ok();
    assert!(there || std::env::var_os("CI").is_none(), "linuxcnc-uspace must be installed where CI is set");
    if !there {
        return;
    }
    let mut samples = Vec::new();
    programs(Path::new(SAMPLES), &mut samples);
    samples.sort();
    let dialect = nc_dialect::builtin("linuxcnc").expect("shipped");
    let zero: Vec<Preset> =
        (1..=5000).map(|n| Preset::parse(&format!("#{n}=0")).expect("a preset")).collect();
    let (mut compared, mut not_run, mut refused, mut wrong) = (0, 0, Vec::new(), Vec::new());
    for path in &samples {
        let text = std::fs::read(path).expect("readable");
        let folder = path.parent().expect("in a folder");
        let read = |name: &str| std::fs::read(folder.join(name));
        let environment = Environment { variables: &zero, read_external: &read, limits: Limits::default() };
        let name = path.strip_prefix(SAMPLES).expect("a sample").display().to_string();
        match expand(&text, dialect, &environment) {
            Err(refusal) => refused.push(format!("{name}: {}", refusal.diagnostics[0])),
            Ok(expanded) if expanded.changed() && !refused_later(expanded.text(), dialect) => {
                let work = tempfile::tempdir().expect("a temporary folder");
                let plain = work.path().join("plain.ngc");
                std::fs::write(&plain, expanded.text()).expect("writable");
                let Some(wanted) = canonical(path, folder) else {
                    not_run += 1;
                    continue;
                };
                compared += 1;
                let found = canonical(&plain, work.path());
                if found.as_ref() != Some(&wanted) {
                    let found = found.unwrap_or_default();
                    let at = wanted.iter().zip(&found).position(|(a, b)| a != b);
                    let at = at.unwrap_or(wanted.len().min(found.len()));
                    wrong.push(format!("{name}: call {at}: {:?} became {:?}", wanted.get(at), found.get(at)));
                }
            }
            Ok(_) => {}
        }
    }
    println!("{compared} compared, {not_run} not run by the interpreter itself, {} refused", refused.len());
    assert!(wrong.is_empty(), "{} of {compared}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(compared > 80, "only {compared} were compared");
}
