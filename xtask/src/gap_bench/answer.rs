//! The JSON of a diagnosis, as the contract writes it (`vpost.diagnosis/1`).

use serde::Deserialize;

/// A diagnosis. Fields of the contract that no figure needs are left out.
#[derive(Debug, Deserialize)]
pub(crate) struct Answer {
    pub(crate) verdict: String,
    #[serde(default, rename = "where")]
    pub(crate) places: Vec<Place>,
    pub(crate) causes: Vec<Cause>,
    #[serde(default)]
    pub(crate) holdout: Option<Holdout>,
}

/// A cell of the gap.
#[derive(Debug, Deserialize)]
pub(crate) struct Place {
    pub(crate) by: String,
    pub(crate) cell: String,
    pub(crate) share: f64,
}

/// A named cause.
#[derive(Debug, Deserialize)]
pub(crate) struct Cause {
    pub(crate) effect: String,
    #[serde(default)]
    pub(crate) parameters: Vec<Parameter>,
    #[serde(default)]
    pub(crate) cannot_be_told_from: Vec<String>,
    #[serde(default)]
    pub(crate) shrink_predicted: Option<Interval>,
}

/// A parameter of a cause.
#[derive(Debug, Deserialize)]
pub(crate) struct Parameter {
    pub(crate) name: String,
    pub(crate) value: Option<f64>,
    pub(crate) u95: Option<f64>,
}

/// A predicted shrinkage.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(crate) struct Interval {
    pub(crate) mid: Option<f64>,
}

/// What became of the hold-out.
#[derive(Debug, Deserialize)]
pub(crate) struct Holdout {
    pub(crate) shrink: Option<f64>,
}

impl Answer {
    /// The first cause's effect.
    pub(crate) fn first(&self) -> Option<&str> {
        self.causes.first().map(|c| c.effect.as_str())
    }

    /// Every named effect and every effect that a named one cannot be told from.
    pub(crate) fn set(&self) -> Vec<&str> {
        let mut set: Vec<&str> = Vec::new();
        for cause in &self.causes {
            let names = std::iter::once(&cause.effect).chain(&cause.cannot_be_told_from);
            for name in names {
                if !set.contains(&name.as_str()) {
                    set.push(name);
                }
            }
        }
        set
    }

    /// True for the verdicts that admit an unknown cause.
    pub(crate) fn admits_unknown(&self) -> bool {
        matches!(self.verdict.as_str(), "PARTIAL" | "UNKNOWN")
    }
}
