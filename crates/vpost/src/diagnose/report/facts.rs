//! What a page is about: files, options and machine.

use jobs::diagnose::File;
use jobs::profile::Loaded;
use machine_model::EngineId;

use crate::arguments::Shared;
use crate::diagnose::options::Diagnose;
use crate::file;
use crate::message::Failure;
use crate::settings::machine;

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

impl Facts {
    /// Of a profile, options, measurements and hold-out.
    pub(in crate::diagnose) fn new(
        whole: &Loaded,
        arguments: &Diagnose,
        shared: &Shared,
        measurements: &File,
        holdout: Option<&File>,
    ) -> Result<Self, Failure> {
        let profile = &whole.profile;
        Ok(Self {
            machine: profile.name.clone(),
            chain: profile.lathe.is_none().then(|| profile.chain().to_string()),
            origin: crate::origin::Origin::of(profile),
            profile: File {
                name: file::name(machine(&shared.job)?),
                hash: whole.hash.to_string(),
                comments: Vec::new(),
            },
            measurements: measurements.clone(),
            holdout: holdout.cloned(),
            engine: shared.job.engine().unwrap_or(EngineId::RigidBody).to_string(),
            seed: None,
            ignored_columns: arguments.ignore_column.clone(),
            without: arguments.without.clone(),
            tolerance_um: shared.job.tolerance.unwrap_or(profile.correction.tolerance_um),
        })
    }
}
