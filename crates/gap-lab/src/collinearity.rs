//! Which names a design cannot tell apart: the lab's own answer, from its own columns.

use crate::design::Layout;
use crate::effect::Effect;
use crate::linear::{Basis, dot};
use crate::machine::Machine;
use crate::row::{Row, Sight};
use crate::textbook::{variants, visible};

/// Two names count as one on a design where the true effect correlates this much with the other's columns.
pub(crate) const SAME: f64 = 0.98;

/// The numbers a layout measures, with set-up and run offsets taken out.
pub(crate) struct View<'a> {
    machine: &'a Machine,
    layout: &'a Layout,
    /// Class (run and component) of each number, where offsets are per component.
    classes: Option<Vec<usize>>,
    nuisance: Basis,
}

impl<'a> View<'a> {
    /// Prepares the projection: six set-up parameters and three offsets per run.
    pub(crate) fn new(machine: &'a Machine, layout: &'a Layout) -> Self {
        let mut view = Self { machine, layout, classes: None, nuisance: Basis::default() };
        let runs = layout.rows.iter().map(|r| r.run).max().unwrap_or(0) + 1;
        if layout.rows.iter().all(|r| matches!(r.sight, Sight::Components(_))) {
            let mut classes = Vec::new();
            for row in &layout.rows {
                if let Sight::Components(mask) = row.sight {
                    classes.extend((0..3).filter(|i| mask[*i]).map(|i| 3 * row.run + i));
                }
            }
            view.classes = Some(classes);
        } else {
            for run in 0..runs {
                for i in 0..3 {
                    let unit = |r: &Row| {
                        let mut v = [0.0; 3];
                        v[i] = if r.run == run { 1.0 } else { 0.0 };
                        v
                    };
                    let column = view.raw(unit);
                    view.nuisance.add(column);
                }
            }
        }
        for about in 0..3 {
            let turned = |r: &Row| {
                let p = machine.nominal(r);
                let (u, v) = ((about + 1) % 3, (about + 2) % 3);
                let mut d = [0.0; 3];
                d[u] = -p[v];
                d[v] = p[u];
                d
            };
            let mut column = view.raw(turned);
            view.centre(&mut column);
            view.nuisance.add(column);
        }
        view
    }

    /// The measured numbers of a displacement field, as they are.
    pub(crate) fn raw(&self, field: impl Fn(&Row) -> [f64; 3]) -> Vec<f64> {
        self.layout.rows.iter().flat_map(|r| r.seen(field(r))).collect()
    }

    /// The measured numbers of a displacement field without what set-up and run offsets can express.
    pub(crate) fn clean(&self, field: impl Fn(&Row) -> [f64; 3]) -> Vec<f64> {
        self.cleaned(self.raw(field))
    }

    /// The same for a field given row by row.
    pub(crate) fn clean_rows(&self, field: &[[f64; 3]]) -> Vec<f64> {
        let rows = self.layout.rows.iter().zip(field);
        self.cleaned(rows.flat_map(|(row, d)| row.seen(*d)).collect())
    }

    fn cleaned(&self, mut v: Vec<f64>) -> Vec<f64> {
        self.centre(&mut v);
        self.nuisance.remove(&mut v);
        v
    }

    fn centre(&self, v: &mut [f64]) {
        let Some(classes) = &self.classes else { return };
        let count = classes.iter().max().map_or(0, |c| c + 1);
        let (mut sums, mut counts) = (vec![0.0; count], vec![0.0f64; count]);
        for (value, class) in v.iter().zip(classes) {
            sums[*class] += value;
            counts[*class] += 1.0;
        }
        for (value, class) in v.iter_mut().zip(classes) {
            *value -= sums[*class] / counts[*class];
        }
    }

    /// Orthonormal bases of every variant of every effect the file can show, after cleaning.
    pub(crate) fn library(&self) -> Vec<(Effect, Basis, Vec<Vec<f64>>)> {
        let mut effects = Effect::linear();
        if self.machine.centre.is_some() {
            effects.extend(Effect::rotary());
        }
        let mut library = Vec::new();
        for effect in effects {
            if !visible(effect, self.layout) {
                continue;
            }
            for variant in variants(effect, self.machine, self.layout) {
                let mut basis = Basis::default();
                let mut columns = Vec::new();
                for column in &variant {
                    let (raw, clean) = (self.raw(column), self.clean(column));
                    // What set-up swallows is no column; rounding must not make it one.
                    if dot(&clean, &clean) > 1e-8 * dot(&raw, &raw) {
                        basis.add(clean.clone());
                        columns.push(clean);
                    }
                }
                library.push((effect, basis, columns));
            }
        }
        library
    }

    /// Names other than `but` that this design cannot tell from the cleaned effect `v`, with their correlation.
    pub(crate) fn rivals(
        library: &[(Effect, Basis, Vec<Vec<f64>>)],
        v: &[f64],
        but: Option<Effect>,
    ) -> Vec<(Effect, f64)> {
        let mut found: Vec<(Effect, f64)> = Vec::new();
        for (effect, basis, _) in library {
            let correlation = basis.correlation(v);
            if Some(*effect) == but || correlation < SAME {
                continue;
            }
            match found.iter_mut().find(|(e, _)| e == effect) {
                Some((_, most)) => *most = most.max(correlation),
                None => found.push((*effect, correlation)),
            }
        }
        found
    }

    /// Share of the variance of `v` that the best three effects other than `but` leave unexplained,
    /// chosen greedily.
    pub(crate) fn beyond_three(
        library: &[(Effect, Basis, Vec<Vec<f64>>)],
        v: &[f64],
        but: Option<Effect>,
    ) -> f64 {
        let mut joint = Basis::default();
        let mut left = v.to_vec();
        for _ in 0..3 {
            let best = library
                .iter()
                .filter(|(effect, ..)| Some(*effect) != but)
                .max_by(|a, b| a.1.correlation(&left).total_cmp(&b.1.correlation(&left)));
            let Some((_, _, columns)) = best else { break };
            columns.iter().for_each(|column| joint.add(column.clone()));
            left = v.to_vec();
            joint.remove(&mut left);
        }
        dot(&left, &left) / dot(v, v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alias::Alias;
    use crate::design::Plan;
    use crate::dice::Dice;
    use crate::plans::{Runs, lay_out};

    fn unit(effect: Effect, machine: &Machine, layout: &Layout) -> Vec<f64> {
        let view = View::new(machine, layout);
        let all = variants(effect, machine, layout);
        view.clean(|r| all[0][0](r))
    }

    #[test]
    fn a_set_up_is_invisible_after_cleaning() {
        let machine = Machine::random(&mut Dice::new(2, 0, 0));
        let layout = lay_out(Plan::Good, &machine, Runs::OfOneLine, &mut Dice::new(2, 0, 1));
        let view = View::new(&machine, &layout);
        let moved = view.clean(|r| {
            let p = r.tip();
            [3.0 - 2e-3 * p[1] + 1e-3 * p[2], 1.0 + 2e-3 * p[0] + r.run as f64, -1e-3 * p[0]]
        });
        assert!(dot(&moved, &moved).sqrt() < 1e-9);
    }

    #[test]
    fn one_feed_makes_lag_and_backlash_the_same_and_two_feeds_do_not() {
        let machine = Machine::random(&mut Dice::new(2, 0, 0));
        let mut dice = Dice::new(2, 0, 1);
        let one = crate::blind::layout(Alias::LagOrBacklash, 0, &machine, &mut dice);
        let two = lay_out(Plan::Good, &machine, Runs::OfOneLine, &mut dice);
        for (layout, same) in [(one, true), (two, false)] {
            let lag = unit(Effect::ServoLag(0), &machine, &layout);
            let library = View::new(&machine, &layout).library();
            let rivals = View::rivals(&library, &lag, Some(Effect::ServoLag(0)));
            assert_eq!(rivals.iter().any(|(e, _)| *e == Effect::Backlash(0)), same, "{rivals:?}");
        }
    }

    #[test]
    fn a_name_is_expressed_by_its_own_columns() {
        let machine = Machine::random(&mut Dice::new(3, 0, 0));
        let layout = lay_out(Plan::Good, &machine, Runs::Long, &mut Dice::new(3, 0, 1));
        let library = View::new(&machine, &layout).library();
        for effect in [Effect::Scale(1), Effect::Squareness(0, 2), Effect::Load(2), Effect::LostMotion(1, 0)]
        {
            let v = unit(effect, &machine, &layout);
            assert!(View::beyond_three(&library, &v, None) < 1e-9, "{}", effect.id());
            assert!(View::rivals(&library, &v, Some(effect)).is_empty(), "{}", effect.id());
            assert!(View::beyond_three(&library, &v, Some(effect)) > 0.03, "{}", effect.id());
        }
    }
}
