//! Cross sections: how round they are.

use diagnostic::{Text, both, notice};
use machine_model::Vector;
use report::body::Body;
use report::chart::{Magnification, Polar, Round, polar};
use report::numbers::digits;
use serde::Serialize;
use turning::Lathe;
use units::math;

use crate::figures::round;
use crate::message::{Failure, OPTION};
use jobs::turned::judged::{mm, um};
use jobs::turned::surface::{ANGLES, HIGHEST_WAVE, Place, Stretch, Turned};

/// Roundness that differs by less is the same, µm.
const SAME_UM: f64 = 0.01;

/// A wave of the outline.
#[derive(Serialize)]
struct Wave {
    order: u32,
    amplitude_um: f64,
    /// Where its first crest lies, from X+ of the workpiece.
    crest_deg: f64,
}

/// A cross section.
#[derive(Serialize)]
pub(super) struct Drawn {
    pub(super) z_mm: f64,
    pub(super) roundness_um: f64,
    pub(super) roundness_zone_um: f64,
    /// Centre of the least-squares circle, X and Y of the workpiece.
    pub(super) centre_um: [f64; 2],
    waves: Vec<Wave>,
    /// Angle, rad, and deviation from the least-squares circle, µm.
    #[serde(skip)]
    outline: Vec<(f64, f64)>,
    #[serde(skip)]
    radius_um: f64,
}

/// The sections that are wanted; where none are: both ends of the longest cylinder, and the one that is least round.
///
/// # Errors
/// Nothing is turned at a place that is wanted.
pub(super) fn wanted(turned: &Turned, at_mm: &[f64], lathe: &Lathe) -> Result<Vec<Drawn>, Failure> {
    let places = &turned.places;
    let (Some(first), Some(last)) = (places.first(), places.last()) else { return Ok(Vec::new()) };
    let mut chosen: Vec<&Place> = Vec::new();
    for z_mm in at_mm {
        if !(first.z_mm - 1e-9..=last.z_mm + 1e-9).contains(z_mm) {
            return Err(Failure::usage(notice!(OPTION;
                "nothing is turned at `--section {z_mm}`", "в `--section {z_mm}` ничего не точится";
                "write Z from the chuck, mm: the program turns from {} to {}",
                "напишите Z от торца патрона, мм: программа точит от {} до {}", mm(first.z_mm), mm(last.z_mm)
            )));
        }
        let near = places.iter().min_by(|a, b| (a.z_mm - z_mm).abs().total_cmp(&(b.z_mm - z_mm).abs()));
        chosen.extend(near);
    }
    if at_mm.is_empty() {
        let length = |c: &Stretch| c.to_z_mm - c.from_z_mm;
        let longest = turned.cylinders.iter().max_by(|a, b| length(a).total_cmp(&length(b)));
        let ends = longest.map_or([first.z_mm, last.z_mm], |c| [c.from_z_mm, c.to_z_mm]);
        chosen.extend(places.iter().filter(|place| ends.contains(&place.z_mm)));
        let rounder = chosen.iter().map(|place| place.roundness_um).fold(0.0, f64::max) + SAME_UM;
        let worst = places.iter().max_by(|a, b| a.roundness_um.total_cmp(&b.roundness_um));
        chosen.extend(worst.filter(|place| place.roundness_um > rounder));
    }
    chosen.sort_by(|a, b| a.z_mm.total_cmp(&b.z_mm));
    chosen.dedup_by_key(|place| place.place);
    Ok(chosen.into_iter().map(|place| Drawn::of(place, lathe)).collect())
}

impl Drawn {
    fn of(place: &Place, lathe: &Lathe) -> Self {
        let section = lathe.section(&place.command, ANGLES);
        let circle = section.least_squares();
        let centre = Vector::new(circle.centre_mm[0], circle.centre_mm[1], 0.0);
        let about = section.points_mm().iter().map(|point| point - centre);
        let polar = about.map(|p| {
            let angle = math::atan2(p.y, p.x);
            let angle = if angle < 0.0 { angle + std::f64::consts::TAU } else { angle };
            (angle, (math::hypot(p.x, p.y) - circle.radius_mm) * 1e3)
        });
        let mut outline: Vec<(f64, f64)> = polar.collect();
        outline.sort_by(|a, b| a.0.total_cmp(&b.0));
        let wave = |wave: &turning::Wave| Wave {
            order: wave.order,
            amplitude_um: round(wave.amplitude_mm * 1e3, 6),
            // a·cos(kθ − phase) has its crests at phase/k and every turn/k.
            crest_deg: round(wave.phase_rad.to_degrees().rem_euclid(360.0) / f64::from(wave.order), 3),
        };
        Self {
            z_mm: place.z_mm,
            roundness_um: place.roundness_um,
            roundness_zone_um: place.roundness_zone_um,
            centre_um: circle.centre_mm.map(|mm| round(mm * 1e3, 6)),
            waves: section.waves(HIGHEST_WAVE).iter().map(wave).collect(),
            outline,
            radius_um: circle.radius_mm * 1e3,
        }
    }

    /// Amplitude and crest of a wave; of a wave too small to be written no crest.
    pub(super) fn wave(&self, order: u32) -> Text {
        match self.waves.iter().find(|wave| wave.order == order) {
            Some(wave) if wave.amplitude_um >= 0.005 => {
                let (amplitude, crest) = (um(wave.amplitude_um), digits(wave.crest_deg, 0));
                both!("{amplitude} ({crest}\u{b0})", "{amplitude:#} ({crest:#}\u{b0})")
            }
            Some(_) => um(0.0),
            None => Text::same("\u{2014}"),
        }
    }

    /// The polar plot, on one scale with those of the other sections.
    pub(super) fn figure(&self, out: &mut Body, all: &[Self]) {
        let off = |drawn: &Self| drawn.outline.iter().map(|(_, um)| um.abs()).fold(0.0, f64::max);
        // A circle is drawn as one, and not its last digits.
        let largest = all.iter().map(off).fold(0.01, f64::max);
        let m = Magnification::of(largest, self.radius_um);
        let drawn = Polar {
            axes: ["X", "Y"],
            radius: self.radius_um,
            curves: vec![Round { class: "round s1", at: self.outline.clone() }],
            keys: Vec::new(),
        };
        let (z, roundness, times) = (mm(self.z_mm), um(self.roundness_um), digits(m.times, 0));
        let title = both!("Roundness at Z {z} mm", "Круглость в Z {z:#} мм");
        let described = both!(
            "RONt {roundness} \u{b5}m, magnified {times} times",
            "RONt {roundness:#} мкм, увеличение {times:#}\u{d7}"
        );
        let caption = both!("Z {z} mm: {described}", "Z {z:#} мм: {described:#}");
        out.figure(&polar(out.language(), &title, &described, &drawn, m), &caption);
    }
}
