//! What a program as a whole shows: signs of a lathe, lengths without a point, unknown M codes, the unit, a cut.

use crate::common;

use common::{dialect, setup};
use diagnostic::Severity;
use nc_program::{Evidence, Questions, Setup};
use nc_syntax::{PlainLine, Reader};

/// What refuses a program, else what is doubtful about it: the number, its line, the words it is about.
fn verdict(name: &str, text: &str) -> Vec<(u16, u64, String)> {
    verdict_with(name, &setup(), text)
}

fn verdict_with(name: &str, setup: &Setup, text: &str) -> Vec<(u16, u64, String)> {
    let questions = Questions::new(dialect(name), setup);
    let evidence = Evidence::of(text.as_bytes(), &questions);
    let findings = match evidence.refusal(&questions) {
        Err(finding) => vec![*finding],
        Ok(()) => {
            let doubts = evidence.doubts(&questions);
            assert!(doubts.iter().all(|(doubt, _)| doubt.severity == Severity::Doubt));
            doubts
        }
    };
    findings
        .into_iter()
        .map(|(diagnostic, line)| {
            let span = diagnostic.span.expect("every finding has a place");
            (diagnostic.code.0, line, text[span.start as usize..span.end as usize].to_owned())
        })
        .collect()
}

fn codes(name: &str, text: &str) -> Vec<u16> {
    verdict(name, text).into_iter().map(|(code, _, _)| code).collect()
}

#[test]
fn a_sure_sign_of_a_lathe_is_enough() {
    for text in [
        "G21\nG0 X50. Y0.\nG71 P10 Q20 U0.5 W0.1 F0.3\n",
        "G21\nG71 U2. R1.\n",
        "G21\nG76 P021060 Q100 R0.05\n",
        "G21\nG92 X28. Z-30. F1.5\n",
    ] {
        assert_eq!(codes("fanuc", text), [240], "{text}");
    }
    assert_eq!(codes("sinumerik", "DIAMON\nG0 X10 Y10\n"), [240]);
}

#[test]
fn hints_of_a_lathe_count_together_or_where_y_is_never_named() {
    let alone = "G21\nG96 S180 M3\nG0 X62. Y0. Z2.\n";
    assert_eq!(codes("fanuc", alone), [0; 0]);
    assert_eq!(verdict("fanuc", &format!("{alone}G50 S2000\n")), [(240, 2, "G96 S180 M3".to_owned())]);
    assert_eq!(codes("fanuc", &format!("{alone}G92 S2000\n")), [240]);
    assert_eq!(codes("fanuc", "G21\nG96 S180 M3\nG0 X62. Z2.\n"), [240]);
    assert_eq!(codes("fanuc", "G21\nT0101\nG0 X62. Z2.\nG1 Z-30. F0.2\n"), [240]);
    assert_eq!(codes("fanuc", "G21\nG0 X62. Z2.\nG1 X50. W-3. F0.2\n"), [240]);
    assert_eq!(codes("fanuc", "G21\nG0 X62. Z2.\nG90 X58. Z-30. F0.25\n"), [240]);
}

#[test]
fn programs_of_mills_are_no_lathes() {
    for text in [
        // G90 beside its motion code, in a program that never names Y.
        "G21\nG0 X10. Z5.\nG90 G1 X20. Z-5. F100\n",
        // Cancelled beside others, before the spindle starts.
        "G21\nG17 G40 G50 G80 S1200 M3\nG0 X1. Z1.\n",
        // Fine boring, left-hand tapping, pecks.
        "G21\nG0 X1. Z9.\nG76 X1. Z-5. R2. Q0.1 P1000 F50\nG74 X1. Z-5. R2. P500 F50\nG73 X1. Z-5. R2. Q2. F50\n",
        // Tools with four digits.
        "G21\nT1012 M6\nG0 X1. Z9.\n",
        "G21\nT1000\nG0 X1. Z9.\n",
        // A dwell and an argument.
        "G21\nG0 X1. Z9.\nG4 U2.\n",
    ] {
        assert_eq!(codes("fanuc", text), [0; 0], "{text}");
    }
}

#[test]
fn lengths_that_mix_two_conventions_are_refused_until_somebody_says() {
    let mixed = "G21\nG0 X10. Y10.\nZ5\n";
    assert_eq!(verdict("fanuc", mixed), [(241, 3, "Z5".to_owned())]);
    let settled = Setup { lengths_settled: true, ..setup() };
    assert_eq!(verdict_with("fanuc", &settled, mixed), []);
    // Zero is zero; a dwell, a peck, counts and codes are no lengths.
    let innocent = "G21\nG0 X0 Y0 Z10.\nG4 X2\nG83 X1. Z-9. R2. Q3000 P100 K2 F100\nG28 Z0\nG43 H1\nX#1\n";
    assert_eq!(codes("fanuc", innocent), [0; 0]);
    assert_eq!(codes("linuxcnc", mixed), [0; 0]);
    // The turn of a rotary axis and of the frame count too.
    assert_eq!(codes("fanuc", "G21\nG0 X1.\nA90\n"), [241]);
    assert_eq!(codes("fanuc", "G21\nG0 X1.\nG68 X0 Y0 R30\n"), [241]);
}

#[test]
fn bare_lengths_alone_are_counted() {
    assert_eq!(verdict("fanuc", "G21\nG0 X10000 Y0\nZ5000\n"), [(242, 2, "X10000".to_owned())]);
    let questions = Questions::new(dialect("fanuc"), &Setup::default());
    let doubts = Evidence::of(b"G21\nG0 X10000 Y0\nZ5000\n", &questions).doubts(&questions);
    assert!(doubts[0].0.message.english().starts_with("2 length(s)"), "{}", doubts[0].0.message);
}

/// `X40` of a post for LinuxCNC, read by a control that counts increments: a part of 0.04 mm is none.
#[test]
fn a_program_of_forty_increments_is_refused() {
    let small = "G21\nG0 X10 Y10 Z60\nG1 Z-5 F200\nX40 Y30\n";
    assert_eq!(verdict("fanuc", small), [(242, 2, "X10".to_owned())]);
    let refused = |dialect_name: &str, text: &str, setup: &Setup| {
        let questions = Questions::new(dialect(dialect_name), setup);
        Evidence::of(text.as_bytes(), &questions).refusal(&questions).is_err()
    };
    let open = Setup::default();
    assert!(refused("fanuc", small, &open) && !refused("linuxcnc", small, &open));
    // One length of a millimetre, a point, or who says what they are: nothing is contradicted.
    assert!(!refused("fanuc", &small.replace("Z60", "Z1000"), &open));
    assert!(!refused("fanuc", small, &Setup { lengths_settled: true, ..Setup::default() }));
    assert!(!refused("fanuc", "G21\nG0 X10\nG0 Y10\n", &open), "two lengths say nothing");
}

#[test]
fn what_one_control_alone_writes_refuses_under_others() {
    assert_eq!(codes("linuxcnc", "G21\nG0 X1. Y1.\nM97 P1000 L3\n"), [246]);
    assert_eq!(codes("fanuc", "G21\nG0 X1. Y1.\nM97 P1000\n"), [246]);
    assert_eq!(codes("haas", "G21\nG0 X1. Y1.\nM97 P1000\n"), [0; 0]);
    assert_eq!(codes("mach", "%_N_PART_MPF\nG21\nG0 X1. Y1.\n"), [246]);
    assert_eq!(codes("sinumerik", "%_N_PART_MPF\nG0 X1. Y1.\n"), [0; 0]);
}

#[test]
fn unknown_m_codes_are_one_doubt_with_their_count() {
    assert_eq!(verdict("fanuc", "G21\nM3\nM777\nM8\nM12\nM777 M98 P1\n"), [(243, 3, "M777".to_owned())]);
    let questions = Questions::new(dialect("fanuc"), &Setup::default());
    let doubts = Evidence::of(b"M777\nM12\nm777\n", &questions).doubts(&questions);
    let (doubt, _) = &doubts[0];
    assert!(
        doubt.message.english().starts_with("3 M code(s)") && doubt.message.english().ends_with("M12, M777"),
        "{}",
        doubt.message
    );
    assert!(
        doubt
            .help
            .as_ref()
            .map(|help| help.english())
            .is_some_and(|help| help.contains("harmless = [\"M12\", \"M777\"]"))
    );
}

#[test]
fn a_unit_that_nobody_states_is_doubtful_where_the_control_keeps_one() {
    assert_eq!(verdict("fanuc", "G90\nG0 X1. Y1.\n"), [(244, 2, "X1.".to_owned())]);
    assert_eq!(codes("fanuc", "G0 X1. Y1.\nG20\n"), [0; 0]);
    assert_eq!(codes("fanuc", "M3 S500\nM30\n"), [0; 0]);
    assert_eq!(codes("linuxcnc", "G0 X1 Y1\n"), [0; 0]);
}

#[test]
fn a_program_that_was_cut_off() {
    assert_eq!(verdict("fanuc", "%\nO1\nG21\nG0 X1. Y1.\n"), [(245, 1, "%".to_owned())]);
    assert_eq!(verdict("fanuc", "G21\nG0 X1. Y1.\nG1 X12.5"), [(245, 3, "X12.5".to_owned())]);
    assert_eq!(codes("fanuc", "%\nG21\nG0 X1.\nM3"), [245]);
    for whole in [
        "%\nG21\nG0 X1.\nM30",
        "%\nG21\nG0 X1.\n%",
        "G21\nG0 X1.\n%\n",
        "G21\nG0 X1.\n",
        "G21\nG0 X1. (END)",
        "O1\nG21\nM99",
    ] {
        assert_eq!(codes("fanuc", whole), [0; 0], "{whole:?}");
    }
}

/// Parts add up to the whole, and plain lines may be seen as what they are.
#[test]
fn parts_and_plain_lines_add_up() {
    let text =
        "%\nO1\nG21\nT0101\nG0 X10. Y20. Z5.\nG1 X12. F100\nY3000\nX4. Z2.\nM777\nG96 S100\nX5\nM30\n%\n";
    let setup = setup();
    let questions = Questions::new(dialect("fanuc"), &setup);
    let whole = Evidence::of(text.as_bytes(), &questions);
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    for cut in 1..lines.len() {
        let mut offset = 0;
        let mut sum = Evidence::default();
        for part in [lines[..cut].concat(), lines[cut..].concat()] {
            let mut evidence = Evidence::default();
            // The program's own envelope: all of it is read.
            let mut finder = nc_syntax::EnvelopeFinder::new(dialect("fanuc"));
            finder.see(text.as_bytes());
            let line = 1 + text[..offset].matches('\n').count() as u64;
            let place = nc_syntax::Place { offset: offset as u64, line, expects_name: false };
            let mut reader = Reader::part(part.as_bytes(), dialect("fanuc"), finder.finish(), place);
            let (mut plain, mut block) = (PlainLine::default(), nc_syntax::Block::default());
            loop {
                if reader.plain_line(&mut plain) {
                    // What sets something is no plain line.
                    let places = |letter: u8| b"XYZ".contains(&letter);
                    let words = plain.words();
                    if offset > 0
                        && words[0].letter() != b'G'
                        && words.iter().any(|word| places(word.letter()))
                    {
                        evidence.see_line(&plain, &questions);
                        continue;
                    }
                    reader.unread(&plain);
                }
                if reader.next(&mut block) {
                    evidence.see(&block, &questions);
                } else {
                    break;
                }
            }
            sum.add(&evidence);
            offset += part.len();
        }
        assert_eq!(sum, whole, "cut behind line {cut}");
    }
}
