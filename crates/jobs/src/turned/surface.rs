//! The finished surface: what the cuts leave at places along Z.

use machine_model::{Command, Vector};
use machine_profile::Nose;
use serde::Serialize;
use turning::{Cylinder, Lathe, Section, Wave, roughness};

use super::cuts::Cut;
use crate::figures::round;
use crate::settings::Settings;

/// Spindle angles of a section.
pub const ANGLES: usize = 360;
/// Waves a turn that are told apart.
pub const HIGHEST_WAVE: u32 = 8;
/// Places of a path are so far apart at most, as a share of the step along Z.
const SHARE_OF_STEP: f64 = 0.2;
/// Most places along Z.
const MOST_PLACES: usize = 200_000;
/// Programmed radii of one cylinder differ by less, mm: more than a correction, less than a taper that is meant.
const SAME_RADIUS_MM: f64 = 0.02;
/// A radius says something where the surface climbs by less than this, mm per mm: of a face it says nothing.
const STEEPEST: f64 = 2.0;
/// Where the slope changes by more from place to place there is an edge, which belongs to neither side.
const EDGE: f64 = 0.3;
/// Errors of Z move an edge by less than this, mm.
const MOVED_MM: f64 = 0.25;
/// A cylinder is judged by so many sections at most, evenly chosen.
const MOST_SECTIONS: usize = 20;

/// What is asked of a surface.
pub struct Asked {
    /// Distance of its places along Z.
    pub step_mm: f64,
    /// The tool cuts inside: the largest radius counts.
    pub bore: bool,
}

/// A place of the finished surface.
#[derive(Serialize)]
pub struct Place {
    /// From the chuck, mm.
    pub z_mm: f64,
    /// Real.
    pub radius_mm: f64,
    /// Twice that.
    pub diameter_mm: f64,
    /// Programmed.
    pub nominal_radius_mm: f64,
    /// Real less programmed.
    pub radius_error_um: f64,
    /// By the least-squares circle.
    pub roundness_um: f64,
    /// By the minimum zone.
    pub roundness_zone_um: f64,
    /// Theoretical, exact; nothing where the tool's nose is not known or does not meet its own cut.
    pub roughness_um: Option<f64>,
    /// f²/8r.
    pub roughness_usual_um: Option<f64>,
    /// Waves a turn, from 2 on: amplitudes.
    pub waves_um: Vec<f64>,
    /// What cut it.
    #[serde(skip)]
    pub command: Command,
    /// Feed a turn and nose's radius, mm, where both are known.
    #[serde(skip)]
    pub ridge_mm: Option<[f64; 2]>,
    /// Its place on the grid along Z.
    #[serde(skip)]
    pub place: usize,
}

/// A stretch of one programmed radius.
#[derive(Serialize)]
pub struct Stretch {
    /// Its end at the chuck.
    pub from_z_mm: f64,
    /// The other.
    pub to_z_mm: f64,
    /// Programmed.
    pub nominal_radius_mm: f64,
    /// By the least-squares cylinder.
    pub cylindricity_um: f64,
    /// By the minimum zone.
    pub cylindricity_zone_um: f64,
}

/// What a lathe turns by a program.
#[derive(Serialize)]
pub struct Turned {
    schema: &'static str,
    angles: usize,
    /// What the spindle adds from turn to turn.
    pub asynchronous_um: f64,
    /// Stretches of one programmed radius.
    pub cylinders: Vec<Stretch>,
    /// All that have a radius.
    pub places: Vec<Place>,
}

/// What cut a place last: radius, command, and the number of the cut.
type Reached = Option<(f64, Command, usize)>;

/// The finished surface at places along Z.
pub struct Surface {
    /// Distance of the places along Z.
    pub step_mm: f64,
    first_mm: f64,
    bore: bool,
    done: usize,
    real: Vec<Reached>,
    nominal: Vec<Option<f64>>,
}

impl Surface {
    /// Over all that the cuts reach; `None` where they reach nothing, or too much.
    pub fn over(cuts: &[Cut], lathe: &Lathe, asked: &Asked) -> Option<Self> {
        let places = cuts.iter().flat_map(|cut| [0.0, 0.5, 1.0].map(|s| lathe.nominal_mm(&cut.at(s))[1]));
        let (low, high) =
            places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
        let Asked { step_mm, bore } = *asked;
        let first_mm = (low / step_mm).ceil() * step_mm;
        let count = ((high - first_mm) / step_mm).floor() + 1.0;
        (count >= 1.0 && count <= MOST_PLACES as f64).then(|| Self {
            step_mm,
            first_mm,
            bore,
            done: 0,
            real: vec![None; count as usize],
            nominal: vec![None; count as usize],
        })
    }

    /// What a corrected program leaves of the part that this one describes: at the same places, programmed the same.
    pub fn corrected(&self, cuts: &[Cut], lathe: &Lathe) -> Self {
        let real = vec![None; self.real.len()];
        let mut corrected = Self { real, nominal: self.nominal.clone(), done: 0, ..*self };
        cuts.iter().for_each(|cut| corrected.cut(cut, lathe));
        corrected.nominal.clone_from(&self.nominal);
        corrected
    }

    /// Takes away what a cut reaches; the tip counts as a point.
    pub fn cut(&mut self, cut: &Cut, lathe: &Lathe) {
        let pieces =
            (cut.curve.length_mm() / (SHARE_OF_STEP * self.step_mm).min(1.0)).ceil().max(1.0) as usize;
        let number = self.done;
        self.done += 1;
        let places = |k: usize| {
            let command = cut.at(k as f64 / pieces as f64);
            (command, lathe.turned_mm(&command), lathe.nominal_mm(&command))
        };
        let mut before = places(0);
        for k in 1..=pieces {
            let after = places(k);
            let bore = self.bore;
            let better = |new: f64, old: f64| if bore { new > old } else { new < old };
            for (place, share) in self.between(before.1[1], after.1[1]) {
                let radius = before.1[0] + share * (after.1[0] - before.1[0]);
                let linear_mm = before.0.linear_mm + (after.0.linear_mm - before.0.linear_mm) * share;
                if self.real[place].is_none_or(|(old, ..)| better(radius, old)) {
                    self.real[place] = Some((radius, Command { linear_mm, ..after.0 }, number));
                }
            }
            for (place, share) in self.between(before.2[1], after.2[1]) {
                let radius = before.2[0] + share * (after.2[0] - before.2[0]);
                if self.nominal[place].is_none_or(|old| better(radius, old)) {
                    self.nominal[place] = Some(radius);
                }
            }
            before = after;
        }
    }

    /// Places from one Z to another, each with its share of the way.
    fn between(&self, from: f64, to: f64) -> Vec<(usize, f64)> {
        let (low, high) = (from.min(to), from.max(to));
        let first = ((low - self.first_mm) / self.step_mm).ceil().max(0.0) as usize;
        let places = (first..self.real.len()).map(|place| (place, self.z_mm(place)));
        let inside = places.take_while(|(_, z)| *z <= high);
        inside.map(|(place, z)| (place, if to == from { 1.0 } else { (z - from) / (to - from) })).collect()
    }

    /// Slope of the programmed outline at a place; nothing near a face or an edge, nor at an end.
    pub fn slope(&self, place: usize) -> Option<f64> {
        slope(&self.nominal, place, (MOVED_MM / self.step_mm).ceil().max(1.0) as usize, self.step_mm)
    }

    /// Programmed radius at every place of the grid, mm.
    pub fn nominal_mm(&self) -> &[Option<f64>] {
        &self.nominal
    }

    /// From the chuck, mm.
    pub fn z_mm(&self, place: usize) -> f64 {
        self.first_mm + place as f64 * self.step_mm
    }

    /// Radii, roundness, roughness and cylinders.
    pub fn turned(&self, lathe: &Lathe, settings: &Settings, cuts: &[Cut]) -> Turned {
        let mut places = Vec::new();
        let mut cylinders = Vec::new();
        let mut run: Vec<(f64, f64, Section)> = Vec::new();
        for place in 0..self.real.len() {
            let known = self.real[place].zip(self.nominal[place]);
            let Some(((radius_mm, command, number), nominal_radius_mm)) =
                known.filter(|((radius, ..), _)| *radius > lathe.near_axis_mm())
            else {
                cylinders.extend(stretch(&std::mem::take(&mut run)));
                continue;
            };
            let section = lathe.section(&command, ANGLES);
            let (circle, zone) = (section.least_squares(), section.minimum_zone());
            let known = cuts[number].feed_mm.zip(nose(settings, &command));
            let ridge = known.map(|(feed_mm, nose)| roughness(feed_mm, nose.radius_mm, nose.minor_edge_rad));
            let um = |mm: f64| round(mm * 1e3, 6);
            places.push(Place {
                z_mm: round(self.z_mm(place), 6),
                radius_mm: round(radius_mm, 9),
                diameter_mm: round(2.0 * radius_mm, 9),
                nominal_radius_mm: round(nominal_radius_mm, 9),
                radius_error_um: um(radius_mm - nominal_radius_mm),
                roundness_um: um(circle.roundness_mm),
                roundness_zone_um: um(zone.roundness_mm),
                roughness_um: ridge.and_then(|ridge| ridge.exact_mm).map(um),
                roughness_usual_um: ridge.map(|ridge| um(ridge.usual_mm)),
                waves_um: section
                    .waves(HIGHEST_WAVE)
                    .iter()
                    .map(|wave: &Wave| um(wave.amplitude_mm))
                    .collect(),
                command,
                ridge_mm: known.map(|(feed_mm, nose)| [feed_mm, nose.radius_mm]),
                place,
            });
            // Where Z errs an edge's place may be another stretch's.
            if self.slope(place).is_none() {
                cylinders.extend(stretch(&std::mem::take(&mut run)));
                continue;
            }
            if run.first().is_some_and(|(_, radius, _)| (radius - nominal_radius_mm).abs() > SAME_RADIUS_MM) {
                cylinders.extend(stretch(&std::mem::take(&mut run)));
            }
            run.push((self.z_mm(place), nominal_radius_mm, section));
        }
        cylinders.extend(stretch(&run));
        Turned {
            schema: "vpost.turned/1",
            angles: ANGLES,
            asynchronous_um: round(lathe.spindle().asynchronous_mm * 1e3, 6),
            cylinders,
            places,
        }
    }
}

/// The nose of the tool whose vector is in force.
fn nose(settings: &Settings, command: &Command) -> Option<Nose> {
    let lathe = settings.profile.lathe.as_ref()?;
    let tool = settings.setup.tools.iter().find(|(_, length)| -Vector::from(*length) == command.tool_mm)?.0;
    lathe.noses.iter().find(|(number, nose)| *number == tool && nose.radius_mm > 0.0).map(|(_, nose)| *nose)
}

/// Sections of one radius, three or more, as a cylinder.
fn stretch(run: &[(f64, f64, Section)]) -> Option<Stretch> {
    let (first, last) = (run.first()?, run.last()?);
    if run.len() < 3 {
        return None;
    }
    let chosen = run.len().min(MOST_SECTIONS);
    let sections: Vec<Section> =
        (0..chosen).map(|k| run[k * (run.len() - 1) / (chosen - 1)].2.clone()).collect();
    let um = |mm: f64| round(mm * 1e3, 6);
    Some(Stretch {
        from_z_mm: round(first.0, 6),
        to_z_mm: round(last.0, 6),
        nominal_radius_mm: round(first.1, 9),
        cylindricity_um: um(Cylinder::least_squares(&sections).cylindricity_mm),
        cylindricity_zone_um: um(Cylinder::minimum_zone(&sections).cylindricity_mm),
    })
}

fn slope(nominal_mm: &[Option<f64>], place: usize, reach: usize, step_mm: f64) -> Option<f64> {
    let around = nominal_mm.get(place.checked_sub(reach)?..=place + reach)?;
    let radii: Vec<f64> = around.iter().copied().collect::<Option<_>>()?;
    let slopes: Vec<f64> = radii.windows(2).map(|pair| (pair[1] - pair[0]) / step_mm).collect();
    let is_edge = slopes.windows(2).any(|pair| (pair[1] - pair[0]).abs() > EDGE);
    let is_face = slopes.iter().any(|slope| slope.abs() > STEEPEST);
    (!is_edge && !is_face).then(|| 0.5 * (slopes[reach - 1] + slopes[reach]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_and_edges_have_no_radius() {
        let cylinder = |radius: f64| [Some(radius); 4];
        let outline = [cylinder(20.0), cylinder(25.0)].concat();
        let slopes: Vec<Option<f64>> = (0..8).map(|place| slope(&outline, place, 1, 1.0)).collect();
        let flat = Some(0.0);
        assert_eq!(slopes, [None, flat, flat, None, None, flat, flat, None]);
        let cone: Vec<Option<f64>> = (0..5).map(|k| Some(f64::from(k))).collect();
        assert_eq!(slope(&cone, 2, 1, 1.0), Some(1.0));
        let chamfer = [20.0, 20.0, 20.0, 19.0, 18.0].map(Some);
        assert_eq!((slope(&chamfer, 1, 1, 1.0), slope(&chamfer, 2, 1, 1.0)), (Some(0.0), None));
        assert_eq!(slope(&[Some(1.0), None, Some(1.0)], 1, 1, 1.0), None);
    }
}
