//! Against LinuxCNC's interpreter: a program and what it was expanded to make the same canonical motion.
//!
//! The samples that come with LinuxCNC are run as they are; variables nobody set are 0, as they are in a
//! freshly started interpreter.

use crate::common;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use nc_dialect::{Action, Dialect};
use nc_syntax::{Block, Reader};

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
        // It keeps its tools under HOME, and one beside another does not start.
        .env("HOME", work.path())
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
            // The sign of a zero that a sine leaves.
            let call = call.replace("-0.0000", "0.0000");
            (!call.starts_with("COMMENT") && !call.starts_with("MESSAGE")).then_some(call)
        })
        .collect();
    (ran.status.success() && errors.trim() == "executing").then_some(lines)
}

/// The same of a program that must run: on a busy machine the interpreter now and then ends without a word, and only
/// what it refuses three times is refused.
fn canonical_of_plain(program: &Path, folder: &Path) -> Option<Vec<String>> {
    (0..3).find_map(|_| canonical(program, folder))
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

fn have_interpreter() -> bool {
    let there = Command::new("rs274").arg("-h").stdin(Stdio::null()).output().is_ok();
    assert!(there || std::env::var_os("CI").is_none(), "linuxcnc-uspace must be installed where CI is set");
    there
}

/// Calls of a sample's subroutine with the defaults that its text gives: `#<width> = #10 (=0.25 …)`, and
/// with other values for those that have none.
fn calls(name: &str, text: &str) -> Vec<String> {
    let mut defaults: Vec<Option<f64>> = Vec::new();
    for line in text.lines() {
        let Some((_, right)) = line.trim().split_once("= ").or_else(|| line.trim().split_once("=")) else {
            continue;
        };
        let Some(rest) = right.trim().strip_prefix('#') else { continue };
        let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
        let Ok(number @ 1..=30) = digits.parse::<usize>() else { continue };
        let value = rest[digits.len()..].trim().strip_prefix("(=").map(|comment| {
            comment
                .trim()
                .chars()
                .take_while(|c| c.is_ascii_digit() || matches!(c, '.' | '-'))
                .collect::<String>()
        });
        if defaults.len() < number {
            defaults.resize(number, None);
        }
        defaults[number - 1] = value.and_then(|value| value.parse().ok());
    }
    let call = |other: f64| {
        let values: String = defaults
            .iter()
            .enumerate()
            .map(|(n, v)| format!(" [{}]", v.unwrap_or(other + n as f64)))
            .collect();
        format!("o<{name}> call{values}\n")
    };
    ["G20", "G21"]
        .iter()
        .flat_map(|unit| {
            [0.5, 1.0, 2.0].map(|other| {
                format!("{unit} G17 G90 F100\nT1 M6\nG0 X1 Y1 Z1\n{}G0 X0 Y0\nM2\n", call(other))
            })
        })
        .collect()
}

/// Corners of the language, each where two readings are possible.
const CORNERS: [&str; 12] = [
    "o1 repeat [2.5]\nG0 X1\no1 endrepeat\no2 repeat [3.5]\nG0 Y1\no2 endrepeat\no3 repeat [0.9]\nG0 Z1\no3 endrepeat\no4 repeat [-2]\nG0 Z2\no4 endrepeat\nM2\n",
    "#1=2 #1=3\nG0 X#1\n#1=5 #2=#1 G0 Y#1\nG0 X#1 Y#2\nM2\n",
    "G0 X[2 + -3] Y[-[2]**2] Z[5 MOD -3]\nG0 X[7 MOD 2.5] Y[2 - 3 - 4] Z[8/4/2]\nM2\n",
    "G0 X[1 LT 2 LT 3] Y[1 OR 0 AND 0] Z[1 + 2 EQ 3]\nG0 X[1 XOR 1] Y[0 AND 0 OR 1] Z[2 EQ 2 AND 3 NE 4]\nM2\n",
    "G0 X[ROUND[-2.5]] Y[FIX[-0.5]] Z[FUP[-0.5]]\nG0 X[ABS[-3] * SQRT[9]] Y[EXP[0]] Z[LN[1]]\nM2\n",
    "#4=9\n#2=4\n#[#2+1]=[##2 + 1]\nG0 X#5 Y##2 Z[-#2]\nM2\n",
    "o3 sub\nG0 X[#1+#2] Y#3\no3 return [#1]\nG0 X99\no3 endsub\no3 call [1] [2]\nG0 Z#<_value> Y#<_value_returned>\no3 call\nG0 Z#<_value>\nM2\n",
    "#1=7\nG0 X#1\nM98 P10 L2\nG0 X#1\nM2\nO10\n#1=[#1+1]\nG0 Y#1\nM99\n",
    "#1=7\n#<x>=1\no1 sub\n#1=8\n#<x>=2\n#<_g>=[#<x>+#1]\no1 endsub\no1 call [3]\nG0 X#1 Y#<x> Z#<_g>\nM2\n",
    "#1=0\no1 while [#1 LT 5]\n#1=[#1+1]\no2 if [#1 EQ 2]\no1 continue\no2 elseif [#1 EQ 4]\no1 break\no2 endif\nG0 X#1\no1 endwhile\nG0 Y#1\nM2\n",
    "#1=0\no1 do\n#1=[#1+1]\no2 if [#1 EQ 2]\no1 continue\no2 endif\nG0 X#1\no1 while [#1 LT 4]\nM2\n",
    "#<a b>=1\n#<AB>=[#<ab>+1]\nG0 X#<A B> Y[EXISTS[#<ab>]] Z[EXISTS[#<abc>]]\no<s t> sub\nG1 X#1 F1\no<st> endsub\nO<ST> CALL [4]\nM2\n",
];

#[test]
fn corners_of_the_language_are_the_interpreters() {
    if !have_interpreter() {
        return;
    }
    let work = tempfile::tempdir().expect("a temporary folder");
    let (main, plain) = (work.path().join("main.ngc"), work.path().join("plain.ngc"));
    for text in CORNERS {
        std::fs::write(&main, text).expect("writable");
        std::fs::write(&plain, common::linuxcnc(text)).expect("writable");
        let wanted =
            canonical(&main, work.path()).unwrap_or_else(|| panic!("not run by the interpreter: {text}"));
        assert!(wanted.iter().any(|call| call.starts_with("STRAIGHT")), "{text}");
        assert_eq!(canonical_of_plain(&plain, work.path()), Some(wanted), "{text}");
    }
}

/// The samples that are subroutines alone, called.
#[test]
fn called_samples_move_as_the_interpreter_moves() {
    if !have_interpreter() {
        return;
    }
    let mut samples = Vec::new();
    programs(Path::new(SAMPLES), &mut samples);
    samples.sort();
    let dialect = nc_dialect::builtin("linuxcnc").expect("shipped");
    // The interpreter looks for subroutines where it is started.
    let work = tempfile::tempdir().expect("a temporary folder");
    for path in &samples {
        std::fs::copy(path, work.path().join(path.file_name().expect("a name"))).expect("writable");
    }
    // Tool 1 of the table above is in the spindle.
    let machine = ["#5400=1".to_owned(), "#5410=0.5".to_owned(), "#<_task>=0".to_owned()];
    let known: Vec<Preset> = (31..=5000)
        .map(|n| format!("#{n}=0"))
        .chain(machine)
        .map(|text| Preset::parse(&text).expect("a preset"))
        .collect();
    let read = |name: &str| std::fs::read(work.path().join(name));
    let setup = common::setup(dialect);
    let environment =
        Environment { variables: &known, read_external: &read, setup: &setup, limits: Limits::default() };
    let (mut compared, mut moving, mut refused, mut wrong) = (0, 0, 0, Vec::new());
    for path in &samples {
        let name = path.file_stem().expect("a name").to_string_lossy().to_lowercase();
        let text = std::fs::read(work.path().join(format!("{name}.ngc"))).unwrap_or_default();
        let text = String::from_utf8_lossy(&text).into_owned();
        if !text.to_lowercase().contains(&format!("o<{name}> sub")) {
            continue;
        }
        for (number, call) in calls(&name, &text).iter().enumerate() {
            let Ok(expanded) = expand(call.as_bytes(), dialect, &environment) else {
                refused += 1;
                continue;
            };
            if refused_later(expanded.text(), dialect) {
                refused += 1;
                continue;
            }
            let (main, plain) = (work.path().join("main-call.ngc"), work.path().join("plain-call.ngc"));
            std::fs::write(&main, call).expect("writable");
            std::fs::write(&plain, expanded.text()).expect("writable");
            let Some(wanted) = canonical(&main, work.path()) else { continue };
            compared += 1;
            moving += usize::from(
                wanted
                    .iter()
                    .filter(|call| call.starts_with("STRAIGHT_FEED") || call.starts_with("ARC_FEED"))
                    .count()
                    > 2,
            );
            let found = canonical_of_plain(&plain, work.path()).unwrap_or_default();
            if found != wanted {
                let at = wanted.iter().zip(&found).position(|(a, b)| a != b);
                let at = at.unwrap_or(wanted.len().min(found.len()));
                wrong.push(format!(
                    "{name} {number}: call {at}: {:?} became {:?}",
                    wanted.get(at),
                    found.get(at)
                ));
            }
        }
    }
    println!("{compared} calls compared, {moving} of them with feed motion, {refused} refused");
    assert!(wrong.is_empty(), "{} of {compared}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(moving >= 20, "only {moving} calls moved");
}

#[test]
fn expanded_samples_move_as_the_interpreter_moves() {
    if !have_interpreter() {
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
        let setup = common::setup(dialect);
        let environment =
            Environment { variables: &zero, read_external: &read, setup: &setup, limits: Limits::default() };
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
                let found = canonical_of_plain(&plain, work.path());
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
    assert!(compared >= 7, "only {compared} were compared");
}
