//! `docs/traps.md`: every trap has a proof that exists, and every program of the corpus proves something.
//! Below: the traps that only a whole output shows.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

use crate::common::{files, messages, root, run};
use nc_syntax::{Block, ItemKind, Reader, Value};

const PROFILE: &str = "tests/profiles/corpus.toml";
const DIALECTS: [&str; 6] = ["balt-system", "centroid", "fanuc", "linuxcnc", "perspektiva", "sinumerik"];
const HEAD: &str = "G17 G21 G40 G49 G54 G80 G90\nG0 X10. Y10. Z60.\n";

/// One row of a table of the document: the trap, and the references of its last column.
struct Trap {
    text: String,
    proofs: String,
}

fn traps(document: &str) -> Vec<Trap> {
    document
        .lines()
        .filter(|line| line.starts_with('|') && !line.starts_with("|---") && !line.starts_with("| trap |"))
        .map(|line| {
            let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
            let [text, answer, broke, proofs] = cells.as_slice() else { panic!("not four cells: {line}") };
            assert!(!answer.is_empty() && !broke.is_empty(), "{text}");
            Trap { text: (*text).to_owned(), proofs: (*proofs).to_owned() }
        })
        .collect()
}

/// The programs that a reference such as `*/accept/helix.nc` stands for, relative to `tests/corpus/`.
fn programs(reference: &str) -> Vec<String> {
    let Some(rest) = reference.strip_prefix("*/") else { return vec![reference.to_owned()] };
    let all = DIALECTS.iter().map(|dialect| format!("{dialect}/{rest}"));
    all.filter(|path| root().join("tests/corpus").join(path).is_file()).collect()
}

/// True where a file of tests has a test of that name, among the plain ones or the properties.
fn is_test(path: &str, name: &str) -> bool {
    let Ok(text) = std::fs::read_to_string(root().join(path)) else { return false };
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let at = lines.iter().position(|line| line.starts_with(&format!("fn {name}(")));
    at.is_some_and(|at| lines[..at].iter().rev().take(3).any(|line| *line == "#[test]"))
}

#[test]
fn every_trap_has_its_proof() {
    let document = std::fs::read_to_string(root().join("docs/traps.md")).expect("readable");
    let codes = std::fs::read_to_string(root().join("docs/dialects.md")).expect("readable");
    let traps = traps(&document);
    let mut faults = String::new();
    let mut named = BTreeSet::new();
    for trap in &traps {
        let mut count = 0;
        for proof in trap.proofs.split(", ") {
            let mut parts = proof.split('`');
            let (Some(""), Some(what), Some(behind)) = (parts.next(), parts.next(), parts.next()) else {
                writeln!(faults, "{}: `{proof}` is no reference", trap.text).expect("a string");
                continue;
            };
            count += 1;
            let found = match behind.trim().strip_prefix("in ") {
                Some(path) => is_test(path, what),
                None => {
                    let programs = programs(what);
                    let all = !programs.is_empty()
                        && programs.iter().all(|path| root().join("tests/corpus").join(path).is_file());
                    named.extend(programs);
                    all
                }
            };
            if !found {
                writeln!(faults, "{}: {proof} is not there", trap.text).expect("a string");
            }
        }
        if count == 0 {
            writeln!(faults, "{}: no proof", trap.text).expect("a string");
        }
    }
    assert!(traps.len() > 100, "only {} traps", traps.len());
    for dialect in DIALECTS {
        let section = codes.split(&format!("### `{dialect}`")).nth(1).expect("every dialect is listed");
        let section = section.split("\n### ").next().unwrap_or_default();
        for kind in ["accept", "reject"] {
            for path in files(&root().join("tests/corpus").join(dialect).join(kind), &["nc", "ngc"]) {
                let file = format!("{kind}/{}", path.file_name().expect("a name").to_string_lossy());
                if !section.contains(&format!("`{file}`")) && !named.contains(&format!("{dialect}/{file}")) {
                    writeln!(faults, "tests/corpus/{dialect}/{file} is named in neither document")
                        .expect("a string");
                }
            }
        }
    }
    assert!(faults.is_empty(), "{faults}");
}

/// Corrects a program for a machine; the output.
fn corrected_for(profile: &str, dialect: &str, text: &str) -> String {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("part.nc");
    std::fs::write(&program, text).expect("writable");
    let ran = run(&[program.to_str().expect("a plain path"), "-m", profile, "-d", dialect]);
    assert!(ran.status.success(), "{dialect}: {}\n{text}", messages(&ran));
    String::from_utf8(ran.stdout).expect("ASCII")
}

fn corrected(dialect: &str, text: &str) -> String {
    corrected_for(PROFILE, dialect, text)
}

/// The lines of the program behind its first two, which every program here has, and the comment.
fn body(output: &str) -> Vec<&str> {
    output.lines().filter(|line| !line.starts_with('(') && !line.starts_with(';')).skip(2).collect()
}

/// Number words of a line: letter and value.
fn words(line: &str, dialect: &str) -> Vec<(char, f64)> {
    let dialect = nc_dialect::builtin(dialect).expect("shipped");
    let (mut reader, mut block) = (Reader::new(line.as_bytes(), dialect), Block::default());
    assert!(reader.next(&mut block));
    let number = |item: &nc_syntax::Item| match item.kind {
        ItemKind::Word { letter, value: Value::Number(number) } => Some((letter as char, number.to_f64())),
        _ => None,
    };
    block.items.iter().filter_map(number).collect()
}

fn value(line: &str, letter: char) -> Option<f64> {
    words(line, "linuxcnc").into_iter().find(|(found, _)| *found == letter).map(|(_, value)| value)
}

/// X is off by 310 µrad of Z: 10 mm down are 3.1 µm, 1 mm is less than half a step.
#[test]
fn plunges_gain_words_only_where_a_step_is_reached() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let profile = folder.path().join("square.toml");
    let axes: String = ["X", "Y", "Z"].map(|axis| format!("[axis.{axis}]\ntravel_mm = [0, 400]\n")).concat();
    let text = format!(
        "format = 1\nname = \"Square\"\nchain = \"[w X Y b Z t]\"\n{axes}[squareness]\nEB0Z_urad = 310.0\n\
         [work_offsets_mm]\nG54 = [0, 0, 0]\n"
    );
    std::fs::write(&profile, text).expect("writable");
    let out = corrected_for(
        profile.to_str().expect("a plain path"),
        "linuxcnc",
        &format!("{HEAD}Z61.\nG1 Z60. F200.\nZ49.\nM2\n"),
    );
    let body = body(&out);
    assert_eq!(body[1], "G1 Z60. F200.", "{out}");
    assert!(body[2].contains('X') && !body[2].contains('Y'), "{out}");
}

/// The sum of what was emitted is where the absolute program ends, to the step.
#[test]
fn ten_thousand_increments_do_not_drift() {
    let increments = "X0.1\n".repeat(10_000);
    let out = corrected("linuxcnc", &format!("{HEAD}G1 Z50. F200.\nG91\n{increments}G90\nM2\n"));
    let absolute = corrected("linuxcnc", &format!("{HEAD}G1 Z50. F200.\nX1010.\nM2\n"));
    let end = |out: &str, letter: char| {
        let (mut at, mut incremental) = (0.0, false);
        for line in body(out) {
            incremental = (incremental || line.contains("G91")) && !line.contains("G90");
            if let Some(value) = value(line, letter) {
                at = if incremental { at + value } else { value };
            }
        }
        at
    };
    let start = corrected("linuxcnc", &format!("{HEAD}M2\n"));
    for letter in ['X', 'Y', 'Z'] {
        // An axis that the plunge left alone stands where the rapid brought it.
        let rapid = start.lines().find_map(|line| value(line, letter)).expect("the rapid names all");
        let shown = |out: &str| if end(out, letter) == 0.0 { rapid } else { end(out, letter) };
        let (one, other) = (shown(&out), shown(&absolute));
        assert!((one - other).abs() < 0.0015, "{letter}: {one} against {other}");
    }
}

#[test]
fn rapids_are_never_split() {
    for dialect in DIALECTS {
        let head = HEAD.replace("G21 G40 G49", "G40").replace(" G80", "");
        let out = corrected(dialect, &format!("{head}G0 X1500. Y-1400. Z-300.\nX10. Y10.\nM30\n"));
        assert_eq!(body(&out).len(), 3, "{dialect}:\n{out}");
    }
}

#[test]
fn starts_stay_before_the_motion() {
    for dialect in DIALECTS {
        for start in ["M3 S500", "M8"] {
            let head = HEAD.replace("G21 G40 G49", "G40").replace(" G80", "");
            let out = corrected(dialect, &format!("{head}G1 Z50. F200.\nX900. Y700. {start}\n"));
            let body = body(&out);
            assert!(body.len() > 4, "{dialect}: not split\n{out}");
            let at: Vec<usize> = (0..body.len()).filter(|i| body[*i].contains(start)).collect();
            assert_eq!(at, [1], "{dialect} {start}:\n{out}");
        }
    }
}

/// A block that becomes several stays one for the switch.
#[test]
fn block_delete_is_copied_to_every_piece() {
    for dialect in ["fanuc", "linuxcnc", "perspektiva", "centroid"] {
        let text = format!("{HEAD}G1 Z50. F200.\n/X900. Y700.\nG0 X10. Y10. Z60.\nM30\n");
        let out = corrected(dialect, &text);
        let skipped = out.lines().filter(|line| line.starts_with('/')).count();
        let feeds = body(&out).len() - 3;
        assert!(skipped > 3 && skipped == feeds, "{dialect}: {skipped} of {feeds}\n{out}");
    }
}

#[test]
fn numbers_never_repeat() {
    let mut split = 0;
    for dialect in DIALECTS {
        let head = HEAD.replace("G21 G40 G49", "G40").replace(" G80", "");
        for step in [1, 2, 10] {
            let lines = [head.lines().collect(), vec!["G1 Z50. F200.", "X900. Y700.", "X10.", "Y10.", "M30"]]
                .concat();
            let numbered: String =
                lines.iter().enumerate().map(|(at, line)| format!("N{} {line}\n", 100 - at * step)).collect();
            let out = corrected(dialect, &numbered);
            let numbers: Vec<u64> = out
                .lines()
                .filter_map(|line| line.trim_start_matches('/').strip_prefix('N'))
                .map(|rest| rest.split(' ').next().unwrap_or_default().parse().expect("a number"))
                .collect();
            let distinct: BTreeSet<u64> = numbers.iter().copied().collect();
            assert_eq!(distinct.len(), numbers.len(), "{dialect}, N falling by {step}:\n{out}");
            split += out.lines().count() - lines.len();
        }
    }
    assert!(split > 100, "hardly a block was split");
}

/// Pieces under G93: each has its F, and their times are that of the block.
#[test]
fn inverse_time_of_the_pieces_adds_up() {
    for dialect in ["fanuc", "linuxcnc", "perspektiva", "centroid"] {
        let out = corrected(dialect, &format!("{HEAD}G1 Z50. F200.\nG93 X900. Y700. F2.\nG94 F200.\nM30\n"));
        let body = body(&out);
        let first = body.iter().position(|line| line.contains("G93")).expect("it stays");
        let last = body.iter().position(|line| line.contains("G94")).expect("it stays");
        assert!(last - first > 3, "{dialect}: not split\n{out}");
        let minutes: f64 = body[first..last]
            .iter()
            .map(|line| 1.0 / value(line, 'F').unwrap_or_else(|| panic!("{line} has no F\n{out}")))
            .sum();
        // Three decimals of F.
        assert!((minutes - 0.5).abs() < 1e-3, "{dialect}: {minutes} minutes\n{out}");
    }
}

#[test]
fn a_split_block_keeps_its_feed_word_once() {
    for mode in ["G94", "G95"] {
        let out = corrected("fanuc", &format!("{HEAD}{mode}\nG1 Z50. F0.2\nX900. Y700. F0.3\nM30\n"));
        assert!(body(&out).len() > 6, "not split\n{out}");
        assert_eq!(out.matches("F0.3").count(), 1, "{out}");
        assert_eq!(out.matches(" F").count() - out.matches(" FOR ").count(), 2, "{out}");
    }
}

/// What the corpus becomes, byte for byte.
fn outputs() -> Vec<(String, Vec<u8>, Vec<u8>)> {
    let mut found = Vec::new();
    for dialect in DIALECTS {
        for path in files(&root().join("tests/corpus").join(dialect).join("accept"), &["nc", "ngc"]) {
            let text = path.to_str().expect("a plain path");
            let ran = run(&[text, "-m", PROFILE, "-d", dialect]);
            assert!(ran.status.success(), "{text}: {}", messages(&ran));
            found.push((text.to_owned(), read(&path), ran.stdout));
        }
    }
    found
}

fn read(path: &Path) -> Vec<u8> {
    std::fs::read(path).expect("readable")
}

/// Text between brackets, and behind a semicolon where nothing stands behind it but text.
fn comments(text: &[u8]) -> Vec<&[u8]> {
    text.split(|byte| *byte == b'(')
        .skip(1)
        .filter_map(|rest| rest.iter().position(|byte| *byte == b')').map(|end| &rest[..end]))
        .collect()
}

#[test]
fn no_exponent_and_no_minus_zero() {
    let mut written = 0;
    for (name, before, after) in outputs() {
        let dialect =
            name.split("/tests/corpus/").nth(1).and_then(|rest| rest.split('/').next()).expect("a dialect");
        let dialect = nc_dialect::builtin(dialect).expect("shipped");
        let minus_zero = |text: &[u8]| {
            let (mut reader, mut block) = (Reader::new(text, dialect), Block::default());
            let mut count = 0;
            while reader.next(&mut block) {
                assert!(block.first_invalid().is_none(), "{name}: {}", String::from_utf8_lossy(block.bytes));
                for word in block.words() {
                    let Value::Number(number) = word.value else { continue };
                    let zero = number.decimal.mantissa == 0;
                    count += usize::from(zero && block.text(word.span).contains(&b'-'));
                    written += 1;
                }
            }
            count
        };
        // The user's own `X-.0` stays where it is right.
        let mut minus_zero = minus_zero;
        assert!(minus_zero(&after) <= minus_zero(&before), "{name}:\n{}", String::from_utf8_lossy(&after));
    }
    assert!(written > 5000, "{written}");
}

#[test]
fn comments_keep_their_bytes() {
    let mut high = 0;
    for (name, before, after) in outputs() {
        for comment in comments(&before) {
            high += usize::from(!comment.is_ascii());
            let there = after.windows(comment.len().max(1)).any(|window| window == comment);
            assert!(there || comment.is_empty(), "{name}: {}", String::from_utf8_lossy(comment));
        }
    }
    assert!(high >= 9, "only {high} comments in other bytes than ASCII");
}

#[test]
fn inserted_blocks_end_as_the_file_does() {
    let plain = format!("%\nO0001\n{HEAD}G1 Z50. F200.\nX900. Y700.\nM30\n%\n");
    let wanted = corrected("fanuc", &plain);
    assert!(wanted.lines().count() > plain.lines().count() + 4, "not split");
    for end in ["\r\n", "\r", "\r\r\n"] {
        let out = corrected("fanuc", &plain.replace('\n', end));
        assert_eq!(out, wanted.replace('\n', end), "{end:?}");
    }
}
