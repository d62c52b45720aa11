//! What a search arrived at.

use diagnostic::Text;
use machine_model::effects::EffectKind;

use crate::effects::Why;
use crate::equations::fit::Solution;
use crate::equations::observation::Scalar;
use crate::equations::serial::Serial;
use crate::equations::set_up::Clamping;
use crate::library::candidates::{Library, Part};
use crate::search::bounds::log_prior;
use crate::search::space::{Fit, Space};

/// What the search arrived at.
#[derive(Clone, Debug)]
pub(crate) struct Explanation {
    /// Equations that were used.
    pub scalars: Vec<Scalar>,
    /// Library with all proposed shapes.
    pub library: Library,
    /// Products of all its columns, raw and whitened.
    pub space: Space,
    /// The model.
    pub parts: Vec<Part>,
    /// Its judgement.
    pub fit: Fit,
    /// It, solved.
    pub solution: Solution,
    /// Rows left out as outliers, ascending.
    pub outliers: Vec<usize>,
    /// Effects of other explanations that are as good (readings that are lengths only).
    pub equally_good: Vec<EffectKind>,
    /// Residuals of the rows left out, µm.
    pub dropped_residuals_um: Vec<f64>,
    /// The effect that would come next and why it did not.
    pub refused: Option<Refused>,
    /// How readings of a run hang together.
    pub serial: Serial,
    /// The same as tests and intervals count with it, for runs of any length.
    pub caution: Serial,
    /// How the set-ups of the runs may differ.
    pub clamping: Clamping,
}

impl Explanation {
    /// BIC of the whole model, its set-up counted, so that models with different set-ups compare.
    pub(crate) fn evidence(&self) -> f64 {
        self.space.evidence(&self.fit)
    }

    /// Logarithm of how plausible some parts are before anything is measured, with the values that they have together
    /// at this model's run-offset ratio ([`log_prior`]).
    pub(crate) fn log_prior(&self, parts: &[Part]) -> f64 {
        log_prior(&self.space.values(&self.library, parts, self.solution.rho))
    }
}

/// An effect that scored and failed a test.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Refused {
    /// Which.
    pub kind: EffectKind,
    /// Share of the square left that it explains.
    pub share: f64,
    /// Corrected p value.
    pub p: f64,
    /// Which test it failed.
    pub reason: Reason,
}

/// Which test an effect failed, and what that says of the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reason {
    /// It may be there and is not proven.
    Unproven,
    /// It explains the rows and not the next ones.
    NotElsewhere,
    /// Its form cannot be meant, whatever it explains.
    Form(Why),
    /// It explains too little to be named.
    Little(Why),
}

impl Reason {
    /// The same in words.
    pub(crate) const fn words(self) -> Text {
        let [english, russian] = match self {
            Self::Unproven => ["the F test", "не прошёл F-критерий"],
            Self::NotElsewhere => {
                ["it does not predict lines it has not seen", "не предсказывает линий, которых не видел"]
            }
            Self::Form(why) | Self::Little(why) => why,
        };
        Text::pair(english, russian)
    }
}
