//! What else a cause may be.

use nalgebra::DVector;

use super::asked::Asked;
use super::columns::{Bar, Cause};
use super::mixed::Fitted;
use super::words::SEVERAL;

/// A taper is sure where it is so many times the curve beside it.
const MOSTLY: f64 = 3.0;
/// Wear or growth of less than this share of the other is not sure beside it.
const LITTLE_DRIFT: f64 = 0.5;

impl Asked<'_> {
    /// What else may be a cause: what in its place leaves nothing for it.
    pub(super) fn rivals(&self, cause: usize, selected: &[usize]) -> Vec<String> {
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
            rivals.push(SEVERAL.to_owned());
        }
        rivals
    }

    /// What may be a cause, and no column shows: what nobody wrote into the file.
    pub(super) fn unseen_rivals(
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
}
