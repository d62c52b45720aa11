//! Readings as equations, and their adjustments.

use diagnostic::{Speaks, both};
use nalgebra::{DMatrix, DVector};

use super::equations::{Change, Stretch, TurningBase};
use super::rounding::{Stepped, is_smooth};
use super::rows::{Feature, TurnedReading, finest_mm};
use super::strata::{Between, MeanSquare, Spread, Uncertainty, Whitening};
use super::term::Term;
use crate::CalibrationError;
use crate::adjustment::{Estimate, Jacobian, Noise, Outlier, Problem, adjust};
use crate::turning::bases::{orthonormal, projection, without};
pub(crate) use crate::turning::levels::{Levels, order_of_parts};

/// Test pieces of one machine differ so much in their tapers with this chance.
pub(crate) const PARTS_CHANCE: f64 = 1e-3;
/// Of differences: large against rounding, small against the curvature of the model.
const STEPS: [f64; 3] = [1e-4, 1e-4, 1e-2];
/// A step that changes no reading by more is the last, mm: what it leaves is its square.
const SETTLED_MM: f64 = 1e-9;
/// Rounds in which faces and diameters are weighed.
const WEIGHINGS: usize = 3;
/// No reading is finer, mm: weights of readings without noise stay finite.
const LEAST_NOISE_MM: f64 = 1e-9;
/// What rounding does to a fit lies within so many of its standard deviations, where few readings ask for more.
const MOST_OF_ROUNDING: f64 = 6.0;
/// Shares below this are rounding.
const NOTHING: f64 = 1e-9;

/// Readings with what does not change from fit to fit.
pub(super) struct Readings<'r> {
    pub(super) rows: &'r [TurnedReading],
    base: &'r TurningBase,
    pub(super) stretch: Stretch,
    /// One size per tool, where it is known, else per part; a shift per part's faces.
    pub(super) tools: Levels,
    /// One size per part and tool: what parts share is none of the form.
    pub(crate) cells: Levels,
    /// Parts that have diameters, in the order in which they are named.
    pub(super) parts: Vec<usize>,
    /// h from the mean.
    hours: Vec<f64>,
    /// Order of its part among those of its tool, from the mean.
    order: Vec<f64>,
    /// mm, or relative.
    pub(crate) weights: Vec<f64>,
    pub(super) is_known: bool,
}

/// Errors that readings share because they were read in coarse steps: [`super::rounding`].
struct Rounded {
    /// Of weighted readings.
    covariance: DMatrix<f64>,
    /// What of its variances each part at its own size leaves, by reading.
    within: Vec<f64>,
    /// What of it is in the sum of squares that one size per tool adds.
    between: f64,
}

/// Adjusted with the error that parts share.
pub(super) struct Adjusted {
    /// Of the terms, then of the tools' sizes.
    pub(super) values: DVector<f64>,
    pub(super) spread: Spread,
    /// mm, of the rows.
    pub(super) residuals: DVector<f64>,
    /// Standard deviation of what a part's diameters share, mm on the diameter; `None` where no part tells it.
    pub(super) shared_mm: Option<f64>,
}

impl Adjusted {
    pub(super) fn uncertainty(&self, k: usize) -> Uncertainty {
        self.spread.of_unknown(k)
    }
}

impl<'r> Readings<'r> {
    pub(super) fn new(rows: &'r [TurnedReading], base: &'r TurningBase) -> Self {
        let tools = Levels::by(rows, |row| {
            let tool = row.tool.filter(|_| row.feature == Feature::Diameter);
            (row.feature, tool, tool.is_none().then_some(row.part))
        });
        let cells = Levels::by(rows, |row| {
            (row.feature, row.tool.filter(|_| row.feature == Feature::Diameter), row.part)
        });
        let mut parts: Vec<usize> =
            rows.iter().filter(|row| row.feature == Feature::Diameter).map(|row| row.part).collect();
        parts.sort_unstable();
        parts.dedup();
        let order = order_of_parts(rows, &tools);
        let times: Vec<f64> = rows.iter().filter_map(|row| row.time_s).collect();
        let mean = if times.is_empty() { 0.0 } else { times.iter().sum::<f64>() / times.len() as f64 };
        let hours = rows.iter().map(|row| row.time_s.map_or(0.0, |time| (time - mean) / 3600.0)).collect();
        let is_known = rows.iter().all(|row| row.uncertainty_mm.is_some());
        let weights = rows.iter().map(|row| row.uncertainty_mm.unwrap_or(1.0)).collect();
        let stretch = Stretch::of(rows);
        Self { rows, base, stretch, tools, cells, parts, hours, order, weights, is_known }
    }

    pub(super) fn change(terms: &[Term], values: &DVector<f64>) -> Change {
        let mut change = Change::default();
        for (term, value) in terms.iter().zip(values.iter()) {
            match term {
                Term::Axis => change.axis = *value,
                Term::Squareness => change.eb0z_rad = *value,
                Term::Bow => change.bow_mm[0] = *value,
                Term::FourthOrder => change.bow_mm[1] = *value,
                Term::Growth | Term::Wear | Term::PartToPart => {}
            }
        }
        change
    }

    pub(super) fn is(&self, row: usize, feature: Feature) -> bool {
        self.rows[row].feature == feature
    }

    /// A machine that cannot be made predicts nothing: the adjustment says so.
    fn predicted(&self, change: &Change) -> DVector<f64> {
        let nothing = |_| vec![f64::NAN; self.rows.len()];
        self.base.predicted_mm(change, self.stretch, self.rows).unwrap_or_else(nothing).into()
    }

    /// What a unit of a term that is no geometry does to a row.
    fn drift(&self, term: Term, row: usize) -> f64 {
        match (self.rows[row].feature, term) {
            (Feature::Diameter, Term::Growth) => 2.0 * self.hours[row],
            (Feature::Diameter, Term::Wear | Term::PartToPart) => 2.0 * self.order[row],
            _ => 0.0,
        }
    }

    fn by_level(&self, row: usize) -> f64 {
        if self.is(row, Feature::Diameter) { 2.0 } else { 1.0 }
    }

    fn forward(&self, terms: &[Term], levels: &Levels, values: &DVector<f64>) -> DVector<f64> {
        let mut predicted = self.predicted(&Self::change(terms, values));
        for (row, value) in predicted.iter_mut().enumerate() {
            for (k, term) in terms.iter().enumerate() {
                *value += self.drift(*term, row) * values[k];
            }
            *value += self.by_level(row) * values[terms.len() + levels.of_row[row]];
        }
        predicted
    }

    /// One column per term, then one per level.
    pub(super) fn jacobian(&self, terms: &[Term], levels: &Levels, values: &DVector<f64>) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.rows.len(), terms.len() + levels.count());
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
            matrix[(row, terms.len() + levels.of_row[row])] = self.by_level(row);
        }
        matrix
    }

    pub(super) fn readings(&self) -> DVector<f64> {
        DVector::from_iterator(self.rows.len(), self.rows.iter().map(|row| row.deviation_mm))
    }

    /// Divided by the uncertainties.
    pub(super) fn weighted(&self, mut design: DMatrix<f64>) -> DMatrix<f64> {
        for (row, weight) in self.weights.iter().enumerate() {
            design.row_mut(row).scale_mut(1.0 / weight);
        }
        design
    }

    fn fit(&self, terms: &[Term], levels: &Levels) -> Result<Estimate, CalibrationError> {
        let unknowns = terms.len() + levels.count();
        if self.rows.len() <= unknowns {
            return Err(CalibrationError::TooFew(both!(
                "{} readings for {unknowns} unknowns: nothing is left that could judge them",
                "отсчётов {} на {unknowns} неизвестных: судить о них уже нечем",
                self.rows.len()
            )));
        }
        let problem = Problem {
            readings: &self.readings(),
            noise: if self.is_known { Noise::Known(&self.weights) } else { Noise::Relative(&self.weights) },
            forward: &|values| self.forward(terms, levels, values),
            jacobian: Jacobian::Exact(&|values| self.jacobian(terms, levels, values)),
            gauge: &DMatrix::zeros(0, unknowns),
            settled: SETTLED_MM,
        };
        adjust(&problem, &DVector::zeros(unknowns))
            .map_err(|error| CalibrationError::Contradicted(error.text()))
    }

    /// Each part at its own size: what is left is the noise of a reading.
    pub(super) fn within(&self, terms: &[Term]) -> Result<Estimate, CalibrationError> {
        self.fit(&within_a_part(terms), &self.cells)
    }

    /// True where readings are left that judge the noise.
    pub(super) fn is_judged(&self, terms: &[Term]) -> bool {
        self.rows.len() > within_a_part(terms).len() + self.cells.count() + 1
    }

    /// Nothing changed, each tool at its size: residuals, mm.
    pub(super) fn unchanged(&self) -> Result<DVector<f64>, CalibrationError> {
        Ok(self.fit(&[], &self.tools)?.residuals)
    }

    /// Faces and diameters scatter differently: each by what is left of its own.
    pub(super) fn weigh(&mut self, terms: &[Term]) -> Result<(), CalibrationError> {
        if self.is_known || self.rows.iter().all(|row| row.feature == Feature::Diameter) {
            return Ok(());
        }
        for _ in 0..WEIGHINGS {
            let within = self.within(terms)?;
            let [diameters, faces] =
                [Feature::Diameter, Feature::Face].map(|feature| self.noise_mm(&within, feature));
            for (row, weight) in self.rows.iter().zip(&mut self.weights) {
                let own = if row.feature == Feature::Diameter { diameters } else { faces };
                *weight = own.max(LEAST_NOISE_MM);
            }
        }
        Ok(())
    }

    /// Standard deviation of the readings of a feature by what is left, mm.
    pub(super) fn noise_mm(&self, within: &Estimate, feature: Feature) -> f64 {
        self.left(within, feature, |_| 1.0).value.sqrt()
    }

    /// Mean square of the noise of a feature, in squares of the weights: what is left, less the part that is of rounding which
    /// readings share.
    fn mean_square(&self, within: &Estimate, feature: Feature, rounded: Option<&Rounded>) -> MeanSquare {
        if self.is_known {
            return MeanSquare { value: 1.0, freedom: f64::INFINITY };
        }
        let left = self.left(within, feature, |k| self.weights[k]);
        let shared = rounded.map_or(0.0, |rounded| {
            (0..self.rows.len()).filter(|k| self.is(*k, feature)).map(|k| rounded.within[k]).sum::<f64>()
        });
        MeanSquare { value: (left.value - shared / left.freedom).max(0.0), ..left }
    }

    /// The same in squares of any unit.
    fn left(&self, within: &Estimate, feature: Feature, unit: impl Fn(usize) -> f64) -> MeanSquare {
        let own = || (0..self.rows.len()).filter(|k| self.is(*k, feature));
        let squares: f64 = own().map(|k| (within.residuals[k] / unit(k)).powi(2)).sum();
        let freedom: f64 = own().map(|k| within.redundancy_numbers[k]).sum();
        MeanSquare {
            value: if freedom > NOTHING { squares / freedom } else { 0.0 },
            freedom: freedom.max(1.0),
        }
    }

    /// Weighted sum of squares.
    pub(crate) fn squares(&self, found: &Estimate) -> f64 {
        found.residuals.iter().zip(&self.weights).map(|(r, w)| (r / w) * (r / w)).sum()
    }

    /// Columns of Z: the diameters of a part, weighted.
    fn shared(&self) -> Vec<DVector<f64>> {
        let of_part = |part: &usize| {
            DVector::from_fn(self.rows.len(), |k, _| {
                let is_own = self.rows[k].part == *part && self.is(k, Feature::Diameter);
                if is_own { 1.0 / self.weights[k] } else { 0.0 }
            })
        };
        self.parts.iter().map(of_part).collect()
    }

    /// What the sizes of the parts leave where each tool has one, and `basis` is that of the fit.
    fn between(
        &self,
        within: &Estimate,
        of_tools: &Estimate,
        basis: &[DVector<f64>],
        shared: &[DVector<f64>],
        rounded: Option<&Rounded>,
    ) -> Between {
        let squares = (self.squares(of_tools) - self.squares(within)).max(0.0);
        Between {
            squares: squares - rounded.map_or(0.0, |rounded| rounded.between),
            freedom: of_tools.redundancy.saturating_sub(within.redundancy) as f64,
            share: shared.iter().map(|column| without(column, basis).norm_squared()).sum(),
        }
    }

    /// An orthonormal basis of what a fit explains, weighted.
    fn basis(&self, terms: &[Term], levels: &Levels, values: &DVector<f64>) -> Vec<DVector<f64>> {
        let design = self.weighted(self.jacobian(terms, levels, values));
        let columns: Vec<DVector<f64>> = design.column_iter().map(|column| column.into_owned()).collect();
        orthonormal(&columns, &[])
    }

    /// The errors that readings share because they were read in coarse steps; `None` where nothing is known of them: the
    /// uncertainties are stated, or the noise is larger.
    fn rounded(
        &self,
        within: &Estimate,
        of_tools: &Estimate,
        [cells, tools]: [&[DVector<f64>]; 2],
    ) -> Option<Rounded> {
        if self.is_known {
            return None;
        }
        let step_mm = finest_mm(self.rows);
        let rows = self.rows.len();
        let predicted = self.readings() - &of_tools.residuals;
        let mut covariance = DMatrix::zeros(rows, rows);
        for feature in [Feature::Diameter, Feature::Face] {
            let own: Vec<usize> = (0..rows).filter(|k| self.is(*k, feature)).collect();
            let left = self.left(within, feature, |_| step_mm);
            if own.is_empty() || is_smooth(left.value) {
                continue;
            }
            let [fitted, parts] = [tools, cells].map(|basis| projection(basis, &own));
            let stepped = Stepped {
                predicted: DVector::from_iterator(own.len(), own.iter().map(|k| predicted[*k] / step_mm)),
                level: own.iter().map(|k| self.tools.of_row[*k]).collect(),
                fitted: &fitted,
                within: &parts,
                squares: left.value * left.freedom,
                freedom: left.freedom,
            };
            let Some(shared) = stepped.shared() else { continue };
            for (a, k) in own.iter().enumerate() {
                for (b, l) in own.iter().enumerate() {
                    covariance[(*k, *l)] =
                        shared[(a, b)] * step_mm * step_mm / (self.weights[*k] * self.weights[*l]);
                }
            }
        }
        if covariance.amax() == 0.0 {
            return None;
        }
        let all: Vec<usize> = (0..rows).collect();
        let [by_cells, by_tools] = [cells, tools].map(|basis| projection(basis, &all));
        let rest = DMatrix::identity(rows, rows) - &by_cells;
        let left = &rest * &covariance * &rest;
        Some(Rounded {
            within: left.diagonal().iter().copied().collect(),
            between: (by_cells - by_tools).dot(&covariance),
            covariance,
        })
    }

    /// Generalised least squares (30) with the covariance of [`super::strata`].
    pub(super) fn adjusted(&self, terms: &[Term]) -> Result<Adjusted, CalibrationError> {
        let within = self.within(terms)?;
        let shared = self.shared();
        let of_tools = self.fit(terms, &self.tools)?;
        let tools = self.basis(terms, &self.tools, &of_tools.values);
        let cells = self.basis(&within_a_part(terms), &self.cells, &within.values);
        let rounded = self.rounded(&within, &of_tools, [&cells, &tools]);
        let between = self.between(&within, &of_tools, &tools, &shared, rounded.as_ref());
        let noise = [Feature::Diameter, Feature::Face]
            .map(|feature| self.mean_square(&within, feature, rounded.as_ref()));
        let variance = between.variance(noise[0].value, &shared);
        // Weights need not be the variances: below nought they are those of parts that share nothing, and rounding is noise.
        let scatter = self.mean_square(&within, Feature::Diameter, None).value;
        let theta = variance.max(0.0) / scatter.max(LEAST_NOISE_MM * LEAST_NOISE_MM);
        let whitening = Whitening::new(&shared, theta);
        let white =
            |raw: DVector<f64>| whitening.apply(DVector::from_fn(raw.len(), |k, _| raw[k] / self.weights[k]));
        let unknowns = terms.len() + self.tools.count();
        let settled = SETTLED_MM / self.weights.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let problem = Problem {
            readings: &white(self.readings()),
            noise: Noise::Known(&vec![1.0; self.rows.len()]),
            forward: &|values| white(self.forward(terms, &self.tools, values)),
            jacobian: Jacobian::Exact(&|values| {
                whitening.apply_to(&self.weighted(self.jacobian(terms, &self.tools, values)))
            }),
            gauge: &DMatrix::zeros(0, unknowns),
            settled,
        };
        let found = adjust(&problem, &DVector::zeros(unknowns))
            .map_err(|error| CalibrationError::Contradicted(error.text()))?;
        let design = whitening.apply_to(&self.weighted(self.jacobian(terms, &self.tools, &found.values)));
        let gains = whitening.apply_to(&(design * &found.covariance)).transpose();
        let is_face: Vec<bool> = (0..self.rows.len()).map(|k| self.is(k, Feature::Face)).collect();
        let mut spread = Spread::new(&gains, &is_face, &shared, noise, &between, variance);
        if let Some(rounded) = &rounded {
            spread = spread.with(&gains, &rounded.covariance);
        }
        let residuals = self.readings() - self.forward(terms, &self.tools, &found.values);
        let shared_mm = between.is_seen().then(|| variance.max(0.0).sqrt());
        Ok(Adjusted { values: found.values, spread, residuals, shared_mm })
    }

    /// A reading that does not belong to its part's others. Rounding scatters by a step over √12 whatever the luck of the
    /// others.
    pub(super) fn outlier(&self, within: &Estimate, chance: f64) -> Option<Outlier> {
        let finest_mm = finest_mm(self.rows);
        let rounding_mm = finest_mm / 12f64.sqrt();
        within.outlier(chance).filter(|found| {
            let own = within.redundancy_numbers[found.reading].sqrt();
            found.residual.abs() > finest_mm
                && found.residual.abs() > found.limit.min(MOST_OF_ROUNDING) * rounding_mm * own
        })
    }

    /// Standard deviation that most readings keep, mm: by the median, which a few wrong ones do not move.
    pub(super) fn usual_mm(&self, within: &Estimate) -> f64 {
        let mut sizes: Vec<f64> = within.residuals.iter().map(|r| r.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let widened = (sizes.len() as f64 / within.redundancy.max(1) as f64).sqrt();
        1.4826 * sizes[sizes.len() / 2] * widened
    }

    /// True where the parts' order (or time) goes with their diameter: an error of X that does may be what changes their size.
    pub(super) fn goes_with_the_diameter(&self, term: Term, alike: f64) -> bool {
        let diameters: Vec<usize> = (0..self.rows.len()).filter(|k| self.is(*k, Feature::Diameter)).collect();
        let centred = |value: &dyn Fn(usize) -> f64| {
            let mean = diameters.iter().map(|k| value(*k)).sum::<f64>() / diameters.len() as f64;
            DVector::from_iterator(diameters.len(), diameters.iter().map(|k| value(*k) - mean))
        };
        let own = centred(&|k| self.drift(term, k));
        let size = centred(&|k| self.rows[k].tip_mm().x);
        size.norm() > NOTHING && own.dot(&size).powi(2) > alike * own.norm_squared() * size.norm_squared()
    }
}

/// Those that differ within a part; the others are part of its size.
fn within_a_part(terms: &[Term]) -> Vec<Term> {
    terms.iter().copied().filter(|term| !matches!(term, Term::Wear | Term::PartToPart)).collect()
}
