//! What the reader of an answer should know beside it.

use crate::equations::noise::{Noise, NoiseSource};
use crate::equations::observation::{Measurements, Row};
use crate::equations::set_up::Clamping;
use crate::judgement::answer::Cause;
use crate::judgement::assembly::Assembly;
use crate::judgement::structure::jerks;
use crate::search::bounds::Harm;

impl Assembly<'_> {
    pub(crate) fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        match self.noise {
            Some(Noise { source: NoiseSource::Neighbours, .. }) => notes.push(
                "No command was measured twice in a run: the noise is estimated from neighbouring rows, and a gap finer than their distance counts as noise.".to_owned(),
            ),
            Some(Noise { source: NoiseSource::Returns, .. }) => notes.push(
                "No command was measured twice in a run: the noise is estimated from what the same commands read in other runs, for neighbouring rows differ by far more.".to_owned(),
            ),
            Some(Noise { source: NoiseSource::Forms, .. }) => notes.push(
                "No command was measured twice in a run: the noise is what a form of second degree leaves of each run, for rows measured one after the other differ by far more.".to_owned(),
            ),
            None => notes.push("There are neither repeats nor neighbours to tell noise from gap.".to_owned()),
            Some(noise) if noise.is_slow() => notes.push(format!(
                "Repeats of one command scatter {:.1} times as much as neighbouring readings: something changes between the passes (temperature, machine or instrument), and the repeats' scatter is not noise alone.",
                noise.slow
            )),
            Some(_) => {}
        }
        if !self.model.caution.is_none() {
            notes.push(format!(
                "Neighbouring readings hang together (correlation {:.2} from one to the next): intervals and tests count them as {:.0} % of as many independent ones.",
                self.model.caution.lag(1),
                100.0 / self.model.caution.as_one()
            ));
        }
        notes.extend(self.setup_notes());
        if let Some(ratio) = self.noise_ratio().filter(|r| !(1.0 / 1.6..=1.6).contains(r)) {
            notes.push(format!(
                "The scatter of the rows is {ratio:.2} times what u_um says; the rows' own scatter was used."
            ));
        }
        let model = self.model;
        notes.extend(jerks(self.data, &model.scalars, &model.solution.residuals_um).into_iter().map(|found| {
            format!(
                "{} moves in jerks below {:.0} mm/min: there it scatters {:.1} times as much from reading to reading as when it is faster (stick-slip, or a drive that hunts). No effect describes that and no correction removes it: see to guideways, lubrication and drive.",
                ["X", "Y", "Z"][found.axis], found.below_mm_min, found.ratio
            )
        }));
        if let Some(refused) = &self.model.refused {
            notes.push(format!("{} was considered next and not named: {}.", refused.kind, refused.reason));
        }
        notes
    }

    /// What the set-up holds that its reader should know.
    fn setup_notes(&self) -> Vec<String> {
        let setup = self.setup();
        let mut notes = Vec::new();
        if self.model.clamping == Clamping::Turned {
            let turns = || setup.run_rotations_urad.iter().flat_map(|(_, turn)| turn.iter().copied());
            let (low, high) =
                turns().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            notes.push(format!(
                "The runs are turned against each other by up to {:.0} urad: every run has a set-up of its own (clamping), and that is taken out of the gap.",
                high - low
            ));
        }
        for (instrument, zeros) in &setup.instruments_um {
            let axis = (0..3).max_by(|a, b| zeros[*a].0.abs().total_cmp(&zeros[*b].0.abs())).unwrap_or(0);
            let (value, u95) = zeros[axis];
            if value.abs() > u95 && value.abs() > 2.0 * self.noise_variance().sqrt() {
                let name = |i: usize| self.data.instruments.get(i).map_or("?", String::as_str);
                notes.push(format!(
                    "The instruments {} and {} disagree by {:.1} ± {u95:.1} um in {}: taken out as set-up; which of them is right these rows do not say.",
                    name(0),
                    name(*instrument),
                    value.abs(),
                    ["X", "Y", "Z"][axis]
                ));
            }
        }
        notes
    }

    /// What the reader of a forecast for other commands must know: where they lie outside what was measured, and
    /// where the rivals of a cause would have it otherwise.
    pub(crate) fn forecast_notes(&self, holdout: &Measurements, causes: &[Cause]) -> Vec<String> {
        type Value = fn(&Row) -> Option<f64>;
        let mut notes = Vec::new();
        let mut beyond: Vec<&str> = Vec::new();
        let values: [(&str, Value); 6] = [
            ("X", |r| Some(r.command.linear_mm.x)),
            ("Y", |r| Some(r.command.linear_mm.y)),
            ("Z", |r| Some(r.command.linear_mm.z)),
            ("the tool's length", |r| Some(r.command.tool_mm.z)),
            ("the feed", |r| r.conditions.feed_mm_min),
            ("the load", |r| r.conditions.load_kg),
        ];
        for (name, value) in values {
            let ends = |data: &Measurements| {
                let known = data.rows.iter().filter_map(value);
                known.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)))
            };
            let ((low, high), (from, to)) = (ends(self.data), ends(holdout));
            // A tenth of the range beyond its ends is still the same neighbourhood.
            let slack = 0.1 * (high - low) + 1e-6;
            if from < low - slack || to > high + slack {
                beyond.push(name);
            }
        }
        if !beyond.is_empty() {
            notes.push(format!(
                "The hold-out lies outside what was measured in {}: the predicted shrinkage is an extrapolation there.",
                beyond.join(", ")
            ));
        }
        if let Some(open) = causes.iter().find(|c| {
            !c.cannot_be_told_from.is_empty() && c.shrink_predicted.high - c.shrink_predicted.low > 0.2
        }) {
            notes.push(format!(
                "Whether {} or {} is the cause decides how far the gap shrinks on the hold-out: settle that before correcting there.",
                open.effect,
                open.cannot_be_told_from.join(", ")
            ));
        }
        notes
    }
}

impl Harm {
    /// Why no correction may be made of the causes.
    pub(crate) fn words(self) -> String {
        match self {
            Self::Swings(moved_um, reading_um) => format!(
                "No correction is made of the causes: between the places measured they would together move the tool by up to {moved_um:.0} um, and no reading is larger than {reading_um:.0} um. Measure more places between, and repeat each."
            ),
            Self::Cancels(alone_um, gap_um) => format!(
                "No correction is made of the causes: they cancel each other. With the first of them alone {alone_um:.1} um RMS are left, and {gap_um:.1} um without any; another cause with the shape of their difference is likelier."
            ),
            Self::Shifts(moved_um, range_um) => format!(
                "No correction is made of the causes: they count from machine zero and would move all of the places measured by up to {moved_um:.0} um, and the readings reach and range over no more than {range_um:.0} um: the way that was measured is too short, so far from zero. Measure over more of the axis."
            ),
        }
    }
}
