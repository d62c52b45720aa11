//! How programs are corrected, as a value that can be hashed: with the same one the same input gives the same bytes.

use blake3::{Hash, Hasher};

use super::inputs::Item;
use super::record::{Fault, Record, Status};
use crate::arguments::Shared;
use jobs::correct::refuse_doubts;
use nc_program::codes::CUT_OFF;
use rewrite::Manner;

use crate::conditions::conditions;
use crate::correct::{self, Input, Program};
use crate::file::Place;
use crate::interrupt::Interrupt;
use crate::message::{Failure, Messages, Report};
use crate::settings::Settings;

/// Profile, dialect, engine and options, read once for all programs.
pub(crate) struct Job {
    pub settings: Settings,
    /// Hash of everything that decides the output besides the program and the subprograms it calls.
    pub hash: Hash,
    /// What becomes of a program that seems to be cut off.
    pub cut_off: CutOff,
}

/// What becomes of a program that seems to be cut off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CutOff {
    /// It is corrected, and warned of.
    Warned,
    /// It is refused: the rest may be on its way.
    Refused,
}

impl Job {
    /// Reads profile and dialect and refuses what no program could be corrected with.
    pub(crate) fn load(shared: &Shared, messages: &Messages) -> Result<Self, Failure> {
        let settings = crate::settings::load(shared, messages)?;
        settings.path_model()?;
        let hash = hash(&settings, shared)?;
        Ok(Self { settings, hash, cut_off: CutOff::Warned })
    }

    /// Corrects a program. The one place where batch meets the correction.
    ///
    /// `threads`: for a large program; the bytes are the same for any number.
    pub(crate) fn correct(
        &self,
        item: &Item,
        threads: usize,
        out: &mut Place,
        interrupt: &Interrupt,
    ) -> Result<Program, Failure> {
        let manner = Manner { force: false, threads, hashes: true };
        let input = Input::File(item.input.clone());
        let done = correct::program(input, &self.settings, manner, out, &|_| interrupt.check())?;
        if self.cut_off == CutOff::Refused {
            refuse_doubts(&done.warnings, |doubt| doubt.code == CUT_OFF)?;
        }
        Ok(done)
    }
}

/// Completes the record of a program that was corrected.
pub(crate) fn corrected(record: &mut Record, done: &Program) {
    let hex = |hash: Option<Hash>| hash.map(|hash| hash.to_hex().to_string());
    record.status = if done.changed { Status::Corrected } else { Status::Unchanged };
    record.input_blake3 = hex(done.input.hash);
    record.output_blake3 = hex(done.output.hash);
    record.bytes_in = done.input.bytes;
    record.bytes_out = Some(done.output.bytes);
    record.figures = Some((&done.figures).into());
    record.warnings = done.warnings.iter().flat_map(faults).collect();
    record.subprograms.clone_from(&done.lookups);
}

/// A report in few words.
pub(crate) fn faults(report: &Report) -> Vec<Fault> {
    report.diagnostics.iter().map(|diagnostic| Fault::new(diagnostic, report.source.as_ref())).collect()
}

/// Every value that decides the output, each with its name and length, so that none can run into the next.
///
/// The values as they were understood, not as they were written: `--tolerance 1` and `1.0` are the same job.
fn hash(settings: &Settings, shared: &Shared) -> Result<Hash, Failure> {
    let mut hasher = Hasher::new();
    let mut put = |name: &str, value: &[u8]| {
        for part in [name.as_bytes(), value] {
            hasher.update(&(part.len() as u64).to_le_bytes());
            hasher.update(part);
        }
    };
    put("vpost", env!("CARGO_PKG_VERSION").as_bytes());
    put("profile", settings.profile_hash.as_bytes());
    put("dialect", format!("{:?}", settings.dialect).as_bytes());
    put("setup", format!("{:?}", settings.setup).as_bytes());
    put("engine", settings.engine.id().name().as_bytes());
    put("options", format!("{:?}", settings.options).as_bytes());
    put("values", format!("{:?}", settings.flow.presets()).as_bytes());
    put("strict", &[u8::from(settings.strict)]);
    put("conditions", format!("{:?}", conditions(&shared.job)?).as_bytes());
    put("guards", &[u8::from(shared.job.guard)]);
    put("path mode", format!("{:?}", settings.path_mode).as_bytes());
    Ok(hasher.finalize())
}
