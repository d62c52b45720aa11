//! Which control a program looks written for, where the dialect that reads it is another one's.
//!
//! Controls share most of their codes, and what one of them alone writes gives it away: `VC1=5`, `CYCLE81(`, `TOOL CALL`.
//! A program is refused by the first of these that its dialect cannot read; that it is the dialect that is wrong, and not
//! the block, is said here. A sign that the dialect does read, as something else, refuses the program by itself
//! (`G15 H1`, `M97 P1000`, see [`crate::Evidence`]).

use std::ops::Range;

use diagnostic::{Diagnostic, both};
use nc_dialect::Dialect;

use crate::codes;

/// No more of a program is looked at, bytes: what tells is at its start.
const MOST_BYTES: usize = 256 << 10;

/// A control by what its programs alone have.
struct Control {
    /// For people.
    name: &'static str,
    /// Dialects that read its programs, the first of which is named; none: vpost has none.
    dialects: &'static [&'static str],
    signs: &'static [Sign],
}

impl Control {
    fn reads(&self, dialect: &Dialect) -> bool {
        let of = |name: &str| self.dialects.contains(&name);
        of(&dialect.name) || dialect.extends.as_deref().is_some_and(of)
    }
}

/// What stands in a line: letters upper case, blanks of any number as one, none at either end.
#[derive(Clone, Copy)]
enum Sign {
    /// The line begins with it.
    Starts(&'static str),
    /// It stands in the line as a word: no letter or digit before it.
    Has(&'static str),
    /// The same with a digit behind it, and then this: `VC1=`.
    Numbered(&'static str, &'static str),
    /// The line is this.
    Is(&'static str),
    /// The line ends with it.
    Ends(&'static str),
}

/// A control that one block gives away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sure {
    Okuma,
    Haas,
    Sinumerik,
}

impl Sure {
    /// Its place in [`CONTROLS`].
    const fn place(self) -> usize {
        match self {
            Self::Okuma => 1,
            Self::Sinumerik => 2,
            Self::Haas => 5,
        }
    }

    /// The dialect reads this control's programs.
    pub(crate) fn is_read_by(self, dialect: &Dialect) -> bool {
        CONTROLS[self.place()].reads(dialect)
    }
}

const CONTROLS: [Control; 7] = [
    Control {
        name: "Heidenhain",
        dialects: &[],
        signs: &[
            Sign::Has("BEGIN PGM"),
            Sign::Has("BLK FORM"),
            Sign::Has("TOOL CALL"),
            Sign::Has("CYCL DEF"),
            Sign::Has("R0 FMAX"),
        ],
    },
    Control {
        name: "Okuma OSP",
        dialects: &["okuma"],
        signs: &[
            Sign::Has(".MIN%"),
            Sign::Has(".SSB%"),
            Sign::Numbered("VC", "="),
            Sign::Starts("CALL O"),
            Sign::Starts("MODIN O"),
            Sign::Is("RTS"),
            Sign::Numbered("G15 H", ""),
            Sign::Numbered("G16 H", ""),
            Sign::Numbered("G15H", ""),
            Sign::Numbered("G56 H", ""),
        ],
    },
    Control {
        name: "Sinumerik",
        dialects: &["sinumerik", "sinumerik-turn"],
        signs: &[
            Sign::Starts("%_N_"),
            Sign::Numbered("CYCLE", "("),
            Sign::Starts("MCALL"),
            Sign::Has("MSG("),
            Sign::Starts("DEF REAL"),
            Sign::Starts("DEF INT"),
            Sign::Has("GOTOF"),
            Sign::Has("GOTOB"),
            Sign::Has("TRAORI"),
            Sign::Has("TRANS X"),
            Sign::Has("SUPA"),
            Sign::Has("CR="),
            Sign::Numbered("R", "="),
        ],
    },
    Control {
        name: "LinuxCNC",
        dialects: &["grbl", "linuxcnc", "linuxcnc-lathe", "mach"],
        signs: &[
            Sign::Numbered("O", " SUB"),
            Sign::Numbered("O", " CALL"),
            Sign::Numbered("O", " WHILE"),
            Sign::Numbered("O", " IF"),
            Sign::Numbered("O", " REPEAT"),
            Sign::Starts("O<"),
            Sign::Has("#<"),
        ],
    },
    Control {
        name: "Fanuc",
        dialects: &["fanuc", "fanuc-lathe", "haas", "mitsubishi", "linuxcnc", "linuxcnc-lathe", "mach"],
        signs: &[
            Sign::Has("G65 P"),
            Sign::Has("G54.1 P"),
            Sign::Has("M98 P"),
            Sign::Starts("IF[#"),
            Sign::Starts("IF [#"),
            Sign::Starts("WHILE[#"),
            Sign::Numbered("#", "="),
        ],
    },
    Control { name: "Haas", dialects: &["haas"], signs: &[Sign::Numbered("M97 P", "")] },
    Control { name: "Heidenhain DIN/ISO", dialects: &["heidenhain-iso"], signs: &[Sign::Ends("*")] },
];

/// Names the control that a program looks written for: VP0246, where its dialect is none of that control's.
///
/// Of a program that was refused: what a program that reads well is, its dialect says.
#[must_use]
pub fn looks_like(text: &[u8], dialect: &Dialect) -> Option<Diagnostic> {
    let text = &text[..text.len().min(MOST_BYTES)];
    let mut counts = [0_usize; CONTROLS.len()];
    let mut firsts: [Option<Range<u64>>; CONTROLS.len()] = [const { None }; CONTROLS.len()];
    let mut start = 0;
    for line in text.split(|byte| *byte == b'\n') {
        let plain = plain(line);
        for (index, control) in CONTROLS.iter().enumerate() {
            if control.signs.iter().any(|sign| sign.stands_in(&plain)) {
                counts[index] += 1;
                firsts[index].get_or_insert_with(|| start..start + line.trim_ascii_end().len() as u64);
            }
        }
        start += line.len() as u64 + 1;
    }
    let most = counts.iter().copied().max().filter(|most| *most > 0)?;
    // What the dialect's own control has too tells nothing.
    if CONTROLS.iter().zip(counts).any(|(control, count)| count == most && control.reads(dialect)) {
        return None;
    }
    let index = counts.iter().position(|count| *count == most)?;
    Some(named(&CONTROLS[index], dialect, firsts[index].clone()?))
}

/// The program is another control's than its dialect.
fn named(control: &Control, dialect: &Dialect, span: Range<u64>) -> Diagnostic {
    let message = both!(
        "this looks like a program for {}, and it is read as one of the dialect {}",
        "это похоже на программу для {}, а читается она как программа диалекта {}",
        control.name,
        dialect.name
    );
    let label = both!("no other control writes this", "другие стойки так не пишут");
    let help = match control.dialects.first() {
        Some(name) => both!(
            "`--dialect {name}`, or `control = \"{name}\"` in the machine's profile",
            "`--dialect {name}` или `control = \"{name}\"` в профиле станка"
        ),
        None => both!(
            "vpost has no dialect of this control: post for one of `vpost grammar list`",
            "диалекта этой стойки в vpost нет: выведите программу для одной из `vpost grammar list`"
        ),
    };
    Diagnostic::error(codes::LOOKS_LIKE, message).at(span, label).help(help)
}

/// VP0246 for a block that another control alone writes, and that this dialect reads as something else.
pub(crate) fn sure(control: Sure, dialect: &Dialect, span: Range<u64>) -> Diagnostic {
    named(&CONTROLS[control.place()], dialect, span)
}

/// A line without its number and its comments, upper case, blanks as one.
fn plain(line: &[u8]) -> Vec<u8> {
    let mut plain: Vec<u8> = Vec::with_capacity(line.len().min(200));
    let (mut depth, mut before) = (0_usize, b' ');
    for byte in line.iter().take(400) {
        match byte {
            b';' if depth == 0 => break,
            // `CYCLE81(` is a name's bracket, ` (` begins a comment.
            b'(' if depth > 0 || before == b' ' || before == b'\t' => depth += 1,
            b')' if depth > 0 => depth -= 1,
            _ if depth > 0 => {}
            b' ' | b'\t' | b'\r' if plain.last() == Some(&b' ') || plain.is_empty() => {}
            b' ' | b'\t' | b'\r' => plain.push(b' '),
            other => plain.push(other.to_ascii_uppercase()),
        }
        before = *byte;
    }
    if plain.last() == Some(&b' ') {
        plain.pop();
    }
    let digits = plain.iter().skip(1).take_while(|byte| byte.is_ascii_digit()).count();
    if plain.first() == Some(&b'N') && digits > 0 {
        plain.drain(..=digits);
        if plain.first() == Some(&b' ') {
            plain.remove(0);
        }
    }
    plain
}

impl Sign {
    fn stands_in(self, line: &[u8]) -> bool {
        match self {
            Self::Starts(text) => line.starts_with(text.as_bytes()),
            Self::Is(text) => line == text.as_bytes(),
            Self::Ends(text) => line.len() > 1 && line.ends_with(text.as_bytes()),
            Self::Has(text) => places(line, text).next().is_some(),
            Self::Numbered(text, behind) => places(line, text).any(|at| {
                let rest = &line[at + text.len()..];
                let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
                digits > 0 && rest[digits..].starts_with(behind.as_bytes())
            }),
        }
    }
}

/// Where a text stands as the start of a word.
fn places<'t>(line: &'t [u8], text: &'t str) -> impl Iterator<Item = usize> + 't {
    let whole = |at: &usize| {
        let starts_word = text.starts_with(|c: char| c.is_ascii_alphanumeric());
        *at == 0 || !starts_word || !line[at - 1].is_ascii_alphanumeric()
    };
    (0..line.len()).filter(|at| line[*at..].starts_with(text.as_bytes())).filter(whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(dialect: &str, text: &str) -> Option<String> {
        let found = looks_like(text.as_bytes(), nc_dialect::builtin(dialect).unwrap())?;
        Some(found.message.english().to_owned())
    }

    fn says(dialect: &str, text: &str, control: &str) {
        let found = name(dialect, text).unwrap_or_default();
        assert!(found.contains(&format!("for {control},")), "{dialect} {text:?}: {found}");
    }

    #[test]
    fn each_control_is_known_by_what_it_alone_writes() {
        says("fanuc", "G21\nVC1=5\nG0 X=VC1\n", "Okuma OSP");
        says("haas", "N10 G15 H1\n", "Okuma OSP");
        says("fanuc", "$PART.MIN%\nG0 X0\n", "Okuma OSP");
        says("fanuc", "%_N_PART_MPF\nG0 X0\nCYCLE81(10,0,2,-5)\n", "Sinumerik");
        says("linuxcnc", "R1=5\nG1 X=R1\n", "Sinumerik");
        says("fanuc", "0 BEGIN PGM TEST MM\n1 L X+10 R0 FMAX\n", "Heidenhain");
        says("sinumerik", "%TEST G71 *\nN10 G01 X+5 F100 *\n", "Heidenhain DIN/ISO");
        says("fanuc", "o100 sub\nG1 X#<_x>\no100 endsub\n", "LinuxCNC");
        says("sinumerik", "O1000\n#100=5\nM98 P2000\n", "Fanuc");
        says("okuma", "#100=5\n", "Fanuc");
    }

    #[test]
    fn what_its_own_control_writes_too_tells_nothing() {
        assert_eq!(name("okuma", "VC1=5\n"), None);
        assert_eq!(name("mitsubishi", "#1=5\nM98 P2\n"), None);
        assert_eq!(name("linuxcnc", "#1=5\n"), None);
        assert_eq!(name("sinumerik-turn", "MSG(\"A\")\n"), None);
        assert_eq!(name("fanuc", "G21\nG1 X5. (CYCLE81 TOOL CALL 5)\n(VC1=5)\n"), None);
        // More of its own than of another's.
        assert_eq!(name("fanuc", "#1=5\n#2=6\nG15 H1\n"), None);
    }
}
