//! The verdict in one sentence.

use crate::diagnosis::{Cause, Gap, Leftover, Verdict};

/// One sentence for the shop floor.
#[must_use]
pub(crate) fn sentence(verdict: Verdict, gap: &Gap, causes: &[Cause], leftover: &Leftover) -> String {
    let names: Vec<&str> = causes.iter().map(|c| c.effect.as_str()).collect();
    let list = names.join(", ");
    let size = format!("{:.1} µm RMS", gap.rms_um);
    let after = causes.last().map_or(gap.rms_um, |c| c.rms_after_um);
    match verdict {
        Verdict::NoGap => format!("Model and machine agree within the noise of {:.2} µm.", gap.noise_um),
        Verdict::Named => {
            format!("The gap of {size} comes from {list}; with it in the model {after:.1} µm remain.")
        }
        Verdict::Ambiguous => {
            let open = causes.iter().find(|c| !c.cannot_be_told_from.is_empty());
            let open = open.map_or_else(String::new, |c| {
                format!("; these rows cannot tell {} from {}", c.effect, c.cannot_be_told_from.join(", "))
            });
            format!("The gap of {size} is explained by {list} down to {after:.1} µm{open}.")
        }
        Verdict::Partial => format!(
            "{list} explain part of the gap of {size}; {:.0} % of what could be explained is left and is not noise.",
            100.0 * leftover.phi
        ),
        Verdict::Unknown => {
            let absorber = names
                .first()
                .map_or_else(String::new, |n| format!(" (the nearest, {n}, only absorbs part of it)"));
            format!("There is a gap of {size} that no effect of the library explains{absorber}.")
        }
        Verdict::NoiseModelSuspect => {
            if names.is_empty() {
                "No effect is seen above the scatter of the rows, but that scatter is not the independent noise that the file says or repeats show: look at the instrument first.".to_owned()
            } else {
                format!("What looks like a gap of {size} is made by the instrument: {list}.")
            }
        }
        Verdict::Underpowered => "Too little was measured to say anything.".to_owned(),
    }
}
