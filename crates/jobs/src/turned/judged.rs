//! How far a surface leaves the programmed one, and what kind of deviation that is.

use diagnostic::{Text, both};
use report::numbers::figures;
pub use report::numbers::number as um;

use super::surface::{Place, Surface, Turned};

/// Where the surface is how far off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Off {
    /// From the chuck, mm.
    pub z_mm: f64,
    /// Square to the programmed surface, outwards, µm.
    pub deviation_um: f64,
}

/// The surface where it has a radius.
pub struct Outline {
    /// By place of the grid: square to the programmed surface, outwards, µm.
    pub deviations_um: Vec<Option<f64>>,
    /// The largest.
    pub largest: Option<Off>,
}

impl Outline {
    /// Of what was turned, against what was programmed.
    ///
    /// `(r − r_p)/√(1 + r_p'²)` with the slope of the programmed outline: the distance from it to first order.
    pub fn of(surface: &Surface, turned: &Turned) -> Self {
        let mut outline = Self { deviations_um: vec![None; surface.nominal_mm().len()], largest: None };
        for found in &turned.places {
            let Some(slope) = surface.slope(found.place) else { continue };
            let deviation_um = found.radius_error_um / (1.0 + slope * slope).sqrt();
            outline.deviations_um[found.place] = Some(deviation_um);
            if outline.largest.is_none_or(|largest| deviation_um.abs() > largest.deviation_um.abs()) {
                outline.largest = Some(Off { z_mm: found.z_mm, deviation_um });
            }
        }
        outline
    }

    /// Of a cylinder, both ends included; nothing where fewer than three places have a radius.
    pub fn form(&self, surface: &Surface, [from_mm, to_mm]: [f64; 2]) -> Option<Form> {
        let places = self.deviations_um.iter().enumerate();
        let inside = places.filter_map(|(place, deviation)| Some((surface.z_mm(place), (*deviation)?)));
        let rows: Vec<(f64, f64)> =
            inside.filter(|(z, _)| (from_mm - 1e-6..=to_mm + 1e-6).contains(z)).collect();
        Form::of(&rows)
    }
}

/// The generatrix of a cylinder against the programmed one (GOST 24642: deviations of the longitudinal profile).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Form {
    /// Mean deviation of the diameter, µm.
    pub size_um: f64,
    /// Growth of the diameter from the end at the chuck to the other, µm.
    pub cone_um: f64,
    /// Diameter in the middle less that at both ends, the cone taken off, µm: a barrel above zero, a saddle below.
    pub barrel_um: f64,
    /// Straightness of the generatrix: what lies about its least-squares line, on the radius, µm (ISO 12780).
    pub straightness_um: f64,
}

impl Form {
    /// Least squares of a line and of a parabola through z, mm, and deviations of the radius, µm.
    pub fn of(rows: &[(f64, f64)]) -> Option<Self> {
        if rows.len() < 3 {
            return None;
        }
        let count = rows.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| rows.iter().map(of).sum::<f64>() / count;
        let (low, high) = (rows[0].0, rows[rows.len() - 1].0);
        let half_mm = 0.5 * (high - low);
        let u = |row: &(f64, f64)| (row.0 - low) / half_mm - 1.0;
        // Places lie evenly, so that line and parabola are orthogonal once each has lost its mean.
        let middle = mean(&u);
        let line = |row: &(f64, f64)| u(row) - middle;
        let size = mean(&|row| row.1);
        let slope = mean(&|row| line(row) * row.1) / mean(&|row| line(row) * line(row));
        let square = mean(&|row| line(row) * line(row));
        let bow = |row: &(f64, f64)| line(row) * line(row) - square;
        let bows = mean(&|row| bow(row) * bow(row));
        let curve = mean(&|row| bow(row) * row.1) / bows;
        let left = |row: &(f64, f64)| row.1 - size - slope * line(row);
        let highest = rows.iter().map(left).fold(f64::NEG_INFINITY, f64::max);
        let lowest = rows.iter().map(left).fold(f64::INFINITY, f64::min);
        Some(Self {
            size_um: 2.0 * size,
            cone_um: 4.0 * slope,
            barrel_um: -2.0 * curve,
            straightness_um: highest - lowest,
        })
    }

    /// The largest of its parts.
    pub fn lead(&self) -> Lead {
        let (size, cone, form) = (self.size_um.abs(), self.cone_um.abs(), 2.0 * self.straightness_um);
        if size >= cone.max(form) {
            Lead::Size
        } else if cone >= form {
            Lead::Cone
        } else if self.barrel_um.abs() < self.straightness_um {
            Lead::Other
        } else if self.barrel_um > 0.0 {
            Lead::Barrel
        } else {
            Lead::Saddle
        }
    }

    /// What is wrong, as a clause about the cylinder.
    pub fn says(&self) -> Text {
        let size = um(self.size_um.abs());
        match self.lead() {
            Lead::Size if self.size_um > 0.0 => {
                both!(
                    "its diameter is {size} \u{b5}m too large",
                    "его диаметр больше заданного на {size:#} мкм"
                )
            }
            Lead::Size => {
                both!(
                    "its diameter is {size} \u{b5}m too small",
                    "его диаметр меньше заданного на {size:#} мкм"
                )
            }
            Lead::Cone if self.cone_um > 0.0 => both!(
                "it is a cone, {} \u{b5}m thicker on the diameter at the end away from the chuck",
                "он конусный, у дальнего от патрона конца толще на {:#} мкм по диаметру",
                um(self.cone_um)
            ),
            Lead::Cone => both!(
                "it is a cone, {} \u{b5}m thicker on the diameter at the chuck",
                "он конусный, у патрона толще на {:#} мкм по диаметру",
                um(-self.cone_um)
            ),
            Lead::Barrel => both!(
                "it is a barrel, {} \u{b5}m thicker on the diameter in the middle",
                "он бочкообразный, в середине толще на {:#} мкм по диаметру",
                um(self.barrel_um)
            ),
            Lead::Saddle => both!(
                "it is a saddle, {} \u{b5}m thinner on the diameter in the middle",
                "он седлообразный, в середине тоньше на {:#} мкм по диаметру",
                um(-self.barrel_um)
            ),
            Lead::Other => both!(
                "its generatrix leaves a straight line by {} \u{b5}m on the radius",
                "его образующая отходит от прямой на {:#} мкм по радиусу",
                um(self.straightness_um)
            ),
        }
    }
}

impl Lead {
    /// In a word.
    pub fn word(self) -> Text {
        match self {
            Lead::Size => both!("SIZE", "РАЗМЕР"),
            Lead::Cone => both!("CONE", "КОНУСООБРАЗНОСТЬ"),
            Lead::Barrel => both!("BARREL", "БОЧКООБРАЗНОСТЬ"),
            Lead::Saddle => both!("SADDLE", "СЕДЛООБРАЗНОСТЬ"),
            Lead::Other => both!("GENERATRIX", "ОБРАЗУЮЩАЯ"),
        }
    }
}

/// What most of a cylinder's deviation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lead {
    /// Its diameter.
    Size,
    /// The diameter grows along Z.
    Cone,
    /// Thicker in the middle.
    Barrel,
    /// Thinner in the middle.
    Saddle,
    /// The generatrix is bent in another way.
    Other,
}

/// Stretches of one theoretical roughness.
pub struct Ridge {
    /// Where it is, mm.
    pub z_mm: [f64; 2],
    /// Feed for each turn, mm.
    pub feed_mm: f64,
    /// Radius of the nose, mm.
    pub nose_mm: f64,
    /// Height of the ridge, µm; none where the nose does not meet its own cut.
    pub exact_um: Option<f64>,
    /// The same by the usual formula, f²/8r, µm.
    pub usual_um: f64,
}

/// Ridges along Z; places whose feed or nose is not known are left out.
pub fn ridges(places: &[Place]) -> Vec<Ridge> {
    let mut out: Vec<(usize, Ridge)> = Vec::new();
    for found in places {
        let Some(([feed_mm, nose_mm], usual_um)) = found.ridge_mm.zip(found.roughness_usual_um) else {
            continue;
        };
        match out.last_mut() {
            Some((last, ridge))
                if *last + 1 == found.place && [ridge.feed_mm, ridge.nose_mm] == [feed_mm, nose_mm] =>
            {
                ridge.z_mm[1] = found.z_mm;
                *last = found.place;
            }
            _ => {
                let z_mm = [found.z_mm; 2];
                let ridge = Ridge { z_mm, feed_mm, nose_mm, exact_um: found.roughness_um, usual_um };
                out.push((found.place, ridge));
            }
        }
    }
    out.into_iter().map(|(_, ridge)| ridge).collect()
}

/// A place, mm.
pub fn mm(value: f64) -> Text {
    figures(crate::figures::short(value, 3).replacen('-', "\u{2212}", 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(of: impl Fn(f64) -> f64) -> Form {
        let rows: Vec<(f64, f64)> =
            (0..=200).map(|k| 50.0 + f64::from(k)).map(|z| (z, of((z - 150.0) / 100.0))).collect();
        Form::of(&rows).expect("a form")
    }

    #[test]
    fn parts_of_a_deviation_are_those_of_the_diameter() {
        // Radii: 3 µm too large, growing by 10 µm over the length, 4 µm thicker in the middle than at the ends.
        let found = form(|u| 3.0 + 5.0 * u - 4.0 * (u * u - 1.0 / 3.0));
        assert!((found.size_um - 6.0).abs() < 0.1, "{found:?}");
        assert!((found.cone_um - 20.0).abs() < 1e-9, "{found:?}");
        assert!((found.barrel_um - 8.0).abs() < 1e-9, "{found:?}");
        assert!((found.straightness_um - 4.0).abs() < 1e-9, "{found:?}");
        assert_eq!(found.lead(), Lead::Cone);
    }

    #[test]
    fn each_part_leads_where_it_is_the_largest() {
        assert_eq!(form(|u| 9.0 + u).lead(), Lead::Size);
        assert_eq!(form(|u| 1.0 - 5.0 * (u * u - 1.0 / 3.0)).lead(), Lead::Barrel);
        assert_eq!(form(|u| 1.0 + 5.0 * (u * u - 1.0 / 3.0)).lead(), Lead::Saddle);
        let waves = form(|u| 5.0 * units::math::cos(20.0 * u));
        assert_eq!(waves.lead(), Lead::Other, "{waves:?}");
        assert_eq!(Form::of(&[(0.0, 1.0), (1.0, 1.0)]), None);
    }
}
