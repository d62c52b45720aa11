//! Wear offsets of X, for who may change offsets only: what one number per tool takes off the radius, and what it
//! leaves.

use std::fmt::Write;

use machine_model::Vector;

use crate::figures::fixed;
use crate::settings::Settings;
use jobs::turned::judged::Outline;
use jobs::turned::surface::{Surface, Turned};

/// The smallest largest deviation that one offset leaves, of some places.
struct Offset {
    /// Added to the radius by the machine in the middle of what it does, µm.
    middle_um: f64,
    /// Largest before, largest after, µm.
    largest_um: [f64; 2],
}

impl Offset {
    /// Least largest: half way between the extremes.
    fn of(deviations_um: &[f64]) -> Option<Self> {
        let low = deviations_um.iter().copied().fold(f64::INFINITY, f64::min);
        let high = deviations_um.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (low <= high).then(|| Self {
            middle_um: 0.5 * (low + high),
            largest_um: [low.abs().max(high.abs()), 0.5 * (high - low)],
        })
    }
}

/// The list as CSV: a row for each tool, and one for each cylinder that it cuts.
///
/// What is to be added to the wear of X, for controls that take it as a radius and for those that take a diameter, each
/// rounded to the control's step; a bore's sign is the same, for it is the radius that is to move.
pub(super) fn list(surface: &Surface, turned: &Turned, settings: &Settings) -> String {
    let outline = Outline::of(surface, turned);
    let step_mm = settings.profile.resolution_mm[0];
    let rounded = |mm: f64| if step_mm > 0.0 { (mm / step_mm).round() * step_mm } else { mm };
    let mut out = String::from(
        "tool,from_z_mm,to_z_mm,diameter_mm,wear_radius_mm,wear_diameter_mm,largest_before_um,largest_after_um\n",
    );
    let mut tools: Vec<Vector> = Vec::new();
    for place in &turned.places {
        if !tools.contains(&place.command.tool_mm) {
            tools.push(place.command.tool_mm);
        }
    }
    for tool_mm in tools {
        let name = settings.setup.tools.iter().find(|(_, length)| -Vector::from(*length) == tool_mm);
        let name = name.map_or_else(|| "-".to_owned(), |(number, _)| format!("H{number}"));
        let own = |[from, to]: [f64; 2]| -> Vec<(f64, f64)> {
            let places = turned.places.iter().filter(|place| place.command.tool_mm == tool_mm);
            let inside = places.filter(|place| (from - 1e-6..=to + 1e-6).contains(&place.z_mm));
            inside.filter_map(|place| Some((place.z_mm, outline.deviations_um[place.place]?))).collect()
        };
        let mut row = |places: &[(f64, f64)], diameter: String| {
            let deviations: Vec<f64> = places.iter().map(|(_, um)| *um).collect();
            let (Some(offset), Some(first), Some(last)) =
                (Offset::of(&deviations), places.first(), places.last())
            else {
                return;
            };
            // Writing to a String cannot fail.
            let _ = writeln!(
                out,
                "{name},{},{},{diameter},{},{},{},{}",
                fixed(first.0, 3),
                fixed(last.0, 3),
                fixed(rounded(-offset.middle_um * 1e-3), 4),
                fixed(rounded(-2.0 * offset.middle_um * 1e-3), 4),
                fixed(offset.largest_um[0], 3),
                fixed(offset.largest_um[1], 3)
            );
        };
        row(&own([f64::NEG_INFINITY, f64::INFINITY]), String::new());
        for cylinder in &turned.cylinders {
            row(&own([cylinder.from_z_mm, cylinder.to_z_mm]), fixed(2.0 * cylinder.nominal_radius_mm, 3));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_offset_leaves_half_of_what_the_places_differ_by() {
        let offset = Offset::of(&[3.0, -1.0, 2.0]).expect("places");
        assert_eq!((offset.middle_um, offset.largest_um), (1.0, [3.0, 2.0]));
        assert!(Offset::of(&[]).is_none());
    }
}
