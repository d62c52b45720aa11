//! The outline along Z: programmed, predicted, after the correction.

use diagnostic::both;
use maud::{Markup, html};
use report::chart::{Curves, curves_with};
use report::page::{figure, table_of};
use report::scale::nice;

use super::super::judged::{Outline, mm, um};
use super::Shown;

/// Places that are drawn, at most: of more that lie between two, the worst.
const MOST_DRAWN: usize = 1500;
/// The largest deviation is drawn as this share of the part's radius.
const SHARE: f64 = 0.12;

impl Shown<'_> {
    pub(super) fn outline(&self) -> Markup {
        let Some(largest) = self.before.largest else {
            return html! { p { (self.say(&both!("No radius is turned.", "Радиус не обточен."))) } };
        };
        let nominal = self.surface.nominal_mm();
        let radius_mm = nominal.iter().flatten().copied().fold(0.0, f64::max);
        let times = match largest.deviation_um.abs() {
            off if off > 1e-3 => nice(0.4 * SHARE * radius_mm * 1e3 / off),
            _ => 1.0,
        };
        let drawn = drawn(&self.before.deviations_um);
        let at: Vec<f64> = drawn.iter().map(|place| self.surface.z_mm(*place)).collect();
        let programmed = |place: usize| nominal[place].unwrap_or(f64::NAN);
        let deviations = |outline: &Outline| -> Vec<f64> {
            drawn.iter().map(|place| outline.deviations_um[*place].unwrap_or(f64::NAN)).collect()
        };
        let real = |outline: &Outline| -> Vec<f64> {
            let off = deviations(outline);
            drawn.iter().zip(off).map(|(place, um)| programmed(*place) + times * um * 1e-3).collect()
        };
        let mut radii = vec![drawn.iter().map(|place| programmed(*place)).collect(), real(&self.before)];
        let mut off = vec![deviations(&self.before)];
        let names = [
            both!("programmed", "заданный"),
            both!("predicted", "предсказанный"),
            both!("after the correction", "после исправления"),
        ]
        .map(|name| self.say(&name));
        let mut radii_series = vec![("s3", names[0].as_str()), ("s1", names[1].as_str())];
        let mut off_series = vec![("s1", names[1].as_str())];
        if let Some(after) = &self.after {
            radii.push(real(after));
            off.push(deviations(after));
            radii_series.push(("s0", names[2].as_str()));
            off_series.push(("s0", names[2].as_str()));
        }
        let along = self.say(&both!("Z from the chuck, mm", "Z от торца патрона, мм"));
        let label = |of: &str| format!("{along}; {of}");
        let in_mm = self.say(&both!("radius, mm", "радиус, мм"));
        let in_um = self.say(&both!("deviation, \u{b5}m", "отклонение, мкм"));
        let panel = |label: String, values| [Curves { label, at: at.clone(), values }];
        let numbers = self.numbers(&drawn);
        html! {
            (figure(
                self.language,
                &curves_with(
                    self.language,
                    &self.say(&both!("Radius along Z", "Радиус вдоль Z")),
                    &self.say(&both!("radius up to {} mm, deviations {times} times as large", "радиус до {} мм, увеличение отклонений {times}\u{d7}", mm(radius_mm))),
                    &panel(label(&in_mm), radii),
                    &radii_series,
                ),
                &self.say(&both!(
                    "The outline of the part, its deviations drawn {times} times as large as they are. Faces and shoulders have no radius and are left out.",
                    "Контур детали, увеличение отклонений {times}\u{d7}. У торцов и уступов радиуса нет, они пропущены."
                )),
                None,
            ))
            (figure(
                self.language,
                &curves_with(
                    self.language,
                    &self.say(&both!("Deviation along Z", "Отклонение вдоль Z")),
                    &self.say(&both!("up to {} \u{b5}m at Z {} mm", "до {} мкм в Z {} мм", um(largest.deviation_um.abs()), mm(largest.z_mm))),
                    &panel(label(&in_um), off),
                    &off_series,
                ),
                &self.say(&both!(
                    "How far the surface is off the programmed one, square to it and outwards, on the radius.",
                    "Насколько поверхность отходит от заданной, по нормали наружу, по радиусу."
                )),
                Some(numbers),
            ))
        }
    }

    fn numbers(&self, drawn: &[usize]) -> Markup {
        // A table is read, not drawn: a hundred places are enough.
        let step = drawn.len().div_ceil(100).max(1);
        let cell = |outline: &Outline, place: usize| {
            outline.deviations_um[place].map_or_else(|| "\u{2014}".to_owned(), um)
        };
        let rows: Vec<Vec<String>> = drawn
            .iter()
            .step_by(step)
            .map(|place| {
                let mut row = vec![
                    mm(self.surface.z_mm(*place)),
                    self.surface.nominal_mm()[*place].map_or_else(|| "\u{2014}".to_owned(), mm),
                    cell(&self.before, *place),
                ];
                row.extend(self.after.as_ref().map(|after| cell(after, *place)));
                row
            })
            .collect();
        let mut header = vec![
            both!("Z, mm", "Z, мм"),
            both!("programmed radius, mm", "заданный радиус, мм"),
            both!("predicted, \u{b5}m off", "предсказано, мкм"),
        ];
        if self.after.is_some() {
            header.push(both!("after the correction", "после исправления"));
        }
        let numbers: Vec<usize> = (0..header.len()).collect();
        table_of(self.language, &header, &numbers, &rows)
    }
}

/// Places to draw: all, or of each group the one that is farthest off.
fn drawn(deviations_um: &[Option<f64>]) -> Vec<usize> {
    let size = deviations_um.len().div_ceil(MOST_DRAWN).max(1);
    let groups = deviations_um.chunks(size).enumerate();
    groups
        .map(|(group, values)| {
            let off = |k: &usize| values[*k].map_or(-1.0, f64::abs);
            let worst = (0..values.len()).max_by(|a, b| off(a).total_cmp(&off(b)).then(b.cmp(a)));
            group * size + worst.unwrap_or(0)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_of_a_group_is_drawn() {
        let mut values = vec![Some(0.0); 3 * MOST_DRAWN];
        values[10] = Some(-7.0);
        values[2] = None;
        let drawn = drawn(&values);
        assert_eq!(drawn.len(), MOST_DRAWN);
        assert_eq!(drawn[..5], [0, 3, 6, 10, 12]);
    }
}
