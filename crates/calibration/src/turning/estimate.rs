//! What the test pieces say of the lathe, and what they cannot.

use diagnostic::{Speaks, Text, both};
use nalgebra::{DMatrix, DVector};

use super::bases::{fisher_limit, orthonormal, without};
use super::equations::{Change, Stretch, TurningBase};
use super::readings::{Adjusted, Readings};
use super::rows::{Feature, TurnedReading, check, check_repeats};
use super::strata::Uncertainty;
use super::term::Term;
use crate::CalibrationError;
use crate::adjustment::Estimate;
use crate::student::{quantile, quantile_between};

/// Level of the F tests: of a hundred terms that are not there one is found.
pub const LEVEL: f64 = 0.01;
/// Good readings have one that lies so far off with this chance.
const OUTLIER_CHANCE: f64 = 1e-4;
/// Terms of which more than this share of one is the others cannot be told apart: a correlation of 0.95.
const ALIKE: f64 = 0.9;
/// Shares below this are rounding.
const NOTHING: f64 = 1e-9;

/// A term and how well it is known, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundTerm {
    /// Which.
    pub term: Term,
    /// Its change against the base.
    pub value: f64,
    /// How well.
    pub u: Uncertainty,
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
    /// How well, mm; `None` where no two parts tell how parts differ.
    pub u: Option<Uncertainty>,
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
    /// Terms that can be told, those that are not significant too: such angles are not in [`Self::change`].
    pub terms: Vec<FoundTerm>,
    /// Their covariance, units of the terms; a taper that is not written stands apart from the others.
    pub covariance: DMatrix<f64>,
    /// Shapes of the barrel that were looked for and are not significant.
    pub not_there: Vec<FoundTerm>,
    /// Pairs that these parts cannot tell apart.
    pub not_told_apart: Vec<[Text; 2]>,
    /// Sizes of the tools.
    pub offsets: Vec<Offset>,
    /// What the profile is to be given.
    pub change: Change,
    /// Where along Z.
    pub stretch: Stretch,
    /// Standard deviation of a diameter, mm: as stated, or as left over.
    pub noise_mm: f64,
    /// Standard deviation of what the diameters of a part share beyond that, mm; `None` where too few parts tell it.
    pub shared_mm: Option<f64>,
    /// A single reading wrong by less, mm, may have passed, for want of others that judge it.
    pub unseen_blunder_mm: f64,
    /// Half width of the 95 % interval of the corrected shape on the radius, the largest of all places, mm.
    pub field_u95_mm: f64,
    /// Root mean square of what the base leaves of the diameters at the tools' sizes, and the changed lathe, mm.
    pub rms_mm: [f64; 2],
}

/// Terms to be fitted, and what may be told of them.
struct ToldApart {
    terms: Vec<Term>,
    /// Fitted, since each takes part of what the others show, but not told.
    unnamed: Vec<Term>,
    pairs: Vec<[Text; 2]>,
}

impl ToldApart {
    /// Leaves out what these parts cannot show, or not apart from the geometry that stands before it.
    fn of(readings: &Readings<'_>) -> Result<Self, CalibrationError> {
        let candidates = candidates(readings.rows);
        let start = DVector::zeros(candidates.len() + readings.tools.count());
        let matrix = readings.weighted(readings.jacobian(&candidates, &readings.tools, &start));
        let levels: Vec<DVector<f64>> =
            (candidates.len()..matrix.ncols()).map(|k| matrix.column(k).into_owned()).collect();
        let sizes = orthonormal(&levels, &[]);
        let mut told = Self { terms: Vec::new(), unnamed: Vec::new(), pairs: Vec::new() };
        let mut kept: Vec<(Term, DVector<f64>)> = Vec::new();
        for (k, term) in candidates.into_iter().enumerate() {
            let whole = matrix.column(k).into_owned();
            let seen = without(&whole, &sizes);
            if seen.norm() <= 1e-6 * whole.norm() {
                if term.is_drift() && whole.norm() > 0.0 {
                    told.pairs.push([term.words(), Text::pair("offset", "коррекция инструмента")]);
                }
                continue;
            }
            // A cylinder sees squareness as it sees the taper; the faces, few as they are, tell them apart.
            let alike = if term == Term::Squareness { 1.0 - NOTHING } else { ALIKE };
            let is_alike = |others: &dyn Fn(Term) -> bool, alike: f64| {
                let columns: Vec<DVector<f64>> =
                    kept.iter().filter(|(own, _)| others(*own)).map(|(_, column)| column.clone()).collect();
                let own = without(&seen, &orthonormal(&columns, &sizes));
                own.norm_squared() <= (1.0 - alike) * seen.norm_squared()
            };
            if is_alike(&|_| true, alike) {
                // Growth and wear stay both, if they differ at all: what one of them alone would show tilts the taper.
                let is_drift_alone = term.is_drift()
                    && !is_alike(&|other| !other.is_drift(), alike)
                    && !is_alike(&|_| true, 1.0 - NOTHING);
                let rival = kept.iter().max_by(|(_, a), (_, b)| {
                    let alike = |other: &DVector<f64>| (other.dot(&seen) / other.norm()).abs();
                    alike(a).total_cmp(&alike(b))
                });
                let Some((rival, _)) = rival else { continue };
                match (*rival, term) {
                    (Term::Growth, Term::Wear) => {
                        told.pairs.push([Term::Growth.words(), Term::Wear.words()]);
                        told.unnamed.extend([Term::Growth, Term::Wear]);
                    }
                    (rival, Term::Growth | Term::Wear) => told.pairs.push([term.words(), rival.words()]),
                    (rival, Term::Squareness) => told.pairs.push([rival.words(), term.words()]),
                    _ => {}
                }
                if !is_drift_alone {
                    continue;
                }
            }
            kept.push((term, seen));
        }
        told.terms = kept.into_iter().map(|(term, _)| term).collect();
        if told.terms.first() != Some(&Term::Axis) {
            return Err(CalibrationError::Unobservable(Text::pair(
                "the taper from the sizes of the tools",
                "конусность и размеры инструментов",
            )));
        }
        told.rivals(readings);
        Ok(told)
    }

    /// What else may change the size from part to part: growth where no time is known, an error that goes with the
    /// diameter where time or the parts' order does.
    fn rivals(&mut self, readings: &Readings<'_>) {
        let is_timed =
            readings.rows.iter().all(|row| row.feature != Feature::Diameter || row.time_s.is_some());
        for term in [Term::Growth, Term::Wear] {
            if !self.terms.contains(&term) || self.unnamed.contains(&term) {
                continue;
            }
            let rival = if term == Term::Wear && !is_timed {
                Term::Growth.words()
            } else if readings.goes_with_the_diameter(term, ALIKE) {
                Text::pair(
                    "an error of X that goes with the diameter",
                    "погрешность X, которая идёт с диаметром",
                )
            } else {
                continue;
            };
            self.pairs.push([term.words(), rival]);
            match term {
                Term::Wear => {
                    for own in self.terms.iter_mut().filter(|own| **own == Term::Wear) {
                        *own = Term::PartToPart;
                    }
                }
                _ => self.unnamed.push(term),
            }
        }
    }

    /// Where no part is left that tells by how much parts differ beside their sizes and changes.
    fn without_scatter_of_parts(&mut self) {
        // A change from part to part is then how parts differ: the sizes' intervals hold it.
        self.terms.retain(|term| *term != Term::PartToPart);
        for term in [Term::Growth, Term::Wear] {
            if self.terms.contains(&term) && !self.unnamed.contains(&term) {
                self.unnamed.push(term);
                self.pairs.push([
                    term.words(),
                    Text::pair("what else differs from part to part", "прочие различия образцов"),
                ]);
            }
        }
    }
}

/// Finds what the test pieces show.
///
/// * `part_names` – of the parts, for messages
///
/// # Errors
/// Fewer than two parts, a part with one cross section, fewer readings than unknowns; repeats that disagree, an
/// outlier; parts that are not of one machine; a taper that cannot be told.
pub fn calibrate(
    rows: &[TurnedReading],
    base: &TurningBase,
    part_names: &[String],
) -> Result<TurningCalibration, CalibrationError> {
    let mut readings = Readings::new(rows, base);
    check(rows, &readings.parts, part_names)?;
    let mut told = ToldApart::of(&readings)?;
    while told.terms.len() > 1 && !readings.is_judged(&told.terms) {
        told.terms.pop();
    }
    readings.weigh(&told.terms)?;
    let within = readings.within(&told.terms)?;
    check_repeats(rows, readings.usual_mm(&within))?;
    if let Some(outlier) = readings.outlier(&within, OUTLIER_CHANCE) {
        return Err(CalibrationError::Outlier {
            point: outlier.reading,
            message: both!(
                "this reading is {:.2} um off what the others say, {:.1} standard deviations (limit {:.1})",
                "этот отсчёт отходит от остальных на {:.2} мкм, это {:.1} стандартных отклонений (предел {:.1})",
                outlier.residual * 1e3,
                outlier.standardised,
                outlier.limit
            ),
        });
    }
    let mut adjusted = readings.adjusted(&told.terms)?;
    if adjusted.shared_mm.is_none() {
        told.without_scatter_of_parts();
        adjusted = readings.adjusted(&told.terms)?;
    }
    let mut not_there = Vec::new();
    loop {
        let removable = |k: &usize| match told.terms[*k] {
            Term::Bow => !told.terms.contains(&Term::FourthOrder),
            // Left out though they are there, a squareness or a drift too small to be named would be counted as taper,
            // or as the other drift, and surely.
            term => term == Term::FourthOrder,
        };
        let least = (0..told.terms.len()).filter(removable).map(|k| (k, tested(&told.terms, &adjusted, k)));
        let Some((k, found)) = least.into_iter().find(|(_, found)| !found.is_significant) else { break };
        told.terms.remove(k);
        not_there.push(found);
        adjusted = readings.adjusted(&told.terms)?;
    }
    readings.one_machine(&told.terms, &adjusted, part_names)?;
    let within = readings.within(&told.terms)?;
    let angles = 1 + usize::from(told.terms.contains(&Term::Squareness));
    let is_written = are_there(&adjusted, angles);
    let (mut terms, mut covariance) = told_of(&told, &adjusted);
    for angle in &mut terms[..angles] {
        angle.is_significant = is_written;
    }
    if !is_written {
        told.terms.drain(..angles);
        adjusted = readings.adjusted(&told.terms)?;
        let (others, their) = told_of(&told, &adjusted);
        let own = covariance.view((0, 0), (angles, angles)).into_owned();
        terms.truncate(angles);
        terms.extend(others);
        covariance = DMatrix::zeros(terms.len(), terms.len());
        covariance.view_mut((0, 0), (angles, angles)).copy_from(&own);
        covariance.view_mut((angles, angles), their.shape()).copy_from(&their);
    }
    let offsets =
        readings.tools.first.iter().enumerate().filter(|(_, row)| readings.is(**row, Feature::Diameter));
    let offsets = offsets.map(|(k, row)| Offset {
        tool: rows[*row].tool,
        part: rows[*row].part,
        radius_mm: adjusted.values[told.terms.len() + k],
        u: adjusted.shared_mm.map(|_| adjusted.uncertainty(told.terms.len() + k)),
    });
    let offsets = offsets.collect();
    let noise_mm = if readings.is_known {
        let diameters = rows.iter().filter(|row| row.feature == Feature::Diameter);
        let own: Vec<f64> = diameters.filter_map(|row| row.uncertainty_mm).collect();
        (own.iter().map(|u| u * u).sum::<f64>() / own.len().max(1) as f64).sqrt()
    } else {
        readings.noise_mm(&within, Feature::Diameter)
    };
    let rms = |residuals: &DVector<f64>| {
        let own = (0..rows.len()).filter(|k| readings.is(*k, Feature::Diameter));
        let squares: Vec<f64> = own.map(|k| residuals[k] * residuals[k]).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    Ok(TurningCalibration {
        terms,
        covariance,
        not_there,
        not_told_apart: told.pairs,
        offsets,
        change: Readings::change(&told.terms, &adjusted.values),
        stretch: readings.stretch,
        noise_mm,
        shared_mm: adjusted.shared_mm,
        unseen_blunder_mm: unseen_blunder_mm(&readings, &within, noise_mm),
        field_u95_mm: shape_u95_mm(&readings, &told.terms, &adjusted),
        rms_mm: [rms(&readings.unchanged()?), rms(&adjusted.residuals)],
    })
}

/// The first terms together, by an F test at [`LEVEL`]: a taper may be sure where neither of the angles is by itself.
fn are_there(adjusted: &Adjusted, count: usize) -> bool {
    let values = adjusted.values.rows(0, count).into_owned();
    let covariance = adjusted.spread.covariance().view((0, 0), (count, count)).into_owned();
    let freedom = (0..count).map(|k| adjusted.uncertainty(k).freedom).fold(f64::INFINITY, f64::min);
    let is_seen = values.amax() > SEEN;
    let solved = covariance.lu().solve(&values);
    let limit = fisher_limit(count as f64, freedom, LEVEL);
    is_seen && solved.is_none_or(|solved| values.dot(&solved) / count as f64 > limit)
}

/// A shift of millimetres by a radian's millionth is rounding, whatever the readings.
const SEEN: f64 = 1e-11;

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

fn tested(terms: &[Term], adjusted: &Adjusted, k: usize) -> FoundTerm {
    let (value, u) = (adjusted.values[k], adjusted.uncertainty(k));
    let limit = quantile_between(LEVEL, u.freedom);
    let f = if u.standard > 0.0 { (value / u.standard) * (value / u.standard) } else { f64::INFINITY };
    FoundTerm { term: terms[k], value, u, f, is_significant: value.abs() > SEEN && f > limit * limit }
}

/// The terms that may be told, and their covariance.
fn told_of(told: &ToldApart, adjusted: &Adjusted) -> (Vec<FoundTerm>, DMatrix<f64>) {
    let own: Vec<usize> = (0..told.terms.len()).filter(|k| !told.unnamed.contains(&told.terms[*k])).collect();
    let found = own.iter().map(|k| tested(&told.terms, adjusted, *k)).collect();
    (found, adjusted.spread.covariance().select_rows(&own).select_columns(&own))
}

/// Size below which a wrong diameter may pass as noise, mm: what its residual takes from it, over what noise may do.
fn unseen_blunder_mm(readings: &Readings<'_>, within: &Estimate, noise_mm: f64) -> f64 {
    let others = within.degrees_of_freedom.map(|free| free.saturating_sub(1));
    let limit = quantile(OUTLIER_CHANCE / readings.rows.len() as f64, others);
    let own = (0..readings.rows.len()).filter(|k| readings.is(*k, Feature::Diameter));
    let least = own.map(|k| within.redundancy_numbers[k]).fold(1.0, f64::min);
    if noise_mm > 0.0 { limit * noise_mm / least.sqrt() } else { 0.0 }
}

/// Half width of the 95 % interval of the geometry's part of a diameter against its mean, the largest, mm on the
/// radius.
fn shape_u95_mm(readings: &Readings<'_>, terms: &[Term], adjusted: &Adjusted) -> f64 {
    let mut design = readings.jacobian(terms, &readings.tools, &adjusted.values);
    for k in (0..design.ncols()).filter(|k| terms.get(*k).is_none_or(|term| term.is_drift())) {
        design.column_mut(k).fill(0.0);
    }
    let own: Vec<usize> = (0..readings.rows.len()).filter(|k| readings.is(*k, Feature::Diameter)).collect();
    let zero = DVector::zeros(design.ncols());
    let mean = own.iter().fold(zero, |sum, k| sum + design.row(*k).transpose()) / own.len() as f64;
    own.iter()
        .map(|k| 0.5 * adjusted.spread.of(&(design.row(*k).transpose() - &mean)).half_width_95())
        .fold(0.0, f64::max)
}

impl TurningCalibration {
    /// Judges the change by diameters that the adjustment did not see. Parts of one row are judged at their tool's
    /// size, or not at all.
    ///
    /// # Errors
    /// [`CalibrationError::TooFew`] where no row can be judged.
    pub fn held_out(&self, rows: &[TurnedReading], base: &TurningBase) -> Result<HeldOut, CalibrationError> {
        let rows: Vec<TurnedReading> =
            rows.iter().filter(|row| row.feature == Feature::Diameter).cloned().collect();
        let left = |change: &Change| -> Result<Vec<f64>, CalibrationError> {
            let predicted = base
                .predicted_mm(change, self.stretch, &rows)
                .map_err(|error| CalibrationError::Axes(error.text()))?;
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
            return Err(CalibrationError::TooFew(Text::pair(
                "the held-out file has no part with two diameters, nor a tool whose size is known",
                "в контрольном файле нет ни образца с двумя диаметрами, ни инструмента с известным размером",
            )));
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
