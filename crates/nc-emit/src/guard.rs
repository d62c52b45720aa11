//! Blocks that stop a program where the control holds other values than those it was corrected for.

use nc_dialect::Dialect;
use nc_syntax::{GCode, Macros};
use units::decimal::Spelling;

/// Behind this stands what is guarded, in the alarm and in the program.
const MARKER: &str = "VPOST GUARD";
/// Name of the O-words, of which each is used once.
const O_WORD: &str = "o<vpost_guard_";
/// A value that is off by more stops the program, mm: half a step of a machine that resolves a micrometre.
const LIMIT_MM: f64 = 0.0005;
/// The same of a turned work offset, degrees: 2 um over a metre.
const LIMIT_DEG: f64 = 0.0001;

/// What a control is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// The work offset that a code selects, with its P.
    WorkOffset(GCode, Option<u32>),
    /// The tool length in force, by its H number.
    ToolLength(u32),
}

/// `G54`, `G54.1 P3`, `H7`: as they are written, and as the profile names them.
impl std::fmt::Display for Asked {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::WorkOffset(code, None) => write!(f, "{code}"),
            Self::WorkOffset(code, Some(p)) => write!(f, "{code} P{p}"),
            Self::ToolLength(number) => write!(f, "H{number}"),
        }
    }
}

/// What a program was corrected for: X, Y, Z, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stated {
    /// Machine coordinates of the work offset's zero.
    pub zero_mm: [f64; 3],
    /// What is added to program coordinates altogether: the work offset, shifts, the length of the tool.
    pub added_mm: [f64; 3],
}

/// Blocks that compare what a control holds with what is stated, an axis each; empty where the dialect has no way to ask.
///
/// Fanuc (custom macro B; B-63844EN, system variables): `#5221` and the external offset `#5201`, in the unit in force, alarm
/// 3001 to 3003. Its tool length in force (`#5083`) cannot be trusted while blocks are read ahead, and is not asked.
/// LinuxCNC (2.8 and newer): what `#<_abs_x>` is more than `#<_x>`, which is the work offset with every shift and the
/// length in force, in the unit in force; and the turn of the work offset.
///
/// * `unit_mm` – one unit of the program at that place, mm
/// * `serial` – guards that the program has already; is counted on
#[must_use]
pub fn guard(
    dialect: &Dialect,
    asked: Asked,
    stated: &Stated,
    unit_mm: f64,
    serial: &mut u32,
) -> Vec<String> {
    let mut lines = Vec::new();
    let (decimals, per_unit) = if unit_mm == 1.0 { (4, 1e4) } else { (5, 1e5) };
    let text = |mm: f64| {
        let mut text = Vec::new();
        let spelling =
            Spelling { leading_zero: true, trailing_zeros: false, trailing_point: true, plus: false };
        units::decimal::write(&mut text, units::decimal::round(mm / unit_mm * per_unit), decimals, spelling);
        String::from_utf8_lossy(&text).into_owned()
    };
    let limit = text(LIMIT_MM);
    match (dialect.flow.macros, asked) {
        (Macros::Fanuc, Asked::WorkOffset(code, number)) => {
            let Some(first) = fanuc_offset(code, number) else { return lines };
            for (axis, letter) in b"XYZ".iter().enumerate() {
                lines.push(format!(
                    "IF[ABS[#{}+#{}-[{}]]GT{limit}]#3000={}({MARKER} {asked} {})",
                    first + axis as u32,
                    5201 + axis,
                    text(stated.zero_mm[axis]),
                    axis + 1,
                    *letter as char,
                ));
            }
        }
        (Macros::LinuxCnc, asked) => {
            let mut put = |condition: String, what: char| {
                *serial += 1;
                lines.push(format!("{O_WORD}{serial}> if [{condition}]"));
                lines.push(format!("(abort, {MARKER} {asked} {what})"));
                lines.push(format!("{O_WORD}{serial}> endif"));
            };
            if let Asked::WorkOffset(code, _) = asked {
                let Some(first) = linuxcnc_offset(code) else { return lines };
                put(format!("ABS[#{}] GT {LIMIT_DEG}", first + 9), 'R');
            }
            for (axis, letter) in b"xyz".iter().enumerate() {
                let (letter, added) = (*letter as char, text(stated.added_mm[axis]));
                let condition = format!("ABS[#<_abs_{letter}>-#<_{letter}>-[{added}]] GT {limit}");
                put(condition, letter.to_ascii_uppercase());
            }
        }
        _ => {}
    }
    lines
}

/// The text with the guards of [`guard`] blanked out, every byte else where it was; `None` where it has none.
#[must_use]
pub fn without_guards(text: &[u8]) -> Option<Vec<u8>> {
    let mut found = None;
    let mut start = 0;
    while start < text.len() {
        let end = memchr::memchr2(b'\n', b'\r', &text[start..]).map_or(text.len(), |at| start + at);
        let line = &text[start..end];
        let marked = || memchr::memmem::find(line, MARKER.as_bytes()).is_some();
        let guards = line.starts_with(O_WORD.as_bytes())
            || (line.starts_with(b"(abort, ") && marked())
            || (line.starts_with(b"IF[ABS[#") && marked());
        if guards {
            found.get_or_insert_with(|| text.to_vec())[start..end].fill(b' ');
        }
        start = end + 1;
    }
    found
}

/// The variable of a work offset's X: six of 20 each, then those with P.
fn fanuc_offset(code: GCode, number: Option<u32>) -> Option<u32> {
    match (code.0, number) {
        (540 | 550 | 560 | 570 | 580 | 590, None) => Some(5221 + 20 * (u32::from(code.0) / 10 - 54)),
        (541, Some(p @ 1..=48)) => Some(7001 + 20 * (p - 1)),
        _ => None,
    }
}

/// The parameter of a work offset's X, of ten: X Y Z A B C U V W and the turn.
fn linuxcnc_offset(code: GCode) -> Option<u32> {
    match code.0 {
        540 | 550 | 560 | 570 | 580 | 590 => Some(5221 + 20 * (u32::from(code.0) / 10 - 54)),
        591..=593 => Some(5321 + 20 * (u32::from(code.0) - 590)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(dialect: &str, asked: Asked, zero_mm: [f64; 3], unit_mm: f64) -> Vec<String> {
        let dialect = nc_dialect::builtin(dialect).expect("it is shipped");
        let added_mm = [zero_mm[0], zero_mm[1], zero_mm[2] + 80.0];
        guard(dialect, asked, &Stated { zero_mm, added_mm }, unit_mm, &mut 0)
    }

    #[test]
    fn a_control_is_asked_in_its_own_words() {
        let lines = of("fanuc", Asked::WorkOffset(GCode(550), None), [-440.0, 12.3456, 0.0], 1.0);
        assert_eq!(lines[0], "IF[ABS[#5241+#5201-[-440.]]GT0.0005]#3000=1(VPOST GUARD G55 X)");
        assert_eq!(lines[1], "IF[ABS[#5242+#5202-[12.3456]]GT0.0005]#3000=2(VPOST GUARD G55 Y)");
        assert_eq!(lines[2], "IF[ABS[#5243+#5203-[0.]]GT0.0005]#3000=3(VPOST GUARD G55 Z)");
        let inch = of("fanuc", Asked::WorkOffset(GCode(541), Some(3)), [254.0, 0.0, 0.0], 25.4);
        assert_eq!(inch[0], "IF[ABS[#7041+#5201-[10.]]GT0.00002]#3000=1(VPOST GUARD G54.1 P3 X)");
        let lines = of("linuxcnc", Asked::WorkOffset(GCode(593), None), [0.0; 3], 1.0);
        assert_eq!(
            lines[..2],
            ["o<vpost_guard_1> if [ABS[#5390] GT 0.0001]", "(abort, VPOST GUARD G59.3 R)"]
        );
        assert_eq!(lines[9], "o<vpost_guard_4> if [ABS[#<_abs_z>-#<_z>-[80.]] GT 0.0005]");
        let lines = of("linuxcnc", Asked::ToolLength(7), [0.0; 3], 25.4);
        assert_eq!(lines[6], "o<vpost_guard_3> if [ABS[#<_abs_z>-#<_z>-[3.14961]] GT 0.00002]");
        // What cannot be asked.
        assert!(of("fanuc", Asked::ToolLength(7), [0.0, 0.0, 80.0], 1.0).is_empty());
        assert!(of("perspektiva", Asked::WorkOffset(GCode(540), None), [0.0; 3], 1.0).is_empty());
    }

    #[test]
    fn guards_are_blanked_and_nothing_else() {
        for dialect in ["fanuc", "linuxcnc"] {
            let guards = of(dialect, Asked::WorkOffset(GCode(540), None), [1.0, 2.0, 3.0], 1.0).join("\n");
            let program = format!("G54\n{guards}\nIF[ABS[#1]GT2]GOTO5\n(abort, mine)\n");
            let blank = without_guards(program.as_bytes()).expect("it has guards");
            assert_eq!(blank.len(), program.len());
            let lines: Vec<&str> = std::str::from_utf8(&blank).expect("ASCII").lines().collect();
            assert!(lines[1..lines.len() - 2].iter().all(|line| line.trim().is_empty()), "{lines:?}");
            assert_eq!(
                (lines[0], &lines[lines.len() - 2..]),
                ("G54", &["IF[ABS[#1]GT2]GOTO5", "(abort, mine)"][..])
            );
        }
        assert_eq!(without_guards(b"G54\nG0 X1.\n"), None);
    }
}
