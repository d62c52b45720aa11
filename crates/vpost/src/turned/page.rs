//! What a lathe turns as one page: the outline, its roundness, its roughness, and what a correction will bring.

use diagnostic::{Language, Text, both};
use report::body::{Body, Fact, Table};
use report::numbers::{number, or_dash};
use report::page::Page;
use report::text::shown;
use serde::Serialize;
use turning::Lathe;

use crate::file;
use crate::message::{Failure, Wording};
use crate::origin::{Origin, PROFILE};
use jobs::turned::judged::{Form, Outline, mm, ridges, um};
use jobs::turned::surface::{HIGHEST_WAVE, Stretch, Surface, Turned};

mod outline;
mod round;
mod shown;

use round::Drawn;
use shown::Shown;
pub(super) use shown::{Correction, Facts};

/// What the JSON in the page says beside `predict --lathe --json`.
#[derive(Serialize)]
struct Figures<'a> {
    #[serde(flatten)]
    turned: &'a Turned,
    tolerance_um: f64,
    sections: &'a [Drawn],
    /// What is left after the correction; nothing where the program is refused or needs none.
    corrected: Option<&'a Turned>,
}

/// A cylinder before and after.
struct Cylinder<'a> {
    stretch: &'a Stretch,
    before: Option<Form>,
    after: Option<Form>,
    corrected: Option<&'a Stretch>,
}

/// The file.
///
/// # Errors
/// A cross section is wanted where nothing is turned.
pub(super) fn html(
    facts: &Facts<'_>,
    (surface, turned): (&Surface, &Turned),
    correction: &Correction,
    lathe: &Lathe,
    language: Language,
) -> Result<String, Failure> {
    let shown = Shown {
        facts,
        surface,
        turned,
        correction,
        before: Outline::of(surface, turned),
        after: match correction {
            Correction::Turned(after) => Some(Outline::of(surface, after)),
            Correction::Unchanged | Correction::Refused(_) => None,
        },
        sections: round::wanted(turned, facts.at_mm, lathe)?,
    };
    let numbers = Figures {
        turned,
        tolerance_um: shown.tolerance_um(),
        sections: &shown.sections,
        corrected: shown.corrected(),
    };
    let json = serde_json::to_string(&numbers).expect("plain values always serialise");
    let title = both!("Turned \u{2013} {}", "Точение \u{2014} {}", file::without_folders(facts.name));
    let mut page = Page::new(language, title, "predict --lathe", "vpost.turned/1");
    shown.head(&mut page.head);
    shown.outline(page.section("outline", both!("Radius along Z", "Радиус вдоль Z")));
    shown.cylinder_table(page.section("cylinders", both!("Cylinders", "Цилиндры")));
    shown.roundness(page.section("roundness", both!("Roundness", "Круглость")));
    let roughness = both!("Theoretical roughness", "Теоретическая шероховатость");
    shown.roughness(page.section("roughness", roughness));
    page.provenance(shown.provenance()).muted(&both!(
        "The tip counts as a point; the surface is what the lathe's model turns, not what was measured.",
        "Вершина резца считается точкой; поверхность — та, которую точит модель станка, а не измеренная."
    ));
    Ok(page.into_html(&json))
}

impl Shown<'_> {
    fn tolerance_um(&self) -> f64 {
        self.facts.settings.options.tolerance_mm * 1e3
    }

    fn corrected(&self) -> Option<&Turned> {
        match self.correction {
            Correction::Turned(after) => Some(after),
            Correction::Unchanged | Correction::Refused(_) => None,
        }
    }

    fn cylinders(&self) -> Vec<Cylinder<'_>> {
        let form = |outline: &Outline, stretch: &Stretch| {
            outline.form(self.surface, [stretch.from_z_mm, stretch.to_z_mm])
        };
        let one = |stretch| Cylinder {
            stretch,
            before: form(&self.before, stretch),
            after: self.after.as_ref().and_then(|after| form(after, stretch)),
            corrected: self.corrected().and_then(|after| same(stretch, &after.cylinders)),
        };
        self.turned.cylinders.iter().map(one).collect()
    }

    /// The first screen: what is wrong, how bad, what a correction will bring.
    fn head(&self, out: &mut Body) {
        let cylinders = self.cylinders();
        // The cylinder that is worst: a size, a cone or a bend of so much on the diameter.
        let worst = cylinders.iter().filter_map(|c| Some((c, c.before?))).max_by(|(_, a), (_, b)| {
            let size = |f: &Form| f.size_um.abs().max(f.cone_um.abs()).max(2.0 * f.straightness_um);
            size(a).total_cmp(&size(b))
        });
        let largest = self.before.largest;
        let is_within = largest.is_some_and(|off| off.deviation_um.abs() <= self.tolerance_um());
        let verdict = match (largest, is_within, &worst) {
            (None, ..) => both!("NO RADIUS", "НЕТ РАДИУСА"),
            (_, true, _) => both!("WITHIN TOLERANCE", "В ДОПУСКЕ"),
            (_, false, None) => both!("DEVIATES", "ОТКЛОНЕНИЕ"),
            (_, false, Some((_, form))) => form.lead().word(),
        };
        let wrong = largest.map_or_else(
            || both!("The program turns faces only: no radius can be shown", "Программа точит только торцы: радиус показать нельзя"),
            |off| {
                both!(
                    "The turned surface is up to {} \u{b5}m off the programmed one, Z {} mm from the chuck; the tolerance is {} \u{b5}m",
                    "Обточенная поверхность отходит от заданной до {:#} мкм, Z {:#} мм от торца патрона; допуск {:#} мкм",
                    um(off.deviation_um.abs()),
                    mm(off.z_mm),
                    um(self.tolerance_um())
                )
            },
        );
        let (machine, name) = (&self.facts.settings.profile.name, file::without_folders(self.facts.name));
        out.muted(&Text::same(format!("{machine}, {name}")));
        out.verdict(&verdict, &wrong);
        if let Some((cylinder, form)) = worst {
            out.p(&what(cylinder.stretch, form));
        }
        self.gain(out, worst.map(|(cylinder, _)| cylinder));
        out.p(&self.kept());
        out.muted(&Origin::of(&self.facts.settings.profile).said());
    }

    /// What a correction will bring.
    fn gain(&self, out: &mut Body, worst: Option<&Cylinder<'_>>) {
        match (self.correction, self.after.as_ref().and_then(|after| after.largest)) {
            (Correction::Turned(_), Some(off)) => {
                let mut text = both!(
                    "Corrected by vpost the surface is up to {} \u{b5}m off, Z {} mm.",
                    "После исправления программы поверхность отходит до {:#} мкм, Z {:#} мм.",
                    um(off.deviation_um.abs()),
                    mm(off.z_mm)
                );
                if let Some(after) = worst.and_then(|worst| worst.after) {
                    let [size, cone, bend] = [after.size_um, after.cone_um, after.straightness_um].map(um);
                    text.push(&both!(
                        " That cylinder: diameter {size} \u{b5}m off, cone {cone} \u{b5}m, straightness {bend} \u{b5}m.",
                        " Этот цилиндр: диаметр отходит на {size:#} мкм, конусообразность {cone:#} мкм, прямолинейность образующей {bend:#} мкм."
                    ));
                }
                out.p(&text);
            }
            (Correction::Turned(_), None) => {}
            (Correction::Unchanged, _) => out.p(&both!(
                "The program needs no correction within the tolerance.",
                "В пределах допуска программу исправлять не нужно."
            )),
            (Correction::Refused(failure), _) => {
                out.p(&both!(
                    "vpost does not correct this program, so that nothing is gained until that is settled:",
                    "vpost эту программу не исправляет; пока это не улажено, улучшения не будет:"
                ));
                let message = Wording::plain().quiet().speaking(out.language()).text(failure);
                out.lines(&message.lines().map(shown).collect::<Vec<_>>().join("\n"));
            }
        }
    }

    /// What no correction of X and Z changes.
    fn kept(&self) -> Text {
        let places = || self.turned.places.iter();
        let roundness = places().map(|place| place.roundness_um).fold(0.0, f64::max);
        let mut text = both!(
            "Roundness (RONt, least squares) is up to {} \u{b5}m: it comes from the spindle, and moving X and Z along the part does not change it.",
            "Отклонение от круглости (RONt, по средней окружности) до {:#} мкм: оно идёт от шпинделя, перемещения X и Z его не меняют.",
            um(roundness)
        );
        let asynchronous_um = self.turned.asynchronous_um;
        if asynchronous_um > 0.0 {
            text.push(&both!(
                " On top of all this comes what the spindle does not repeat, a band of {} \u{b5}m.",
                " Ко всему добавляется то, что шпиндель не повторяет, — полоса {:#} мкм.",
                um(asynchronous_um)
            ));
        }
        text
    }

    fn cylinder_table(&self, out: &mut Body) {
        let cylinders = self.cylinders();
        if cylinders.is_empty() {
            out.p(&both!(
                "No stretch of one radius is three places long.",
                "Участков одного радиуса длиной в три места нет."
            ));
            return;
        }
        let pair = |before: Option<f64>, after: Option<f64>| match (before.map(um), after.map(um)) {
            (Some(before), Some(after)) => Text::join([&before, &after], " \u{2192} "),
            (before, _) => before.unwrap_or(Text::same("\u{2014}")),
        };
        let of = |get: fn(&Form) -> f64| {
            move |c: &&Cylinder<'_>| pair(c.before.as_ref().map(get), c.after.as_ref().map(get))
        };
        let both = |get: fn(&Stretch) -> f64| {
            move |c: &&Cylinder<'_>| pair(Some(get(c.stretch)), c.corrected.map(get))
        };
        let table = Table::of(&cylinders)
            .numbers(both!("\u{d8}, mm", "\u{d8}, мм"), |c| mm(2.0 * c.stretch.nominal_radius_mm))
            .numbers(both!("Z, mm", "Z, мм"), |c| from_to(c.stretch.from_z_mm, c.stretch.to_z_mm))
            .numbers(both!("size, \u{b5}m", "размер, мкм"), of(|form| form.size_um))
            .numbers(both!("cone", "конус"), of(|form| form.cone_um))
            .numbers(both!("barrel", "бочка"), of(|form| form.barrel_um))
            .numbers(both!("straightness", "прямолинейность"), of(|form| form.straightness_um))
            .numbers(Text::same("CYLt"), both(|stretch| stretch.cylindricity_um))
            .numbers(both!("CYLt, zone", "CYLt, зона"), both(|stretch| stretch.cylindricity_zone_um));
        out.table(&table);
        out.muted(&both!(
            "Before and, behind the arrow, after the correction. Size: mean deviation of the diameter. Cone: growth of the diameter from the end at the chuck to the other. Barrel: diameter in the middle less that at both ends, a saddle below zero. Straightness of the generatrix about its least-squares line, on the radius. CYLt: cylindricity by least squares and by the minimum zone (ISO 12180), spindle included.",
            "До исправления и, за стрелкой, после него. Размер: среднее отклонение диаметра. Конус: рост диаметра от конца у патрона к другому. Бочка: диаметр в середине минус диаметр на концах, ниже нуля — седло. Прямолинейность образующей относительно её средней линии, по радиусу. CYLt: отклонение от цилиндричности по среднему цилиндру и по минимальной зоне (ISO 12180), вместе со шпинделем."
        ));
    }

    fn roughness(&self, out: &mut Body) {
        let ridges = ridges(&self.turned.places);
        if ridges.is_empty() {
            out.p(&both!(
                "Not known: it needs a feed a turn in the program and the nose of the tool in the profile (noses).",
                "Неизвестна: нужны подача на оборот в программе и радиус при вершине в профиле (noses)."
            ));
            return;
        }
        let table = Table::of(ridges)
            .numbers(both!("Z, mm", "Z, мм"), |ridge| from_to(ridge.z_mm[0], ridge.z_mm[1]))
            .numbers(both!("feed f, mm a turn", "подача f, мм/об"), |ridge| mm(ridge.feed_mm))
            .numbers(both!("nose r, mm", "радиус r, мм"), |ridge| mm(ridge.nose_mm))
            .numbers(both!("exact, \u{b5}m", "точно, мкм"), |ridge| or_dash(ridge.exact_um, um))
            .numbers(both!("f\u{b2}/8r, \u{b5}m", "f\u{b2}/8r, мкм"), |ridge| um(ridge.usual_um))
            .numbers(both!("difference", "разница"), |ridge| {
                let more = |exact: f64| number(100.0 * (exact / ridge.usual_um - 1.0));
                let percent = Text::same("%");
                ridge.exact_um.map_or(Text::EMPTY, |exact| Text::join([&more(exact), &percent], " "))
            });
        out.table(&table);
        out.muted(&both!(
            "Height of the ridge that the nose leaves between two turns, the geometry alone; a dash where the nose does not meet its own cut of the turn before.",
            "Высота гребешка, который вершина оставляет между двумя оборотами, только геометрия; прочерк там, где вершина не встречает свой след прошлого оборота."
        ));
    }

    fn roundness(&self, out: &mut Body) {
        out.side(|out| self.sections.iter().for_each(|drawn| drawn.figure(out, &self.sections)));
        let zones = Table::of(&self.sections)
            .numbers(both!("Z, mm", "Z, мм"), |drawn| mm(drawn.z_mm))
            .numbers(both!("RONt, \u{b5}m", "RONt, мкм"), |drawn| um(drawn.roundness_um))
            .numbers(both!("RONt, zone", "RONt, зона"), |drawn| um(drawn.roundness_zone_um))
            .numbers(both!("eccentric X", "эксцентриситет X"), |drawn| um(drawn.centre_um[0]))
            .numbers(both!("eccentric Y", "эксцентриситет Y"), |drawn| um(drawn.centre_um[1]));
        out.table(&zones);
        out.heading(&both!("Harmonics", "Гармоники"));
        let mut waves = Table::of(2..=HIGHEST_WAVE)
            .numbers(both!("waves a turn", "волн на оборот"), |order| {
                Text::same(order.to_string())
            });
        for drawn in &self.sections {
            let z = mm(drawn.z_mm);
            waves = waves.numbers(both!("Z {z}, \u{b5}m", "Z {z:#}, мкм"), |order| drawn.wave(*order));
        }
        out.table(&waves);
        out.muted(&both!(
            "Amplitude, half of what the wave spans, and in degrees where its crest lies, from X+ of the workpiece. One wave a turn is the centre: eccentricity, and no roundness.",
            "Амплитуда, половина размаха волны, и место её вершины в градусах от X+ детали. Одна волна на оборот — это центр: эксцентриситет, а не круглость."
        ));
    }

    fn provenance(&self) -> Vec<Fact> {
        let Facts { name, text, settings, .. } = self.facts;
        let (places, apart) = (self.turned.places.len(), mm(self.surface.step_mm));
        let program = Some(blake3::hash(text).to_string());
        let mut all = vec![
            Fact::file(both!("program", "программа"), name, program),
            Fact::same(both!("lathe", "станок"), &settings.profile.name),
            Fact::file(PROFILE, &settings.profile_name, Some(settings.profile_hash.to_string())),
            Fact::new(
                both!("places along Z", "места вдоль Z"),
                &both!("{places}, {apart} mm apart", "{places}, {apart:#} мм друг от друга"),
            ),
        ];
        all.extend(Origin::of(&settings.profile).facts());
        all
    }
}

/// A stretch along Z.
fn from_to(from_mm: f64, to_mm: f64) -> Text {
    Text::join([&mm(from_mm), &mm(to_mm)], " \u{2026} ")
}

/// The cylinder of the corrected part on that of the program: places at a shoulder may belong to another.
fn same<'t>(stretch: &Stretch, all: &'t [Stretch]) -> Option<&'t Stretch> {
    all.iter().find(|other| {
        (other.nominal_radius_mm - stretch.nominal_radius_mm).abs() < 1e-6
            && other.from_z_mm <= stretch.to_z_mm
            && stretch.from_z_mm <= other.to_z_mm
    })
}

/// What is wrong with a cylinder.
fn what(stretch: &Stretch, form: Form) -> Text {
    let diameter = mm(2.0 * stretch.nominal_radius_mm);
    let (from, to) = (mm(stretch.from_z_mm), mm(stretch.to_z_mm));
    let most = form.says();
    both!(
        "The worst cylinder is \u{d8} {diameter}, Z {from} to {to}: {most}.",
        "Худший цилиндр \u{d8} {diameter:#}, Z от {from:#} до {to:#}: {most:#}."
    )
}
