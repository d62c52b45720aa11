//! The shortest list of deviations to mend on a machine as measured.

use machine_model::{Vector, WithEffects};

use crate::{Budget, Criteria, Machine};

/// Contributions looked at before the list found by taking the best one each time is left unproven: about a second.
const MOST_WORK: usize = 500_000_000;
/// Points kept that refused a set: they will refuse many others.
const WITNESSES: usize = 16;
/// How often the aim is lowered because the whole model stays above the target where the sum does not.
const MOST_ATTEMPTS: usize = 8;

/// What to mend.
#[derive(Clone, Debug, PartialEq)]
pub struct Mending {
    /// In the order that lowers M fastest: the deviation's index, and M of the whole model with it and all before
    /// it switched off, mm. `None` where no list was found.
    pub steps: Option<Vec<(usize, f64)>>,
    /// True where every shorter list was tried, or every list where there is none; tried by sums of
    /// contributions, so to second order.
    pub proven: bool,
}

/// The shortest list of deviations whose coefficients, set to 0, bring M to the target: equation (56).
///
/// Of lists as short, the one that leaves the smallest M. Deviations with `keep` stay as they are. Then a longer list is
/// not always better: what is mended may have made up for what is kept.
#[must_use]
pub fn shortest(
    machine: &Machine,
    budget: &Budget,
    keep: &[bool],
    target_mm: f64,
    evaluate: impl Fn(&WithEffects) -> Vec<Vector>,
) -> Mending {
    let largest_without = |off: &[usize]| {
        let of = |deviation: usize| if off.contains(&deviation) { 0.0 } else { 1.0 };
        let coefficients: Vec<f64> = (0..keep.len()).map(of).collect();
        Criteria::of(&evaluate(&machine.scaled(&coefficients))).map_or(0.0, |found| found.largest_mm)
    };
    let each = |list: &[usize]| -> Vec<(usize, f64)> {
        (1..=list.len()).map(|length| (list[length - 1], largest_without(&list[..length]))).collect()
    };
    let reached = |steps: &[(usize, f64)]| steps.last().map_or(budget.measured.largest_mm, |step| step.1);
    let candidates: Vec<usize> =
        budget.items.iter().map(|item| item.deviation).filter(|&deviation| !keep[deviation]).collect();
    // The whole model says whether anything is to be done; sums would to the last bit only.
    if budget.measured.largest_mm <= target_mm {
        return Mending { steps: Some(Vec::new()), proven: true };
    }
    let mut aim_mm = target_mm;
    let mut proven = true;
    for _ in 0..MOST_ATTEMPTS {
        let (list, tried) = Search::new(budget, &candidates).run(aim_mm);
        proven = tried;
        let Some(list) = list else { break };
        let steps = each(&list);
        if reached(&steps) <= target_mm {
            return Mending { steps: Some(steps), proven };
        }
        aim_mm -= reached(&steps) - target_mm;
    }
    // Sums may fail, by the second order, where the whole model does not: without any deviation it is perfect.
    let steps = each(&candidates);
    if reached(&steps) <= target_mm {
        return Mending { steps: Some(steps), proven: false };
    }
    Mending { steps: None, proven }
}

/// The machine as a sum of contributions, some of them taken out.
struct Search<'b> {
    budget: &'b Budget,
    candidates: &'b [usize],
    work: usize,
    /// The points that refused the last sets.
    witnesses: Vec<usize>,
}

impl<'b> Search<'b> {
    fn new(budget: &'b Budget, candidates: &'b [usize]) -> Self {
        Self { budget, candidates, work: 0, witnesses: vec![budget.measured.largest_at] }
    }

    /// The list, ordered, and whether it is proven to be the shortest, or that there is none.
    fn run(&mut self, aim_mm: f64) -> (Option<Vec<usize>>, bool) {
        let greedy = self.ordered(self.candidates, aim_mm);
        let most = greedy.as_ref().map_or(self.candidates.len(), Vec::len);
        for length in 0..=most {
            match self.best_of(length, aim_mm) {
                Some(Some(best)) => return (self.ordered(&best, f64::NEG_INFINITY), true),
                Some(None) => {}
                None => {
                    let proven = greedy.as_ref().is_some_and(|list| list.len() == length);
                    return (greedy, proven);
                }
            }
        }
        (None, true)
    }

    /// Takes out one after the other, always the one that leaves the smallest M, until the aim is reached; an
    /// aim of -∞ takes all. `None` where all are not enough.
    fn ordered(&self, from: &[usize], aim_mm: f64) -> Option<Vec<usize>> {
        let mut left = self.budget.errors_mm.clone();
        let mut open = from.to_vec();
        let mut list = Vec::new();
        let largest = |errors: &[Vector]| errors.iter().map(Vector::norm_squared).fold(0.0, f64::max).sqrt();
        while largest(&left) > aim_mm {
            let after = |own: &[Vector]| {
                left.iter().zip(own).map(|(d, own)| (d - own).norm_squared()).fold(0.0, f64::max)
            };
            let each = open.iter().enumerate().map(|(place, &d)| (after(self.own(d)), place));
            let Some((_, place)) = each.reduce(|a, b| if b.0 < a.0 { b } else { a }) else {
                return (aim_mm == f64::NEG_INFINITY).then_some(list);
            };
            let taken = open.remove(place);
            left.iter_mut().zip(self.own(taken)).for_each(|(d, own)| *d -= own);
            list.push(taken);
        }
        Some(list)
    }

    /// Of all sets of a length that reach the aim the one with the smallest M, `Some(None)` where there is none, `None`
    /// where there are too many to try.
    fn best_of(&mut self, length: usize, aim_mm: f64) -> Option<Option<Vec<usize>>> {
        let mut places: Vec<usize> = (0..length).collect();
        let mut best: Option<Vec<usize>> = None;
        let mut limit = aim_mm * aim_mm;
        if aim_mm < 0.0 || length > self.candidates.len() {
            return Some(None);
        }
        loop {
            if self.work > MOST_WORK {
                return None;
            }
            let set: Vec<usize> = places.iter().map(|&place| self.candidates[place]).collect();
            if let Some(square) = self.largest_square_within(&set, limit)
                && (best.is_none() || square < limit)
            {
                limit = square;
                best = Some(set);
            }
            // The next set in the order of the alphabet.
            let last = self.candidates.len() - length;
            let Some(k) = (0..length).rfind(|&k| places[k] < last + k) else { return Some(best) };
            places[k] += 1;
            for later in k + 1..length {
                places[later] = places[later - 1] + 1;
            }
        }
    }

    /// M² without a set, mm², `None` where a point is above the limit.
    fn largest_square_within(&mut self, set: &[usize], limit: f64) -> Option<f64> {
        let budget = self.budget;
        let square = |point: usize| {
            let own = |deviation: usize| budget.field.contributions_mm[deviation][point];
            set.iter().fold(budget.errors_mm[point], |d, &off| d - own(off)).norm_squared()
        };
        self.work += WITNESSES * (set.len() + 1);
        if self.witnesses.iter().any(|&point| square(point) > limit) {
            return None;
        }
        let mut largest = 0.0_f64;
        for point in 0..self.budget.errors_mm.len() {
            let own = square(point);
            if own > limit {
                self.work += point * (set.len() + 1);
                self.witnesses.insert(0, point);
                self.witnesses.truncate(WITNESSES);
                return None;
            }
            largest = largest.max(own);
        }
        self.work += self.budget.errors_mm.len() * (set.len() + 1);
        Some(largest)
    }

    fn own(&self, deviation: usize) -> &'b [Vector] {
        &self.budget.field.contributions_mm[deviation]
    }
}
