//! What is fuzzed: functions of bytes that panic where a promise is broken.
//!
//! A program's first byte says under which dialect and for which machine it is read (see [`split`]); the rest is the
//! program. The same functions are run by libFuzzer (`targets/`) and by `cargo test -p vpost --test fuzz`.

mod five_axis;
mod generate;
mod machines;

use nc_expand::{Environment, Limits, expand};
use nc_program::{Interpreter, Setup};
use nc_syntax::{Block, Reader};

pub use generate::program;
pub use machines::{DIALECTS, letter, split};
use machines::{Machine, session};

/// What became of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Refused, by the number of its message.
    Refused(u16),
    /// Needs no correction.
    Unchanged,
    /// Corrected, and the check held.
    Corrected,
}

/// Work for one program ends here; the command allows a thousand times as much.
pub const LIMITS: Limits = Limits { steps: 2_000, output_bytes: 16 << 10, depth: 10 };

/// Any bytes: the blocks are the file's bytes, their items lie in them in order; flow and programs are read without a
/// panic.
pub fn parse(bytes: &[u8]) {
    let (name, _, bytes) = split(bytes);
    let dialect = nc_dialect::builtin(name).expect("shipped");
    let setup = Setup { start_mm: [Some(0.0); 3], ..Setup::default() };
    blocks(bytes, name, &setup);
    let nothing = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let environment = Environment { variables: &[], read_external: &nothing, setup: &setup, limits: LIMITS };
    if let Ok(plain) = expand(bytes, dialect, &environment)
        && plain.changed()
    {
        blocks(plain.text(), name, &setup);
    }
}

fn blocks(bytes: &[u8], name: &str, setup: &Setup) {
    let dialect = nc_dialect::builtin(name).expect("shipped");
    let mut reader = Reader::new(bytes, dialect);
    let mut interpreter = Interpreter::new(dialect, setup);
    let mut block = Block::default();
    let mut at = 0;
    while reader.next(&mut block) {
        assert_eq!(block.offset, at as u64, "{name}: a block does not follow the one before it");
        assert!(!block.bytes.is_empty(), "{name}: a block of nothing");
        assert_eq!(block.bytes, &bytes[at..at + block.bytes.len()], "{name}: other bytes than the file's");
        at += block.bytes.len();
        let mut end = 0;
        for item in &block.items {
            assert!(end <= item.span.start && item.span.start <= item.span.end, "{name}: {:?}", block.items);
            end = item.span.end;
        }
        assert!(end as usize <= block.bytes.len(), "{name}: an item beyond its block");
        let before = interpreter.modal().clone();
        if let Err(diagnostics) = interpreter.step(&block) {
            assert!(!diagnostics.is_empty(), "{name}: refused without a word");
            assert_eq!(*interpreter.modal(), before, "{name}: a refused block left its mark");
        }
    }
    assert_eq!(at, bytes.len(), "{name}: bytes are missing");
}

/// A machine without errors gives a program back as it is, or refuses it.
pub fn round_trip(bytes: &[u8]) -> Outcome {
    let (dialect, _, text) = split(bytes);
    match session(dialect, Machine::Perfect).correct(text) {
        Err(refusal) => refused(dialect, &refusal.0),
        Ok(done) if done.text == text => Outcome::Unchanged,
        Ok(done) => {
            panic!("{dialect}: a machine without errors changed the program\n{}", both(text, &done.text))
        }
    }
}

/// What is corrected passes `vpost check`, and is refused when it comes again.
pub fn correct_check(bytes: &[u8]) -> Outcome {
    let (dialect, machine, text) = split(bytes);
    judged(dialect, machine, text)
}

/// The same of a program of a grammar, all choices taken from `bytes`.
pub fn generated(bytes: &[u8]) -> Outcome {
    let (dialect, machine, rest) = split(bytes);
    let text = match rest.split_last() {
        // Half of them with what stands for motions; of lathes all.
        Some((last, rest)) if last % 2 == 1 || dialect == "fanuc-lathe" => {
            generate::shorthand(rest, if dialect == "fanuc-lathe" { "fanuc-lathe A" } else { dialect })
        }
        _ => program(rest, dialect),
    };
    blocks(text.as_bytes(), dialect, &Setup::default());
    judged(dialect, machine, text.as_bytes())
}

/// Programs with rotary words – axes run evenly, tip led, planes, vectors – for a tilting table: what is corrected passes
/// `vpost check`; a table without errors gives the program back. Choices past the program damage it.
pub fn five_axis(bytes: &[u8]) -> Outcome {
    let (&machine, rest) = bytes.split_first().unwrap_or((&0, &[]));
    let (dialect, text) = five_axis::program(rest);
    blocks(&text, dialect, &Setup::default());
    match machine % 4 {
        0 | 1 => judged(dialect, Machine::Table, &text),
        2 => judged(dialect, Machine::Pointed, &text),
        _ => match session(dialect, Machine::PerfectTable).correct(&text) {
            Err(refusal) => refused(dialect, &refusal.0),
            Ok(done) if done.text == text => Outcome::Unchanged,
            Ok(done) => {
                panic!("{dialect}: a table without errors changed the program\n{}", both(&text, &done.text))
            }
        },
    }
}

fn judged(dialect: &str, machine: Machine, text: &[u8]) -> Outcome {
    let session = session(dialect, machine);
    let (out, warnings) = match session.correct(text) {
        Err(refusal) => return refused(dialect, &refusal.0),
        Ok(done) => (done.text, done.figures.warnings),
    };
    let mut findings = match session.check(text, &out) {
        Ok(findings) => findings,
        Err(refusal) => vec![refusal.0],
    };
    // A tapping cycle drills straight down whatever the machine does: the command says by how much it leans, and the
    // check says it too.
    if warnings.iter().any(|warning| warning.code == rewrite::LEANING_CYCLE) {
        // Where many holes lean the list ends before the last of them.
        let leans = |finding: &String| {
            finding.contains(" um off the path of line ") || finding.ends_with(" more of the path")
        };
        findings.retain(|finding| !leans(finding));
    }
    assert!(findings.is_empty(), "{dialect}, {machine:?}: {findings:#?}\n{}", both(text, &out));
    if out == text {
        return Outcome::Unchanged;
    }
    let again = session.correct(&out);
    assert!(
        again.as_ref().is_err_and(|refusal| refusal.0.starts_with("error[VP0505]")),
        "{dialect}, {machine:?}: a second pass gave {again:?}\n{}",
        both(text, &out)
    );
    Outcome::Corrected
}

fn refused(dialect: &str, said: &str) -> Outcome {
    let code = said.strip_prefix("error[VP").and_then(|rest| rest.get(..4)?.parse().ok());
    Outcome::Refused(code.unwrap_or_else(|| panic!("{dialect}: refused with `{said}`")))
}

fn both(posted: &[u8], corrected: &[u8]) -> String {
    let shown = |text: &[u8]| text.escape_ascii().to_string().replace("\\n", "\n");
    format!("--- posted\n{}\n--- corrected\n{}", shown(posted), shown(corrected))
}

/// Profiles (`p`, a table behind a NUL), dialect tables (`g`), measurements (anything else): an answer, no panic; what
/// is accepted can be used.
pub fn tables(bytes: &[u8]) {
    match bytes.split_first() {
        Some((b'p', rest)) => {
            let mut parts = rest.splitn(2, |byte| *byte == 0);
            let text = String::from_utf8_lossy(parts.next().unwrap_or_default());
            let table = parts.next().unwrap_or_default().to_vec();
            if let Ok(profile) = machine_profile::load(&text, &|_: &str| Ok(table.clone())) {
                let middle = profile.volume().nearest(&machine_model::Vector::zeros());
                let command = machine_model::Command {
                    linear_mm: middle,
                    rotary_rad: machine_model::Vector::zeros(),
                    tool_mm: profile.default_tool_mm.into(),
                    direction: [1; 3],
                    ..Default::default()
                };
                let error = profile.rigid_body_without_effects().predict(&command).error_mm;
                assert!(error.iter().all(|v| v.is_finite()), "{error:?} at {middle:?}\n{text}");
            }
        }
        Some((b'g', rest)) => {
            if let Ok(dialect) = nc_dialect::load("fuzzed", &String::from_utf8_lossy(rest)) {
                let text = b"%\nO1\nG21 G90 G0 X1. Y2 Z3.\nG1 X1 F100.\nM30\n%\n";
                let mut reader = Reader::new(text, &dialect);
                let setup = Setup::default();
                let mut interpreter = Interpreter::new(&dialect, &setup);
                let mut block = Block::default();
                while reader.next(&mut block) {
                    // A refusal is an answer.
                    let _ = interpreter.step(&block);
                }
            }
        }
        _ => {
            // A refusal is an answer.
            let _ = session("fanuc", Machine::Crooked).read_measurements(bytes);
        }
    }
}
