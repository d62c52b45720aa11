//! Which deviations make the error of a map: what the first screen names.

use diagnostic::{Text, both};
use error_budget::{Budget, Machine};
use machine_model::effects::Conditions;
use machine_model::{EngineId, Vector, WithEffects};
use machine_profile::Profile;
use rayon::prelude::*;
use report::body::{Body, Table};
use report::numbers::number;

use super::options::{Asked, command};

/// Nodes along an axis: the largest error of a smooth machine lies at an end or near one.
const NODES: usize = 5;
/// Named on the first screen.
const NAMED: usize = 3;

/// One deviation, and what it does to the largest error of the map.
pub(super) struct Dominant {
    pub name: String,
    /// The largest error of the machine with it alone, mm.
    pub alone_mm: f64,
    /// The largest error of the machine without it, mm.
    pub without_mm: f64,
}

/// The deviations of the rigid-body model, first the one without which the largest error is smallest; none for models that
/// have no deviations to be taken out one by one.
pub(super) fn dominant(
    profile: &Profile,
    id: EngineId,
    conditions: &Conditions,
    asked: &Asked,
) -> Vec<Dominant> {
    if id != EngineId::RigidBody {
        return Vec::new();
    }
    // Under these conditions the engine was built already.
    let Ok(model) = profile.machine(conditions) else { return Vec::new() };
    let machine = Machine::new(model);
    let places: [Vec<f64>; 3] = asked.grid.axes().each_ref().map(|nodes| {
        let all = nodes.places_mm();
        let kept = all.len().min(NODES);
        (0..kept).map(|k| all[if kept > 1 { k * (all.len() - 1) / (kept - 1) } else { 0 }]).collect()
    });
    let mut commands = Vec::new();
    for z in &places[2] {
        for y in &places[1] {
            commands.extend(places[0].iter().map(|x| command(asked, Vector::new(*x, *y, *z), [0; 3])));
        }
    }
    let evaluate = |model: &WithEffects| -> Vec<Vector> {
        use machine_model::PathModel;
        commands.par_iter().map(|command| model.error_mm(command)).collect()
    };
    let Some(budget) = Budget::new(&machine, evaluate) else { return Vec::new() };
    budget
        .items
        .iter()
        .map(|item| Dominant {
            name: machine.deviations()[item.deviation].name.clone(),
            alone_mm: item.alone.largest_mm,
            without_mm: item.without.largest_mm,
        })
        .collect()
}

fn um(mm: f64) -> Text {
    number(mm * 1e3)
}

/// The sentence of the first screen; nothing where nothing is known of single deviations.
pub(super) fn sentence(all: &[Dominant]) -> Option<Text> {
    let largest = all.iter().map(|own| own.alone_mm).fold(0.0, f64::max);
    let named: Vec<Text> = all
        .iter()
        .take(NAMED)
        // A tenth of the largest is none that one would begin with.
        .filter(|own| own.alone_mm > 0.1 * largest)
        .map(|own| {
            let (name, um) = (called(&own.name), um(own.alone_mm));
            both!("{name} (alone {um} \u{b5}m)", "{name:#} (само по себе {um:#} мкм)")
        })
        .collect();
    let said = Text::join(&named, ", ");
    (!named.is_empty()).then(|| both!("What makes most of it: {said}.", "Больше всего вносят: {said:#}."))
}

/// A symbol of ISO 230-1 with its kind in a word, for whoever does not read symbols: `EC0Y squareness`.
fn called(name: &str) -> Text {
    let kind = match name.as_bytes() {
        [b'E', b'A'..=b'C', b'0', b'X'..=b'Z'] => both!("squareness", "перпендикулярность"),
        [b'E', a @ b'X'..=b'Z', b] if a == b => both!("positioning", "позиционирование"),
        [b'E', b'X'..=b'Z', b'X'..=b'Z'] => both!("straightness", "прямолинейность"),
        [b'E', b'A'..=b'C', b'X'..=b'Z'] => both!("angle", "угол"),
        _ => return Text::same(name),
    };
    both!("{name} {kind}", "{name} {kind:#}")
}

/// All of them as a table; nothing where there are none.
pub(super) fn section(out: &mut Body, all: &[Dominant]) {
    if all.is_empty() {
        return;
    }
    out.typed(&both!(
        "Symbols of ISO 230-1, at up to five places along each axis of the map, in order of what is left without it. More, and what each deviation may be, says `vpost budget`.",
        "Обозначения по ISO 230-1, до пяти мест вдоль каждой оси карты; первым стоит то, без которого остаётся меньше всего. Подробнее, с допуском на каждое отклонение, говорит `vpost budget`."
    ));
    let table = Table::of(all)
        .words(both!("deviation", "отклонение"), |own| Text::same(&own.name))
        .numbers(
            both!("largest with it alone, \u{b5}m", "наибольшее с ним одним, мкм"),
            |own| um(own.alone_mm),
        )
        .numbers(both!("largest without it, \u{b5}m", "наибольшее без него, мкм"), |own| um(own.without_mm));
    out.table(&table);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_are_said_in_a_word() {
        for (symbol, word) in [
            ("EC0Y", "EC0Y squareness"),
            ("EXX", "EXX positioning"),
            ("EYX", "EYX straightness"),
            ("EAX", "EAX angle"),
            ("EX0C", "EX0C"),
            ("backlash X", "backlash X"),
        ] {
            assert_eq!(called(symbol).english(), word);
        }
        assert_eq!(format!("{:#}", called("EYX")), "EYX прямолинейность");
    }
}
