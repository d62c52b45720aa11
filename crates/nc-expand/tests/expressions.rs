//! Expressions against a reference that shares no algorithm with the product: a flat list of operands and
//! operators is reduced rank by rank, as one does on paper.

use crate::common;

use common::flat;
use proptest::prelude::*;

/// An operand: its text and value.
#[derive(Clone, Debug)]
struct Operand {
    text: String,
    value: f64,
}

/// Operators of LinuxCNC with their ranks, tightest first.
const LINUXCNC: [&[&str]; 5] =
    [&["**"], &["*", "/", "MOD"], &["+", "-"], &["LT", "GT", "LE", "GE", "EQ", "NE"], &["AND", "OR", "XOR"]];

fn apply(operator: &str, a: f64, b: f64) -> f64 {
    let truth = |holds: bool| if holds { 1.0 } else { 0.0 };
    match operator {
        "**" => a.powi(b as i32),
        "*" => a * b,
        "/" => a / b,
        "MOD" => a.rem_euclid(b),
        "+" => a + b,
        "-" => a - b,
        "LT" => truth(a < b),
        "GT" => truth(a > b),
        "LE" => truth(a <= b),
        "GE" => truth(a >= b),
        "EQ" => truth((a - b).abs() < 1e-4),
        "NE" => truth((a - b).abs() >= 1e-4),
        "AND" => truth(a != 0.0 && b != 0.0),
        "OR" => truth(a != 0.0 || b != 0.0),
        _ => truth((a != 0.0) != (b != 0.0)),
    }
}

fn reference(operands: &[Operand], operators: &[&str]) -> f64 {
    let mut values: Vec<f64> = operands.iter().map(|operand| operand.value).collect();
    let mut operators = operators.to_vec();
    for rank in LINUXCNC {
        while let Some(at) = operators.iter().position(|operator| rank.contains(operator)) {
            let value = apply(operators.remove(at), values[at], values[at + 1]);
            values[at] = value;
            values.remove(at + 1);
        }
    }
    values[0]
}

fn text(operands: &[Operand], operators: &[&str]) -> String {
    let mut text = operands[0].text.clone();
    for (operator, operand) in operators.iter().zip(&operands[1..]) {
        text.push_str(&format!(" {operator} {}", operand.text));
    }
    text
}

fn number() -> impl Strategy<Value = Operand> {
    (0..100_000_i64, 0..4_u32, any::<bool>()).prop_map(|(mantissa, decimals, negative)| {
        let shown = format!("{:.*}", decimals as usize, mantissa as f64 / f64::from(10_u32.pow(decimals)));
        let shown = if negative { format!("-{shown}") } else { shown };
        Operand { value: shown.parse().expect("a number"), text: shown }
    })
}

/// Numbers, functions of numbers, and brackets.
fn operand() -> impl Strategy<Value = Operand> {
    number().prop_recursive(3, 24, 4, |inner| {
        prop_oneof![
            (inner.clone(), 0..4_usize).prop_map(|(inside, which)| {
                let (name, value) = match which {
                    0 => ("ABS", inside.value.abs()),
                    1 => ("FIX", inside.value.floor()),
                    2 => ("FUP", inside.value.ceil()),
                    _ => ("-", -inside.value),
                };
                Operand { text: format!("{name}[{}]", inside.text), value }
            }),
            inner.clone().prop_map(|inside| Operand {
                text: format!("SQRT[ABS[{}]]", inside.text),
                value: inside.value.abs().sqrt(),
            }),
            (inner.clone(), inner, 0..13_usize).prop_map(|(a, b, which)| {
                let operator =
                    ["*", "+", "-", "LT", "GT", "LE", "GE", "EQ", "NE", "AND", "OR", "XOR", "/"][which];
                let b = if operator == "/" && b.value == 0.0 {
                    Operand { text: "3".into(), value: 3.0 }
                } else {
                    b
                };
                Operand {
                    value: apply(operator, a.value, b.value),
                    text: format!("[{} {operator} {}]", a.text, b.text),
                }
            }),
        ]
    })
}

fn computed(text: &str) -> f64 {
    let plain = flat("linuxcnc", &format!("X[{text}]\nM2\n"), &[], &[]);
    let line = plain.lines().find(|line| line.starts_with('X')).expect("a block with X");
    line[1..].parse().expect("a number")
}

/// What the written decimals leave of a value.
fn near(found: f64, wanted: f64) -> bool {
    let decimals: f64 = if wanted.abs() < 1e5 { 1e-9 } else { 1e-3 };
    (found - wanted).abs() <= 0.6 * decimals.max(wanted.abs() * 1e-15)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn operators_without_brackets(
        operands in prop::collection::vec(operand(), 2..7),
        picks in prop::collection::vec(0..14_usize, 6),
    ) {
        let names = ["*", "/", "MOD", "+", "-", "LT", "GT", "LE", "GE", "EQ", "NE", "AND", "OR", "XOR"];
        let operators: Vec<&str> = picks.iter().take(operands.len() - 1).map(|pick| names[*pick]).collect();
        let wanted = reference(&operands, &operators);
        // Division by zero and results beyond what a word holds are tested elsewhere.
        prop_assume!(wanted.is_finite() && wanted.abs() < 1e9);
        let text = text(&operands, &operators);
        let divides = operators.iter().zip(&operands[1..]).any(|(operator, operand)| {
            matches!(*operator, "/" | "MOD") && operand.value.abs() < 1e-9
        });
        prop_assume!(!divides);
        prop_assert!(near(computed(&text), wanted), "{} is {}, computed {}", text, wanted, computed(&text));
    }

    #[test]
    fn powers_bind_tightest(a in 1..9_i32, b in 0..4_i32, c in 0..3_i32, d in 1..9_i32) {
        let wanted = f64::from(d) * f64::from(a).powi(b).powi(c) + 1.0;
        prop_assume!(wanted < 1e6);
        let text = format!("1+{d}*{a}**{b}**{c}");
        prop_assert!(near(computed(&text), wanted), "{}", text);
    }

    #[test]
    fn angles_are_degrees(angle in -720.0..720.0f64) {
        let shown = format!("{angle:.3}");
        let radians = shown.parse::<f64>().expect("a number").to_radians();
        let computed_all = [computed(&format!("SIN[{shown}]")), computed(&format!("COS[{shown}]"))];
        prop_assert!((computed_all[0] - units::math::sin(radians)).abs() < 1e-9);
        prop_assert!((computed_all[1] - units::math::cos(radians)).abs() < 1e-9);
        // Where the angle jumps by a turn, the control's rounding decides, and nothing is computed.
        prop_assume!((angle.rem_euclid(360.0) - 180.0).abs() > 1e-3);
        let back = computed(&format!("ATAN[SIN[{shown}]]/[COS[{shown}]]"));
        prop_assert!((back - angle).rem_euclid(360.0).min((angle - back).rem_euclid(360.0)) < 2e-3);
    }

    /// Whatever the bytes, the answer is a program or a refusal with a place.
    #[test]
    fn any_text_is_expanded_or_refused(lines in prop::collection::vec("[#\\[\\]<>=+*/0-9.A-Zo ();%-]{0,24}", 0..12), linuxcnc: bool) {
        let text = lines.join("\n");
        let dialect = if linuxcnc { "linuxcnc" } else { "fanuc" };
        match common::expanded(dialect, &text, &[], &[]) {
            Ok(plain) => prop_assert!(plain.changed() || plain.text() == text.as_bytes()),
            Err(refusal) => {
                let span = refusal.diagnostics[0].span.clone().unwrap();
                prop_assert!(span.start <= span.end && span.end <= text.len() as u64);
                prop_assert!(refusal.diagnostics[0].help.is_some());
            }
        }
    }

    /// Programs of statements that mostly make sense.
    #[test]
    fn programs_of_flow_are_expanded_or_refused(picks in prop::collection::vec(0..16_usize, 1..20)) {
        let lines = ["#1=0", "#1=#1+1", "X#1", "IF[#1LT5]GOTO2", "N2 Y1.", "WHILE[#1LT9]DO1", "END1", "M98 P7",
            "M30", "O7", "M99", "G65 P7 A1.", "GOTO3", "N3 Z#2", "IF[#1EQ3]THEN #2=5", "%"];
        let mut text: Vec<&str> = picks.iter().map(|pick| lines[*pick]).collect();
        // Behind the closing `%` nothing is a program's, and what stands there is refused by who executes it.
        let mut percents = text.iter().enumerate().filter(|(_, line)| **line == "%");
        if let Some((closing, _)) = percents.nth(1) {
            text.truncate(closing + 1);
        }
        let text = text.join("\n");
        if let Ok(plain) = common::expanded("fanuc", &text, &[], &[]) {
            // What comes out has no flow left.
            let again = String::from_utf8(plain.text().to_vec()).unwrap();
            prop_assert!(!common::expanded("fanuc", &again, &[], &[]).is_ok_and(|plain| plain.changed()), "{}", again);
        }
    }
}
