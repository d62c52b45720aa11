//! What is told of a stretch by commands that were solved for it already.

use std::array::from_fn;

use machine_model::{Command, Vector};

use crate::curve::Curve;
use crate::deviation::{Machine, Pair, Place, Verdict};
use crate::extent::Extent;

/// Commands that bring the tool to a programmed motion.
#[derive(Clone, Copy)]
pub(crate) struct Solved {
    /// At s = 0, ¼, ½, ¾, 1.
    pub(crate) commands: [Vector; 5],
    /// For motion in these directions.
    pub(crate) direction: [i8; 3],
}

impl Solved {
    /// At ¼, ½ and ¾.
    pub(crate) fn between(&self) -> [Vector; 3] {
        let [_, a, b, c, _] = self.commands;
        [a, b, c]
    }

    /// At the end.
    pub(crate) fn end(&self) -> Vector {
        let [.., end] = self.commands;
        end
    }
}

/// What the model says of all stretches in the box of an arc's two halves: one question for both.
#[derive(Clone, Copy)]
pub(crate) struct Enclosed {
    /// What a stretch may be.
    pub(crate) extent: Extent,
    pub(crate) state: Command,
    /// Upper bound of how far the error leaves its chord, mm.
    pub(crate) leaves_chord_mm: f64,
}

impl Enclosed {
    /// For a quarter of either half, or of an arc that stands for it.
    pub(crate) fn of(machine: &Machine<'_>, halves: &[Curve; 2], solved: [&Solved; 2]) -> Option<Self> {
        /// What a commanded arc may have over the one through the corrected commands, mm and as a part.
        const ROOM_MM: f64 = 0.02;
        const ROOM: f64 = 1.01;
        let mut extent = of_a_quarter(&halves[0], &solved[0].commands)?;
        let other = of_a_quarter(&halves[1], &solved[1].commands)?;
        for axis in 0..3 {
            let (range, other_range) = (&mut extent.range[axis], other.range[axis]);
            range.low = range.low.min(other_range.low) - ROOM_MM;
            range.high = range.high.max(other_range.high) + ROOM_MM;
            extent.speed[axis] = extent.speed[axis].max(other.speed[axis]) * ROOM + ROOM_MM;
            extent.acceleration[axis] =
                extent.acceleration[axis].max(other.acceleration[axis]) * ROOM + ROOM_MM;
        }
        let leaves_chord_mm = machine.leaves_chord_mm(&extent, 2);
        Some(Self { extent, state: machine.state, leaves_chord_mm })
    }

    /// True where what it says holds for a stretch.
    pub(crate) fn holds(&self, machine: &Machine<'_>, stretch: &Extent) -> bool {
        let Extent { range, speed, acceleration } = &self.extent;
        self.state == machine.state
            && (0..3).all(|i| {
                range[i].low <= stretch.range[i].low
                    && stretch.range[i].high <= range[i].high
                    && stretch.speed[i] <= speed[i]
                    && stretch.acceleration[i] <= acceleration[i]
            })
    }
}

/// Of a motion, from place to place that is compared with a corrected command.
pub(crate) const STRETCH: f64 = 0.25;

/// A stretch from place to place that may be anywhere in an arc's box; `None` for a line.
pub(crate) fn of_a_quarter(arc: &Curve, at_quarters: &[Vector; 5]) -> Option<Extent> {
    let mut extent = arc.extent_by(at_quarters)?;
    extent.speed = extent.speed.map(|speed| speed * STRETCH);
    extent.acceleration = extent.acceleration.map(|acceleration| acceleration * STRETCH * STRETCH);
    Some(extent)
}

/// More than a corrected command is off, and all rounding in comparing with it, mm.
pub(crate) const SOLVED_MM: f64 = 1e-8;

/// What corrected commands tell of a motion.
pub(crate) enum ByCommands {
    /// The real path stays this near the programmed one, everywhere; mm.
    Within(f64),
    /// It is further away than allowed at this s, by at least this many mm.
    Beyond {
        /// Where.
        s: f64,
        /// How far.
        distance_mm: f64,
    },
    /// The model has to be asked.
    Open,
}

impl Pair<'_> {
    /// [`Pair::verdict`], without asking the model where corrected commands tell enough.
    pub(crate) fn verdict_by(
        &self,
        machine: &Machine<'_>,
        solved: Option<&Solved>,
        enclosed: Option<&Enclosed>,
        limit_mm: f64,
    ) -> Verdict {
        let known =
            solved.map_or(ByCommands::Open, |solved| self.by_commands(machine, solved, enclosed, limit_mm));
        match known {
            ByCommands::Beyond { s, distance_mm } => Verdict::Beyond { s, distance_mm },
            ByCommands::Within(bound) => Verdict::Within(bound),
            ByCommands::Open => self.verdict(machine, limit_mm),
        }
    }

    /// What the commands that bring the tool to the programmed path tell of the one commanded, without the model being asked:
    /// equation (P7).
    pub(crate) fn by_commands(
        &self,
        machine: &Machine<'_>,
        solved: &Solved,
        enclosed: Option<&Enclosed>,
        limit_mm: f64,
    ) -> ByCommands {
        let Some(everywhere) = &machine.everywhere else { return ByCommands::Open };
        let mut places = [Place::default(); 5];
        let mut unsure: f64 = 0.0;
        let (commanded, tangents) = (self.commanded.at_quarters(), self.wanted.tangents_at_quarters());
        for (k, place) in places.iter_mut().enumerate() {
            let s = STRETCH * k as f64;
            let off = commanded[k] - solved.commands[k];
            *place = self.place_of(s, off, tangents[k]);
            let own = everywhere.gradient * place.size + SOLVED_MM;
            if own.is_nan() {
                // An axis whose place is not known: `max` would forget it.
                return ByCommands::Open;
            }
            if place.square - own > limit_mm && 0 < k && k < 4 {
                return ByCommands::Beyond { s, distance_mm: place.square - own };
            }
            unsure = unsure.max(own);
        }
        // More than one turn is not for four places.
        let turns = self.commanded.turning_rad() * STRETCH > 1.6 || self.commanded.is_steep_spiral();
        if turns || !self.commanded.lies_inside(&everywhere.volume) {
            return ByCommands::Open;
        }
        // Of a stretch that runs through all of the motion's box: it holds for those that run through a part of it.
        let Some(extent) = of_a_quarter(self.commanded, &commanded) else { return ByCommands::Open };
        let difference = self.commanded.difference_bound(self.wanted, 0.0, STRETCH);
        let bound = |leaves_chord_mm: f64| {
            let leaves = leaves_chord_mm + difference;
            let worst = places.windows(2).map(|ends| self.between_leaving(&ends[0], &ends[1], leaves));
            worst.fold(0.0, f64::max) + 4.0 * unsure
        };
        if let Some(enclosed) = enclosed.filter(|enclosed| enclosed.holds(machine, &extent)) {
            let bound = bound(enclosed.leaves_chord_mm);
            if bound <= limit_mm {
                return ByCommands::Within(bound);
            }
        }
        let bound = bound(machine.leaves_chord_mm(&extent, 2));
        if bound <= limit_mm { ByCommands::Within(bound) } else { ByCommands::Open }
    }

    /// [`Pair::verdict`] of a line that stands for a line, with less asked of the model where the commands are known that
    /// bring the tool to the programmed one at s = 0, ½, 1.
    pub(crate) fn line_verdict_by(
        &self,
        machine: &Machine<'_>,
        solved: Option<&[Vector; 3]>,
        limit_mm: f64,
    ) -> Verdict {
        match solved.and_then(|solved| self.line_by_commands(machine, solved)) {
            Some(bound) if bound <= limit_mm => Verdict::Within(bound),
            _ => self.verdict(machine, limit_mm),
        }
    }

    /// Upper bound of the distance from the programmed line, mm: equation (P8).
    pub(crate) fn line_by_commands(&self, machine: &Machine<'_>, solved: &[Vector; 3]) -> Option<f64> {
        /// Of the line, from place to place.
        const HALF: f64 = 0.5;
        let everywhere = machine.everywhere.as_ref()?;
        if !self.commanded.lies_inside(&everywhere.volume) {
            return None;
        }
        let (tangent, mut unsure) = (self.wanted.tangent(0.0), 0.0_f64);
        let places: [Place; 3] = from_fn(|k| {
            let s = HALF * k as f64;
            let place = self.place_of(s, self.commanded.at(s) - solved[k], tangent);
            unsure = unsure.max(everywhere.gradient * place.size + SOLVED_MM);
            place
        });
        // Of a stretch that runs through all of the line's box at half its speed: it holds for both halves.
        let mut extent = self.commanded.extent(0.0, 1.0);
        extent.speed = extent.speed.map(|speed| speed * HALF);
        let leaves_chord = machine.leaves_chord_mm(&extent, 1);
        let worst = places.windows(2).map(|ends| self.between_leaving(&ends[0], &ends[1], leaves_chord));
        Some(worst.fold(0.0, f64::max) + unsure)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use machine_model::{LANES, PathModel};
    use proptest::prelude::*;
    use toolpath::Plane;

    use super::*;
    use crate::deviation::Begun;
    use crate::testing::machine;

    /// The machine with a tool.
    fn with_tool(model: &dyn PathModel) -> Machine<'_> {
        let state = Command { tool_mm: Vector::new(3.0, -5.0, -120.0), ..Default::default() };
        Machine {
            model,
            state,
            everywhere: model.everywhere(&state).map(Arc::new),
            turns: false,
            lag_rad: None,
        }
    }

    /// The largest distance found at many places.
    fn furthest(pair: &Pair<'_>, machine: &Machine<'_>, places: u32) -> f64 {
        let distance = |k: u32| pair.place(machine, f64::from(k) / f64::from(places)).distance;
        (0..=places).map(distance).fold(0.0, f64::max)
    }

    proptest! {
        /// Equation (P7), held against the model at many places.
        #[test]
        fn what_corrected_commands_tell_is_so(
            monotone: bool, plane in 0usize..3, middle in prop::array::uniform3(60.0f64..140.0), radius in 0.3f64..40.0,
            angle in -4.0f64..4.0, sweep in prop_oneof![-6.2f64..-0.05, 0.05f64..6.2], rise in prop_oneof![Just(0.0), -5.0f64..5.0],
            rounded in prop::array::uniform6(-0.001f64..0.001), centred in prop::array::uniform2(-0.003f64..0.003),
            limit_um in 0.5f64..12.0,
        ) {
            let model = machine(monotone);
            let machine = with_tool(&model);
            let axes = [Plane::Xy, Plane::Zx, Plane::Yz][plane].axes();
            let [u, v, n] = axes;
            let on_circle = |angle: f64, along: f64| {
                let (sin, cos) = units::math::sin_cos(angle);
                let mut place = Vector::zeros();
                (place[u], place[v], place[n]) = (middle[u] + radius * cos, middle[v] + radius * sin, middle[n] + along);
                place
            };
            let wanted = Curve::Arc {
                axes, centre: [middle[u], middle[v]], angle, sweep, radius: [radius; 2],
                ends: [on_circle(angle, 0.0), on_circle(angle + sweep, rise)],
            };
            let at = |s: f64| wanted.at(s);
            let solve = |places: [f64; LANES]| machine.solved_together(places.map(at)).unwrap();
            let ([a, b, c, end], [start, ..]) = (solve([0.25, 0.5, 0.75, 1.0]), solve([0.0; LANES]));
            let solved = Solved { commands: [start, a, b, c, end], direction: [0; 3] };
            let from = start + Vector::new(rounded[0], rounded[1], rounded[2]);
            let to = end + Vector::new(rounded[3], rounded[4], rounded[5]);
            let shift = 0.5 * (start - at(0.0) + end - at(1.0));
            let centre = [middle[u] + shift[u] + centred[0], middle[v] + shift[v] + centred[1]];
            let commanded = Curve::from_centre(from, to, axes, centre, sweep);
            let Curve::Arc { sweep: turned, .. } = commanded else { panic!() };
            prop_assume!((turned - sweep).abs() < 0.1);
            let pair = Pair { wanted: &wanted, commanded: &commanded, in_step: false, begun: Begun::No };
            let limit_mm = limit_um * 1e-3;
            let told = |enclosed: Option<&Enclosed>| match pair.by_commands(&machine, &solved, enclosed, limit_mm) {
                ByCommands::Within(bound) => {
                    assert!(bound <= limit_mm);
                    let found = furthest(&pair, &machine, 257);
                    assert!(found <= bound + 1e-12, "{found} > {bound}");
                    Some(bound)
                }
                ByCommands::Beyond { distance_mm, .. } => {
                    assert!(distance_mm > limit_mm);
                    assert!(furthest(&pair, &machine, 4) >= distance_mm);
                    None
                }
                ByCommands::Open => None,
            };
            let own = told(None);
            // With the bound for both halves of an arc of which this is the one.
            if sweep.abs() < 3.0 {
                let other = Curve::Arc {
                    axes, centre: [middle[u], middle[v]], angle: angle + sweep, sweep, radius: [radius; 2],
                    ends: [on_circle(angle + sweep, rise), on_circle(angle + 2.0 * sweep, 2.0 * rise)],
                };
                let [_, a, b, c, last] = other.at_quarters();
                let [a, b, c, last] = machine.solved_together([a, b, c, last]).unwrap();
                let behind = Solved { commands: [end, a, b, c, last], direction: [0; 3] };
                let enclosed = Enclosed::of(&machine, &[wanted, other], [&solved, &behind]).unwrap();
                prop_assert!(radius > 8.0 || enclosed.holds(&machine, &of_a_quarter(&commanded, &commanded.at_quarters()).unwrap()));
                let with_other = told(Some(&enclosed));
                prop_assert!(own.is_some() || with_other.is_none());
                prop_assert!(with_other.is_none_or(|bound| Some(bound) >= own.map(|own| own - 1e-12)));
            }
        }

        /// Equation (P8), held against the model at many places.
        #[test]
        fn what_corrected_commands_tell_of_a_line_is_so(
            monotone: bool, from in prop::array::uniform3(20.0f64..180.0), along in 0usize..4, length in -60.0f64..60.0,
            beside in prop::array::uniform3(-0.01f64..0.01), rounded in prop::array::uniform6(-0.001f64..0.001),
        ) {
            let model = machine(monotone);
            let machine = with_tool(&model);
            let from = Vector::from(from);
            // Along an axis but for its correction, or across all.
            let way = Vector::from(beside) + match along {
                3 => Vector::new(length, 0.4 * length, -0.3 * length),
                axis => Vector::ith(axis, length),
            };
            let end = from + way;
            prop_assume!((0..3).all(|axis| (5.0..195.0).contains(&end[axis])));
            let wanted = Curve::Line(from, end);
            let [start, middle, last, _] = machine.solved_together([from, wanted.at(0.5), end, end]).unwrap();
            let commanded = Curve::Line(
                start + Vector::new(rounded[0], rounded[1], rounded[2]), last + Vector::new(rounded[3], rounded[4], rounded[5]),
            );
            let pair = Pair { wanted: &wanted, commanded: &commanded, in_step: false, begun: Begun::No };
            let bound = pair.line_by_commands(&machine, &[start, middle, last]).unwrap();
            let found = furthest(&pair, &machine, 257);
            prop_assert!(found <= bound + 1e-12, "{found} > {bound}");
        }
    }
}
