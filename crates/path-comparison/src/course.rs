//! What several machines make of one program: the errors along every feed motion.

use machine_model::Models;
use toolpath::PeckRetreats;

use crate::Step;
use crate::items::{Counted, Item, Items, Role};
use crate::others::{Course, DatumOf, Others};

/// Runs a program on several machines at once: every feed motion in order, a cycle as the feed motions that it makes,
/// one for each trace that [`crate::compare`] keeps.
///
/// Where axes turn and have their play taken up is asked of the first machine, and what the others are there; so the
/// others should be the first without some of its errors.
///
/// * `step_mm` – distance between places on a line, at most; an arc turns by [`crate::TURN_RAD`] between them at most
/// * `asked` – lines that are asked for; of others nothing is made
/// * `datum_of` – [`machine_model::Command::datum`] of a machine, by its number, where that of the first is given: each
///   machine would have been touched by itself
pub fn courses<'m>(
    models: &[Models<'m>],
    steps: impl Iterator<Item = Step>,
    retreats: PeckRetreats,
    step_mm: f64,
    asked: &'m dyn Fn(u64) -> bool,
    datum_of: &'m DatumOf<'m>,
    each: &mut dyn FnMut(Course),
) {
    let Some((first, others)) = models.split_first() else { return };
    let others = Others::new(others, step_mm, asked, datum_of);
    let mut items = Items::new(*first, steps, Role::Wanted, retreats, Counted::default()).with_others(others);
    while let Some(item) = items.pop() {
        if let Item::Feed(mut feed) = item
            && let Some(course) = feed.course.take()
        {
            each(*course);
        }
    }
}
