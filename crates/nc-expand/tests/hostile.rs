//! Programs that would run or grow without end: refused quickly, whatever they hold.

use crate::common;

use std::time::{Duration, Instant};

use nc_expand::{Environment, Limits, expand};

/// Generous against a busy machine; the release build needs a tenth.
const SOON: Duration = Duration::from_secs(60);

/// The code of a refused program, which must come soon.
fn refusal(dialect: &str, text: &str) -> u16 {
    let setup = common::setup(nc_dialect::builtin(dialect).expect("shipped"));
    let environment = Environment {
        variables: &[],
        read_external: &common::nothing,
        setup: &setup,
        limits: Limits::default(),
    };
    let start = Instant::now();
    let result = expand(text.as_bytes(), nc_dialect::builtin(dialect).expect("shipped"), &environment);
    let took = start.elapsed();
    assert!(took < SOON, "{took:?} for {}", text.chars().take(60).collect::<String>());
    result.map(|plain| plain.text().len()).expect_err("it must be refused").diagnostics[0].code.0
}

#[test]
fn loops_of_a_million_million_turns() {
    assert_eq!(refusal("fanuc", "#1=0\nWHILE[#1LT1000000000000]DO1\n#1=#1+1\nEND1\nM30\n"), 130);
    assert_eq!(refusal("fanuc", "#1=0\nWHILE[#1LT1000000000000]DO1\nG1X#1\n#1=#1+1\nEND1\nM30\n"), 130);
    assert_eq!(refusal("linuxcnc", "o1 repeat [1000000000000]\nG91 G1 X0.001\no1 endrepeat\nM2\n"), 130);
    assert_eq!(refusal("fanuc", "N1 GOTO1\n"), 130);
    // Each pass opens with a comment.
    assert_eq!(refusal("fanuc", "O1\nM98 P2 L999999999\nM30\nO2\nM99\n"), 131);
    assert_eq!(refusal("fanuc", "WHILE[1EQ1]DO1\nEND1\nM30\n"), 130);
}

#[test]
fn calls_that_multiply() {
    let mut fanuc = String::from("O1\nM98 P2 L99\nM30\n");
    let mut linuxcnc = String::new();
    for level in 2..10 {
        fanuc.push_str(&format!("O{level}\nX1.\nM98 P{} L99\nM99\n", level + 1));
        linuxcnc.push_str(&format!(
            "o{} sub\nX1\n{}o{} endsub\n",
            level + 1,
            format!("o{level} call\n").repeat(9),
            level + 1
        ));
    }
    fanuc.push_str("O10\nX2.\nM99\n");
    assert!(matches!(refusal("fanuc", &fanuc), 130 | 131));
    let linuxcnc = format!("o2 sub\nX1\no2 endsub\n{linuxcnc}o10 call\nM2\n");
    assert!(matches!(refusal("linuxcnc", &linuxcnc), 130 | 131));
}

#[test]
fn long_blocks_that_repeat() {
    let comment = "x".repeat(60_000);
    assert_eq!(refusal("linuxcnc", &format!("o1 repeat [1000000]\n({comment})\no1 endrepeat\nM2\n")), 131);
    let sum = |parts| "1+".repeat(parts);
    assert_eq!(refusal("fanuc", &format!("N1 #1={}1\nGOTO1\n", sum(30_000))), 120);
    assert_eq!(refusal("fanuc", &format!("N1 #1={}1\nGOTO1\n", sum(400))), 130);
}

#[test]
fn brackets_without_end() {
    let deep = "[".repeat(20_000) + "1" + &"]".repeat(20_000);
    assert_eq!(refusal("fanuc", &format!("G1 X{deep}\nM30\n")), 120);
    assert_eq!(refusal("linuxcnc", &format!("#1={deep}\nM2\n")), 120);
    assert_eq!(refusal("fanuc", &format!("#1=-{}1\nM30\n", "-".repeat(20_000))), 120);
    assert_eq!(refusal("fanuc", &format!("X{}1\nM30\n", "#".repeat(20_000))), 120);
    let signs = format!("#1={}1", "SIN[".repeat(10_000)) + &"]".repeat(10_000);
    assert_eq!(refusal("linuxcnc", &format!("{signs}\nM2\n")), 120);
}

#[test]
fn a_long_program_with_one_call_is_no_bomb() {
    let text = format!("O1\nM98 P2\n{}M30\nO2\nX9.\nM99\n", "G1 X1. Y2.\n".repeat(300_000));
    let environment = Environment {
        variables: &[],
        read_external: &common::nothing,
        setup: &common::setup(nc_dialect::builtin("fanuc").expect("shipped")),
        limits: Limits { steps: 10, ..Limits::default() },
    };
    let plain = expand(text.as_bytes(), nc_dialect::builtin("fanuc").unwrap(), &environment).unwrap();
    assert!(plain.text().len() > 3_000_000);
}
