//! What flows through a program.

use correction::Corrector;
use machine_model::Placement;
use nc_emit::{Asked, BlockNumbers, Emitter};
use nc_program::Interpreter;
use smallvec::SmallVec;

use crate::job::Job;

/// What flows from block to block: all that the blocks before have to do with those that follow.
#[derive(Clone)]
pub(crate) struct State<'a> {
    pub(crate) interpreter: Interpreter<'a>,
    pub(crate) corrector: Corrector<'a>,
    pub(crate) emitter: Emitter<'a>,
    pub(crate) guarded: Guarded,
    /// [`machine_model::Command::datum`] of the last motion.
    pub(crate) datum: Option<Placement>,
    /// [`nc_syntax::Place::expects_name`]
    pub(crate) expects_name: bool,
}

impl<'a> State<'a> {
    /// At the start of a program.
    pub(crate) fn new(job: &Job<'a>, numbers: &'a BlockNumbers) -> Self {
        let mut corrector = Corrector::new(job.models.axes, job.options).with_tip_control(job.models.tip);
        if job.dialect.turning.is_some() {
            // A lathe's Y stands on the axis, whatever moves.
            corrector = corrector.with_axis_at(1, 0.0);
        }
        for (axis, start_mm) in job.setup.start_mm.into_iter().enumerate() {
            corrector = match start_mm {
                Some(start_mm) => corrector.with_axis_at(axis, start_mm),
                None => corrector,
            };
        }
        Self {
            interpreter: Interpreter::new(job.dialect, job.setup),
            corrector,
            emitter: Emitter::new(job.dialect).with_numbers(numbers),
            guarded: Guarded::default(),
            datum: None,
            expects_name: false,
        }
    }

    /// True where whatever follows comes out alike.
    pub(crate) fn continues_as(&self, other: &Self) -> bool {
        let Self { interpreter, corrector, emitter, guarded, datum, expects_name } = self;
        interpreter.modal() == other.interpreter.modal()
            && corrector.continues_as(&other.corrector)
            && emitter.continues_as(&other.emitter)
            && *guarded == other.guarded
            && *datum == other.datum
            && *expects_name == other.expects_name
    }
}

/// What the output guards already.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Guarded {
    pub(crate) asked: SmallVec<[Asked; 4]>,
    pub(crate) serial: u32,
}
