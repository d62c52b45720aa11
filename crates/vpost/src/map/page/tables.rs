//! Sizes, axes, diagonals and zero points of an error map, as tables.

use diagnostic::{Text, both};
use report::body::{Body, Fact, Table};
use report::chart::{Curves, Histogram, curves, histogram};
use report::numbers::{count, digits, figures as written, number, percent, prose};
use report::text::MICROMETRES;

use jobs::map::drawn::classes;
use jobs::map::study::{Part, Study, freedom_name};
use jobs::map::text::proof;

pub(super) const AXES: [&str; 3] = ["X", "Y", "Z"];

pub(super) fn sizes(out: &mut Body, study: &Study) {
    let found = classes(study);
    let width = found.width_mm * 1e3;
    let table = Table::of(found.before.iter().zip(&found.after).enumerate())
        .numbers(both!("from, \u{b5}m", "от, мкм"), |(k, _)| number(width * *k as f64))
        .numbers(both!("to, \u{b5}m", "до, мкм"), |(k, _)| number(width * (k + 1) as f64))
        .numbers(both!("before", "до сдвига"), |(_, (before, _))| count(**before))
        .numbers(both!("after", "после сдвига"), |(_, (_, after))| count(**after));
    let drawn = Histogram {
        largest: width * found.before.len() as f64,
        before: found.before.clone(),
        after: found.after.clone(),
    };
    let title = both!("Nodes by the size of their error", "Узлы по величине погрешности");
    let within = both!("within", "в пределах");
    let labels =
        [&both!("length of the error, \u{b5}m", "длина вектора погрешности, мкм"), &both!("nodes", "узлов")];
    let limit = Some((study.asked.within_mm * 1e3, &within));
    out.figure_of(
        &histogram(out.language(), &title, &drawn, limit, labels),
        &both!(
            "Before, and after the zero point is moved by the geometric median.",
            "До и после сдвига нулевой точки на геометрическую медиану."
        ),
        &table,
    );
}

pub(super) fn axes(out: &mut Body, study: &Study) {
    let panels = study.curves.iter().map(|curve| Curves {
        label: both!(
            "{}, mm, the other axes in the middle of the map",
            "{}, мм, остальные оси в середине карты",
            AXES[curve.axis]
        ),
        at: curve.at_mm.clone(),
        values: (0..3).map(|c| curve.errors_mm.iter().map(|e| e[c] * 1e3).collect()).collect(),
    });
    let series = [("s0", "dx"), ("s1", "dy"), ("s2", "dz")].map(|(class, name)| (class, Text::same(name)));
    let title = both!("Errors along the axes", "Погрешности вдоль осей");
    out.figure(
        &curves(out.language(), &title, &panels.collect::<Vec<_>>(), &series),
        &both!(
            "Components of the error, \u{b5}m, while one axis moves. The numbers are in the JSON.",
            "Составляющие погрешности, мкм, когда движется одна ось. Числа есть в JSON."
        ),
    );
}

pub(super) fn diagonals(out: &mut Body, study: &Study) {
    let forward =
        |d: &error_map::diagonals::Diagonal| d.deviations_mm.iter().map(|row| row[1] * 1e3).collect();
    let panels = [Curves {
        label: both!("distance along the diagonal, mm", "путь по диагонали, мм"),
        at: study.diagonals[0].deviations_mm.iter().map(|row| row[0]).collect(),
        values: study.diagonals.iter().map(forward).collect(),
    }];
    let names = study.diagonals.iter().map(|d| signs(d.signs));
    let series: Vec<(&str, Text)> = ["s0", "s1", "s2", "s3"].into_iter().zip(names).collect();
    let title = both!("Positioning along the body diagonals", "Позиционирование по объёмным диагоналям");
    out.figure(
        &curves(out.language(), &title, &panels, &series),
        &both!(
            "Deviation forward along each diagonal, \u{b5}m, as an interferometer would read it (ISO 230-6); P and N: whether X, Y, Z run to plus or to minus. Spread between diagonals speaks of squareness, a common slope of scale.",
            "Отклонение на прямом ходе по каждой диагонали, мкм, как его показал бы интерферометр (ISO 230-6); P и N — в плюс или в минус идут X, Y, Z. Расхождение диагоналей говорит об отклонении от перпендикулярности, общий наклон — о масштабе."
        ),
    );
    let table = Table::of(&study.diagonals)
        .words(both!("diagonal", "диагональ"), |d| signs(d.signs))
        .numbers(both!("systematic E", "систематическое E"), |d| um(d.systematic_mm))
        .numbers(both!("mean M", "среднее M"), |d| um(d.mean_mm))
        .numbers(both!("reversal B", "зона нечувствительности B"), |d| um(d.reversal_mm))
        .numbers(both!("length error", "погрешность длины"), |d| um(d.length_error_mm));
    out.table(&table);
}

/// `PPN`: positive in X and Y, negative in Z.
pub(super) fn signs(signs: [i8; 3]) -> Text {
    Text::same(signs.map(|sign| if sign > 0 { "P" } else { "N" }).concat())
}

pub(super) fn zero_points(out: &mut Body, study: &Study) {
    out.p(&both!(
        "The offset to enter is minus the error: the machine goes too far by the error, so the zero point goes back by it. Do this or correct programs, not both; what is to be added holds for a zero that an outside instrument found: one that was touched off on this machine has its error at that place in it already, and what is to be entered for it reckons with that.",
        "Вводится погрешность с обратным знаком: станок уходит на погрешность дальше, поэтому нулевая точка отводится на неё назад. Либо так, либо исправлять программы, но не то и другое вместе; прибавлять нужно к нулю, найденному внешним прибором: в нуле, найденном касанием на этом станке, его погрешность в этом месте уже есть, и вводимые для него числа её учитывают."
    ));
    for part in &study.parts {
        zero_points_of(out, study, part);
    }
}

pub(super) fn zero_points_of(out: &mut Body, study: &Study, part: &Part) {
    out.heading(&part.name);
    let as_it_is = (both!("as it is", "как есть"), None, &part.figures);
    let answers = part.zero_points.iter().map(|z| (z.kind.name(), Some(z.to_enter_mm(study)), &z.figures));
    let mut table = Table::of(std::iter::once(as_it_is).chain(answers))
        .words(both!("answer", "ответ"), |(name, ..)| name.clone());
    for (k, axis) in AXES.into_iter().enumerate() {
        table = table.numbers(both!("add {axis}, mm", "к {axis}, мм"), |(_, add, _)| {
            add.map_or(Text::EMPTY, |add| digits(add[k], study.decimals()))
        });
    }
    let table = table
        .numbers(both!("RMS, \u{b5}m", "СКЗ, мкм"), |(.., f)| um(f.rms_mm))
        .numbers(Text::same("95 %"), |(.., f)| um(f.p95_mm))
        .numbers(both!("largest", "наиб."), |(.., f)| um(f.magnitude_mm.high))
        .numbers(within_said(study), |(.., f)| percent2(f.share_within()));
    out.table(&table);
    let proofs: Vec<Text> = part.zero_points.iter().map(|zero| prose(&proof(zero, part))).collect();
    out.details(&both!("How good these answers are", "Насколько хороши эти ответы"), |out| out.list(&proofs));
    if !study.work_offsets.is_empty() {
        let zero = part.median();
        out.p(&both!("To enter for the geometric median:", "Ввести для геометрической медианы:"));
        out.facts(study.work_offsets.iter().map(|offset| {
            let (name, how, to) = (&offset.name, offset.how(), offset.to_enter_mm(zero, study));
            // A control takes a point in every language.
            let [x, y, z] = [to.x, to.y, to.z].map(|v| digits(v, study.decimals()));
            Fact::same(both!("{name} ({how})", "{name} ({how:#})"), format!("X {x} Y {y} Z {z}"))
        }));
    }
}

pub(super) fn places(out: &mut Body, study: &Study) {
    if study.places.is_empty() {
        return;
    }
    out.p(&both!(
        "Axis commands of the box in which least is left after the set-up did what it can; turns are about its centre.",
        "Координаты осей для габарита, в котором после наладки остаётся наименьшая погрешность; повороты — вокруг его центра."
    ));
    let mut table = Table::of(&study.places)
        .words(both!("the set-up can", "при наладке можно"), |(freedom, _)| {
            freedom_name(*freedom)
        });
    for (k, axis) in AXES.into_iter().enumerate() {
        table = table.words(both!("{axis}, mm", "{axis}, мм"), |(_, place)| {
            let [low, high] = [place.box_mm[k].low, place.box_mm[k].high].map(|mm| digits(mm, 1));
            // Two lines where there is no room for one.
            both!("{low} to\u{a0}{high}", "от\u{a0}{low:#} до\u{a0}{high:#}")
        });
    }
    table = table
        .numbers(both!("RMS before, \u{b5}m", "СКЗ до, мкм"), |(_, place)| {
            um(place.fit.before.rms_mm)
        })
        .numbers(both!("after", "после"), |(_, place)| um(place.fit.after.rms_mm))
        .numbers(both!("largest", "наиб."), |(_, place)| um(place.fit.after.magnitude_mm.high));
    let adds = [both!("add X, mm", "к X, мм"), both!("add Y", "к Y"), both!("add Z", "к Z")];
    for (k, add) in adds.into_iter().enumerate() {
        table = table.numbers(add, |(_, place)| digits(-place.fit.shift_mm[k], study.decimals()));
    }
    let turns = [
        both!("turn X, \u{b5}rad", "вокруг X, мкрад"),
        both!("turn Y", "вокруг Y"),
        both!("turn Z", "вокруг Z"),
    ];
    for (k, turn) in turns.into_iter().enumerate() {
        table = table.numbers(turn, |(_, place)| digits(-place.fit.rotation_rad[k] * 1e6, 0));
    }
    out.table(&table);
}

pub(super) fn um(mm: f64) -> Text {
    digits(mm * 1e3, if mm.abs() < 0.0995 { 1 } else { 0 })
}

/// The tolerance as it was typed.
pub(super) fn within(study: &Study) -> Text {
    written(format!("{}", (study.asked.within_mm * 1e6).round() * 1e-3))
}

pub(super) fn within_said(study: &Study) -> Text {
    let within = within(study);
    both!("\u{2264} {within} {MICROMETRES}", "\u{2264} {within:#} {MICROMETRES:#}")
}

/// A share as people compare them: small ones with a decimal.
pub(super) fn percent2(share: f64) -> Text {
    let small = || digits(100.0 * share, 1);
    if share < 0.1 { Text::join([&small(), &Text::same("%")], " ") } else { percent(share) }
}
