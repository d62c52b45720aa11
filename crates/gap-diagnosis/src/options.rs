//! What can be asked for beside the measurements.

use machine_model::Volume;
use machine_model::effects::EffectKind;

/// What can be asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Effects taken out of the library.
    pub without: Vec<EffectKind>,
    /// Seed of every random relabelling.
    pub seed: u64,
    /// Where the causes are to be used; default: the box that was measured.
    pub volume: Option<Volume>,
    /// Finest step of the axes, µm: a gap below it is none that anyone could correct. 0: not known.
    pub resolution_um: f64,
}
