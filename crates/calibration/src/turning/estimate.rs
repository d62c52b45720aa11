//! What the test pieces say of the lathe, and what they cannot.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::equations::{Change, Stretch, TurningBase};
use super::rows::{FINEST_MM, Feature, TurnedReading, check, check_repeats};
use crate::CalibrationError;
use crate::adjustment::{Estimate, Jacobian, Noise, Problem, adjust};
use crate::student::{quantile, quantile_95};

/// Level of the F tests: of a hundred terms that are not there one is found.
pub const LEVEL: f64 = 0.01;
/// Good readings have one that lies so far off with this chance.
const OUTLIER_CHANCE: f64 = 1e-4;
/// Test pieces of one machine differ so much in their tapers with this chance.
const PARTS_CHANCE: f64 = 1e-3;
/// Terms of which more than this share of one is the others cannot be told apart: a correlation of 0.95.
const ALIKE: f64 = 0.9;
/// Shares below this are rounding.
const NOTHING: f64 = 1e-9;
/// Of differences: large against rounding, small against the curvature of the model.
const STEPS: [f64; 3] = [1e-4, 1e-4, 1e-2];
/// A step that changes no reading by more is the last, mm: what it leaves is its square.
const SETTLED_MM: f64 = 1e-9;

/// What a test piece may show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Term {
    /// Tilt of the workpiece's axis: EB0S, rad, or the tailstock's offset, mm.
    Axis,
    /// EB0Z, rad.
    Squareness,
    /// Growth with time on the radius, mm/h.
    Growth,
    /// Wear, mm on the radius from part to part.
    Wear,
    /// Quadratic EXZ, mm: middle above ends.
    Bow,
    /// EXZ of order 4, mm.
    FourthOrder,
    /// Growth and wear, which these parts cannot tell apart: taken off, not named.
    Drift,
    /// From part to part, by wear or by something else: taken off, not named.
    PartToPart,
}

impl Term {
    /// As messages name it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Axis => "taper",
            Self::Squareness => "squareness",
            Self::Growth => "growth",
            Self::Wear => "wear",
            Self::Bow => "barrel",
            Self::FourthOrder => "order 4 of the barrel",
            Self::Drift => "drift",
            Self::PartToPart => "from part to part",
        }
    }

    /// True where it is geometry that a profile holds.
    #[must_use]
    pub fn is_geometry(self) -> bool {
        !matches!(self, Self::Growth | Self::Wear | Self::Drift | Self::PartToPart)
    }

    /// True where it may be told: the others are taken off, and nobody knows what they are.
    #[must_use]
    pub fn is_named(self) -> bool {
        !matches!(self, Self::Drift | Self::PartToPart)
    }
}

/// A term and how well it is known, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundTerm {
    /// Which.
    pub term: Term,
    /// Its change against the base.
    pub value: f64,
    /// Standard uncertainty.
    pub u: f64,
    /// F of its test: what it explains over what is left, 1 and so many degrees of freedom.
    pub f: f64,
    /// Its test at [`LEVEL`] says that it is there.
    pub is_significant: bool,
}

/// Size of a tool, mm on the radius, with the profile that is to be written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset {
    /// The tool; `None`: of [`Self::part`] alone.
    pub tool: Option<usize>,
    /// The first part it cut.
    pub part: usize,
    /// Where the parts' mean time and order are, mm.
    pub radius_mm: f64,
    /// Standard uncertainty, mm.
    pub u_mm: f64,
}

/// Held-out diameters, mm, each part at its own size: that is the tool's, not the profile's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldOut {
    /// How many.
    pub rows: usize,
    /// Root mean square by the base.
    pub rms_before_mm: f64,
    /// By the changed lathe.
    pub rms_after_mm: f64,
    /// Largest by the changed lathe.
    pub max_after_mm: f64,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct TurningCalibration {
    /// Terms of the final adjustment, and angles that are not significant: those are not in [`Self::change`].
    pub terms: Vec<FoundTerm>,
    /// Their covariance, units of the terms; a taper that is not written stands apart from the others.
    pub covariance: DMatrix<f64>,
    /// Terms that were looked for and are not significant.
    pub not_there: Vec<FoundTerm>,
    /// Pairs that these parts cannot tell apart.
    pub not_told_apart: Vec<[&'static str; 2]>,
    /// Sizes of the tools.
    pub offsets: Vec<Offset>,
    /// What the profile is to be given.
    pub change: Change,
    /// Where along Z.
    pub stretch: Stretch,
    /// Standard deviation of a diameter, mm: as stated, or as left over.
    pub noise_mm: f64,
    /// Of a face, mm, where there are any.
    pub face_noise_mm: Option<f64>,
    /// Half width of the 95 % interval of the corrected shape on the radius, the largest of all places, mm.
    pub field_u95_mm: f64,
    /// From a standard uncertainty to 95 %.
    pub coverage_95: f64,
    /// Root mean square of what the base leaves of the diameters at the tools' sizes, and the changed lathe, mm.
    pub rms_mm: [f64; 2],
    /// The final adjustment.
    pub estimate: Estimate,
}

/// Readings with what does not change from fit to fit.
struct Readings<'r> {
    rows: &'r [TurnedReading],
    base: &'r TurningBase,
    stretch: Stretch,
    /// Size or shift that a row has.
    level: Vec<usize>,
    levels: Vec<(Feature, Option<usize>, usize)>,
    /// h from the mean.
    hours: Vec<f64>,
    /// Order of its part among those of its tool, from the mean.
    order: Vec<f64>,
    /// mm, or relative.
    weights: Vec<f64>,
    is_known: bool,
}

impl<'r> Readings<'r> {
    fn new(rows: &'r [TurnedReading], base: &'r TurningBase) -> Self {
        let mut levels: Vec<(Feature, Option<usize>, usize)> = Vec::new();
        let mut level = Vec::new();
        for row in rows {
            let known = levels.iter().position(|(feature, tool, part)| {
                *feature == row.feature
                    && match (feature, row.tool) {
                        (Feature::Diameter, Some(own)) => *tool == Some(own),
                        _ => tool.is_none() && *part == row.part,
                    }
            });
            level.push(known.unwrap_or_else(|| {
                let tool = row.tool.filter(|_| row.feature == Feature::Diameter);
                levels.push((row.feature, tool, row.part));
                levels.len() - 1
            }));
        }
        let order = (0..rows.len()).map(|k| {
            let mut parts: Vec<usize> = Vec::new();
            for (row, _) in rows.iter().zip(&level).filter(|(_, own)| **own == level[k]) {
                if !parts.contains(&row.part) {
                    parts.push(row.part);
                }
            }
            let own = parts.iter().position(|part| *part == rows[k].part).unwrap_or(0);
            own as f64 - 0.5 * (parts.len() - 1) as f64
        });
        let order = order.collect();
        let times: Vec<f64> = rows.iter().filter_map(|row| row.time_s).collect();
        let mean = if times.is_empty() { 0.0 } else { times.iter().sum::<f64>() / times.len() as f64 };
        let hours = rows.iter().map(|row| row.time_s.map_or(0.0, |time| (time - mean) / 3600.0)).collect();
        let is_known = rows.iter().all(|row| row.uncertainty_mm.is_some());
        let weights = rows.iter().map(|row| row.uncertainty_mm.unwrap_or(1.0)).collect();
        Self { rows, base, stretch: Stretch::of(rows), level, levels, hours, order, weights, is_known }
    }

    fn change(terms: &[Term], values: &DVector<f64>) -> Change {
        let mut change = Change::default();
        for (term, value) in terms.iter().zip(values.iter()) {
            match term {
                Term::Axis => change.axis = *value,
                Term::Squareness => change.eb0z_rad = *value,
                Term::Bow => change.bow_mm[0] = *value,
                Term::FourthOrder => change.bow_mm[1] = *value,
                Term::Growth | Term::Wear | Term::Drift | Term::PartToPart => {}
            }
        }
        change
    }

    /// A machine that cannot be made predicts nothing: the adjustment says so.
    fn predicted(&self, change: &Change) -> DVector<f64> {
        let nothing = |_| vec![f64::NAN; self.rows.len()];
        self.base.predicted_mm(change, self.stretch, self.rows).unwrap_or_else(nothing).into()
    }

    /// What a unit of a term that is no geometry does to a row.
    fn drift(&self, term: Term, row: usize) -> f64 {
        match (self.rows[row].feature, term) {
            (Feature::Diameter, Term::Growth | Term::Drift) => 2.0 * self.hours[row],
            (Feature::Diameter, Term::Wear | Term::PartToPart) => 2.0 * self.order[row],
            _ => 0.0,
        }
    }

    fn by_level(&self, row: usize) -> f64 {
        if self.rows[row].feature == Feature::Diameter { 2.0 } else { 1.0 }
    }

    fn forward(&self, terms: &[Term], values: &DVector<f64>) -> DVector<f64> {
        let mut predicted = self.predicted(&Self::change(terms, values));
        for (row, value) in predicted.iter_mut().enumerate() {
            for (k, term) in terms.iter().enumerate() {
                *value += self.drift(*term, row) * values[k];
            }
            *value += self.by_level(row) * values[terms.len() + self.level[row]];
        }
        predicted
    }

    fn jacobian(&self, terms: &[Term], values: &DVector<f64>) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.rows.len(), terms.len() + self.levels.len());
        for (k, term) in terms.iter().enumerate() {
            if term.is_geometry() {
                let step = match term {
                    Term::Axis => STEPS[0],
                    Term::Squareness => STEPS[1],
                    _ => STEPS[2],
                };
                let at = |by: f64| {
                    let mut moved = values.clone();
                    moved[k] += by;
                    self.predicted(&Self::change(terms, &moved))
                };
                matrix.set_column(k, &((at(step) - at(-step)) / (2.0 * step)));
            } else {
                matrix.set_column(k, &DVector::from_fn(self.rows.len(), |row, _| self.drift(*term, row)));
            }
        }
        for row in 0..self.rows.len() {
            matrix[(row, terms.len() + self.level[row])] = self.by_level(row);
        }
        matrix
    }

    fn fit(&self, terms: &[Term]) -> Result<Estimate, CalibrationError> {
        let readings = DVector::from_iterator(self.rows.len(), self.rows.iter().map(|row| row.deviation_mm));
        let unknowns = terms.len() + self.levels.len();
        if self.rows.len() <= unknowns {
            return Err(CalibrationError::TooFew(format!(
                "{} readings for {unknowns} unknowns: nothing is left that could judge them",
                self.rows.len()
            )));
        }
        let problem = Problem {
            readings: &readings,
            noise: if self.is_known { Noise::Known(&self.weights) } else { Noise::Relative(&self.weights) },
            forward: &|values| self.forward(terms, values),
            jacobian: Jacobian::Exact(&|values| self.jacobian(terms, values)),
            gauge: &DMatrix::zeros(0, unknowns),
            settled: SETTLED_MM,
        };
        adjust(&problem, &DVector::zeros(unknowns))
            .map_err(|error| CalibrationError::Contradicted(error.to_string()))
    }

    /// Faces and diameters scatter differently: each by what is left of its own.
    fn weigh(&mut self, terms: &[Term]) -> Result<(), CalibrationError> {
        if self.is_known || self.rows.iter().all(|row| row.feature == Feature::Diameter) {
            return Ok(());
        }
        for _ in 0..WEIGHINGS {
            let estimate = self.fit(terms)?;
            let [diameters, faces] =
                [Feature::Diameter, Feature::Face].map(|feature| self.left(&estimate, feature));
            for (row, weight) in self.rows.iter().zip(&mut self.weights) {
                let own = if row.feature == Feature::Diameter { diameters } else { faces };
                *weight = own.max(LEAST_NOISE_MM);
            }
        }
        Ok(())
    }

    /// Standard deviation of the readings of a feature by what is left, mm.
    fn left(&self, estimate: &Estimate, feature: Feature) -> f64 {
        let own = |k: &usize| self.rows[*k].feature == feature;
        let all = || (0..self.rows.len()).filter(own);
        let squares: f64 = all().map(|k| estimate.residuals[k] * estimate.residuals[k]).sum();
        let free: f64 = all().map(|k| estimate.redundancy_numbers[k]).sum();
        if free > NOTHING { (squares / free).sqrt() } else { 0.0 }
    }

    /// Degrees of freedom that 95 % are counted with: where faces and diameters are weighed by what is left of them, those of
    /// the fewer, which is on the safe side.
    fn freedom(&self, estimate: &Estimate) -> Option<usize> {
        let free = estimate.degrees_of_freedom?;
        let of = |feature: Feature| {
            let own = (0..self.rows.len()).filter(|k| self.rows[*k].feature == feature);
            own.map(|k| estimate.redundancy_numbers[k]).sum::<f64>().round() as usize
        };
        let has_faces = self.rows.iter().any(|row| row.feature == Feature::Face);
        Some(if has_faces { free.min(of(Feature::Diameter)).min(of(Feature::Face)) } else { free })
    }

    /// Leaves out what these parts cannot show, or not apart from what stands before it.
    fn told_apart(
        &self,
        candidates: Vec<Term>,
        pairs: &mut Vec<[&'static str; 2]>,
    ) -> Result<Vec<Term>, CalibrationError> {
        let start = DVector::zeros(candidates.len() + self.levels.len());
        let mut matrix = self.jacobian(&candidates, &start);
        for (row, weight) in self.weights.iter().enumerate() {
            matrix.row_mut(row).scale_mut(1.0 / weight);
        }
        let levels: Vec<DVector<f64>> =
            (candidates.len()..matrix.ncols()).map(|k| matrix.column(k).into_owned()).collect();
        let mut kept: Vec<(Term, DVector<f64>)> = Vec::new();
        let mut basis = orthonormal(&levels, &[]);
        for (k, term) in candidates.into_iter().enumerate() {
            let whole = matrix.column(k).into_owned();
            let seen = without(&whole, &orthonormal(&levels, &[]));
            if seen.norm() <= 1e-6 * whole.norm() {
                if matches!(term, Term::Growth | Term::Wear) && whole.norm() > 0.0 {
                    pairs.push([term.name(), "offset"]);
                }
                continue;
            }
            let own = without(&seen, &basis);
            // A cylinder sees squareness as it sees the taper; the faces, few as they are, tell them apart.
            let alike = if term == Term::Squareness { 1.0 - NOTHING } else { ALIKE };
            if own.norm_squared() <= (1.0 - alike) * seen.norm_squared() {
                let rival = kept.iter_mut().max_by(|(_, a), (_, b)| {
                    let alike = |other: &DVector<f64>| (other.dot(&seen) / other.norm()).abs();
                    alike(a).total_cmp(&alike(b))
                });
                let Some((rival, _)) = rival else { continue };
                match (*rival, term) {
                    (Term::Growth, Term::Wear) => {
                        pairs.push(["growth", "wear"]);
                        *rival = Term::Drift;
                    }
                    (rival, Term::Growth | Term::Wear) => pairs.push([term.name(), rival.name()]),
                    (rival, Term::Squareness) => pairs.push([rival.name(), term.name()]),
                    _ => {}
                }
                continue;
            }
            basis.push(own.normalize());
            kept.push((term, seen));
        }
        if kept.first().is_none_or(|(term, _)| *term != Term::Axis) {
            return Err(CalibrationError::Unobservable("the taper from the sizes of the tools".to_owned()));
        }
        if let (Some((wear, _)), Some(rival)) =
            (kept.iter_mut().find(|(term, _)| *term == Term::Wear), self.rival_of_wear())
        {
            pairs.push(["wear", rival]);
            *wear = Term::PartToPart;
        }
        Ok(kept.into_iter().map(|(term, _)| term).collect())
    }

    /// What else may change the size from part to part: growth where no time is known, an error that goes with the diameter
    /// where the parts' order does.
    fn rival_of_wear(&self) -> Option<&'static str> {
        let diameters: Vec<usize> =
            (0..self.rows.len()).filter(|k| self.rows[*k].feature == Feature::Diameter).collect();
        if diameters.iter().any(|k| self.rows[*k].time_s.is_none()) {
            return Some("growth");
        }
        let centred = |value: &dyn Fn(usize) -> f64| {
            let mean = diameters.iter().map(|k| value(*k)).sum::<f64>() / diameters.len() as f64;
            DVector::from_iterator(diameters.len(), diameters.iter().map(|k| value(*k) - mean))
        };
        let order = centred(&|k| self.order[k]);
        let size = centred(&|k| self.rows[k].tip_mm().x);
        let together = order.dot(&size).powi(2) > ALIKE * order.norm_squared() * size.norm_squared();
        (together && size.norm() > NOTHING).then_some("an error of X that goes with the diameter")
    }

    /// Refuses test pieces whose tapers differ beyond chance.
    fn one_machine(
        &self,
        terms: &[Term],
        estimate: &Estimate,
        names: &[String],
    ) -> Result<(), CalibrationError> {
        let mut parts: Vec<usize> =
            self.rows.iter().filter(|row| row.feature == Feature::Diameter).map(|row| row.part).collect();
        parts.sort_unstable();
        parts.dedup();
        let design = self.jacobian(terms, &estimate.values);
        let middle = 0.5 * (self.stretch.low_mm + self.stretch.high_mm);
        // The last part's own taper is what the others differ from.
        let own = parts[1..].iter().map(|part| {
            DVector::from_fn(self.rows.len(), |k, _| {
                let row = &self.rows[k];
                let is_own = row.part == *part && row.feature == Feature::Diameter;
                if is_own { 2.0 * (row.command.linear_mm.z - middle) } else { 0.0 }
            })
        });
        let columns: Vec<DVector<f64>> =
            design.column_iter().map(|column| column.into_owned()).chain(own).collect();
        let more = parts.len() - 1;
        if self.rows.len() < columns.len() + 2 {
            return Ok(());
        }
        let wide = DMatrix::from_columns(&columns);
        let noise = Noise::Relative(&self.weights);
        let gauge = DMatrix::zeros(0, wide.ncols());
        let apart = crate::adjustment::linear(&wide, &estimate.residuals, noise, &gauge)
            .map_err(|error| CalibrationError::Contradicted(error.to_string()))?;
        let squares = |found: &Estimate| {
            let weighted = found.residuals.iter().zip(&self.weights).map(|(r, w)| (r / w) * (r / w));
            weighted.sum::<f64>()
        };
        let (all, left) = (squares(estimate), squares(&apart));
        let free = apart.redundancy.max(1);
        let variance = if self.is_known { 1.0 } else { left / free as f64 };
        let ratio = (all - left) / more as f64 / variance;
        let freedom = if self.is_known { KNOWN_FREEDOM } else { free as f64 };
        let limit = FisherSnedecor::new(more as f64, freedom)
            .map_or(f64::INFINITY, |f| f.inverse_cdf(1.0 - PARTS_CHANCE));
        let tapers = apart.values.rows(design.ncols(), more);
        let length = self.stretch.high_mm - self.stretch.low_mm;
        let (low, high) = tapers.iter().fold((0.0f64, 0.0f64), |(l, h), t| (l.min(*t), h.max(*t)));
        let apart_mm = 2.0 * (high - low) * length;
        if ratio <= limit || apart_mm <= FINEST_MM {
            return Ok(());
        }
        let odd = tapers.iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let odd = odd.map_or(0, |(k, _)| parts[k + 1]);
        Err(CalibrationError::Contradicted(format!(
            "the test pieces differ in their tapers, by {:.2} um on the diameter over {length:.0} mm (F {ratio:.1}, {limit:.1} by \
             chance at 0.1 %), `{}` and `{}` among them: that is their own bending or clamping, not one machine",
            apart_mm * 1e3,
            names[parts[0]],
            names[odd],
        )))
    }
}

/// Rounds in which faces and diameters are weighed.
const WEIGHINGS: usize = 3;
/// No reading is finer, mm: weights of readings without noise stay finite.
const LEAST_NOISE_MM: f64 = 1e-9;
/// Degrees of freedom of a standard deviation that is stated.
const KNOWN_FREEDOM: f64 = 1e6;

/// An orthonormal basis of what these span beyond the given one.
fn orthonormal(vectors: &[DVector<f64>], given: &[DVector<f64>]) -> Vec<DVector<f64>> {
    let mut basis = given.to_vec();
    for vector in vectors {
        let own = without(vector, &basis);
        if own.norm() > 1e-9 * vector.norm() {
            basis.push(own.normalize());
        }
    }
    basis
}

/// A vector less its part in an orthonormal basis; twice, for rounding.
fn without(vector: &DVector<f64>, basis: &[DVector<f64>]) -> DVector<f64> {
    let once = basis.iter().fold(vector.clone(), |left, own| &left - own * own.dot(&left));
    basis.iter().fold(once, |left, own| &left - own * own.dot(&left))
}

fn tested(terms: &[Term], estimate: &Estimate, k: usize) -> FoundTerm {
    let (value, u) = (estimate.values[k], estimate.standard_uncertainty(k));
    let limit = quantile(LEVEL, estimate.degrees_of_freedom);
    // A shift of millimetres by a radian's millionth is rounding, whatever the readings.
    let is_seen = value.abs() > 1e-11;
    let f = if u > 0.0 { (value / u) * (value / u) } else { f64::INFINITY };
    FoundTerm { term: terms[k], value, u, f, is_significant: is_seen && f > limit * limit }
}

/// Finds what the test pieces show.
///
/// * `part_names` – of the parts, for messages
///
/// # Errors
/// Fewer than two parts, a part with one cross section, fewer readings than unknowns; repeats that disagree, an outlier;
/// parts that are not of one machine; a taper that cannot be told.
pub fn calibrate(
    rows: &[TurnedReading],
    base: &TurningBase,
    part_names: &[String],
) -> Result<TurningCalibration, CalibrationError> {
    check(rows, part_names)?;
    let mut readings = Readings::new(rows, base);
    let mut not_told_apart = Vec::new();
    let mut terms = readings.told_apart(candidates(rows), &mut not_told_apart)?;
    while terms.len() > 1 && rows.len() <= terms.len() + readings.levels.len() + 1 {
        terms.pop();
    }
    readings.weigh(&terms)?;
    let mut estimate = readings.fit(&terms)?;
    check_repeats(rows, usual_mm(&estimate))?;
    if let Some(outlier) = estimate.outlier(OUTLIER_CHANCE).filter(|found| found.residual.abs() > FINEST_MM) {
        return Err(CalibrationError::Outlier {
            point: outlier.reading,
            message: format!(
                "this reading is {:.2} um off what the others say, {:.1} standard deviations (limit {:.1})",
                outlier.residual * 1e3,
                outlier.standardised,
                outlier.limit
            ),
        });
    }
    let mut not_there = Vec::new();
    loop {
        let removable = |k: &usize| {
            let is_highest = terms[*k] != Term::Bow || !terms.contains(&Term::FourthOrder);
            // Left out though it is there, a squareness too small to be named would be counted as taper, and surely.
            !matches!(terms[*k], Term::Axis | Term::Squareness) && is_highest
        };
        let least = (0..terms.len())
            .filter(removable)
            .map(|k| (k, tested(&terms, &estimate, k)))
            .filter(|(_, found)| !found.is_significant)
            .min_by(|a, b| a.1.f.total_cmp(&b.1.f));
        let Some((k, found)) = least else { break };
        terms.remove(k);
        not_there.push(found);
        estimate = readings.fit(&terms)?;
    }
    readings.one_machine(&terms, &estimate, part_names)?;
    let taper = tested(&terms, &estimate, 0);
    let (mut found, mut covariance) = of_terms(&terms, &estimate);
    let coverage_95 = quantile_95(readings.freedom(&estimate));
    let angles = 1 + usize::from(terms.contains(&Term::Squareness));
    let is_written = if angles == 1 { taper.is_significant } else { are_there(&estimate, angles) };
    for angle in &mut found[..angles] {
        angle.is_significant = is_written;
    }
    if !is_written {
        terms.drain(..angles);
        estimate = readings.fit(&terms)?;
        let (others, their) = of_terms(&terms, &estimate);
        let own = covariance.view((0, 0), (angles, angles)).into_owned();
        found.truncate(angles);
        found.extend(others);
        covariance = DMatrix::zeros(found.len(), found.len());
        covariance.view_mut((0, 0), (angles, angles)).copy_from(&own);
        covariance.view_mut((angles, angles), (terms.len(), terms.len())).copy_from(&their);
    }
    let change = Readings::change(&terms, &estimate.values);
    let offsets =
        readings.levels.iter().enumerate().filter(|(_, (feature, ..))| *feature == Feature::Diameter);
    let offsets = offsets.map(|(k, (_, tool, part))| Offset {
        tool: *tool,
        part: *part,
        radius_mm: estimate.values[terms.len() + k],
        u_mm: estimate.standard_uncertainty(terms.len() + k),
    });
    let offsets = offsets.collect();
    let noise = |feature| {
        if readings.is_known {
            let own: Vec<f64> = rows
                .iter()
                .filter(|row| row.feature == feature)
                .filter_map(|row| row.uncertainty_mm)
                .collect();
            (own.iter().map(|u| u * u).sum::<f64>() / own.len().max(1) as f64).sqrt()
        } else {
            readings.left(&estimate, feature)
        }
    };
    let has_faces = rows.iter().any(|row| row.feature == Feature::Face);
    let (noise_mm, face_noise_mm) = (noise(Feature::Diameter), has_faces.then(|| noise(Feature::Face)));
    let rms = |estimate: &Estimate| {
        let own = (0..rows.len()).filter(|k| rows[*k].feature == Feature::Diameter);
        let squares: Vec<f64> = own.map(|k| estimate.residuals[k] * estimate.residuals[k]).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let before = readings.fit(&[])?;
    Ok(TurningCalibration {
        terms: found,
        covariance,
        not_there,
        not_told_apart,
        offsets,
        change,
        stretch: readings.stretch,
        noise_mm,
        face_noise_mm,
        field_u95_mm: coverage_95 * shape_u_mm(&readings, &terms, &estimate),
        coverage_95,
        rms_mm: [rms(&before), rms(&estimate)],
        estimate,
    })
}

/// The first terms together, by an F test at [`LEVEL`]: a taper may be sure where neither of the angles is by itself.
fn are_there(estimate: &Estimate, count: usize) -> bool {
    let values = estimate.values.rows(0, count).into_owned();
    let covariance = estimate.covariance.view((0, 0), (count, count)).into_owned();
    let freedom = estimate.degrees_of_freedom.map_or(KNOWN_FREEDOM, |free| free as f64);
    let limit =
        FisherSnedecor::new(count as f64, freedom).map_or(f64::INFINITY, |f| f.inverse_cdf(1.0 - LEVEL));
    let is_seen = values.amax() > 1e-11;
    let solved = covariance.lu().solve(&values);
    is_seen && solved.is_none_or(|solved| values.dot(&solved) / count as f64 > limit)
}

/// What the columns could show, the surest first.
fn candidates(rows: &[TurnedReading]) -> Vec<Term> {
    let diameters = || rows.iter().filter(|row| row.feature == Feature::Diameter);
    let mut places: Vec<f64> = diameters().map(|row| row.tip_mm().z).collect();
    places.sort_by(f64::total_cmp);
    places.dedup_by(|b, a| *b - *a < 1e-3);
    let mut terms = vec![Term::Axis];
    let ifs = [
        (Term::Squareness, rows.iter().any(|row| row.feature == Feature::Face)),
        (Term::Growth, diameters().all(|row| row.time_s.is_some())),
        (Term::Wear, diameters().all(|row| row.tool.is_some())),
        (Term::Bow, places.len() >= 3),
        (Term::FourthOrder, places.len() >= 5),
    ];
    terms.extend(ifs.into_iter().filter_map(|(term, may)| may.then_some(term)));
    terms
}

fn of_terms(terms: &[Term], estimate: &Estimate) -> (Vec<FoundTerm>, DMatrix<f64>) {
    let found = (0..terms.len()).map(|k| tested(terms, estimate, k)).collect();
    (found, estimate.covariance.view((0, 0), (terms.len(), terms.len())).into_owned())
}

/// Standard deviation that most readings keep, mm: by the median, which a few wrong ones do not move.
fn usual_mm(estimate: &Estimate) -> f64 {
    let mut sizes: Vec<f64> = estimate.residuals.iter().map(|r| r.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let widened = (sizes.len() as f64 / estimate.redundancy.max(1) as f64).sqrt();
    1.4826 * sizes[sizes.len() / 2] * widened
}

/// Largest standard uncertainty of the geometry's part of a diameter against its mean, mm on the radius.
fn shape_u_mm(readings: &Readings<'_>, terms: &[Term], estimate: &Estimate) -> f64 {
    let mut design = readings.jacobian(terms, &estimate.values).columns(0, terms.len()).into_owned();
    for (k, term) in terms.iter().enumerate() {
        if !term.is_geometry() {
            design.column_mut(k).fill(0.0);
        }
    }
    let own: Vec<usize> =
        (0..readings.rows.len()).filter(|k| readings.rows[*k].feature == Feature::Diameter).collect();
    let mean = own.iter().fold(DVector::zeros(terms.len()), |sum, k| sum + design.row(*k).transpose())
        / own.len() as f64;
    let covariance = estimate.covariance.view((0, 0), (terms.len(), terms.len())).into_owned();
    own.iter()
        .map(|k| {
            let row = design.row(*k).transpose() - &mean;
            0.5 * row.dot(&(&covariance * &row)).max(0.0).sqrt()
        })
        .fold(0.0, f64::max)
}

impl TurningCalibration {
    /// Judges the change by diameters that the adjustment did not see. Parts of one row are judged at their tool's size,
    /// or not at all.
    ///
    /// # Errors
    /// [`CalibrationError::TooFew`] where no row can be judged.
    pub fn held_out(&self, rows: &[TurnedReading], base: &TurningBase) -> Result<HeldOut, CalibrationError> {
        let rows: Vec<TurnedReading> =
            rows.iter().filter(|row| row.feature == Feature::Diameter).cloned().collect();
        let left = |change: &Change| -> Result<Vec<f64>, CalibrationError> {
            let predicted = base
                .predicted_mm(change, self.stretch, &rows)
                .map_err(|error| CalibrationError::Axes(error.to_string()))?;
            let raw: Vec<f64> = rows.iter().zip(&predicted).map(|(row, p)| row.deviation_mm - p).collect();
            let mut left = Vec::new();
            for (k, row) in rows.iter().enumerate() {
                let same = |other: &TurnedReading| (other.part, other.tool) == (row.part, row.tool);
                let own: Vec<f64> =
                    rows.iter().zip(&raw).filter(|(other, _)| same(other)).map(|(_, raw)| *raw).collect();
                let of_tool =
                    self.offsets.iter().find(|offset| row.tool.is_some() && offset.tool == row.tool);
                let level = if own.len() > 1 {
                    own.iter().sum::<f64>() / own.len() as f64
                } else if let Some(offset) = of_tool {
                    2.0 * offset.radius_mm
                } else {
                    continue;
                };
                left.push(raw[k] - level);
            }
            Ok(left)
        };
        let (before, after) = (left(&Change::default())?, left(&self.change)?);
        if after.is_empty() {
            return Err(CalibrationError::TooFew(
                "the held-out file has no part with two diameters, nor a tool whose size is known".to_owned(),
            ));
        }
        let rms = |all: &[f64]| (all.iter().map(|v| v * v).sum::<f64>() / all.len() as f64).sqrt();
        Ok(HeldOut {
            rows: after.len(),
            rms_before_mm: rms(&before),
            rms_after_mm: rms(&after),
            max_after_mm: after.iter().map(|v| v.abs()).fold(0.0, f64::max),
        })
    }
}
