//! The search: add, refine, swap, drop, on inner products alone.

use crate::effects::gives_way_to;
use crate::library::candidates::Library;
use crate::library::candidates::Part;
use crate::search::space::{Asked, Fit, Space};

/// Most effects tried for one place in the model.
pub(crate) const MOST_TRIED: usize = 8;

/// A change of the model.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Move {
    /// The changed model and its judgement; no new effect in it.
    Change(Vec<Part>, Fit),
    /// New effects are proposed, each in its best form, the best first.
    Add(Vec<(Part, Fit)>),
    /// Nothing is better.
    Stop,
}

/// The best next move: the known causes get their true shape first, then their rivals a hearing, then one
/// may go, and only then a new one is blamed.
///
/// `may` says whether a rival, beside the other parts, passes the tests of a new cause: a cause that passed them must not
/// give way to one that does not.
pub(crate) fn next_move(
    space: &Space,
    library: &Library,
    parts: &[Part],
    score: f64,
    may: impl Fn(&[Part], Part, &Fit) -> bool,
) -> Move {
    const WORTH: f64 = 1e-6;
    for (place, part) in parts.iter().enumerate() {
        let rest = without(parts, place);
        let fit = space.fit(library, &rest);
        if fit.score < score - space.allowance() {
            return Move::Change(rest, fit);
        }
        let refined = best(&space.scan(library, &rest, Asked::Of(part.candidate)));
        if let Some((new, fit)) = refined.filter(|(_, fit)| fit.score < score - WORTH) {
            return Move::Change(replaced(parts, place, new), fit);
        }
    }
    let mut swaps: Vec<(usize, Part, Fit)> = Vec::new();
    for place in 0..parts.len() {
        let found = by_effect(space.scan(library, &without(parts, place), Asked::Nameable), score - WORTH);
        swaps.extend(found.into_iter().map(|(part, fit)| (place, part, fit)));
    }
    swaps.sort_by(|(.., a), (.., b)| a.score.total_cmp(&b.score));
    let passing = swaps.into_iter().take(MOST_TRIED);
    for (place, new, fit) in passing {
        let own = parts[place].candidate == new.candidate;
        if own || may(&without(parts, place), new, &fit) {
            return Move::Change(replaced(parts, place, new), fit);
        }
    }
    let new = by_effect(space.scan(library, parts, Asked::Nameable), score + space.allowance() - WORTH);
    if new.is_empty() { Move::Stop } else { Move::Add(new) }
}

/// The best form of every effect that scores below a limit, the best effect first.
pub(crate) fn by_effect(found: Vec<(Part, Fit)>, limit: f64) -> Vec<(Part, Fit)> {
    let mut best: Vec<(Part, Fit)> = Vec::new();
    for (part, fit) in found.into_iter().filter(|(_, fit)| fit.score < limit) {
        match best.iter_mut().find(|(known, _)| known.candidate == part.candidate) {
            Some(known) if fit.score < known.1.score => *known = (part, fit),
            Some(_) => {}
            None => best.push((part, fit)),
        }
    }
    best.sort_by(|(_, a), (_, b)| a.score.total_cmp(&b.score));
    best
}

fn best(found: &[(Part, Fit)]) -> Option<(Part, Fit)> {
    found.iter().copied().min_by(|(_, a), (_, b)| a.score.total_cmp(&b.score))
}

/// The model without one of its parts.
pub(crate) fn without(parts: &[Part], place: usize) -> Vec<Part> {
    parts.iter().enumerate().filter(|(i, _)| *i != place).map(|(_, p)| *p).collect()
}

/// The model with one more part.
pub(crate) fn with(parts: &[Part], part: Part) -> Vec<Part> {
    parts.iter().copied().chain([part]).collect()
}

/// Effects that are not enough for a cause, the nearest of a scan without it, each of which may stand for it together
/// with a second one: a plainer form of it, and what an angle or a droop gives way to.
pub(crate) fn halves(library: &Library, cause: Part, scanned: &[(Part, Fit)]) -> Vec<Part> {
    /// How many are tried.
    const MOST: usize = 6;
    let columns = |part: Part| library.form(part).columns.len();
    let is_half = |(part, _): &&(Part, Fit)| {
        let is_plainer = part.candidate == cause.candidate && columns(*part) < columns(cause);
        is_plainer || gives_way_to(library.kind(cause), library.kind(*part))
    };
    let found = by_effect(scanned.iter().filter(is_half).copied().collect(), f64::INFINITY);
    found.into_iter().take(MOST).map(|(part, _)| part).collect()
}

fn replaced(parts: &[Part], place: usize, new: Part) -> Vec<Part> {
    parts.iter().enumerate().map(|(i, p)| if i == place { new } else { *p }).collect()
}
