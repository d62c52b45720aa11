//! Each cause in a sentence that a metrologist would say, and what not to do about it.

use machine_model::Vector;
use machine_model::effects::EffectKind;

use crate::equations::term::Term;
use crate::judgement::assembly::Assembly;

const AXES: [&str; 3] = ["X", "Y", "Z"];

/// What stands in the place of a remedy where the causes do not explain the gap, or unseen rows refute them.
pub(crate) const DO_NOT_ACT: &str = "Do not act on this: what is left of the gap has no name yet, or rows that were not fitted contradict it, or it would move more than was ever read.";

/// What stands there for play of the wrong sign.
pub(crate) const NO_PLAY: &str = "This is no play: the reversal is over-compensated (lower the control's backlash value), or the sensor sits on the motor's side of it.";

impl Assembly<'_> {
    /// The part at a place of the model in words, with its size where it was measured.
    pub(crate) fn words(&self, place: usize) -> String {
        let kind = self.model.library.kind(self.model.parts[place]);
        let own = self.own(place);
        let first = own.first().map_or(0.0, |(_, value)| *value);
        let swing = self.swing_um(&own);
        let shape = own.iter().find_map(|(t, _)| match t {
            Term::Effect { shape, .. } => Some(*shape),
            _ => None,
        });
        let shape = shape.unwrap_or_default();
        let axis = |a: usize| AXES[a];
        match kind {
            EffectKind::Scale(a) => format!(
                "{} travels {:.1} µm per metre too {}",
                axis(a),
                first.abs(),
                if first > 0.0 { "far" } else { "short" }
            ),
            EffectKind::Squareness(a, b) => format!(
                "{} leans {:.0} µrad against {}: {:.1} µm per 100 mm",
                axis(b),
                first.abs(),
                axis(a),
                0.1 * first.abs()
            ),
            EffectKind::Backlash(a) if first < 0.0 => format!(
                "{} reverses with {:.1} µm too much, not too little: over-compensated, or the sensor sits on the motor's side",
                axis(a),
                2.0 * first.abs()
            ),
            EffectKind::Backlash(a) => {
                format!("{} loses {:.1} µm of travel when it reverses", axis(a), 2.0 * first)
            }
            EffectKind::LostMotion { direction, axis: a } => format!(
                "{} steps {:.1} µm along {} when it reverses",
                axis(a),
                2.0 * first.abs(),
                axis(direction)
            ),
            EffectKind::Thermal(a) => {
                format!("{} grows with its temperature: {swing:.1} µm over what was measured", axis(a))
            }
            EffectKind::Warmup(a) => format!(
                "{} creeps by {:.1} µm with a time constant of {:.0} min",
                axis(a),
                first.abs(),
                shape.tau_s / 60.0
            ),
            EffectKind::Positioning(a) => {
                format!("the positions of {} err along a curve of {swing:.1} µm", axis(a))
            }
            EffectKind::Straightness { direction, axis: a } => {
                format!("{} runs {swing:.1} µm out of straight along {}", axis(a), axis(direction))
            }
            EffectKind::Pitch(a) => format!(
                "{} errs by {swing:.1} µm once every {:.2} mm: one turn of its screw",
                axis(a),
                shape.pitch_mm
            ),
            EffectKind::Angular { about, axis: a } => format!(
                "{} {} as it travels: {swing:.1} µm at the tool",
                axis(a),
                if about == a {
                    "rolls"
                } else if about == 2 {
                    "yaws"
                } else {
                    "pitches"
                }
            ),
            EffectKind::Sag(a) => format!("{} droops by {swing:.1} µm as it reaches out", axis(a)),
            EffectKind::Load(a) => {
                format!("the load bends the machine along {} by {swing:.1} µm", axis(a))
            }
            EffectKind::ServoLag(a) => format!("{} runs {:.2} ms behind its command", axis(a), first.abs()),
            EffectKind::ServoMismatch(a, b) => {
                format!("{} and {} run {:.2} ms apart", axis(a), axis(b), first.abs())
            }
            EffectKind::Rotary { axis: a, .. } => {
                format!(
                    "the rotary axis {} does not stand where the model has it: {swing:.1} µm",
                    ["A", "B", "C"][a]
                )
            }
            EffectKind::Eccentricity(a) => {
                format!("{} errs once per turn by {swing:.1} µm", ["A", "B", "C"][a])
            }
            EffectKind::ProbeLobing => {
                format!("the probe triggers {swing:.1} µm apart from direction to direction")
            }
            EffectKind::InstrumentDrift => {
                format!("the instrument drifts: {swing:.1} µm while it measured")
            }
            EffectKind::Step(a) => {
                format!("something moved by {:.1} µm along {} at {:.0} s", first.abs(), axis(a), shape.time_s)
            }
            EffectKind::Joint(a) => {
                format!(
                    "the rails of {} do not meet at {:.0} mm: a step of {swing:.1} µm",
                    axis(a),
                    shape.centre_mm
                )
            }
            EffectKind::Spike(a) => format!(
                "{} sticks where it turns: {:.1} µm, gone after {:.1} mm of way",
                axis(a),
                first.abs(),
                2.3 * shape.width_mm
            ),
            EffectKind::Contraction => {
                format!("circles shrink with the square of the feed: {swing:.1} µm over what was measured")
            }
            EffectKind::SpindleTilt(a) => format!(
                "the spindle leans {:.0} µrad towards {}: {:.1} µm per 100 mm of tool",
                first.abs(),
                axis(a),
                0.1 * first.abs()
            ),
            EffectKind::Tracker(fault) => format!(
                "the tracker reads its {} wrong: {swing:.1} µm",
                machine_model::effects::TRACKER[fault].replace('-', " ")
            ),
            EffectKind::Local(a) => format!(
                "{} errs by {swing:.1} µm near {:.0} mm, over {:.0} mm",
                axis(a),
                shape.centre_mm,
                shape.width_mm
            ),
        }
    }

    /// From the least to the most that some terms displace the rows, along the direction where that is largest, µm.
    fn swing_um(&self, terms: &[(Term, f64)]) -> f64 {
        let (mut low, mut high) = (Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY));
        for moved in crate::equations::align::displacements(self.data, terms) {
            (low, high) = (low.inf(&moved), high.sup(&moved));
        }
        (high - low).max().max(0.0)
    }
}
