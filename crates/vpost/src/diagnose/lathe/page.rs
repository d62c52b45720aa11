//! The page of a lathe's diagnosis: the sections of every diagnosis, and the readings as they were turned.

use calibration::turning::CauseRow;
use diagnostic::{Language, Text, both};
use gap_diagnosis::{Diagnosis, Residual};
use jobs::diagnose::change::Change;
use report::body::{Body, Table};
use report::chart::{Fitted, Points, fitted};
use report::numbers::{digits, number, prose};

use crate::diagnose::report::{self as sections, Facts};

/// What the page is made from.
pub(super) struct Lathe<'a> {
    pub(super) found: &'a Diagnosis,
    pub(super) changes: &'a [Vec<Change>],
    pub(super) rows: &'a [CauseRow],
    /// Their names.
    pub(super) parts: &'a [String],
    pub(super) facts: &'a Facts,
}

impl Lathe<'_> {
    /// The file.
    pub(super) fn html(&self, json: &str, language: Language) -> String {
        let (found, facts) = (self.found, self.facts);
        let mut page = sections::begun(language, found, facts);
        if let Some(own) = found.causes.first() {
            page.head.typed(&prose(&own.remedy));
        }
        sections::gap(&mut page.head, found, facts);
        if !found.residuals.is_empty() {
            self.drawing(page.section("readings", both!("The readings", "Показания")));
        }
        sections::causes(page.section("causes", both!("Causes", "Причины")), found, self.changes);
        sections::next(page.section("next", both!("What to measure next", "Что измерить дальше")), found);
        sections::more(page.provenance(sections::facts(facts)), found);
        page.into_html(json)
    }

    /// Radii at angles are drawn over the turn, diameters along Z.
    fn is_turned(&self) -> bool {
        self.rows.iter().any(|row| row.angle_rad.is_some())
    }

    fn at(&self, row: &CauseRow) -> f64 {
        if self.is_turned() { row.angle_rad.unwrap_or_default().to_degrees() } else { row.z_mm }
    }

    fn drawing(&self, out: &mut Body) {
        let rows = self.rows;
        let is_turned = self.is_turned();
        let placed = || rows.iter().zip(&self.found.residuals);
        let series = |series: usize, name: Text, of: fn(&Residual) -> f64| {
            let at = placed().map(|(row, um)| (self.at(row), of(um))).collect();
            (Points { series, at }, name)
        };
        let mut curve: Vec<(f64, f64)> =
            placed().map(|(row, um)| (self.at(row), um.before_um - um.after_um)).collect();
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        let drawn = Fitted {
            label: match is_turned {
                true => both!(
                    "angle of the spindle, degrees; radius, \u{b5}m",
                    "угол шпинделя, градусы; радиус, мкм"
                ),
                false => both!("machine Z, mm; radius, \u{b5}m", "Z станка, мм; радиус, мкм"),
            },
            points: vec![
                series(0, both!("measured", "измерено"), |um| um.before_um),
                series(1, both!("left by the causes", "остаётся после причин"), |um| {
                    um.after_um
                }),
            ],
            curve: (means(&curve), both!("what the causes make", "что делают причины")),
        };
        let described = both!("{} radii of turned parts", "радиусов обточенных деталей: {}", rows.len());
        let caption = both!(
            "Measured minus commanded radius less what the profile predicts, each part at its own mean: its size is the tool's.",
            "Измеренный минус заданный радиус за вычетом предсказания профиля; каждая деталь при своём среднем: её размер — от инструмента."
        );
        let part = |row: &CauseRow| self.parts.get(row.part).cloned().unwrap_or_default();
        let readings = Table::of(placed())
            .words(both!("part", "деталь"), |(row, _)| Text::same(part(row)))
            .numbers(both!("Z, mm", "Z, мм"), |(row, _)| number(row.z_mm))
            .numbers(both!("diameter, mm", "диаметр, мм"), |(row, _)| number(row.diameter_mm))
            .numbers(both!("angle, \u{b0}", "угол, \u{b0}"), |(row, _)| {
                row.angle_rad.map_or(Text::EMPTY, |angle| digits(angle.to_degrees(), 1))
            })
            .numbers(both!("radius, \u{b5}m", "радиус, мкм"), |(_, um)| digits(um.before_um, 2))
            .numbers(both!("left, \u{b5}m", "остаётся, мкм"), |(_, um)| digits(um.after_um, 2));
        let title = both!("Radii of the parts", "Радиусы деталей");
        out.figure_of(&fitted(out.language(), &title, &described, &drawn), &caption, &readings);
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
