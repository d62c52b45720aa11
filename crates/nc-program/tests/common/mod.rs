//! Programs as text, run through the reader and a shipped dialect.

use diagnostic::Diagnostic;
use nc_dialect::Dialect;
use nc_program::{Interpreter, Modal, Setup, Step};
use nc_syntax::{Block, Reader};
use toolpath::{Feed, Hole, Motion, Partial, Shape};

pub(crate) fn dialect(name: &str) -> &'static Dialect {
    nc_dialect::builtin(name).expect("a shipped dialect")
}

/// G54 at the machine's zero, G55 shifted, H1 of 120 mm, H2 of 80 mm.
pub(crate) fn setup() -> Setup {
    Setup {
        work_offsets: vec![("G54".to_owned(), [0.0; 3]), ("G55".to_owned(), [100.0, 10.0, 1.0])],
        tools: vec![(1, [0.0, 0.0, 120.0]), (2, [0.5, 0.0, 80.0])],
        ..Setup::default()
    }
}

pub(crate) struct Run {
    pub(crate) steps: Vec<Step>,
    pub(crate) modal: Modal,
    /// Line and diagnostics of the block that was refused; nothing is run after it.
    pub(crate) refused: Option<(u64, Vec<Diagnostic>)>,
}

pub(crate) fn run_with(dialect: &Dialect, setup: &Setup, text: &str) -> Run {
    let mut reader = Reader::new(text.as_bytes(), dialect);
    let mut interpreter = Interpreter::new(dialect, setup);
    let mut block = Block::default();
    let mut steps = Vec::new();
    let mut refused = None;
    while reader.next(&mut block) {
        let before = interpreter.modal().clone();
        match interpreter.step(&block) {
            Ok(step) => steps.push(step),
            Err(diagnostics) => {
                assert_eq!(*interpreter.modal(), before, "an error leaves the state as it was");
                refused = Some((block.line, diagnostics));
                break;
            }
        }
    }
    Run { steps, modal: interpreter.modal().clone(), refused }
}

pub(crate) fn run(name: &str, text: &str) -> Run {
    run_with(dialect(name), &setup(), text)
}

/// All motions of a program that must not be refused.
pub(crate) fn motions(name: &str, text: &str) -> Vec<Motion> {
    let run = run(name, text);
    if let Some((line, diagnostics)) = &run.refused {
        panic!("line {line} of {text:?} is refused: {diagnostics:#?}");
    }
    run.steps.into_iter().flat_map(|step| step.motions).collect()
}

/// Code and line of the refusal.
pub(crate) fn refusal(name: &str, text: &str) -> (u16, u64) {
    let run = run(name, text);
    let Some((line, diagnostics)) = run.refused else { panic!("{text:?} is accepted: {:?}", run.modal) };
    assert!(!diagnostics.is_empty());
    for diagnostic in &diagnostics {
        assert!(diagnostic.span.is_some() && diagnostic.help.is_some(), "place and way out: {diagnostic:?}");
    }
    (diagnostics[0].code.0, line)
}

/// The refusal as the user meets it, without the frame around the line.
pub(crate) fn message(name: &str, text: &str) -> String {
    message_with(dialect(name), &setup(), text)
}

pub(crate) fn message_with(dialect: &Dialect, setup: &Setup, text: &str) -> String {
    let run = run_with(dialect, setup, text);
    let Some((line, diagnostics)) = run.refused else { panic!("{text:?} is accepted") };
    diagnostics
        .iter()
        .map(|d| {
            let span = d.span.clone().expect("each refusal has a place");
            let at = &text[span.start as usize..span.end as usize];
            format!(
                "{d}\n  {line}: `{at}` {}\n  help: {}\n",
                d.label,
                d.help.as_ref().map(|help| help.english()).unwrap_or("-")
            )
        })
        .collect()
}

/// X, Y, Z where the program ends.
pub(crate) fn end(name: &str, text: &str) -> [Option<f64>; 3] {
    let run = run(name, text);
    assert!(run.refused.is_none(), "{text:?}: {:?}", run.refused);
    run.modal.axes.partial().linear_mm
}

pub(crate) fn feed(motion: &Motion) -> &Feed {
    if let Motion::Feed(feed) = motion { feed } else { panic!("{motion:?} is no feed") }
}

pub(crate) fn hole(motion: &Motion) -> &Hole {
    if let Motion::Hole(hole) = motion { hole } else { panic!("{motion:?} is no hole") }
}

pub(crate) fn sweep(motion: &Motion) -> f64 {
    if let Shape::Arc(arc) = feed(motion).shape { arc.sweep_rad } else { panic!("{motion:?} is no arc") }
}

pub(crate) fn centre(motion: &Motion) -> [f64; 2] {
    if let Shape::Arc(arc) = feed(motion).shape { arc.centre_mm } else { panic!("{motion:?} is no arc") }
}

pub(crate) fn uncorrected(motion: &Motion) -> &Partial {
    if let Motion::Uncorrected { end, .. } = motion { end } else { panic!("{motion:?} is corrected") }
}
