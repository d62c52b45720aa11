//! Which cause makes the diameters of turned parts wrong.
//!
//! Radii of parts, less what the model predicts, are a sum of what each [`Cause`] does; sizes of the tools and eccentric
//! clampings are the set-up's. Parts share an error of their own (equation (78)), so that what differs from part to part is
//! judged by parts, not by readings. A cause has a name where no sum of all other causes can be it: the F test of its
//! columns beside all others. Where only some other can be it too, both are told.

mod asked;
mod columns;
mod mixed;
mod rivals;
mod words;

use diagnostic::{Text, both};
use gap_diagnosis::{Cause as Found, Diagnosis, Gap, Holdout, Leftover, Parameter, Residual, Verdict};
use machine_model::Vector;
use machine_model::effects::legendre;
use nalgebra::DVector;
use turning::WorkpieceError;
use units::math;

use asked::{Asked, Sizes, centres, indicator, levels};
use columns::Columns;
pub use columns::{Bar, Cause, CauseRow};
use mixed::Fitted;
pub use words::cause_name;
use words::{CLAMPING, meaning};

use crate::student::quantile_between;

/// Chance that noise looks like something left.
const LEFTOVER: f64 = 1e-3;
/// Parts whose tapers differ so much with this chance may be clamped askew.
const DOUBTFUL: f64 = 0.05;
/// No lathe of these presses so hard beyond what its profile says, N.
const MOST_N: f64 = 5000.0;
/// Less than this share of what is no noise is no matter.
const LITTLE: f64 = 0.05;
/// Good readings have one that lies so far off with this chance.
const OUTLIER: f64 = 1e-4;
/// Rows, parts and degrees of freedom of the noise below which nothing is named.
const LEAST_ROWS: usize = 12;
const LEAST_PARTS: usize = 2;
const LEAST_FREEDOM: usize = 6;

/// Finds what makes radii wrong.
///
/// * `held` – rows that judge what was found
/// * `tailstock_mm` – where the tailstock's centre stands, if there is one
///
/// # Errors
/// A bar that cannot be.
pub fn lathe_causes(
    rows: &[CauseRow],
    held: &[CauseRow],
    bar: Option<&Bar>,
    tailstock_mm: Option<f64>,
) -> Result<Diagnosis, WorkpieceError> {
    let columns = Columns::new(rows, bar)?;
    let mut parts: Vec<usize> = rows.iter().map(|row| row.part).collect();
    parts.sort_unstable();
    parts.dedup();
    let mut asked = Asked::new(&columns, &parts, Sizes::OfTools);
    let everything = asked.everything();
    if !asked.mixed.fit(&asked.independent(&everything)).is_scatter_seen {
        // No part is left that tells how parts differ: then every part has its own size, and drift is not asked.
        asked = Asked::new(&columns, &parts, Sizes::OfParts);
    }
    Ok(asked.diagnosis(&parts, held, bar, tailstock_mm))
}

impl Asked<'_> {
    fn diagnosis(
        &self,
        parts: &[usize],
        held: &[CauseRow],
        bar: Option<&Bar>,
        tailstock_mm: Option<f64>,
    ) -> Diagnosis {
        let everything = self.independent(&self.everything());
        let typical = self.typical();
        let noise_um = self.mixed.fit(&everything).noise * typical * 1e3;
        let beyond = self.mixed.beyond();
        let gap = Gap::new(beyond.iter().map(|own| own.abs() * typical * 1e3).collect(), noise_um);
        let asked: Vec<Text> = self.all.iter().map(|(cause, _)| cause_name(cause.id())).collect();
        let notes = vec![
            both!(
                "All figures are on the radius; sizes of tools and where parts were clamped are taken off.",
                "Все числа — по радиусу, без размеров инструментов и установок деталей."
            ),
            both!("These rows could show: {}.", "Эти строки могли показать: {:#}.", Text::join(&asked, ", ")),
        ];
        let of = |verdict: Verdict| Diagnosis {
            notes: notes.clone(),
            ..Diagnosis::new(verdict, meaning(verdict), gap)
        };
        let rows = self.columns.rows.len();
        if rows < LEAST_ROWS || parts.len() < LEAST_PARTS || self.mixed.freedom(&everything) < LEAST_FREEDOM {
            return Diagnosis { next_measurement: Some(words::more_parts()), ..of(Verdict::Underpowered) };
        }
        let (row, size, freedom) = self.mixed.largest_residual(&everything);
        if size > quantile_between(OUTLIER / rows as f64, freedom) {
            let suspect = of(Verdict::NoiseModelSuspect);
            let mut sentence = suspect.sentence.clone();
            sentence.push(&words::outlier(&self.columns.rows[row]));
            return Diagnosis { sentence, residuals: self.residuals(None), ..suspect };
        }
        let leftovers: Vec<DVector<f64>> =
            self.columns.leftovers(parts).iter().map(|column| self.weighed(column)).collect();
        let all: Vec<DVector<f64>> = everything.iter().chain(&leftovers).cloned().collect();
        let is_judged = self.mixed.freedom(&self.independent(&all)) >= LEAST_FREEDOM;
        let leftover_p = if is_judged { self.p_beside(&leftovers, &everything) } else { 1.0 };
        let selected = self.selected();
        let model = self.of(&selected);
        let found = self.mixed.fit(&model);
        let own = self.independent(&model);
        let with = self.independent(&own.iter().chain(&leftovers).cloned().collect::<Vec<_>>());
        let share = self.share(&own, &with, &found);
        let is_left = leftover_p < LEFTOVER && share > LITTLE;
        let causes = self.causes(parts, &selected, &found, bar, tailstock_mm);
        let holdout = self.unseen(held, &selected, &found, bar);
        let is_refuted = holdout.as_ref().is_some_and(|unseen| unseen.rms_after_um > unseen.rms_before_um);
        let verdict = match (selected.is_empty(), is_left) {
            (true, false) => Verdict::NoGap,
            (true, true) => Verdict::Unknown,
            (false, _) if is_refuted || (is_left && share > 0.5) => Verdict::Unknown,
            (false, true) => Verdict::Partial,
            (false, false) if causes.iter().any(|own| !own.cannot_be_told_from.is_empty()) => {
                Verdict::Ambiguous
            }
            (false, false) => Verdict::Named,
        };
        let rms_um = causes.last().map_or(gap.rms_um, |last| last.rms_after_um);
        let signal = (gap.rms_um * gap.rms_um - noise_um * noise_um).max(f64::MIN_POSITIVE);
        let phi = ((rms_um * rms_um - noise_um * noise_um) / signal).clamp(0.0, 1.0);
        Diagnosis {
            next_measurement: words::next(&causes),
            causes,
            leftover: Leftover { rms_um, phi, lack_of_fit_p: leftover_p, ..Leftover::default() },
            holdout,
            residuals: self.residuals(Some(&self.effect_mm(&selected, &found, |_| true))),
            ..of(verdict)
        }
    }

    /// Each with what it leaves of the gap.
    fn causes(
        &self,
        parts: &[usize],
        selected: &[usize],
        found: &Fitted,
        bar: Option<&Bar>,
        tailstock_mm: Option<f64>,
    ) -> Vec<Found> {
        let tilts = self.p_beside(&self.tilts(parts), &self.independent(&self.everything()));
        let mut place = 0;
        let mut causes = Vec::new();
        for (rank, k) in selected.iter().enumerate() {
            let (cause, own) = &self.all[*k];
            let mut rivals = self.rivals(*k, selected);
            rivals.extend(self.unseen_rivals(*cause, selected, found, bar));
            let along = matches!(cause, Cause::Taper | Cause::Bending | Cause::Straightness);
            let drifts = matches!(cause, Cause::Growth | Cause::Wear | Cause::Scale);
            let is_absurd = *cause == Cause::Bending && found.values[place].abs() > MOST_N;
            let is_coarse = self.columns.degrees() < 2 && *cause != Cause::Taper;
            if (along || drifts) && (tilts < DOUBTFUL || is_absurd || is_coarse) {
                rivals.push(CLAMPING.to_owned());
            }
            let kept: Vec<usize> = selected.iter().copied().filter(|other| other != k).collect();
            let others = match rivals.is_empty() {
                true => (0..self.all.len()).filter(|other| other != k).collect(),
                false => kept.clone(),
            };
            let rms = |count: usize| self.mixed.rms_with(&self.of(&selected[..count])) * self.typical() * 1e3;
            let parameters = self.numbers(*cause, place, own.len(), found);
            causes.push(Found {
                term: None,
                effect: cause.id().to_owned(),
                words: words::sentence(*cause, &parameters),
                remedy: words::remedy(*cause, &parameters, tailstock_mm),
                share_unique: self.share(&self.of(&kept), &self.of(selected), found),
                share_alone: self.share(&[], own, found),
                p: self.p(*k, &others),
                parameters,
                cannot_be_told_from: rivals,
                nearest: Vec::new(),
                rms_before_um: rms(rank),
                rms_after_um: rms(rank + 1),
                shrink_predicted: None,
            });
            place += own.len();
        }
        causes
    }

    /// Gap and what is left of it by row, each part at its own mean: its size is the tool's.
    fn residuals(&self, explained_mm: Option<&DVector<f64>>) -> Vec<Residual> {
        let rows = self.columns.rows;
        let after_mm = |k: usize| rows[k].gap_mm - explained_mm.map_or(0.0, |all| all[k]);
        let of = |k: usize| {
            let same = |i: &usize| (rows[*i].part, rows[*i].tool) == (rows[k].part, rows[k].tool);
            let own: Vec<usize> = (0..rows.len()).filter(same).collect();
            let mean = |of: &dyn Fn(usize) -> f64| own.iter().map(|i| of(*i)).sum::<f64>() / own.len() as f64;
            Residual {
                row: k,
                class: 0,
                along: Vector::x(),
                before_um: (rows[k].gap_mm - mean(&|i| rows[i].gap_mm)) * 1e3,
                after_um: (after_mm(k) - mean(&after_mm)) * 1e3,
            }
        };
        (0..rows.len()).map(of).collect()
    }

    /// * `place`, `count` – its columns in the model
    fn numbers(&self, cause: Cause, place: usize, count: usize, found: &Fitted) -> Vec<Parameter> {
        let size = found.values.len();
        let sum = |of: &[f64]| {
            DVector::from_fn(size, |i, _| {
                i.checked_sub(place).and_then(|k| of.get(k)).copied().unwrap_or(0.0)
            })
        };
        let number = |name: &'static str, of: &[f64]| {
            let row = sum(of);
            Parameter { name: name.to_owned(), value: row.dot(&found.values), u95: Some(found.u95(&row)) }
        };
        match cause {
            // r falls where the axis leads to +X with growing Z.
            Cause::Taper => vec![number("taper_urad", &[1e6]), number("EB0S_urad", &[-1e6])],
            Cause::Bending => vec![number("radial_force_n", &[1.0])],
            Cause::Wear => vec![number("wear_um_per_part", &[1e3])],
            Cause::Scale => vec![number("scale_um_per_m", &[1e6])],
            Cause::Growth => {
                let last = self.columns.times.map_or(0.0, |[first, last]| (last - first) / 3600.0);
                vec![number("growth_um", &self.columns.grown(last).map(|v| v * 1e3)[..count])]
            }
            // Middle less ends: of the parabola (3u² − 1)/2, −3/2.
            Cause::Straightness => vec![number("bow_um", &[-1.5e3])],
            Cause::Runout | Cause::Jaws => {
                let names: &[&'static str] = match (cause, count) {
                    (Cause::Jaws, _) => &["wave_3_um"],
                    (_, 6) => &["wave_2_um", "wave_3_um", "wave_4_um"],
                    _ => &["wave_2_um", "wave_4_um"],
                };
                let pairs = (0..count / 2).zip(names);
                pairs
                    .map(|(k, name)| {
                        let [c, s] = [0, 1].map(|i| found.values[place + 2 * k + i]);
                        let amplitude = math::hypot(c, s).max(f64::MIN_POSITIVE);
                        // Along its own phase.
                        let mut of = vec![0.0; 2 * k];
                        of.extend([1e3 * c / amplitude, 1e3 * s / amplitude]);
                        number(name, &of)
                    })
                    .collect()
            }
        }
    }

    /// Predicts rows that no fit saw by what was found, each part at its own size.
    fn unseen(
        &self,
        held: &[CauseRow],
        selected: &[usize],
        found: &Fitted,
        bar: Option<&Bar>,
    ) -> Option<Holdout> {
        if held.is_empty() || selected.is_empty() {
            return None;
        }
        let own = Columns::new(held, bar).ok()?;
        let [low, high] = self.columns.along;
        let middle = 0.5 * (low + high);
        let u = |row: &CauseRow| if high > low { (row.z_mm - middle) / (0.5 * (high - low)) } else { 0.0 };
        let mut predicted = DVector::zeros(held.len());
        let mut place = 0;
        for k in selected {
            let (cause, columns) = &self.all[*k];
            let values: Vec<f64> = (0..columns.len()).map(|i| found.values[place + i]).collect();
            place += columns.len();
            let column = |of: &dyn Fn(&CauseRow) -> f64| indicator(held, of);
            let parts: Vec<DVector<f64>> = match cause {
                Cause::Taper => vec![column(&|row| row.z_mm - middle)],
                Cause::Straightness => (2..4).map(|k| column(&|row| legendre(k, u(row)))).collect(),
                Cause::Growth => {
                    let hours = |row: &CauseRow| self.columns.hours(row);
                    (0..2).map(|i| column(&|row| self.columns.grown(hours(row))[i])).collect()
                }
                // What differs from part to part is in the parts' own sizes.
                Cause::Wear | Cause::Scale => continue,
                Cause::Bending | Cause::Runout | Cause::Jaws => own.cause(*cause),
            };
            for (column, value) in parts.iter().zip(values) {
                predicted += column * value;
            }
        }
        let cells = mixed::basis(&[levels(held, |row| (row.part, row.tool)), centres(held)].concat());
        let gap = indicator(held, |row| row.gap_mm);
        let rms =
            |of: &DVector<f64>| 1e3 * (mixed::beyond(of, &cells).norm_squared() / held.len() as f64).sqrt();
        Some(Holdout::new(held.len(), rms(&gap), rms(&(&gap - predicted))))
    }
}
