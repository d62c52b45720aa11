//! What must hold for any program.

use crate::common;

use common::{dialect, run, setup};
use nc_program::{Interpreter, Setup};
use nc_syntax::{Block, Reader};
use proptest::prelude::*;
use toolpath::Motion;

/// Words that meet, contradict and complete each other.
const WORDS: [&str; 56] = [
    "G0", "G1", "G2", "G3", "G4", "G17", "G18", "G19", "G20", "G21", "G28", "G30", "G31", "G40", "G41",
    "G43", "G44", "G49", "G53", "G54", "G55", "G56", "G73", "G80", "G81", "G83", "G90", "G91", "G93", "G94",
    "G98", "G99", "X1.", "X-2.5", "Y0", "Y3.", "Z5.", "Z-1.", "I1.", "J-1.", "K2.", "K2", "R2.", "R-3.",
    "Q1.", "P1", "F100.", "H1", "H9", "T1", "M6", "M8", "A10.", "(c)", "X#1", "M30",
];

fn programs() -> impl Strategy<Value = String> {
    let block = (prop::bool::weighted(0.1), prop::collection::vec(prop::sample::select(&WORDS[..]), 0..6));
    prop::collection::vec(block, 1..40).prop_map(|blocks| {
        let lines = blocks
            .iter()
            .map(|(skip, words)| format!("{}{}\n", if *skip { "/" } else { "" }, words.join(" ")));
        lines.collect()
    })
}

/// Steps through a program past its refusals; returns everything that was said.
fn transcript(name: &str, setup: &Setup, text: &str) -> String {
    let dialect = dialect(name);
    let mut reader = Reader::new(text.as_bytes(), dialect);
    let mut interpreter = Interpreter::new(dialect, setup);
    let mut block = Block::default();
    let mut said = String::new();
    while reader.next(&mut block) {
        let before = interpreter.modal().clone();
        let result = interpreter.step(&block);
        if let Ok(step) = &result {
            for motion in &step.motions {
                assert_sound(motion);
            }
        } else {
            assert_eq!(*interpreter.modal(), before, "{:?}", String::from_utf8_lossy(block.bytes));
        }
        said.push_str(&format!("{result:?}\n"));
    }
    said
}

/// A motion starts where the one before it ended is checked by `chained`; this looks at one alone.
fn assert_sound(motion: &Motion) {
    let finite = |values: &[f64]| assert!(values.iter().all(|v| v.is_finite()), "{motion:?}");
    match motion {
        Motion::Feed(feed) => {
            finite(&feed.start.linear_mm);
            finite(&feed.end.linear_mm);
            if let toolpath::Shape::Arc(arc) = feed.shape {
                finite(&arc.centre_mm);
                assert!(arc.sweep_rad != 0.0 && arc.sweep_rad.abs() <= std::f64::consts::TAU, "{motion:?}");
            }
        }
        Motion::Hole(hole) => {
            finite(&hole.start.linear_mm);
            finite(&hole.at_r.linear_mm);
            finite(&[hole.bottom_mm, hole.initial_mm]);
            assert_eq!(hole.end().rotary_deg, hole.start.rotary_deg);
        }
        Motion::Rapid { end, .. } | Motion::Uncorrected { end, .. } => {
            finite(&end.linear_mm.map(|v| v.unwrap_or(0.0)));
        }
    }
}

/// Places, but for those that are no longer known.
fn forgetting(at: [Option<f64>; 3], now: [Option<f64>; 3]) -> [Option<f64>; 3] {
    [0, 1, 2].map(|i| now[i].and(at[i]))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    /// Any program, right or wrong: no panic, the same answer twice, an error leaves the state alone.
    #[test]
    fn any_program_twice(text in programs(), name in prop::sample::select(vec!["fanuc", "linuxcnc", "perspektiva", "centroid"]),
                         with_a: bool, known: bool) {
        let setup = Setup { has_rotary: [with_a, false, false], rotary_matters: true, start_mm: [known.then_some(0.0); 3], ..setup() };
        prop_assert_eq!(transcript(name, &setup, &text), transcript(name, &setup, &text));
    }

    /// Motions are one path: each starts where the one before it ended, wherever both are known.
    #[test]
    fn motions_are_chained(text in programs()) {
        let dialect = dialect("fanuc");
        let setup = Setup { start_mm: [Some(0.0); 3], ..setup() };
        let mut reader = Reader::new(text.as_bytes(), dialect);
        let mut interpreter = Interpreter::new(dialect, &setup);
        let mut block = Block::default();
        let mut at = [Some(0.0); 3];
        while reader.next(&mut block) {
            // Behind moves that may have been skipped nobody knows where the axes are.
            let aside = interpreter.modal().aside.as_ref();
            let open = aside.is_some() || block.switches() != 0;
            let closes = aside.is_some_and(|aside| aside.moved && block.acts() && aside.switches != block.switches());
            let Ok(step) = interpreter.step(&block) else { continue };
            if closes {
                at = [None; 3];
            }
            for motion in &step.motions {
                let (start, end) = match motion {
                    Motion::Rapid { start, end } => (start.linear_mm, end.linear_mm),
                    Motion::Feed(feed) => (feed.start.linear_mm.map(Some), feed.end.linear_mm.map(Some)),
                    Motion::Hole(hole) => (hole.start.linear_mm.map(Some), hole.end().linear_mm.map(Some)),
                    Motion::Uncorrected { end, .. } => (at, end.linear_mm),
                };
                // A tool length that changes may move its axis: nobody knows where it is then.
                prop_assert_eq!(start, forgetting(at, start));
                at = end;
            }
            at = forgetting(at, interpreter.modal().axes.partial().linear_mm);
            // `/M30` closes the blocks that may be skipped too.
            if open && interpreter.modal().aside.is_none() {
                at = interpreter.modal().axes.partial().linear_mm;
            }
            prop_assert_eq!(interpreter.modal().axes.partial().linear_mm, at);
        }
    }

    /// The words of a block may stand in any order.
    #[test]
    fn order_inside_a_block_is_free(words in prop::sample::subsequence(
            vec!["G91", "G1", "G55", "G43", "H2", "X1.5", "Y-2.", "Z3.", "F100.", "M8", "G94"], 0..=11).prop_shuffle()) {
        let sorted = { let mut sorted = words.clone(); sorted.sort_unstable(); sorted };
        let go = |words: &[&str]| run("linuxcnc", &format!("T1 M6\nG0 X0 Y0 Z0\n{}\n", words.join(" "))).modal;
        prop_assert_eq!(go(&words), go(&sorted));
    }

    /// The same path in increments and in absolute coordinates ends in the same place.
    #[test]
    fn increments_equal_absolute_coordinates(steps in prop::collection::vec((-9999i32..9999, -9999i32..9999, -9999i32..9999), 1..60)) {
        let thousandths = |v: i32| format!("{}{}.{:03}", if v < 0 { "-" } else { "" }, v.abs() / 1000, v.abs() % 1000);
        let mut absolute = "G90 G1 F100.\n".to_owned();
        let mut incremental = "G91 G1 F100.\n".to_owned();
        let mut at = [0i32; 3];
        for (x, y, z) in steps {
            at = [at[0] + x, at[1] + y, at[2] + z];
            absolute.push_str(&format!("X{} Y{} Z{}\n", thousandths(at[0]), thousandths(at[1]), thousandths(at[2])));
            incremental.push_str(&format!("X{} Y{} Z{}\n", thousandths(x), thousandths(y), thousandths(z)));
        }
        let start = "G55 G43 H1 G0 X0. Y0. Z0.\n";
        let one = run("fanuc", &format!("{start}{absolute}"));
        let other = run("fanuc", &format!("{start}{incremental}"));
        prop_assert!(one.refused.is_none() && other.refused.is_none());
        for (a, b) in one.modal.axes.partial().linear_mm.iter().zip(other.modal.axes.partial().linear_mm) {
            prop_assert!((a.unwrap_or(f64::NAN) - b.unwrap_or(f64::NAN)).abs() < 1e-9);
        }
    }

    /// Any bytes: an answer, no panic.
    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400), name in prop::sample::select(vec!["fanuc", "linuxcnc"])) {
        let dialect = dialect(name);
        let setup = setup();
        let mut reader = Reader::new(&bytes, dialect);
        let mut interpreter = Interpreter::new(dialect, &setup);
        let mut block = Block::default();
        while reader.next(&mut block) {
            let before = interpreter.modal().clone();
            if interpreter.step(&block).is_err() {
                prop_assert_eq!(interpreter.modal(), &before);
            }
        }
    }
}
