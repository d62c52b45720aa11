//! A drilling cycle as the moves that a control makes of it.

use machine_model::Vector;
use toolpath::{CycleKind, Hole, HoleMove, MOST_PECKS, whole_pecks};

use crate::Step;
use crate::items::{Common, Deed, Item, Items, Role};
use crate::positioning::Kind;
use crate::process::Process;
use crate::way::Way;

impl<I: Iterator<Item = Step>> Items<'_, I> {
    /// How many pecks a hole has that is so many of them deep.
    ///
    /// The depth of a corrected cycle is the programmed one but for micrometres: where they decide, it has as many
    /// pecks as the programmed hole there.
    fn pecks_of(&self, hole: &Hole, depth: f64, unsure: f64) -> u32 {
        /// So many holes the one program may be ahead of the other.
        const KEPT: usize = 64;
        /// Holes that are nearer are one, mm.
        const ONE_HOLE_MM: f64 = 1.0;
        let counted = whole_pecks(depth);
        let at = Vector::from(hole.at_r.linear_mm);
        let mut known = self.counted.borrow_mut();
        if self.role == Role::Wanted {
            known.push_back((at, counted));
            if known.len() > KEPT {
                known.pop_front();
            }
            return counted;
        }
        let here = known.iter().rposition(|(known, _)| (known - at).norm() < ONE_HOLE_MM);
        let programmed = here.map(|k| known[k].1).filter(|count| {
            let count = f64::from(*count);
            depth - unsure <= count && count - 1.0 <= depth + unsure
        });
        programmed.unwrap_or(counted)
    }

    /// A cycle, move by move.
    pub(crate) fn hole(&mut self, common: &Common, hole: &Hole) {
        // All moves of a cycle are made with the correction of its hole.
        let ends = [hole.at_r, hole.at(hole.bottom_mm)].into_iter().filter(|_| self.role == Role::Commanded);
        let errors_mm = ends.map(|place| {
            let rotary_rad = Vector::from(place.rotary_deg.map(f64::to_radians));
            self.error_mm(&common.command(Vector::from(place.linear_mm), rotary_rad)).norm()
        });
        let hole_error_mm = errors_mm.fold(0.0, f64::max);
        // A hole of more pecks is compared as one.
        let count = match hole.pecks().zip(hole.cycle.peck_mm) {
            Some((pecks, peck_mm)) if pecks < MOST_PECKS => {
                self.pecks_of(hole, pecks, 8.0 * common.limit_mm / peck_mm)
            }
            _ => 1,
        };
        let mut at = hole.start;
        for step in hole.moves(count, self.retreats) {
            let to = step.end().unwrap_or(at);
            match step {
                HoleMove::FeedIn { .. } => {
                    self.feeding(common, Way::line(at, to), hole.rate, [true, false]);
                }
                HoleMove::FeedOut { .. } => {
                    self.feeding(common, Way::line(at, to), hole.rate, [false, true]);
                }
                HoleMove::Rise { .. } | HoleMove::Position { .. } | HoleMove::Leave { .. } => {
                    self.positioning(common, at.into(), to.into(), Kind::OfCycle);
                    if let Some(Item::Position(made)) = self.ready.back_mut() {
                        made.error_mm = made.error_mm.max(hole_error_mm);
                    }
                }
                HoleMove::Dwell => {
                    if let Some(number) = common.dwell.filter(|_| hole.cycle.kind != CycleKind::Synchronised)
                    {
                        let process = Process::of_number(common.process.number);
                        self.ready.push_back(Item::Deed(Deed { number, line: common.line, process }));
                    }
                }
            }
            at = to;
        }
    }
}
