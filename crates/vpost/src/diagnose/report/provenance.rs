//! What the page was made from, and how.

use diagnostic::{Text, both};
use gap_diagnosis::{Diagnosis, number_name};
use jobs::diagnose::File;
use report::body::{Body, Fact, Table};
use report::numbers::number;

use super::facts::Facts;
use super::names::{named, prose};
use crate::origin::{MACHINE, MEASUREMENTS, MODEL, PROFILE};

/// Most comment lines shown, and most runs.
const MOST: usize = 60;

/// Files, options and machine.
pub(in crate::diagnose) fn facts(facts: &Facts) -> Vec<Fact> {
    let file = |name: Text, file: &File| {
        let comments = file.comments.iter().take(MOST).cloned().collect();
        // What is read once has no hash.
        let hash = Some(file.hash.clone()).filter(|hash| !hash.is_empty());
        Fact::remarked(name, &file.name, hash, comments)
    };
    let list = |name: Text, all: &[String]| (!all.is_empty()).then(|| Fact::same(name, all.join(", ")));
    let machine = &facts.machine;
    let chained = |chain: &String| both!("{machine}, chain {chain}", "{machine}, цепь {chain}");
    let mut all = vec![
        Fact::new(MACHINE, &facts.chain.as_ref().map_or_else(|| Text::same(machine), chained)),
        file(MEASUREMENTS, &facts.measurements),
        file(PROFILE, &facts.profile),
    ];
    all.extend(facts.holdout.as_ref().map(|held| file(both!("unseen points", "новые точки"), held)));
    all.push(Fact::same(MODEL, &facts.engine));
    all.extend(facts.seed.map(|seed| Fact::same(both!("seed", "начальное число"), seed.to_string())));
    all.extend(list(both!("columns passed over", "пропущенные столбцы"), &facts.ignored_columns));
    all.extend(list(both!("effects left out", "исключённые эффекты"), &facts.without));
    all.extend(facts.origin.facts());
    all
}

/// Notes, set-up, and what would have been seen.
pub(in crate::diagnose) fn more(out: &mut Body, d: &Diagnosis) {
    if !d.notes.is_empty() {
        out.heading(&both!("Notes", "Примечания"));
        out.list(&d.notes.iter().map(prose).collect::<Vec<_>>());
    }
    let Some(setup) = d.setup.as_ref().filter(|_| !d.residuals.is_empty()) else { return };
    out.heading(&both!(
        "Set-up: measuring frame against machine frame",
        "Установка: система измерения относительно системы станка"
    ));
    let [x, y, z] = setup.shift_um.map(number);
    let [a, b, c] = setup.rotation_urad.map(number);
    out.p(&both!(
        "Shift {x}, {y}, {z} \u{b5}m; rotation {a}, {b}, {c} \u{b5}rad about X, Y, Z. Fitted with everything else, reported, never blamed.",
        "Сдвиг {x:#}; {y:#}; {z:#} мкм; поворот {a:#}; {b:#}; {c:#} мкрад вокруг X, Y, Z. Подогнано вместе со всем остальным; сообщается, но причиной не считается."
    ));
    let runs = &setup.run_offsets_um;
    out.details(&both!("Offsets of the runs", "Смещения серий"), |out| {
        let table = Table::of(runs.iter().take(MOST))
            .words(both!("run", "серия"), |(run, _)| Text::same(run))
            .numbers(both!("x, \u{b5}m", "x, мкм"), |(_, o)| number(o[0]))
            .numbers(both!("y, \u{b5}m", "y, мкм"), |(_, o)| number(o[1]))
            .numbers(both!("z, \u{b5}m", "z, мкм"), |(_, o)| number(o[2]));
        out.table(&table);
        if runs.len() > MOST {
            out.muted(&both!("The rest is in the JSON.", "Остальное есть в JSON."));
        }
    });
    let smallest =
        both!("Smallest effects that would have been named", "Наименьшие эффекты, которые были бы названы");
    out.details(&smallest, |out| {
        let unseen = both!("not visible on these rows", "на этих строках не виден");
        let table = Table::of(&d.detectable)
            .words(both!("effect", "эффект"), |s| named(&s.effect))
            .words(both!("number", "параметр"), |s| number_name(&s.parameter))
            .numbers(both!("smallest", "наименьшее"), |s| {
                s.smallest.map_or(unseen.clone(), number)
            });
        out.table(&table);
    });
}
