//! Which cause makes the diameters of turned parts wrong.
//!
//! Radii of parts, less what the model predicts, are a sum of what each [`Cause`] does; sizes of the tools and eccentric
//! clampings are the set-up's. Parts share an error of their own (equation (78)), so that what differs from part to part is
//! judged by parts, not by readings. A cause has a name where no sum of all other causes can be it: the F test of its
//! columns beside all others. Where only some other can be it too, both are told.

mod answer;
mod columns;
mod mixed;

use machine_model::effects::legendre;
use nalgebra::DVector;
use turning::WorkpieceError;
use units::math;

pub use answer::{FoundCause, LatheDiagnosis, Number, Unseen, Verdict};
use columns::Columns;
pub use columns::{Bar, Cause, CauseRow};
use mixed::{Fitted, Mixed};

use crate::student::quantile_between;

/// Chance of a name that is none, over all causes.
const LEVEL: f64 = 0.01;
/// Chance that noise looks like something left.
const LEFTOVER: f64 = 1e-3;
/// Parts whose tapers differ so much with this chance may be clamped askew.
const DOUBTFUL: f64 = 0.05;
/// No lathe of these presses so hard beyond what its profile says, N.
const MOST_N: f64 = 5000.0;
/// A rival that is no cause of the list.
const CLAMPING: &str = "how the parts were clamped";
/// Less than this share of what is no noise is no matter.
const LITTLE: f64 = 0.05;
/// Good readings have one that lies so far off with this chance.
const OUTLIER: f64 = 1e-4;
/// Rows, parts and degrees of freedom of the noise below which nothing is named.
const LEAST_ROWS: usize = 12;
const LEAST_PARTS: usize = 2;
const LEAST_FREEDOM: usize = 6;
/// A taper is sure where it is so many times the curve beside it.
const MOSTLY: f64 = 3.0;
/// Wear or growth of less than this share of the other is not sure beside it.
const LITTLE_DRIFT: f64 = 0.5;
/// A column of which less is its own is one of the others.
const OWN: f64 = 1e-6;

/// The causes that are asked for, with their columns.
struct Asked<'a> {
    columns: &'a Columns<'a>,
    mixed: Mixed,
    all: Vec<(Cause, Vec<DVector<f64>>)>,
    weights: Vec<f64>,
}

/// Finds what makes radii wrong.
///
/// * `held` – rows that judge what was found
///
/// # Errors
/// A bar that cannot be.
pub fn lathe_causes(
    rows: &[CauseRow],
    held: &[CauseRow],
    bar: Option<&Bar>,
) -> Result<LatheDiagnosis, WorkpieceError> {
    let columns = Columns::new(rows, bar)?;
    let mut parts: Vec<usize> = rows.iter().map(|row| row.part).collect();
    parts.sort_unstable();
    parts.dedup();
    let mut asked = Asked::new(&columns, &parts, false);
    let everything = asked.everything();
    if !asked.mixed.fit(&asked.independent(&everything)).is_scatter_seen {
        // No part is left that tells how parts differ: then every part has its own size, and drift is not asked.
        asked = Asked::new(&columns, &parts, true);
    }
    Ok(asked.diagnosis(&parts, held, bar))
}

fn indicator(rows: &[CauseRow], of: impl Fn(&CauseRow) -> f64) -> DVector<f64> {
    DVector::from_iterator(rows.len(), rows.iter().map(of))
}

/// One column for each different key.
fn levels<K: PartialEq>(rows: &[CauseRow], key: impl Fn(&CauseRow) -> K) -> Vec<DVector<f64>> {
    let mut keys: Vec<K> = Vec::new();
    for row in rows {
        if !keys.contains(&key(row)) {
            keys.push(key(row));
        }
    }
    keys.iter().map(|own| indicator(rows, |row| f64::from(u8::from(key(row) == *own)))).collect()
}

/// Where the centre of each cross section lies: one wave a turn is the clamping's, in the machine or on the instrument.
fn centres(rows: &[CauseRow]) -> Vec<DVector<f64>> {
    let turned: Vec<CauseRow> = rows.iter().filter(|row| row.angle_rad.is_some()).cloned().collect();
    let mut sections: Vec<(usize, f64)> = Vec::new();
    for row in &turned {
        if !sections.contains(&(row.part, row.z_mm)) {
            sections.push((row.part, row.z_mm));
        }
    }
    let wave = |section: &(usize, f64), of: fn(f64) -> f64| {
        indicator(rows, |row| match row.angle_rad {
            Some(angle) if (row.part, row.z_mm) == *section => of(angle),
            _ => 0.0,
        })
    };
    sections.iter().flat_map(|section| [wave(section, math::cos), wave(section, math::sin)]).collect()
}

impl<'a> Asked<'a> {
    /// * `is_each_its_own` – every part has its own size
    fn new(columns: &'a Columns<'a>, parts: &[usize], is_each_its_own: bool) -> Self {
        let rows = columns.rows;
        let is_known = rows.iter().all(|row| row.uncertainty_mm.is_some());
        let weights: Vec<f64> =
            rows.iter().map(|row| if is_known { row.uncertainty_mm.unwrap_or(1.0) } else { 1.0 }).collect();
        let weigh = |column: DVector<f64>| DVector::from_fn(rows.len(), |k, _| column[k] / weights[k]);
        let weighed = |all: Vec<DVector<f64>>| all.into_iter().map(weigh).collect::<Vec<DVector<f64>>>();
        let centres = centres(rows);
        let with = |own: Vec<DVector<f64>>| weighed(own.into_iter().chain(centres.clone()).collect());
        let cells = with(levels(rows, |row| (row.part, row.tool)));
        let sizes = match is_each_its_own {
            true => cells.clone(),
            false => with(levels(rows, |row| (row.tool, row.tool.is_none().then_some(row.part)))),
        };
        let shared = weighed(
            parts.iter().map(|part| indicator(rows, |row| f64::from(u8::from(row.part == *part)))).collect(),
        );
        let readings = weigh(indicator(rows, |row| row.gap_mm));
        let mixed = Mixed::new(readings, sizes, &cells, shared, is_known);
        let mut asked = Self { columns, mixed, all: Vec::new(), weights: weights.clone() };
        for cause in Cause::ALL {
            let own: Vec<DVector<f64>> = weighed(columns.cause(cause))
                .into_iter()
                .filter(|column| column.norm() > 0.0 && asked.mixed.seen(column) > OWN)
                .collect();
            if !own.is_empty() {
                asked.all.push((cause, own));
            }
        }
        asked
    }

    fn everything(&self) -> Vec<DVector<f64>> {
        self.all.iter().flat_map(|(_, own)| own.clone()).collect()
    }

    /// The columns without those that others before them are.
    fn independent(&self, columns: &[DVector<f64>]) -> Vec<DVector<f64>> {
        let mut kept: Vec<DVector<f64>> = Vec::new();
        for column in columns {
            if self.mixed.own_share(column, &kept) > OWN {
                kept.push(column.clone());
            }
        }
        kept
    }

    fn of(&self, causes: &[usize]) -> Vec<DVector<f64>> {
        causes.iter().flat_map(|k| self.all[*k].1.clone()).collect()
    }

    /// Chance that columns beside others are noise; 1 where the others are these.
    fn p_beside(&self, own: &[DVector<f64>], others: &[DVector<f64>]) -> f64 {
        let mut model = self.independent(others);
        let before = model.len();
        for column in own {
            if self.mixed.own_share(column, &model) > OWN {
                model.push(column.clone());
            }
        }
        let tested: Vec<usize> = (before..model.len()).collect();
        if tested.is_empty() { 1.0 } else { self.mixed.fit(&model).p(&tested) }
    }

    /// Of a cause beside others.
    fn p(&self, cause: usize, others: &[usize]) -> f64 {
        self.p_beside(&self.all[cause].1, &self.of(others))
    }

    fn level(&self) -> f64 {
        LEVEL / self.all.len().max(1) as f64
    }

    /// Causes that are needed, the surest first: one after the other, and none that the later ones made needless.
    fn selected(&self) -> Vec<usize> {
        let mut selected: Vec<usize> = Vec::new();
        loop {
            let open = (0..self.all.len()).filter(|k| !selected.contains(k));
            let best = open.map(|k| (k, self.p(k, &selected))).min_by(|a, b| a.1.total_cmp(&b.1));
            match best {
                Some((k, p)) if p < self.level() => selected.push(k),
                _ => break,
            }
        }
        let mut place = 0;
        while place < selected.len() {
            let others: Vec<usize> = selected.iter().copied().filter(|k| *k != selected[place]).collect();
            if self.p(selected[place], &others) < self.level() {
                place += 1;
            } else {
                selected.remove(place);
                place = 0;
            }
        }
        selected
    }

    /// What else may be a cause: what in its place leaves nothing for it.
    fn rivals(&self, cause: usize, selected: &[usize]) -> Vec<String> {
        let kept: Vec<usize> = selected.iter().copied().filter(|k| *k != cause).collect();
        let all_others: Vec<usize> = (0..self.all.len()).filter(|k| *k != cause).collect();
        if self.p(cause, &all_others) < self.level() {
            return Vec::new();
        }
        let open: Vec<usize> = all_others.iter().copied().filter(|k| !kept.contains(k)).collect();
        let id = |k: &usize| self.all[*k].0.id();
        let replaces = |others: &[usize]| self.p(cause, &[&kept[..], others].concat()) >= self.level();
        let singles: Vec<usize> = open.iter().copied().filter(|k| replaces(&[*k])).collect();
        let mut rivals: Vec<String> = singles.iter().map(|k| id(k).to_owned()).collect();
        if rivals.is_empty() {
            for (place, a) in open.iter().enumerate() {
                let pairs = open[place + 1..].iter().filter(|b| replaces(&[*a, **b]));
                rivals.extend(pairs.map(|b| format!("{} with {}", id(a), id(b))));
            }
        }
        if rivals.is_empty() {
            rivals.push("several other causes together".to_owned());
        }
        rivals
    }

    fn diagnosis(&self, parts: &[usize], held: &[CauseRow], bar: Option<&Bar>) -> LatheDiagnosis {
        let everything = self.independent(&self.everything());
        let whole = self.mixed.fit(&everything);
        let typical = self.weights.iter().sum::<f64>() / self.weights.len().max(1) as f64;
        let mut answer = LatheDiagnosis {
            verdict: Verdict::Underpowered,
            rms_mm: self.mixed.rms() * typical,
            noise_mm: whole.noise * typical,
            causes: Vec::new(),
            asked: self.all.iter().map(|(cause, _)| *cause).collect(),
            leftover_p: 1.0,
            outlier: None,
            unseen: None,
            explained_mm: vec![0.0; self.weights.len()],
        };
        let rows = self.columns.rows.len();
        if rows < LEAST_ROWS || parts.len() < LEAST_PARTS || self.mixed.freedom(&everything) < LEAST_FREEDOM {
            return answer;
        }
        let leftovers: Vec<DVector<f64>> = self
            .columns
            .leftovers(parts)
            .into_iter()
            .map(|column| DVector::from_fn(rows, |k, _| column[k] / self.weights[k]))
            .collect();
        let (row, size, freedom) = self.mixed.largest_residual(&everything);
        if size > quantile_between(OUTLIER / rows as f64, freedom) {
            answer.verdict = Verdict::NoiseModelSuspect;
            answer.outlier = Some(row);
            return answer;
        }
        let all: Vec<DVector<f64>> = everything.iter().chain(&leftovers).cloned().collect();
        let is_judged = self.mixed.freedom(&self.independent(&all)) >= LEAST_FREEDOM;
        answer.leftover_p = if is_judged { self.p_beside(&leftovers, &everything) } else { 1.0 };
        let tilts = self.p_beside(&self.tilts(parts), &everything);
        let selected = self.selected();
        let model = self.of(&selected);
        let found = self.mixed.fit(&model);
        let share = self.leftover_share(&model, &leftovers, &found);
        let is_left = answer.leftover_p < LEFTOVER && share > LITTLE;
        let mut place = 0;
        for (rank, k) in selected.iter().enumerate() {
            let (cause, own) = &self.all[*k];
            let mut rivals = self.rivals(*k, &selected);
            rivals.extend(self.unseen_rivals(*cause, &selected, &found, bar));
            let along = matches!(cause, Cause::Taper | Cause::Bending | Cause::Straightness);
            let drifts = matches!(cause, Cause::Growth | Cause::Wear | Cause::Scale);
            let is_absurd = *cause == Cause::Bending && found.values[place].abs() > MOST_N;
            let is_coarse = self.columns.degrees() < 2 && *cause != Cause::Taper;
            if (along || drifts) && (tilts < DOUBTFUL || is_absurd || is_coarse) {
                rivals.push(CLAMPING.to_owned());
            }
            let others: Vec<usize> = match rivals.is_empty() {
                true => (0..self.all.len()).filter(|other| other != k).collect(),
                false => selected.iter().copied().filter(|other| other != k).collect(),
            };
            let rms = |count: usize| self.mixed.rms_with(&self.of(&selected[..count])) * typical;
            answer.causes.push(FoundCause {
                cause: *cause,
                p: self.p(*k, &others),
                numbers: self.numbers(*cause, place, own.len(), &found),
                rivals,
                rms_mm: [rms(rank), rms(rank + 1)],
            });
            place += own.len();
        }
        answer.explained_mm = self.effect_mm(&selected, &found, |_| true).iter().copied().collect();
        answer.unseen = self.unseen(held, &selected, &found, bar);
        let is_refuted = answer.unseen.is_some_and(|unseen| unseen.rms_mm[1] > unseen.rms_mm[0]);
        answer.verdict = match (selected.is_empty(), is_left) {
            (true, false) => Verdict::NoGap,
            (true, true) => Verdict::Unknown,
            (false, _) if is_refuted || (is_left && share > 0.5) => Verdict::Unknown,
            (false, true) => Verdict::Partial,
            (false, false) if answer.causes.iter().any(|own| !own.rivals.is_empty()) => Verdict::Ambiguous,
            (false, false) => Verdict::Named,
        };
        answer
    }

    /// Every part's own lean, as a clamping makes it.
    fn tilts(&self, parts: &[usize]) -> Vec<DVector<f64>> {
        let own = self.columns.tilts(parts);
        own.map(|column| DVector::from_fn(column.len(), |k, _| column[k] / self.weights[k])).collect()
    }

    /// Of the squares that are no noise, those that what is left explains.
    fn leftover_share(&self, model: &[DVector<f64>], leftovers: &[DVector<f64>], found: &Fitted) -> f64 {
        let own = self.independent(model);
        let all: Vec<DVector<f64>> = own.iter().chain(leftovers).cloned().collect();
        let (before, after) = (self.mixed.rms_with(&own), self.mixed.rms_with(&self.independent(&all)));
        let gap = self.mixed.rms();
        let signal = (gap * gap - found.noise * found.noise).max(f64::MIN_POSITIVE);
        ((before * before - after * after) / signal).clamp(0.0, 1.0)
    }

    /// What may be a cause, and no column shows: what nobody wrote into the file.
    fn unseen_rivals(
        &self,
        cause: Cause,
        selected: &[usize],
        found: &Fitted,
        bar: Option<&Bar>,
    ) -> Vec<String> {
        let is_timed = self.columns.times.is_some();
        let is = |own: Cause| self.all.iter().any(|(known, _)| *known == own);
        let mut rivals: Vec<&'static str> = Vec::new();
        // No spindle grows quite as the columns do: a little of the one beside much of the other may be its shape.
        let is_little = |own: Cause, other: Cause| {
            let [own, other] = [own, other].map(|cause| self.extent_mm(cause, selected, found));
            own < LITTLE_DRIFT * other
        };
        match cause {
            Cause::Wear if !is_timed || is_little(Cause::Wear, Cause::Growth) => {
                rivals.push("spindle.growth")
            }
            Cause::Growth if !is(Cause::Wear) || is_little(Cause::Growth, Cause::Wear) => {
                rivals.push("tool.wear");
            }
            Cause::Straightness if bar.is_none() => rivals.push("lathe.bending"),
            Cause::Jaws => rivals.push("spindle.runout"),
            Cause::Bending => rivals.extend(self.within_the_cut(cause, selected)),
            Cause::Taper => {
                rivals.extend(self.within_the_cut(cause, selected));
                // Few places do not tell a slope from a curve, and a curve's slope is not sure.
                if self.columns.degrees() < 2 || self.is_mostly_curve(selected, found) {
                    rivals.push("straightness.EXZ");
                }
            }
            _ => {}
        }
        rivals.into_iter().map(str::to_owned).collect()
    }

    /// What causes that were found do to each row, mm.
    fn effect_mm(
        &self,
        selected: &[usize],
        found: &Fitted,
        is_asked: impl Fn(Cause) -> bool,
    ) -> DVector<f64> {
        let mut place = 0;
        let mut sum = DVector::zeros(self.weights.len());
        for k in selected {
            let (own, columns) = &self.all[*k];
            for (i, column) in columns.iter().enumerate().filter(|_| is_asked(*own)) {
                let value = found.values[place + i];
                sum += DVector::from_fn(column.len(), |row, _| column[row] * self.weights[row] * value);
            }
            place += columns.len();
        }
        sum
    }

    /// How much a cause that was found changes the radius, from least to most, mm.
    fn extent_mm(&self, cause: Cause, selected: &[usize], found: &Fitted) -> f64 {
        let sum = self.effect_mm(selected, found, |own| own == cause);
        sum.max() - sum.min()
    }

    /// The curve that was found beside a taper is nearly as large: a part of it that these places do not resolve may be all
    /// that the taper is.
    fn is_mostly_curve(&self, selected: &[usize], found: &Fitted) -> bool {
        let (mut place, mut taper_mm) = (0, 0.0);
        let mut curve = DVector::zeros(self.columns.rows.len());
        for k in selected {
            let (cause, own) = &self.all[*k];
            for (i, _) in own.iter().enumerate() {
                let value = found.values[place + i];
                match cause {
                    Cause::Taper => taper_mm = value * (self.columns.along[1] - self.columns.along[0]),
                    Cause::Straightness => curve += self.columns.legendre(i + 2) * value,
                    _ => {}
                }
            }
            place += own.len();
        }
        MOSTLY * (curve.max() - curve.min()) > taper_mm.abs()
    }

    /// Wear and growth go on while a part is cut, and look like its taper: as large as what parts differ by, at most.
    fn within_the_cut(&self, cause: Cause, selected: &[usize]) -> Vec<&'static str> {
        let is_timed = self.columns.times.is_some();
        let with: Vec<usize> =
            (0..self.all.len()).filter(|k| selected.contains(k) || self.all[*k].0 == Cause::Wear).collect();
        let causes: Vec<Cause> =
            with.iter().flat_map(|k| vec![self.all[*k].0; self.all[*k].1.len()]).collect();
        let at = |own: Cause| causes.iter().position(|known| *known == own);
        let (Some(place), Some(wear)) = (at(cause), at(Cause::Wear)) else {
            // No tool is named: nothing tells by how much a tip recedes.
            return if is_timed { vec!["tool.wear"] } else { vec!["spindle.growth", "tool.wear"] };
        };
        let columns = self.of(&with);
        let fitted = self.mixed.fit(&columns);
        let unit = DVector::from_fn(causes.len(), |i, _| f64::from(u8::from(i == wear)));
        let own = DVector::from_fn(self.weights.len(), |k, _| columns[place][k] * self.weights[k]);
        let along_mm = (fitted.values[place] * (own.max() - own.min())).abs();
        let is_small = along_mm <= fitted.values[wear].abs() + fitted.u95(&unit);
        match (is_small, is_timed) {
            (false, _) => Vec::new(),
            (true, true) => vec!["tool.wear"],
            (true, false) => vec!["spindle.growth", "tool.wear"],
        }
    }

    /// * `place`, `count` – its columns in the model
    fn numbers(&self, cause: Cause, place: usize, count: usize, found: &Fitted) -> Vec<Number> {
        let size = found.values.len();
        let sum = |of: &[f64]| {
            DVector::from_fn(size, |i, _| {
                i.checked_sub(place).and_then(|k| of.get(k)).copied().unwrap_or(0.0)
            })
        };
        let number = |name: &'static str, of: &[f64]| {
            let row = sum(of);
            Number { name, value: row.dot(&found.values), u95: found.u95(&row) }
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
    ) -> Option<Unseen> {
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
        let rms = |of: &DVector<f64>| (mixed::beyond(of, &cells).norm_squared() / held.len() as f64).sqrt();
        Some(Unseen { rows: held.len(), rms_mm: [rms(&gap), rms(&(&gap - predicted))] })
    }
}
