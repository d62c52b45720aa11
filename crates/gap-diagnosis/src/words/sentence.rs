//! The verdict in one sentence.

use crate::judgement::answer::{Cause, Gap, Leftover, Verdict};
use crate::judgement::verdict::Unseen;

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

impl Unseen {
    /// What the headline says of it where nothing is named.
    pub(crate) fn gap_note(&self) -> Option<String> {
        self.shows_a_gap()
            .then(|| format!(" Rows that were not fitted show a gap of {:.1} times the noise.", self.before))
    }

    /// What the headline says of it where causes are named.
    pub(crate) fn refutation(&self) -> Option<String> {
        self.refutes().then(|| {
            format!(
                " Rows that were not fitted refute it: {:.0} % were promised there, {:.0} % achieved.",
                100.0 * self.promised.1,
                100.0 * self.achieved()
            )
        })
    }

    /// What is said of runs that were kept back because there is no hold-out.
    pub(crate) fn kept_back_note(&self) -> String {
        format!(
            "No hold-out was given: a search without every fourth run promised {:.0} % on these, and {:.0} % were achieved.",
            100.0 * self.promised.1,
            100.0 * self.achieved()
        )
    }
}
