//! The diagnosis of a lathe as one page: what, how sure, what to do, the readings that say so, from what.

use std::path::Path;

use calibration::turning::{Cause, CauseRow, FoundCause};
use diagnostic::{Language, Text, both, say};
use machine_profile::Profile;
use maud::{Markup, html};
use report::chart::{Fitted, Points, fitted};
use report::page::{Page, Section, figure, table_of};
use report::text::{Numbers, number, number_of_digits, opening, shown, typed};

use super::{ProfileFile, Said, meaning, sentence, words};
use crate::diagnose::report::cause_heading;
use crate::file;
use crate::message::Failure;
use crate::origin::Origin;

/// What the page is made from.
pub(super) struct Facts<'a> {
    pub(super) measurements: &'a Path,
    pub(super) holdout: Option<&'a Path>,
    pub(super) profile: &'a Profile,
    /// Its name as it was given, and the hash of it and its tables.
    pub(super) profile_file: &'a ProfileFile,
}

/// Rows as they are drawn.
struct Drawn<'a> {
    said: &'a Said<'a>,
    language: Language,
    /// By row: the gap and what of it no cause explains, each part at its own mean, µm on the radius.
    gaps_um: Vec<[f64; 2]>,
    /// Radii at angles are drawn over the turn, diameters along Z.
    is_turned: bool,
}

/// The file.
///
/// # Errors
/// A file of measurements that can no longer be read.
pub(super) fn html(
    said: &Said<'_>,
    facts: &Facts<'_>,
    json: &str,
    language: Language,
) -> Result<String, Failure> {
    let drawn = Drawn::new(said, language);
    let sections = vec![
        Section {
            id: "readings", title: Text::pair("The readings", "Показания"), body: drawn.drawing()
        },
        Section { id: "causes", title: Text::pair("Causes", "Причины"), body: drawn.causes() },
        Section {
            id: "next",
            title: Text::pair("What to measure next", "Что измерить дальше"),
            body: drawn.next(),
        },
        Section {
            id: "provenance",
            title: Text::pair("Where this comes from", "Откуда эти данные"),
            body: provenance(facts, language)?,
        },
    ];
    let page = Page {
        language,
        title: &say!(language, "Parts of a lathe", "Детали токарного станка"),
        head: drawn.head(facts),
        sections,
        json,
        command: "diagnose",
        schema: "vpost.diagnosis/1",
    };
    Ok(page.into_html())
}

impl<'a> Drawn<'a> {
    fn new(said: &'a Said<'a>, language: Language) -> Self {
        let rows = said.rows;
        let of = |k: usize| {
            let gap = rows[k].gap_mm * 1e3;
            let explained = said.found.explained_mm.get(k).copied().unwrap_or_default() * 1e3;
            [gap, gap - explained]
        };
        let all: Vec<[f64; 2]> = (0..rows.len()).map(of).collect();
        let gaps_um = (0..rows.len())
            .map(|k| {
                let same = |i: &usize| (rows[*i].part, rows[*i].tool) == (rows[k].part, rows[k].tool);
                let own: Vec<usize> = (0..rows.len()).filter(same).collect();
                let mean = |which: usize| own.iter().map(|i| all[*i][which]).sum::<f64>() / own.len() as f64;
                [0, 1].map(|which| all[k][which] - mean(which))
            })
            .collect();
        Self { said, language, gaps_um, is_turned: rows.iter().any(|row| row.angle_rad.is_some()) }
    }

    fn say(&self, text: &Text) -> String {
        self.language.prose(text)
    }

    fn head(&self, facts: &Facts<'_>) -> Markup {
        let found = self.said.found;
        let what = match found.causes.first() {
            Some(own) => sentence(own),
            None => meaning(found.verdict),
        };
        html! {
            p.muted { (self.say(&both!("Parts of {}: {}", "Детали станка {}: {}", shown(&facts.profile.name), shown(file::without_folders(&file::name(facts.measurements)))))) }
            p { span.verdict { (words(found.verdict).in_language(self.language)) } }
            h1 { (opening(&self.say(&what))) }
            @if !found.causes.is_empty() { p { (opening(&self.say(&meaning(found.verdict)))) "." } }
            p { (self.say(&both!(
                "The gap is {} \u{b5}m RMS on the radius beyond sizes and clampings, {} \u{b5}m of it noise ({} rows).",
                "Невязка {} мкм (среднеквадратичное, по радиусу, без размеров и установок), из них шум {} мкм (строк {}).",
                number_of_digits(found.rms_mm * 1e3, 2),
                number_of_digits(found.noise_mm * 1e3, 2),
                self.said.rows.len()
            ))) }
            @if let Some(last) = found.causes.last() {
                p { (self.say(&both!(
                    "With what is found corrected {} \u{b5}m of it is left.",
                    "С исправлением найденного от неё остаётся {} мкм.",
                    number_of_digits(last.rms_mm[1] * 1e3, 2)
                ))) }
            }
            @if let Some(own) = found.causes.first() { p { (typed(&self.say(&self.said.remedy(own)))) } }
            @match found.unseen {
                Some(unseen) => p { (self.say(&both!(
                    "Unseen parts: {} \u{2192} {} \u{b5}m RMS ({} rows, each part at its own size).",
                    "Контрольные детали: {} \u{2192} {} мкм (строк {}, каждая деталь при своём размере).",
                    number_of_digits(unseen.rms_mm[0] * 1e3, 2),
                    number_of_digits(unseen.rms_mm[1] * 1e3, 2),
                    unseen.rows
                ))) },
                None => p.muted { (self.say(&both!(
                    "No parts were held out: give some with --holdout, or these judge themselves.",
                    "Контрольных деталей нет: дайте их ключом --holdout, иначе эти судят сами себя."
                ))) },
            }
            (Origin::of(facts.profile).line(self.language))
        }
    }

    fn at(&self, row: &CauseRow) -> f64 {
        if self.is_turned { row.angle_rad.unwrap_or_default().to_degrees() } else { row.z_mm }
    }

    fn drawing(&self) -> Markup {
        let rows = self.said.rows;
        let series = |series: usize, name: Text| {
            let at = rows.iter().zip(&self.gaps_um).map(|(row, um)| (self.at(row), um[series])).collect();
            (Points { series, at }, self.say(&name))
        };
        let mut curve: Vec<(f64, f64)> =
            rows.iter().zip(&self.gaps_um).map(|(row, [gap, left])| (self.at(row), gap - left)).collect();
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        let label = if self.is_turned {
            both!("angle of the spindle, degrees; radius, \u{b5}m", "угол шпинделя, градусы; радиус, мкм")
        } else {
            both!("machine Z, mm; radius, \u{b5}m", "Z станка, мм; радиус, мкм")
        };
        let drawn = Fitted {
            label: self.say(&label),
            points: vec![
                series(0, both!("measured", "измерено")),
                series(1, both!("left by the causes", "остаётся после причин")),
            ],
            curve: (means(&curve), self.say(&both!("what the causes make", "что делают причины"))),
        };
        let described =
            self.say(&both!("{} radii of turned parts", "радиусов обточенных деталей: {}", rows.len()));
        let caption = both!(
            "Measured minus commanded radius less what the profile predicts, each part at its own mean: its size is the tool's.",
            "Измеренный минус заданный радиус за вычетом предсказания профиля; каждая деталь при своём среднем: её размер — от инструмента."
        );
        let title = self.say(&both!("Radii of the parts", "Радиусы деталей"));
        let drawing = fitted(self.language, &title, &described, &drawn);
        figure(self.language, &drawing, &self.say(&caption), Some(self.readings()))
    }

    fn readings(&self) -> Markup {
        let row = |(row, um): (&CauseRow, &[f64; 2])| {
            vec![
                self.said.parts.parts.get(row.part).cloned().unwrap_or_default(),
                number(row.z_mm),
                number(row.diameter_mm),
                row.angle_rad.map_or_else(String::new, |angle| number_of_digits(angle.to_degrees(), 1)),
                number_of_digits(um[0], 2),
                number_of_digits(um[1], 2),
            ]
        };
        let rows: Vec<Vec<String>> = self.said.rows.iter().zip(&self.gaps_um).map(row).collect();
        let header = [
            both!("part", "деталь"),
            both!("Z, mm", "Z, мм"),
            both!("diameter, mm", "диаметр, мм"),
            both!("angle, \u{b0}", "угол, \u{b0}"),
            both!("radius, \u{b5}m", "радиус, мкм"),
            both!("left, \u{b5}m", "остаётся, мкм"),
        ];
        table_of(self.language, &header, &[1, 2, 3, 4, 5], &rows)
    }

    fn causes(&self) -> Markup {
        let found = self.said.found;
        let rows: Vec<Vec<String>> = found.causes.iter().flat_map(|own| self.numbers(own)).collect();
        let header = [
            both!("cause", "причина"),
            both!("number", "параметр"),
            both!("value", "значение"),
            both!("\u{b1} 95 %", "\u{b1} 95 %"),
            both!("RMS before, \u{b5}m", "до, мкм"),
            both!("after, \u{b5}m", "после, мкм"),
            both!("chance of noise", "вероятность шума"),
        ];
        html! {
            @if found.causes.is_empty() {
                p { (opening(&self.say(&meaning(found.verdict)))) "." }
            } @else {
                (table_of(self.language, &header, &[2, 3, 4, 5, 6], &rows))
            }
            @for own in &found.causes {
                (cause_heading(&self.called(own.cause.id()), own.cause.id()))
                p { (opening(&self.say(&sentence(own)))) "." }
                @if !own.rivals.is_empty() {
                    p { (self.say(&both!("It cannot be told from {}.", "Не отличить от: {}.", own.rivals.iter().map(|rival| self.called(rival)).collect::<Vec<_>>().join(", ")))) }
                }
                p { (typed(&self.say(&self.said.remedy(own)))) }
            }
            @let asked: Vec<String> = found.asked.iter().map(|cause| self.called(cause.id())).collect();
            p.muted { (self.say(&both!("These rows could show: {}.", "Эти строки могли показать: {}.", asked.join(", ")))) }
        }
    }

    /// A cause by its name, in English its id.
    fn called(&self, id: &str) -> String {
        let known = Cause::ALL.into_iter().find(|cause| cause.id() == id);
        let Some(cause) = known.filter(|_| self.language == Language::Russian) else { return id.to_owned() };
        let name = match cause {
            Cause::Taper => "наклон оси детали",
            Cause::Bending => "прогиб детали",
            Cause::Runout => "биение шпинделя",
            Cause::Growth => "рост передней бабки",
            Cause::Wear => "износ инструмента",
            Cause::Straightness => "прямолинейность EXZ",
            Cause::Scale => "масштаб X",
            Cause::Jaws => "кулачки патрона",
        };
        name.to_owned()
    }

    fn numbers(&self, own: &FoundCause) -> Vec<Vec<String>> {
        let row = |n: &calibration::turning::Number| {
            // The table turns figures into those of its language.
            let [value, spread] = Language::English.measured(n.value, n.u95);
            vec![
                self.called(own.cause.id()),
                gap_diagnosis::number_name(n.name).in_language(self.language).to_owned(),
                value,
                spread,
                number_of_digits(own.rms_mm[0] * 1e3, 2),
                number_of_digits(own.rms_mm[1] * 1e3, 2),
                if own.p < 1e-4 { "< 0.0001".to_owned() } else { number_of_digits(own.p, 4) },
            ]
        };
        own.numbers.iter().map(row).collect()
    }

    fn next(&self) -> Markup {
        let text = match self.said.next() {
            Some((text, _)) => both!("Measure {text}.", "Измерьте: {text:#}."),
            None => both!(
                "Nothing is open that a further part would settle.",
                "Открытых вопросов, которые решила бы ещё одна деталь, нет."
            ),
        };
        html! { p { (self.say(&text)) } }
    }
}

/// The mean of each place, in order.
fn means(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut out: Vec<(f64, f64, f64)> = Vec::new();
    for (at, um) in points {
        match out.last_mut() {
            Some((last, sum, count)) if *last == *at => (*sum, *count) = (*sum + um, *count + 1.0),
            _ => out.push((*at, *um, 1.0)),
        }
    }
    out.into_iter().map(|(at, sum, count)| (at, sum / count)).collect()
}

fn provenance(facts: &Facts<'_>, language: Language) -> Result<Markup, Failure> {
    let named = |path: &Path| -> Result<Markup, Failure> {
        let hash = if path.as_os_str() == "-" { None } else { Some(blake3::hash(&file::read(path)?)) };
        Ok(html! {
            (shown(&file::name(path)))
            @if let Some(hash) = hash { " " span.muted { "BLAKE3 " (hash.to_string()) } }
        })
    };
    let holdout = facts.holdout.map(named).transpose()?;
    Ok(html! {
        dl {
            dt { (say!(language, "machine", "станок")) } dd { (shown(&facts.profile.name)) }
            dt { (say!(language, "profile and its tables", "профиль и его таблицы")) }
            dd { (shown(&facts.profile_file.name)) " " span.muted { "BLAKE3 " (facts.profile_file.hash) } }
            dt { (say!(language, "measurements", "измерения")) } dd { (named(facts.measurements)?) }
            @if let Some(holdout) = holdout {
                dt { (say!(language, "unseen parts", "контрольные детали")) } dd { (holdout) }
            }
            (Origin::of(facts.profile).rows(language))
            dt { (say!(language, "made by", "создано")) }
            dd { "vpost " (env!("CARGO_PKG_VERSION")) ", vpost.diagnosis/1" }
        }
    })
}
