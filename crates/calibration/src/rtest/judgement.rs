//! What may be written, which reading does not belong, and whether the rows are of one machine: equations (102) and (104).

use diagnostic::{Text, both};
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::measured::{Measured, Repeats};
use super::ownership::{Normal, Sweep};
use super::terms::{FUNCTIONS, Term};
use crate::adjustment::Estimate;
use crate::error::{CalibrationError, LETTERS};

/// A good measurement has a reading as far from the others as one that is refused with this chance.
const OUTLIER_CHANCE: f64 = 1e-6;

/// A reading so many times the usual scatter off is none of it; the scatter of all is so many times the usual one then. A normal
/// distribution has 1, Student's with three degrees of freedom 1.5.
const FAR: f64 = 8.0;
const TAILS: f64 = 2.5;

/// No nest and no probe reads finer, mm: what is smaller is no contradiction, however small the noise.
const RESOLVED_MM: f64 = 5e-4;

/// What runs leave alone and what they leave together differs by chance in one good measurement of a million.
const RUNS_CHANCE: f64 = 1e-6;

/// Together so many times of what they leave alone is of two machines; less is a doubt.
const TWO_MACHINES: f64 = 5.0;
const DOUBT: f64 = 1.5;

/// Runs that were read with fewer readings to spare say nothing alone.
const FREE_ALONE: usize = 12;

/// Places that repeat one another have to be as many before their scatter is known.
const FREE_REPEATS: usize = 5;

/// Chance below which repeats scatter less than places do.
const PLACES_CHANCE: f64 = 0.05;

/// What the sweep left open.
pub(super) struct Open {
    pub(super) not_told_apart: Vec<Vec<String>>,
    pub(super) unseen: Vec<String>,
    pub(super) counted_as: Vec<(String, Vec<String>)>,
    /// Balls at other places would tell some of it.
    pub(super) other_rows_tell: bool,
}

/// Location error by its name, coefficient by its function.
fn symbol(term: &Term) -> String {
    match term {
        Term::Coefficient { axis, function, .. } => format!("E{}{axis}", FUNCTIONS[*function]),
        other => other.name(),
    }
}

impl Open {
    /// * `name` – the term of a column, `None` for an offset
    /// * `hidden` – terms that no rows could show: their owners have them everywhere
    pub(super) fn new(sweep: &Sweep, name: &dyn Fn(usize) -> Option<Term>, hidden: &[Term]) -> Self {
        let mut sets: Vec<Vec<String>> = Vec::new();
        let (mut unseen, mut counted_as) = (Vec::new(), Vec::new());
        let mut other_rows_tell = false;
        for (column, owners) in &sweep.owned {
            let Some(term) = name(*column) else { continue };
            let owners: Vec<Term> = owners.iter().filter_map(|owner| name(*owner)).collect();
            let is_part = |term: &Term| matches!(term, Term::Coefficient { .. });
            let is_hidden = hidden.contains(&term);
            // Of a function its owners have the part, everywhere.
            if is_hidden && is_part(&term) {
                continue;
            }
            other_rows_tell |= !is_hidden;
            let rivals: Vec<&Term> = owners.iter().filter(|owner| is_part(owner) == is_part(&term)).collect();
            // A reversal is no part of the machine that is written: what it is mistaken for is not in doubt.
            let is_doubt = !rivals.is_empty() && !is_hidden && !matches!(term, Term::Reversal(_));
            if is_doubt {
                let mut set: Vec<String> = rivals.into_iter().chain([&term]).map(symbol).collect();
                set.sort();
                set.dedup();
                sets.push(set);
            } else if owners.is_empty() || matches!(term, Term::Reversal(_)) {
                unseen.push(term);
            } else {
                counted_as.push((term.name(), owners.iter().map(Term::name).collect()));
            }
        }
        let mut unseen: Vec<String> = unseen.iter().map(symbol).collect();
        unseen.sort();
        unseen.dedup();
        Self { not_told_apart: joined(sets), unseen, counted_as, other_rows_tell }
    }

    /// True for what has one value only that the rows allow.
    pub(super) fn writes(&self, term: &Term) -> bool {
        let own = symbol(term);
        !matches!(term, Term::Reversal(_))
            && !self.unseen.contains(&own)
            && !self.not_told_apart.iter().any(|set| set.contains(&own))
    }
}

/// Sets that share a symbol, as one.
fn joined(sets: Vec<Vec<String>>) -> Vec<Vec<String>> {
    let mut all: Vec<Vec<String>> = Vec::new();
    for mut set in sets {
        let (touching, apart): (Vec<_>, Vec<_>) =
            all.into_iter().partition(|other| other.iter().any(|own| set.contains(own)));
        all = apart;
        set.extend(touching.into_iter().flatten());
        set.sort();
        set.dedup();
        all.push(set);
    }
    all.sort();
    all
}

/// Refuses rows of which one reading is far from all others, or of which many are: those hide behind the scatter that they
/// make, and half of the readings do not.
pub(super) fn no_outlier(estimate: &Estimate, measured: &Measured<'_>) -> Result<(), CalibrationError> {
    let refuse = |reading: usize, more: Text| {
        let own = measured.readings[reading];
        Err(CalibrationError::Outlier {
            point: own.row,
            message: both!(
                "this row's {} is {:.1} um off what all other rows say{more}",
                "{} этой строки отходит на {:.1} мкм от того, что говорят все остальные{more:#}",
                LETTERS[own.component],
                estimate.residuals[reading] * 1e3
            ),
        })
    };
    if let Some(one) = estimate.outlier(OUTLIER_CHANCE).filter(|one| one.residual.abs() > RESOLVED_MM) {
        let help = both!(
            ": {:.0} times its standard deviation",
            ": это {:.0} его стандартных отклонений",
            one.standardised.abs()
        );
        return refuse(one.reading, help);
    }
    let sizes: Vec<f64> = estimate
        .residuals
        .iter()
        .zip(&measured.relative)
        .map(|(rest, relative)| (rest / relative).abs())
        .collect();
    let mut ordered = sizes.clone();
    ordered.sort_by(f64::total_cmp);
    let free = estimate.redundancy as f64 / sizes.len() as f64;
    // The median of normal deviations is 0.6745 standard deviations.
    let usual = ordered[ordered.len() / 2] / (0.6745 * free.sqrt());
    let far = sizes.iter().filter(|size| **size > FAR * usual && **size > RESOLVED_MM).count();
    let largest = (0..sizes.len()).max_by(|a, b| sizes[*a].total_cmp(&sizes[*b]));
    match largest.filter(|_| far > 0 && estimate.misfit > TAILS * usual) {
        Some(largest) => refuse(
            largest,
            both!(
                ", and so are {far} readings by more than {FAR} times the usual scatter",
                ", и ещё так же отсчёты ({far}) больше чем на {FAR} обычных разбросов"
            ),
        ),
        None => Ok(()),
    }
}

/// Refuses runs that contradict one another: each explained by a machine of its own leaves far less than all by one machine.
/// What they leave alone, mm, where the difference is a doubt only.
pub(super) fn runs_alone(
    estimate: &Estimate,
    measured: &Measured<'_>,
    design: &DMatrix<f64>,
    kept: &[usize],
) -> Result<Option<f64>, CalibrationError> {
    let runs = measured.offsets() / 3;
    let (mut squares, mut free) = (0.0, 0);
    for run in 0..runs {
        let own: Vec<usize> = (0..measured.readings.len())
            .filter(|i| measured.rows[measured.readings[*i].row].run == run)
            .collect();
        // Offsets of the run, then the terms.
        let columns: Vec<usize> = (3 * run..3 * run + 3)
            .chain(kept.iter().copied().filter(|column| *column >= measured.offsets()))
            .collect();
        let part = DMatrix::from_fn(own.len(), columns.len(), |i, k| {
            design[(own[i], columns[k])] / measured.relative[own[i]]
        });
        // What the joint machine leaves is explained once more: the same squares, and no difference of large numbers.
        let rest = DVector::from_fn(own.len(), |i, _| estimate.residuals[own[i]] / measured.relative[own[i]]);
        let order: Vec<usize> = (0..columns.len()).collect();
        let Some((left, unknowns)) = Normal::new(&part, &rest).sweep(&order).after.last().copied() else {
            continue;
        };
        squares += left;
        free += own.len().saturating_sub(unknowns);
    }
    let more = estimate.redundancy.saturating_sub(free);
    if free < FREE_ALONE || more == 0 || runs < 2 || estimate.misfit < RESOLVED_MM {
        return Ok(None);
    }
    let alone = (squares / free as f64).max(f64::MIN_POSITIVE);
    let together = estimate.misfit * estimate.misfit * estimate.redundancy as f64;
    let ratio = (together - squares) / more as f64 / alone;
    let chance = FisherSnedecor::new(more as f64, free as f64).map_or(1.0, |f| f.sf(ratio.max(0.0)));
    let times = estimate.misfit / alone.sqrt();
    if chance > RUNS_CHANCE || times < DOUBT {
        return Ok(None);
    }
    if times > TWO_MACHINES {
        return Err(CalibrationError::Contradicted(both!(
            "the runs contradict one another: a machine for each leaves {:.2} um, one machine for all {:.2} um. Rows of two machines, a \
             ball that moved, or errors of the linear axes that the profile does not have",
            "серии противоречат друг другу: свой станок для каждой оставляет {:.2} мкм, один для всех {:.2} мкм. Строки двух станков, \
             сдвинувшийся шар или погрешности линейных осей, которых нет в профиле",
            alone.sqrt() * 1e3,
            estimate.misfit * 1e3
        )));
    }
    Ok(Some(alone.sqrt()))
}

/// Scatter of readings that repeat a command within a run, and its degrees of freedom. Where places scatter more than repeats
/// do, every interval of the estimate is counted by the scatter of the places: a repeat is no new place.
pub(super) fn repeats(estimate: &mut Estimate, measured: &Measured<'_>) -> Option<(f64, usize)> {
    let Repeats { squares, free } = measured.repeats;
    if free == 0 {
        return None;
    }
    let pure = squares / free as f64;
    let places = estimate.redundancy.saturating_sub(free);
    if free >= FREE_REPEATS && places > 0 {
        let all = estimate.misfit * estimate.misfit;
        let lack = (all * estimate.redundancy as f64 - squares).max(0.0) / places as f64;
        let chance = FisherSnedecor::new(places as f64, free as f64)
            .map_or(1.0, |f| f.sf(lack / pure.max(f64::MIN_POSITIVE)));
        if chance < PLACES_CHANCE {
            estimate.covariance *= lack / all;
            estimate.sigma = lack.sqrt();
            estimate.degrees_of_freedom = Some(places);
        }
    }
    Some((pure.sqrt(), free))
}

#[cfg(test)]
mod tests {
    use super::joined;

    #[test]
    fn sets_that_share_a_symbol_are_one() {
        let set = |names: &str| -> Vec<String> { names.split(' ').map(str::to_owned).collect() };
        let sets = vec![set("EXC EBC"), set("EX0A EB0A"), set("EZC EYC"), set("EBC EZC")];
        assert_eq!(joined(sets), [set("EB0A EX0A"), set("EBC EXC EYC EZC")]);
    }
}
