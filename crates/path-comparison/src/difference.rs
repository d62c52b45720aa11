//! What two rows of items are, where they part: names by an alignment of least cost (Needleman and Wunsch 1970).

use crate::What;
use crate::alignment::Entry;
use crate::feeding::Feeding;
use crate::items::Item;
use crate::positioning::{Positioning, ends_alike};

/// Places that are nearer than so many limits are one.
const NEAR_LIMITS: f64 = 4.0;

/// A difference, with the items that it is about, by their place in the two rows.
pub(crate) struct Found {
    pub(crate) what: What,
    pub(crate) wanted: Option<usize>,
    pub(crate) made: Option<usize>,
}

/// Both programs may go on from here: the same is begun, and leads the same way.
///
/// * `entry` – where on the wanted feed the one that was made may begin
/// * `nearly_mm` – feeds so near each other are the same, though not as near as they should be; 0 for what the limits say
pub(crate) fn fits(wanted: &Item, made: &Item, entry: Entry, nearly_mm: f64) -> bool {
    match (wanted, made) {
        (Item::Feed(wanted), Item::Feed(made)) => {
            let near_mm = (NEAR_LIMITS * wanted.limit_mm).max(nearly_mm);
            let ((from_mm, from), (to_mm, to)) = (wanted.nearest(&made.start()), wanted.nearest(&made.end()));
            let length_mm = wanted.length_mm().max(1e-9);
            let moves = (to - from) * length_mm > near_mm || wanted.reach_mm <= near_mm;
            from_mm <= near_mm
                && to_mm <= near_mm
                && moves
                && (entry == Entry::OnTheWay || from * length_mm <= near_mm)
        }
        (Item::Position(wanted), Item::Position(made)) => ends_alike(wanted, made) && !wanted.is_small(),
        (Item::Deed(wanted), Item::Deed(made)) => wanted.number == made.number,
        _ => false,
    }
}

/// What it costs to take one for the other, in halves of leaving one out.
fn cost(wanted: &Item, made: &Item, nearly_mm: f64) -> Option<u32> {
    match (wanted, made) {
        (Item::Feed(wanted), Item::Feed(made)) => {
            // One that is off by much is the same all the same, rather than one left out and one put in.
            Some(match (wanted.end() - made.end()).norm() {
                mm if mm <= NEAR_LIMITS * wanted.limit_mm => 1,
                mm if mm <= nearly_mm => 2,
                _ => 3,
            })
        }
        (Item::Position(wanted), Item::Position(made)) => Some(if ends_alike(wanted, made) { 0 } else { 3 }),
        (Item::Deed(wanted), Item::Deed(made)) => (wanted.number == made.number).then_some(0),
        _ => None,
    }
}

/// Names what parts two rows of items.
///
/// * `next` – the programmed feed behind them, which pieces of the corrected row may have been made for
pub(crate) fn names(wanted: &[Item], made: &[Item], next: Option<&Feeding>, nearly_mm: f64) -> Vec<Found> {
    let columns = made.len() + 1;
    // Least cost of the first so many of either row.
    let mut least = vec![0u32; (wanted.len() + 1) * columns];
    for w in 0..=wanted.len() {
        for m in 0..=made.len() {
            let skip = (w > 0).then(|| least[(w - 1) * columns + m] + 2);
            let add = (m > 0).then(|| least[w * columns + m - 1] + 2);
            let both = (w > 0 && m > 0).then(|| {
                Some(least[(w - 1) * columns + m - 1] + cost(&wanted[w - 1], &made[m - 1], nearly_mm)?)
            });
            let best = [skip, add, both.flatten()].into_iter().flatten().min();
            least[w * columns + m] = best.unwrap_or(0);
        }
    }
    let (mut w, mut m, mut found) = (wanted.len(), made.len(), Vec::new());
    while w > 0 || m > 0 {
        let here = least[w * columns + m];
        let both = (w > 0 && m > 0)
            .then(|| Some(least[(w - 1) * columns + m - 1] + cost(&wanted[w - 1], &made[m - 1], nearly_mm)?));
        let what = if both.flatten() == Some(here) {
            (w, m) = (w - 1, m - 1);
            Found { what: What::Missing, wanted: Some(w), made: Some(m) }
        } else if w > 0 && least[(w - 1) * columns + m] + 2 == here {
            w -= 1;
            Found { what: What::Missing, wanted: Some(w), made: None }
        } else {
            m -= 1;
            Found { what: What::Extra, wanted: None, made: Some(m) }
        };
        found.push(what);
    }
    found.reverse();
    found.iter_mut().for_each(|found| {
        let (w, m) = (found.wanted.map(|w| &wanted[w]), found.made.map(|m| &made[m]));
        found.what = match (w, m) {
            (Some(wanted), Some(made)) => between(wanted, made),
            (Some(wanted), None) => left_out(wanted),
            (None, Some(made)) => put_in(made, next, nearly_mm),
            (None, None) => None,
        }
        .unwrap_or(What::TooFar(0.0));
    });
    found.retain(|found| found.what != What::TooFar(0.0));
    found
}

fn between(wanted: &Item, made: &Item) -> Option<What> {
    match (wanted, made) {
        (Item::Feed(wanted), Item::Feed(made)) => apart(wanted, made),
        (Item::Position(wanted), Item::Position(made)) if !ends_alike(wanted, made) => {
            let near = |(a, b): (&f64, f64)| (a - b).abs() <= wanted.aside_deg;
            Some(if wanted.end.rotary_deg.iter().zip(made.end.rotary_deg).all(near) {
                What::PositionedElsewhere
            } else {
                What::Turned
            })
        }
        _ => None,
    }
}

/// How far a feed lies from the one that it was made for.
fn apart(wanted: &Feeding, made: &Feeding) -> Option<What> {
    let (apart, near_mm) = (wanted.end() - made.end(), NEAR_LIMITS * wanted.limit_mm);
    if apart.fixed_rows::<3>(0).norm() <= near_mm && apart.fixed_rows::<3>(3).norm() > near_mm {
        return Some(What::Turned);
    }
    let places = std::iter::once(made.start()).chain(made.stretches.iter().map(|stretch| stretch.at(1.0)));
    let far = places.map(|place| wanted.nearest(&place).0).fold(0.0, f64::max);
    if far > wanted.limit_mm {
        return Some(What::TooFar(far));
    }
    let left_mm = (wanted.end() - made.end()).norm();
    if left_mm > wanted.limit_mm {
        return Some(What::Short(left_mm));
    }
    // It runs back, or begins late.
    Some(What::TooFar((wanted.start() - made.start()).norm().max(wanted.limit_mm)))
}

fn left_out(wanted: &Item) -> Option<What> {
    match wanted {
        Item::Feed(feed) => match feed.left_mm() {
            // Near its start something else ends.
            Some(left_mm) if left_mm < feed.reach_mm - 2.0 * feed.limit_mm => {
                (left_mm > feed.limit_mm).then_some(What::Short(left_mm))
            }
            _ => (feed.reach_mm > feed.limit_mm).then_some(What::Missing),
        },
        Item::Position(position) => moves(position).then_some(What::NotPositioned),
        Item::Deed(deed) => Some(What::NotDone(deed.number)),
    }
}

fn put_in(made: &Item, next: Option<&Feeding>, nearly_mm: f64) -> Option<What> {
    match made {
        Item::Feed(feed) => {
            let places = feed.stretches.iter().map(|stretch| stretch.at(1.0));
            let far = next.map(|next| places.map(|place| next.nearest(&place).0).fold(0.0, f64::max));
            Some(far.filter(|mm| *mm <= nearly_mm && *mm > 0.0).map_or(What::Extra, What::TooFar))
        }
        Item::Position(position) => moves(position).then_some(What::PositionedElsewhere),
        Item::Deed(deed) => Some(What::DoneToo(deed.number)),
    }
}

fn moves(position: &Positioning) -> bool {
    !position.is_small()
}
