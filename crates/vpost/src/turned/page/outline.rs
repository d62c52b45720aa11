//! The outline along Z: programmed, predicted, after the correction.

use diagnostic::both;
use report::body::{Body, Table};
use report::chart::{Curves, curves_with};
use report::numbers::or_dash;
use report::scale::nice;

use super::shown::Shown;
use jobs::turned::judged::{Outline, mm, um};

/// Places that are drawn, at most: of more that lie between two, the worst.
const MOST_DRAWN: usize = 1500;
/// The largest deviation is drawn as this share of the part's radius.
const SHARE: f64 = 0.12;

impl Shown<'_> {
    pub(super) fn outline(&self, out: &mut Body) {
        let Some(largest) = self.before.largest else {
            return out.p(&both!("No radius is turned.", "Радиус не обточен."));
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
        let predicted = ("s1", both!("predicted", "предсказанный"));
        let mut off_series = vec![predicted.clone()];
        let mut radii_series = vec![("s3", both!("programmed", "заданный")), predicted];
        if let Some(after) = &self.after {
            let corrected = ("s0", both!("after the correction", "после исправления"));
            radii.push(real(after));
            off.push(deviations(after));
            radii_series.push(corrected.clone());
            off_series.push(corrected);
        }
        let language = out.language();
        let panel = |label, values| [Curves { label, at: at.clone(), values }];
        let title = both!("Radius along Z", "Радиус вдоль Z");
        let described = both!(
            "radius up to {} mm, deviations {times} times as large",
            "радиус до {:#} мм, увеличение отклонений {times}\u{d7}",
            mm(radius_mm)
        );
        let label = both!("Z from the chuck, mm; radius, mm", "Z от торца патрона, мм; радиус, мм");
        out.figure(
            &curves_with(language, &title, &described, &panel(label, radii), &radii_series),
            &both!(
                "The outline of the part, its deviations drawn {times} times as large as they are. Faces and shoulders have no radius and are left out.",
                "Контур детали, увеличение отклонений {times}\u{d7}. У торцов и уступов радиуса нет, они пропущены."
            ),
        );
        let title = both!("Deviation along Z", "Отклонение вдоль Z");
        let described = both!(
            "up to {} \u{b5}m at Z {} mm",
            "до {:#} мкм в Z {:#} мм",
            um(largest.deviation_um.abs()),
            mm(largest.z_mm)
        );
        let label =
            both!("Z from the chuck, mm; deviation, \u{b5}m", "Z от торца патрона, мм; отклонение, мкм");
        out.figure_of(
            &curves_with(language, &title, &described, &panel(label, off), &off_series),
            &both!(
                "How far the surface is off the programmed one, square to it and outwards, on the radius.",
                "Насколько поверхность отходит от заданной, по нормали наружу, по радиусу."
            ),
            &self.numbers(&drawn),
        );
    }

    fn numbers<'d>(&self, drawn: &'d [usize]) -> Table<&'d usize> {
        // A table is read, not drawn: a hundred places are enough.
        let step = drawn.len().div_ceil(100).max(1);
        let cell = |outline: &Outline, place: usize| or_dash(outline.deviations_um[place], um);
        let table = Table::of(drawn.iter().step_by(step))
            .numbers(both!("Z, mm", "Z, мм"), |place| mm(self.surface.z_mm(**place)))
            .numbers(both!("programmed radius, mm", "заданный радиус, мм"), |place| {
                or_dash(self.surface.nominal_mm()[**place], mm)
            })
            .numbers(both!("predicted, \u{b5}m off", "предсказано, мкм"), |place| {
                cell(&self.before, **place)
            });
        let Some(after) = &self.after else { return table };
        table.numbers(both!("after the correction", "после исправления"), |place| {
            cell(after, **place)
        })
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
