//! Differences in words.

use path_comparison::{Comparison, Mismatch, What};

use super::reading::Numbers;

/// What the comparison found, a sentence each.
pub(super) fn of(comparison: &Comparison, numbers: &Numbers) -> Vec<String> {
    let (mut findings, mut said) = (Vec::new(), Vec::new());
    for mismatch in &comparison.mismatches {
        findings.extend(sentences(mismatch, numbers, &mut said));
    }
    if comparison.more_mismatches > 0 {
        findings.push(format!("and {} more of the path", comparison.more_mismatches));
    }
    findings
}

/// * `said` – settings that differ and were named: they differ until one of both programs sets them
fn sentences(mismatch: &Mismatch, numbers: &Numbers, said: &mut Vec<[String; 2]>) -> Vec<String> {
    let Mismatch { what, wanted_line: wanted, commanded_line: made } = mismatch;
    let one = match what {
        What::TooFar(mm) => {
            format!(
                "line {made} of the corrected program is {:.3} um off the path of line {wanted}",
                mm * 1e3
            )
        }
        What::Missing => format!("the motion of line {wanted} is missing from the corrected program"),
        What::Short(mm) => {
            format!("the corrected program ends {:.3} um short of the end of line {wanted}", mm * 1e3)
        }
        What::Extra => format!("line {made} of the corrected program belongs to no programmed motion"),
        What::Turned => format!(
            "the rotary axes stand elsewhere in line {made} of the corrected program than in line {wanted}"
        ),
        What::NotPositioned => {
            format!("the positioning of line {wanted} is missing from the corrected program")
        }
        What::PositionedElsewhere => {
            format!("line {made} of the corrected program positions the tool where the program does not")
        }
        What::Process([here, there]) => {
            let (Some(here), Some(there)) = (numbers.process(*here), numbers.process(*there)) else {
                return Vec::new();
            };
            let mut differences = here.differences(there);
            differences.retain(|pair| !said.contains(pair));
            said.extend(differences.iter().cloned());
            return differences.iter().map(|[here, there]| in_force(*wanted, *made, here, there)).collect();
        }
        What::Feed(feeds) => {
            let [here, there] = feeds.map(|f| f.map_or_else(|| "no F".to_owned(), |f| format!("F{f}")));
            in_force(*wanted, *made, &here, &there)
        }
        What::Compensated => format!(
            "under cutter compensation line {made} of the corrected program is not the block of line {wanted}: one was put in or left out, and the control offsets block by block"
        ),
        What::Time(times) => format!(
            "line {made} of the corrected program takes {times:.2} times as long as line {wanted} says by F"
        ),
        What::NotDone(deed) => {
            format!("{} of line {wanted} is missing from the corrected program", numbers.deed(*deed))
        }
        What::DoneToo(deed) => format!(
            "{} on line {made} of the corrected program is not programmed, or not there",
            numbers.deed(*deed)
        ),
    };
    vec![one]
}

fn in_force(wanted: u64, made: u64, here: &str, there: &str) -> String {
    format!(
        "on line {made} of the corrected program {there} is in force, on line {wanted} of the program {here}"
    )
}
