//! The diagnosis of a lathe as one page: what, how sure, what to do, the readings that say so, from what.

use std::path::Path;

use calibration::turning::{Cause, CauseRow};
use diagnostic::{Language, Text, both};
use machine_profile::Profile;
use report::body::{Body, Fact, Table};
use report::chart::{Fitted, Points, fitted};
use report::numbers::{digits, measured, number, prose};
use report::page::Page;
use report::text::opening;

use super::{ProfileFile, Said, meaning, sentence, words};
use crate::diagnose::report::cause_heading;
use crate::file;
use crate::message::Failure;
use crate::origin::{MACHINE, MEASUREMENTS, Origin, PROFILE};

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
    let drawn = Drawn::new(said);
    let title = both!("Parts of a lathe", "Детали токарного станка");
    let mut page = Page::new(language, title, "diagnose", "vpost.diagnosis/1");
    drawn.head(&mut page.head, facts);
    drawn.drawing(page.section("readings", both!("The readings", "Показания")));
    drawn.causes(page.section("causes", both!("Causes", "Причины")));
    drawn.next(page.section("next", both!("What to measure next", "Что измерить дальше")));
    page.provenance(provenance(facts)?);
    Ok(page.into_html(json))
}

/// A text of the terminal as a sentence.
fn opened(text: &Text) -> Text {
    let text = opening(&prose(text));
    both!("{text}.", "{text:#}.")
}

impl<'a> Drawn<'a> {
    fn new(said: &'a Said<'a>) -> Self {
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
        Self { said, gaps_um, is_turned: rows.iter().any(|row| row.angle_rad.is_some()) }
    }

    fn head(&self, out: &mut Body, facts: &Facts<'_>) {
        let found = self.said.found;
        let name = file::name(facts.measurements);
        let (machine, file) = (&facts.profile.name, file::without_folders(&name));
        out.muted(&both!("Parts of {machine}: {file}", "Детали станка {machine}: {file}"));
        let what = found.causes.first().map_or_else(|| meaning(found.verdict), sentence);
        out.verdict(&words(found.verdict), &opening(&prose(&what)));
        if !found.causes.is_empty() {
            out.p(&opened(&meaning(found.verdict)));
        }
        let (rows, [rms, noise]) = (self.said.rows.len(), [found.rms_mm, found.noise_mm].map(um));
        out.p(&both!(
            "The gap is {rms} \u{b5}m RMS on the radius beyond sizes and clampings, {noise} \u{b5}m of it noise ({rows} rows).",
            "Невязка {rms:#} мкм (среднеквадратичное, по радиусу, без размеров и установок), из них шум {noise:#} мкм (строк {rows})."
        ));
        if let Some(last) = found.causes.last() {
            out.p(&both!(
                "With what is found corrected {} \u{b5}m of it is left.",
                "С исправлением найденного от неё остаётся {:#} мкм.",
                um(last.rms_mm[1])
            ));
        }
        if let Some(own) = found.causes.first() {
            out.typed(&prose(&self.said.remedy(own)));
        }
        if let Some(unseen) = found.unseen {
            let (rows, [before, after]) = (unseen.rows, unseen.rms_mm.map(um));
            out.p(&both!(
                "Unseen parts: {before} \u{2192} {after} \u{b5}m RMS ({rows} rows, each part at its own size).",
                "Контрольные детали: {before:#} \u{2192} {after:#} мкм (строк {rows}, каждая деталь при своём размере)."
            ));
        } else {
            out.muted(&both!(
                "No parts were held out: give some with --holdout, or these judge themselves.",
                "Контрольных деталей нет: дайте их ключом --holdout, иначе эти судят сами себя."
            ));
        }
        out.muted(&Origin::of(facts.profile).said());
    }

    fn at(&self, row: &CauseRow) -> f64 {
        if self.is_turned { row.angle_rad.unwrap_or_default().to_degrees() } else { row.z_mm }
    }

    fn drawing(&self, out: &mut Body) {
        let rows = self.said.rows;
        let placed = || rows.iter().zip(&self.gaps_um);
        let series = |series: usize, name: Text| {
            let at = placed().map(|(row, um)| (self.at(row), um[series])).collect();
            (Points { series, at }, name)
        };
        let mut curve: Vec<(f64, f64)> =
            placed().map(|(row, [gap, left])| (self.at(row), gap - left)).collect();
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        let drawn = Fitted {
            label: match self.is_turned {
                true => both!(
                    "angle of the spindle, degrees; radius, \u{b5}m",
                    "угол шпинделя, градусы; радиус, мкм"
                ),
                false => both!("machine Z, mm; radius, \u{b5}m", "Z станка, мм; радиус, мкм"),
            },
            points: vec![
                series(0, both!("measured", "измерено")),
                series(1, both!("left by the causes", "остаётся после причин")),
            ],
            curve: (means(&curve), both!("what the causes make", "что делают причины")),
        };
        let described = both!("{} radii of turned parts", "радиусов обточенных деталей: {}", rows.len());
        let caption = both!(
            "Measured minus commanded radius less what the profile predicts, each part at its own mean: its size is the tool's.",
            "Измеренный минус заданный радиус за вычетом предсказания профиля; каждая деталь при своём среднем: её размер — от инструмента."
        );
        let part = |row: &CauseRow| self.said.parts.also.parts.get(row.part).cloned().unwrap_or_default();
        let readings = Table::of(placed())
            .words(both!("part", "деталь"), |(row, _)| Text::same(part(row)))
            .numbers(both!("Z, mm", "Z, мм"), |(row, _)| number(row.z_mm))
            .numbers(both!("diameter, mm", "диаметр, мм"), |(row, _)| number(row.diameter_mm))
            .numbers(both!("angle, \u{b0}", "угол, \u{b0}"), |(row, _)| {
                row.angle_rad.map_or(Text::EMPTY, |angle| digits(angle.to_degrees(), 1))
            })
            .numbers(both!("radius, \u{b5}m", "радиус, мкм"), |(_, um)| digits(um[0], 2))
            .numbers(both!("left, \u{b5}m", "остаётся, мкм"), |(_, um)| digits(um[1], 2));
        let title = both!("Radii of the parts", "Радиусы деталей");
        out.figure_of(&fitted(out.language(), &title, &described, &drawn), &caption, &readings);
    }

    fn causes(&self, out: &mut Body) {
        let found = self.said.found;
        if found.causes.is_empty() {
            out.p(&opened(&meaning(found.verdict)));
        } else {
            let numbers = found.causes.iter().flat_map(|own| own.numbers.iter().map(move |n| (own, n)));
            let table = Table::of(numbers)
                .words(both!("cause", "причина"), |(own, _)| called(own.cause.id()))
                .words(both!("number", "параметр"), |(_, n)| gap_diagnosis::number_name(n.name))
                .numbers(both!("value", "значение"), |(_, n)| measured(n.value, n.u95)[0].clone())
                .numbers(Text::same("\u{b1} 95 %"), |(_, n)| measured(n.value, n.u95)[1].clone())
                .numbers(both!("RMS before, \u{b5}m", "до, мкм"), |(own, _)| um(own.rms_mm[0]))
                .numbers(both!("after, \u{b5}m", "после, мкм"), |(own, _)| um(own.rms_mm[1]))
                .numbers(both!("chance of noise", "вероятность шума"), |(own, _)| {
                    match own.p < 1e-4 {
                        true => both!("< 0.0001", "< 0,0001"),
                        false => digits(own.p, 4),
                    }
                });
            out.table(&table);
        }
        for own in &found.causes {
            cause_heading(out, &called(own.cause.id()), own.cause.id());
            out.p(&opened(&sentence(own)));
            if !own.rivals.is_empty() {
                let rivals = Text::join(&own.rivals.iter().map(|id| called(id)).collect::<Vec<_>>(), ", ");
                out.p(&both!("It cannot be told from {rivals}.", "Не отличить от: {rivals:#}."));
            }
            out.typed(&prose(&self.said.remedy(own)));
        }
        let asked = Text::join(&found.asked.iter().map(|c| called(c.id())).collect::<Vec<_>>(), ", ");
        out.muted(&both!("These rows could show: {asked}.", "Эти строки могли показать: {asked:#}."));
    }

    fn next(&self, out: &mut Body) {
        out.p(&match self.said.next() {
            Some((text, _)) => {
                let text = prose(&text);
                both!("Measure {text}.", "Измерьте: {text:#}.")
            }
            None => both!(
                "Nothing is open that a further part would settle.",
                "Открытых вопросов, которые решила бы ещё одна деталь, нет."
            ),
        });
    }
}

fn um(mm: f64) -> Text {
    digits(mm * 1e3, 2)
}

/// A cause by its name, in English its id.
fn called(id: &str) -> Text {
    let Some(cause) = Cause::ALL.into_iter().find(|cause| cause.id() == id) else { return Text::same(id) };
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
    Text::new(id.to_owned(), name.to_owned())
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

fn provenance(facts: &Facts<'_>) -> Result<Vec<Fact>, Failure> {
    let file = |name: Text, path: &Path| -> Result<Fact, Failure> {
        let is_read_once = path.as_os_str() == "-";
        let hash = if is_read_once { None } else { Some(blake3::hash(&file::read(path)?).to_string()) };
        Ok(Fact::file(name, &file::name(path), hash))
    };
    let ProfileFile { name, hash } = facts.profile_file;
    let mut all = vec![
        Fact::same(MACHINE, &facts.profile.name),
        Fact::file(PROFILE, name, Some(hash.clone())),
        file(MEASUREMENTS, facts.measurements)?,
    ];
    if let Some(held) = facts.holdout {
        all.push(file(both!("unseen parts", "контрольные детали"), held)?);
    }
    all.extend(Origin::of(facts.profile).facts());
    Ok(all)
}
