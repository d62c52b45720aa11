//! The search: add, refine, swap, drop, on inner products alone.

use crate::library::Library;
use crate::space::{Fit, Part, Space};

/// A change of the model.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Move {
    /// The changed model and its judgement; no new effect in it.
    Change(Vec<Part>, Fit),
    /// A new effect is proposed.
    Add(Part, Fit),
    /// Nothing is better.
    Stop,
}

/// The best next move: the known causes get their true shape first, then their rivals a hearing, then one
/// may go, and only then a new one is blamed.
#[must_use]
pub(crate) fn next_move(space: &Space, library: &Library, parts: &[Part], score: f64) -> Move {
    const WORTH: f64 = 1e-6;
    for (place, part) in parts.iter().enumerate() {
        let rest = without(parts, place);
        let fit = space.fit(library, &rest);
        if fit.score < score - WORTH {
            return Move::Change(rest, fit);
        }
        let refined = best(&space.scan(library, &rest, Some(part.candidate), false));
        if let Some((new, fit)) = refined.filter(|(_, fit)| fit.score < score - WORTH) {
            return Move::Change(replaced(parts, place, new), fit);
        }
    }
    let mut swap: Option<(Vec<Part>, Fit)> = None;
    for place in 0..parts.len() {
        let rest = without(parts, place);
        if let Some((new, fit)) = best(&space.scan(library, &rest, None, false)) {
            let better = swap.as_ref().map_or(score - WORTH, |(_, f)| f.score);
            if fit.score < better {
                swap = Some((replaced(parts, place, new), fit));
            }
        }
    }
    if let Some((changed, fit)) = swap {
        return Move::Change(changed, fit);
    }
    match best(&space.scan(library, parts, None, false)) {
        Some((part, fit)) if fit.score < score - WORTH => Move::Add(part, fit),
        _ => Move::Stop,
    }
}

fn best(found: &[(Part, Fit)]) -> Option<(Part, Fit)> {
    found.iter().copied().min_by(|(_, a), (_, b)| a.score.total_cmp(&b.score))
}

/// The model without one of its parts.
#[must_use]
pub(crate) fn without(parts: &[Part], place: usize) -> Vec<Part> {
    parts.iter().enumerate().filter(|(i, _)| *i != place).map(|(_, p)| *p).collect()
}

fn replaced(parts: &[Part], place: usize, new: Part) -> Vec<Part> {
    parts.iter().enumerate().map(|(i, p)| if i == place { new } else { *p }).collect()
}
