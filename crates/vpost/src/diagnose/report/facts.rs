//! What a page is about: files, options and machine.

use jobs::diagnose::File;

/// Files, options and machine.
#[derive(Debug, Clone)]
pub(in crate::diagnose) struct Facts {
    /// Name in the profile.
    pub machine: String,
    /// Its kinematic chain; none of a lathe, whose model is another.
    pub chain: Option<String>,
    /// When, how warm and with what it was measured.
    pub origin: crate::origin::Origin,
    /// The profile, with the hash of its tables.
    pub profile: File,
    /// The measurements.
    pub measurements: File,
    /// Points for the proof.
    pub holdout: Option<File>,
    /// What predicts the rows.
    pub engine: String,
    /// Seed of the relabellings, where there are any.
    pub seed: Option<u64>,
    /// Columns that were passed over.
    pub ignored_columns: Vec<String>,
    /// Effects taken out of the library.
    pub without: Vec<String>,
    /// Tolerance that the distribution is held against, µm.
    pub tolerance_um: f64,
}
