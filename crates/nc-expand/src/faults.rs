//! What to say when a program cannot be expanded.

use std::ops::Range;

use diagnostic::{Code, Diagnostic};
use nc_syntax::dialect::Macros;

use crate::codes;
use crate::evaluate::Fault;
use crate::jump::CallKind;
use crate::value::{Names, Variable};
use crate::variables::Protected;

/// Why execution ends.
#[derive(Clone, Debug)]
pub(crate) enum Stop {
    /// A value known on the machine only is needed.
    Unknown(Variable),
    /// There is no value.
    Fault(Fault),
    /// Code, message, label, help; the place is the statement.
    Said(Box<(Code, String, String, String)>),
    /// Ready, with its place.
    Diagnostic(Box<Diagnostic>),
    /// Ready, about another file that could not be read in.
    InFile(Box<Diagnostic>, String, Vec<u8>),
}

/// A stop in words.
pub(crate) fn say(
    code: Code,
    message: impl Into<String>,
    label: impl Into<String>,
    help: impl Into<String>,
) -> Stop {
    Stop::Said(Box::new((code, message.into(), label.into(), help.into())))
}

/// The message, at the statement where execution ended.
pub(crate) fn diagnostic(stop: &Stop, span: Range<u64>, names: &Names, macros: Macros) -> Diagnostic {
    match stop {
        Stop::Diagnostic(diagnostic) | Stop::InFile(diagnostic, ..) => (**diagnostic).clone(),
        Stop::Said(said) => {
            let (code, message, label, help) = &**said;
            Diagnostic::error(*code, message.as_str()).at(span, label.as_str()).help(help.as_str())
        }
        Stop::Unknown(variable) => unknown(*variable, span, names, macros),
        Stop::Fault(fault) => arithmetic(fault, span),
    }
}

fn unknown(variable: Variable, span: Range<u64>, names: &Names, macros: Macros) -> Diagnostic {
    let shown = names.show(variable);
    let system = match (variable, macros) {
        (Variable::Numbered(number), Macros::Fanuc) => number >= 1000,
        (Variable::Numbered(number), _) => number > 5000,
        (Variable::Named(_), _) => false,
    };
    let local = match variable {
        Variable::Named(id) if macros == Macros::Siemens => names.is_declared(id),
        Variable::Named(id) => !names.is_global(id),
        Variable::Numbered(_) => false,
    };
    let why = if local {
        "it is read before anything sets it"
    } else if system {
        "the control sets it while the program runs"
    } else {
        "nothing in this program sets it before, and an earlier program may have"
    };
    Diagnostic::error(codes::UNKNOWN_VALUE, format!("{shown} is known on the machine only: {why}"))
        .at(span, format!("needs the value of {shown}"))
        .help(format!("`--set \"{shown}=12.5\"` with the value that it has there"))
}

fn arithmetic(fault: &Fault, span: Range<u64>) -> Diagnostic {
    match fault {
        Fault::Arithmetic(what) => {
            Diagnostic::error(codes::ARITHMETIC, format!("{what}: this has no result"))
                .at(span, "computed here")
                .help("correct the expression, or the values given with `--set`")
        }
        Fault::TooClose(a, b) => Diagnostic::error(
            codes::TOO_CLOSE,
            format!("{a} and {b} differ by rounding only: the control's own rounding decides"),
        )
        .at(span, "decided here")
        .help("compare with a margin, as in `IF[ABS[#1-#2]LT0.0005]`, or count turns with whole numbers"),
        Fault::NotWhole(what, value) => {
            Diagnostic::error(codes::BAD_VALUE, format!("{what}: {value} is not a whole number"))
                .at(span, "a whole number was expected")
                .help("round it where it is computed, as in `ROUND[#1]`")
        }
        Fault::NoVariable(number) => {
            Diagnostic::error(codes::BAD_VALUE, format!("the control has no variable #{number}"))
                .at(span, "computed here")
                .help("correct the number of the variable")
        }
    }
}

/// A whole number that is not negative.
pub(crate) fn whole(what: &'static str, value: f64) -> Result<u64, Stop> {
    let rounded = value.round();
    if (value - rounded).abs() > 1e-4 || !(0.0..=9e15).contains(&rounded) {
        return Err(Stop::Fault(Fault::NotWhole(what, value)));
    }
    Ok(rounded as u64)
}

pub(crate) fn too_many_steps(limit: u64) -> Stop {
    say(
        codes::STEPS,
        format!("the program is still running after {limit} repeated steps"),
        "reached once more",
        "a loop that never ends? correct its condition, or split the program",
    )
}

pub(crate) fn too_long(limit: u64) -> Stop {
    say(
        codes::SIZE,
        format!("the expanded program is longer than {limit} bytes"),
        "grows here",
        "calls or loops that multiply? correct the counts, or split the program",
    )
}

pub(crate) fn too_deep(limit: usize) -> Stop {
    say(
        codes::DEPTH,
        format!("calls inside one another: more than {limit}"),
        "one call too many",
        "a program that calls itself without end? controls refuse it too",
    )
}

/// * `what` – block number or label, as it is corrected
pub(crate) fn label(shown: &str, what: &str, why: &str) -> Stop {
    say(
        codes::LABEL,
        format!("{shown} cannot be gone to: {why}"),
        "leads there",
        format!("correct the {what}"),
    )
}

pub(crate) fn endless() -> Stop {
    say(
        codes::RETURN,
        "M99 in the main program: it starts again without end",
        "no call to return from",
        "end the program with M30; correct it once and repeat it on the control",
    )
}

pub(crate) fn no_call(what: &str) -> Stop {
    say(
        codes::RETURN,
        format!("{what}: there is no call to return from"),
        "reached here",
        "`sub`, `endsub` and `return` belong together, and M98 and M99",
    )
}

pub(crate) fn no_return(names: &Names, kind: CallKind) -> Stop {
    let (name, way) = match kind {
        CallKind::Number(number) => (format!("O{number:04}"), "M99"),
        CallKind::Block(number) => (format!("N{number}"), "M99"),
        CallKind::Name(id) => (format!("o<{}>", names.name(id)), "`endsub`"),
    };
    say(
        codes::RETURN,
        format!("subprogram {name} ends without {way}"),
        "the end of it",
        format!("end the subprogram with {way}"),
    )
}

pub(crate) fn runs_into(number: u32) -> Stop {
    say(
        codes::RETURN,
        format!("the main program runs into O{number:04}"),
        "reached without a call",
        "end the main program with M30 before it",
    )
}

pub(crate) fn nothing_executed(span: Range<u64>) -> Diagnostic {
    Diagnostic::error(codes::NOTHING_EXECUTED, "the file defines subroutines and executes nothing")
        .at(span, "defined here, called nowhere")
        .help("correct the program that calls it, with `--include DIR` naming this file's folder: the moves depend on the call")
}

pub(crate) fn block_delete() -> Stop {
    say(
        codes::BLOCK_DELETE,
        "flow behind block delete: the switch on the panel makes two programs of it",
        "executed or not?",
        "remove the `/`, or the statement, and correct the program you mean to run",
    )
}

pub(crate) fn no_code(letter: char, value: f64) -> Stop {
    say(
        codes::BAD_VALUE,
        format!("{letter} with the computed value {value} is not taken"),
        "computed here",
        "write the code or the count as a plain number",
    )
}

pub(crate) fn too_large(letter: char, value: f64) -> Stop {
    say(
        codes::BAD_VALUE,
        format!("{letter} with the computed value {value} has more than 15 digits"),
        "computed here",
        "correct the expression, or the values given with `--set`",
    )
}

pub(crate) fn protected(protected: Protected, variable: Variable, names: &Names) -> Stop {
    let shown = names.show(variable);
    match protected {
        Protected::Alarm => say(
            codes::ALARM,
            "the program stops itself with an alarm here",
            "reached with the values given",
            "give the values the program expects with `--set`, or remove the line",
        ),
        Protected::System => say(
            codes::SYSTEM_WRITE,
            format!("the program writes {shown}, which the control acts on"),
            "an offset, a position or a switch",
            "set it on the control, and remove the line",
        ),
        Protected::None => say(
            codes::SYSTEM_WRITE,
            format!("{shown} cannot be written"),
            "no such variable",
            "correct the number of the variable",
        ),
    }
}

pub(crate) fn lost_assignment(span: Range<u64>, shown: &str) -> Diagnostic {
    Diagnostic::warning(
        codes::LOST_ASSIGNMENT,
        format!("{shown} keeps its value after the program, and the expanded program does not write it"),
    )
    .at(span, "the first such variable")
    .help("if another program or the operator reads it, set it on the control")
}

pub(crate) fn lost_output(span: Range<u64>) -> Diagnostic {
    Diagnostic::warning(codes::LOST_OUTPUT, "what the program prints is left out of the expanded program")
        .at(span, "the first such block")
        .help("nothing moves by it; the text is kept as a comment")
}
