//! What a lathe turns as one page: the outline, its roundness, its roughness, and what a correction will bring.

use diagnostic::{Language, Text, both, say};
use maud::{Markup, html};
use report::page::{Page, Section, table_of};
use report::text::{Numbers, number, shown};
use serde::Serialize;
use turning::Lathe;

use super::judged::{Form, Outline, mm, ridges, um};
use super::surface::{HIGHEST_WAVE, Stretch, Surface, Turned};
use crate::file;
use crate::message::{Failure, Wording};
use crate::origin::Origin;
use crate::settings::Settings;

mod outline;
mod round;

use round::Drawn;

/// What the main job makes of the program.
pub(super) enum Correction {
    /// What the lathe turns by the corrected one.
    Turned(Turned),
    /// Nothing to correct.
    Unchanged,
    /// It is refused, for this.
    Refused(Failure),
}

/// What the page is made of besides the surface.
pub(super) struct Facts<'a> {
    /// The program, as it is called.
    pub(super) name: &'a str,
    /// Its bytes.
    pub(super) text: &'a [u8],
    pub(super) settings: &'a Settings,
    /// Z of the cross sections that are wanted, from the chuck, mm.
    pub(super) at_mm: &'a [f64],
}

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

/// All that the sections are made of.
struct Shown<'a> {
    language: Language,
    facts: &'a Facts<'a>,
    surface: &'a Surface,
    turned: &'a Turned,
    correction: &'a Correction,
    before: Outline,
    after: Option<Outline>,
    sections: Vec<Drawn>,
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
    let page = Shown {
        language,
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
        tolerance_um: page.tolerance_um(),
        sections: &page.sections,
        corrected: page.corrected(),
    };
    let json = serde_json::to_string(&numbers).expect("plain values always serialise");
    let title =
        page.say(&both!("Turned \u{2013} {}", "Точение \u{2014} {}", file::without_folders(facts.name)));
    let made = Page {
        language,
        title: &title,
        head: page.head(),
        sections: page.sections(),
        json: &json,
        command: "predict --lathe",
        schema: "vpost.turned/1",
    };
    Ok(made.into_html())
}

impl Shown<'_> {
    fn say(&self, text: &Text) -> String {
        self.language.prose(text)
    }

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
    fn head(&self) -> Markup {
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
                    "Обточенная поверхность отходит от заданной до {} мкм, Z {} мм от торца патрона; допуск {} мкм",
                    um(off.deviation_um.abs()),
                    mm(off.z_mm),
                    um(self.tolerance_um())
                )
            },
        );
        html! {
            p.muted { (shown(&self.facts.settings.profile.name)) ", " (shown(file::without_folders(self.facts.name))) }
            p { span.verdict { (self.say(&verdict)) } }
            h1 { (self.say(&wrong)) }
            @if let Some((cylinder, form)) = worst { p { (self.say(&what(cylinder.stretch, form))) } }
            (self.gain(worst.map(|(cylinder, _)| cylinder)))
            p { (self.say(&self.kept())) }
            (Origin::of(&self.facts.settings.profile).line(self.language))
        }
    }

    /// What a correction will bring.
    fn gain(&self, worst: Option<&Cylinder<'_>>) -> Markup {
        match (self.correction, self.after.as_ref().and_then(|after| after.largest)) {
            (Correction::Turned(_), Some(off)) => {
                let mut text = both!(
                    "Corrected by vpost the surface is up to {} \u{b5}m off, Z {} mm.",
                    "После исправления программы поверхность отходит до {} мкм, Z {} мм.",
                    um(off.deviation_um.abs()),
                    mm(off.z_mm)
                );
                if let Some(after) = worst.and_then(|worst| worst.after) {
                    text.push(&both!(
                        " That cylinder: diameter {} \u{b5}m off, cone {} \u{b5}m, straightness {} \u{b5}m.",
                        " Этот цилиндр: диаметр отходит на {} мкм, конусообразность {} мкм, прямолинейность образующей {} мкм.",
                        um(after.size_um),
                        um(after.cone_um),
                        um(after.straightness_um)
                    ));
                }
                html! { p { (self.say(&text)) } }
            }
            (Correction::Turned(_), None) => html! {},
            (Correction::Unchanged, _) => html! {
                p { (self.say(&both!("The program needs no correction within the tolerance.", "В пределах допуска программу исправлять не нужно."))) }
            },
            (Correction::Refused(failure), _) => html! {
                p { (self.say(&both!(
                    "vpost does not correct this program, so that nothing is gained until that is settled:",
                    "vpost эту программу не исправляет; пока это не улажено, улучшения не будет:"
                ))) }
                div.scroll tabindex="0" { pre { (shown_lines(&Wording::plain().quiet().speaking(self.language).text(failure))) } }
            },
        }
    }

    /// What no correction of X and Z changes.
    fn kept(&self) -> Text {
        let places = || self.turned.places.iter();
        let roundness = places().map(|place| place.roundness_um).fold(0.0, f64::max);
        let mut text = both!(
            "Roundness (RONt, least squares) is up to {} \u{b5}m: it comes from the spindle, and moving X and Z along the part does not change it.",
            "Отклонение от круглости (RONt, по средней окружности) до {} мкм: оно идёт от шпинделя, перемещения X и Z его не меняют.",
            um(roundness)
        );
        let asynchronous_um = self.turned.asynchronous_um;
        if asynchronous_um > 0.0 {
            text.push(&both!(
                " On top of all this comes what the spindle does not repeat, a band of {} \u{b5}m.",
                " Ко всему добавляется то, что шпиндель не повторяет, — полоса {} мкм.",
                um(asynchronous_um)
            ));
        }
        text
    }

    fn sections(&self) -> Vec<Section> {
        let mut out = vec![
            Section {
                id: "outline",
                title: Text::pair("Radius along Z", "Радиус вдоль Z"),
                body: self.outline(),
            },
            Section {
                id: "cylinders",
                title: Text::pair("Cylinders", "Цилиндры"),
                body: self.cylinder_table(),
            },
            Section {
                id: "roundness", title: Text::pair("Roundness", "Круглость"), body: self.roundness()
            },
            Section {
                id: "roughness",
                title: Text::pair("Theoretical roughness", "Теоретическая шероховатость"),
                body: self.roughness(),
            },
        ];
        out.push(Section {
            id: "provenance",
            title: Text::pair("Where this comes from", "Откуда эти данные"),
            body: self.provenance(),
        });
        out
    }

    fn cylinder_table(&self) -> Markup {
        let pair = |before: Option<f64>, after: Option<f64>| match (before, after) {
            (Some(before), Some(after)) => format!("{} \u{2192} {}", um(before), um(after)),
            (Some(before), None) => um(before),
            (None, _) => "\u{2014}".to_owned(),
        };
        let row = |c: &Cylinder<'_>| {
            let of = |get: fn(&Form) -> f64| pair(c.before.as_ref().map(get), c.after.as_ref().map(get));
            vec![
                mm(2.0 * c.stretch.nominal_radius_mm),
                format!("{} \u{2026} {}", mm(c.stretch.from_z_mm), mm(c.stretch.to_z_mm)),
                of(|form| form.size_um),
                of(|form| form.cone_um),
                of(|form| form.barrel_um),
                of(|form| form.straightness_um),
                pair(Some(c.stretch.cylindricity_um), c.corrected.map(|after| after.cylindricity_um)),
                pair(
                    Some(c.stretch.cylindricity_zone_um),
                    c.corrected.map(|after| after.cylindricity_zone_um),
                ),
            ]
        };
        let rows: Vec<Vec<String>> = self.cylinders().iter().map(row).collect();
        if rows.is_empty() {
            return html! { p { (self.say(&both!(
                "No stretch of one radius is three places long.",
                "Участков одного радиуса длиной в три места нет."
            ))) } };
        }
        let header = [
            both!("\u{d8}, mm", "\u{d8}, мм"),
            both!("Z, mm", "Z, мм"),
            both!("size, \u{b5}m", "размер, мкм"),
            both!("cone", "конус"),
            both!("barrel", "бочка"),
            both!("straightness", "прямолинейность"),
            both!("CYLt", "CYLt"),
            both!("CYLt, zone", "CYLt, зона"),
        ];
        html! {
            (table_of(self.language, &header, &[0, 1, 2, 3, 4, 5, 6, 7], &rows))
            p.muted { (self.say(&both!(
                "Before and, behind the arrow, after the correction. Size: mean deviation of the diameter. Cone: growth of the diameter from the end at the chuck to the other. Barrel: diameter in the middle less that at both ends, a saddle below zero. Straightness of the generatrix about its least-squares line, on the radius. CYLt: cylindricity by least squares and by the minimum zone (ISO 12180), spindle included.",
                "До исправления и, за стрелкой, после него. Размер: среднее отклонение диаметра. Конус: рост диаметра от конца у патрона к другому. Бочка: диаметр в середине минус диаметр на концах, ниже нуля — седло. Прямолинейность образующей относительно её средней линии, по радиусу. CYLt: отклонение от цилиндричности по среднему цилиндру и по минимальной зоне (ISO 12180), вместе со шпинделем."
            ))) }
        }
    }

    fn roughness(&self) -> Markup {
        let rows: Vec<Vec<String>> = ridges(&self.turned.places)
            .iter()
            .map(|ridge| {
                let more = ridge.exact_um.map(|exact| 100.0 * (exact / ridge.usual_um - 1.0));
                vec![
                    format!("{} \u{2026} {}", mm(ridge.z_mm[0]), mm(ridge.z_mm[1])),
                    mm(ridge.feed_mm),
                    mm(ridge.nose_mm),
                    ridge.exact_um.map_or_else(|| "\u{2014}".to_owned(), um),
                    um(ridge.usual_um),
                    more.map_or_else(String::new, |percent| format!("{} %", number(percent))),
                ]
            })
            .collect();
        if rows.is_empty() {
            return html! { p { (self.say(&both!(
                "Not known: it needs a feed a turn in the program and the nose of the tool in the profile (noses).",
                "Неизвестна: нужны подача на оборот в программе и радиус при вершине в профиле (noses)."
            ))) } };
        }
        let header = [
            both!("Z, mm", "Z, мм"),
            both!("feed f, mm a turn", "подача f, мм/об"),
            both!("nose r, mm", "радиус r, мм"),
            both!("exact, \u{b5}m", "точно, мкм"),
            both!("f\u{b2}/8r, \u{b5}m", "f\u{b2}/8r, мкм"),
            both!("difference", "разница"),
        ];
        html! {
            (table_of(self.language, &header, &[0, 1, 2, 3, 4, 5], &rows))
            p.muted { (self.say(&both!(
                "Height of the ridge that the nose leaves between two turns, the geometry alone; a dash where the nose does not meet its own cut of the turn before.",
                "Высота гребешка, который вершина оставляет между двумя оборотами, только геометрия; прочерк там, где вершина не встречает свой след прошлого оборота."
            ))) }
        }
    }

    fn roundness(&self) -> Markup {
        let zones: Vec<Vec<String>> = self.sections.iter().map(Drawn::row).collect();
        let header = [
            both!("Z, mm", "Z, мм"),
            both!("RONt, \u{b5}m", "RONt, мкм"),
            both!("RONt, zone", "RONt, зона"),
            both!("eccentric X", "эксцентриситет X"),
            both!("eccentric Y", "эксцентриситет Y"),
        ];
        let mut waves_header = vec![both!("waves a turn", "волн на оборот")];
        waves_header
            .extend(self.sections.iter().map(|drawn| both!("Z {}, \u{b5}m", "Z {}, мкм", mm(drawn.z_mm()))));
        let waves: Vec<Vec<String>> = (2..=HIGHEST_WAVE)
            .map(|order| {
                let cells = self.sections.iter().map(|drawn| drawn.wave(order));
                std::iter::once(order.to_string()).chain(cells).collect()
            })
            .collect();
        let numbers: Vec<usize> = (0..waves_header.len()).collect();
        html! {
            div.side { @for drawn in &self.sections { (drawn.figure(&self.sections, self.language)) } }
            (table_of(self.language, &header, &[0, 1, 2, 3, 4], &zones))
            h3 { (say!(self.language, "Harmonics", "Гармоники")) }
            (table_of(self.language, &waves_header, &numbers, &waves))
            p.muted { (self.say(&both!(
                "Amplitude, half of what the wave spans, and in degrees where its crest lies, from X+ of the workpiece. One wave a turn is the centre: eccentricity, and no roundness.",
                "Амплитуда, половина размаха волны, и место её вершины в градусах от X+ детали. Одна волна на оборот — это центр: эксцентриситет, а не круглость."
            ))) }
        }
    }

    fn provenance(&self) -> Markup {
        let settings = self.facts.settings;
        html! {
            dl {
                dt { (say!(self.language, "program", "программа")) }
                dd { (shown(self.facts.name)) " " span.muted { "BLAKE3 " (blake3::hash(self.facts.text).to_string()) } }
                dt { (say!(self.language, "lathe", "станок")) } dd { (shown(&settings.profile.name)) }
                dt { (say!(self.language, "profile and its tables", "профиль и его таблицы")) }
                dd { (shown(&settings.profile_name)) " " span.muted { "BLAKE3 " (settings.profile_hash.to_string()) } }
                dt { (say!(self.language, "places along Z", "места вдоль Z")) }
                dd { (self.turned.places.len()) ", " (self.language.figures(mm(self.surface.step_mm))) " " (say!(self.language, "mm apart", "мм друг от друга")) }
                (Origin::of(&settings.profile).rows(self.language))
                dt { (say!(self.language, "made by", "создано")) } dd { "vpost " (env!("CARGO_PKG_VERSION")) ", vpost.turned/1" }
            }
            p.muted { (self.say(&both!(
                "The tip counts as a point; the surface is what the lathe's model turns, not what was measured.",
                "Вершина резца считается точкой; поверхность — та, которую точит модель станка, а не измеренная."
            ))) }
        }
    }
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
        "Худший цилиндр \u{d8} {diameter}, Z от {from} до {to}: {most:#}."
    )
}

/// Lines of a message, each made visible.
fn shown_lines(text: &str) -> String {
    text.lines().map(shown).collect::<Vec<_>>().join("\n")
}
