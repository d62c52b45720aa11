//! The feeds of a program, as a lathe executes them.

use correction::Curve;
use diagnostic::Diagnostic;
use machine_model::{Command, Vector};
use nc_program::modal::FeedMode;
use nc_program::{Context, Interpreter};
use nc_syntax::{Block, Reader};
use toolpath::{Feed, Motion};

use crate::settings::Settings;

/// A feed of the program.
pub struct Cut {
    /// Its path.
    pub curve: Curve,
    tool_mm: Vector,
    /// mm a turn, where the program says it so.
    pub feed_mm: Option<f64>,
}

impl Cut {
    /// The command at a share of it.
    pub fn at(&self, s: f64) -> Command {
        Command {
            linear_mm: self.curve.at(s),
            rotary_rad: Vector::zeros(),
            tool_mm: self.tool_mm,
            direction: self
                .curve
                .tangent(s)
                .map(|way| if way == 0.0 { 0 } else { way.signum() as i8 })
                .into(),
            ..Default::default()
        }
    }
}

/// The feeds of a program, as they are commanded.
pub fn cuts(text: &[u8], settings: &Settings) -> Result<Vec<Cut>, Vec<Diagnostic>> {
    let (dialect, setup) = (&settings.dialect, &settings.setup);
    let mut interpreter = Interpreter::new(dialect, setup);
    let (mut reader, mut block) = (Reader::new(text, dialect), Block::default());
    let (mut cuts, mut feed) = (Vec::new(), None);
    while reader.next(&mut block) {
        let step = interpreter.step(&block)?;
        if let Some(number) = block.word(b'F').and_then(|word| word.number()) {
            feed = Some(number.decimal.to_f64());
        }
        for motion in &step.motions {
            // The flanks of a thread are no surface whose radius is looked at.
            if let Motion::Feed(Feed { start, end, shape, .. }) = motion
                && !step.context.thread
            {
                let curve = Curve::new(start.linear_mm.into(), end.linear_mm.into(), shape);
                let feed_mm = feed.and_then(|feed| a_turn(feed, &step.context));
                cuts.push(Cut { curve, tool_mm: step.context.tool_mm.into(), feed_mm });
            }
        }
    }
    Ok(cuts)
}

/// F as mm a turn.
fn a_turn(feed: f64, context: &Context) -> Option<f64> {
    (context.feed_mode == FeedMode::PerRevolution).then_some(feed * context.unit_mm)
}
