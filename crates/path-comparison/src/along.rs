//! What a machine makes of the way of a feed: its errors there, and the stretches that are compared.

use machine_model::{Command, Vector, singular_sin};
use smallvec::SmallVec;
use toolpath::{FeedRate, Partial};

use crate::Step;
use crate::feeding::{Feeding, Left};
use crate::items::{Common, Item, Items, Role};
use crate::others::Course;
use crate::stretch::{POINTING_LEVER_MM, Stretch, first_three};
use crate::way::Way;

/// Largest distance between places that the model is asked for, mm.
const SAMPLE_MM: f64 = 0.5;
/// A piece of an arc leaves the parabola through its ends and its middle by no more, mm: by r θ⁴/512 square to the circle
/// and r θ³/125 along it, which on a helix is aside of the path as far as that is steep.
const PARABOLA_MM: f64 = 1e-7;
/// Largest turn between places, rad.
const SAMPLE_RAD: f64 = 0.5;
/// Largest turn of the rotary axes between them, rad: at 500 mm a place leaves the parabola by some nanometres.
const TURN_RAD: f64 = 0.01;
/// No motion is asked for at more places.
const MOST_SAMPLES: f64 = 100_000.0;
/// So near to where an axis turns it is asked for on either side, mm: above what counts as the same place.
const TURN_MM: f64 = 1e-8;
/// The same of a rotary axis, as a share of the turn between two places.
const TURN_SHARE: f64 = 1e-6;

impl<I: Iterator<Item = Step>> Items<'_, I> {
    pub(crate) fn feeding(&mut self, common: &Common, way: Way, rate: FeedRate, airy: [bool; 2]) {
        let length_mm = way.length_mm();
        let pieces = pieces(&way);
        let samples = match &self.others {
            None => pieces.max(length_mm / SAMPLE_MM),
            Some(others) => others.pieces(&way, length_mm),
        };
        let real = self.real(common, &way, samples.ceil().clamp(1.0, MOST_SAMPLES));
        let course = self.course(common, &way, &real);
        let leans_rad = self.leans_rad(common, &way, &real);
        let (stretches, off_mm) = self.stretches(common, &way, &real, pieces.ceil().clamp(1.0, MOST_SAMPLES));
        let leans_at_most_rad = self.leans_at_most_rad(common, &way, stretches.len());
        // Of a long motion its length will do.
        let start = stretches[0].at(0.0);
        let far = || stretches.iter().map(|stretch| (stretch.at(1.0) - start).norm()).fold(0.0, f64::max);
        let reach_mm = if length_mm < 1.0 { far() } else { length_mm };
        self.limit_mm = self.limit_mm.max(common.limit_mm);
        // Tip and direction are found together, and judged apart.
        let leans_mm = self.pointing.map_or(0.0, |pointing| POINTING_LEVER_MM * pointing.leans_near_rad);
        let limit_mm = (common.limit_mm * common.limit_mm + leans_mm * leans_mm).sqrt();
        self.at = Partial {
            linear_mm: Into::<[f64; 3]>::into(way.at(1.0)).map(Some),
            rotary_deg: way.end_rotary_deg(),
            rotary_known: [true; 3],
        };
        self.place = stretches.last().map(|stretch| stretch.at(1.0));
        self.ready.push_back(Item::Feed(Box::new(Feeding {
            stretches,
            left: Left::default(),
            line: common.line,
            process: common.process,
            minutes: match rate {
                // What leads nowhere may be left out, and its F with it.
                FeedRate::InverseTime(f) if reach_mm > common.limit_mm => Some(1.0 / f),
                _ => None,
            },
            limit_mm,
            reach_mm,
            airy,
            way: Some(way),
            off_mm,
            made_off_mm: 0.0,
            made_line: None,
            made: Vec::new(),
            course,
            pointing: self.pointing.map(|pointing| (common.limit_mm, pointing)),
            leans_at_most_rad,
            leans_rad,
            made_leans_rad: 0.0,
        })));
    }

    /// Largest angle of the tool from the ideal direction along a way, rad.
    fn leans_rad(&self, common: &Common, way: &Way, real: &[(f64, Vector)]) -> f64 {
        let leans = |(s, _): &(f64, Vector)| {
            let command = common.command(way.at(*s), way.rotary_rad(*s));
            let both = self.model.tool_directions(&command, &command.rotary_rad);
            both.map_or(0.0, |[ideal, real]| (real - ideal).norm())
        };
        if self.model.rotary_axes() == [false; 3] { 0.0 } else { real.iter().map(leans).fold(0.0, f64::max) }
    }

    /// A way as so many stretches, or, of the real one, a stretch between each two places; and how far the real way is
    /// off the programmed one, mm.
    fn stretches(
        &self,
        common: &Common,
        way: &Way,
        real: &[(f64, Vector)],
        pieces: f64,
    ) -> (SmallVec<[Stretch; 2]>, f64) {
        let seen =
            |s: f64, error_mm: &Vector| self.place(&common.command(way.at(s) + error_mm, way.rotary_rad(s)));
        let nominal = |s: f64| seen(s, &Vector::zeros());
        let stretch = |[(s0, e0), (s1, e1)]: [(f64, Vector); 2]| {
            // How far the middle lies beside the chord.
            let bow =
                (!way.is_straight()).then(|| nominal(0.5 * (s0 + s1)) - 0.5 * (nominal(s0) + nominal(s1)));
            Stretch::new(seen(s0, &e0), seen(s1, &e1), bow)
        };
        let pairs = |places: &[(f64, Vector)]| {
            places.windows(2).map(|pair| stretch([pair[0], pair[1]])).collect::<SmallVec<[Stretch; 2]>>()
        };
        match self.role {
            Role::Commanded => (pairs(real), 0.0),
            Role::Wanted => {
                let mut off_mm = 0.0f64;
                let steps = (0..=pieces as u32).map(|k| (f64::from(k) / pieces, Vector::zeros()));
                let stretches = pairs(&steps.collect::<SmallVec<[_; 4]>>());
                for (s, error) in real {
                    let k = ((s * pieces) as usize).min(stretches.len() - 1);
                    off_mm = off_mm.max(stretches[k].distance_mm(&seen(*s, error)));
                }
                (stretches, off_mm)
            }
        }
    }

    /// How far the direction may be off on each of so many stretches of a way, rad.
    fn leans_at_most_rad(&self, common: &Common, way: &Way, places: usize) -> SmallVec<[f64; 2]> {
        self.pointing.map_or_else(SmallVec::new, |pointing| {
            let near = |k: usize| {
                let s = k as f64 / places as f64;
                let sin = singular_sin(self.model, &common.command(way.at(s), way.rotary_rad(s)));
                sin.is_some_and(|sin| sin < pointing.near_sin)
            };
            let near: SmallVec<[bool; 4]> = (0..=places).map(near).collect();
            let at_most = |ends: &[bool]| {
                if ends.contains(&true) { pointing.leans_near_rad } else { pointing.leans_rad }
            };
            near.windows(2).map(at_most).collect()
        })
    }

    /// What every machine makes of a way, at the places of the first.
    fn course(&mut self, common: &Common, way: &Way, real: &[(f64, Vector)]) -> Option<Box<Course>> {
        let mut others = self.others.take()?;
        if others.passes_over(common.line) {
            self.others = Some(others);
            return None;
        }
        let mut course = Course { line: common.line, places_mm: Vec::new(), errors_mm: Vec::new() };
        for (s, error_mm) in real {
            let here = common.command(way.at(*s), way.rotary_rad(*s));
            let seen =
                |error_mm: Vector| self.place(&Command { linear_mm: here.linear_mm + error_mm, ..here });
            let nominal = seen(Vector::zeros());
            course.places_mm.push(first_three(&nominal));
            let all = std::iter::once(*error_mm).chain(others.errors_mm(&here));
            course.errors_mm.extend(all.map(|error_mm| first_three(&(seen(error_mm) - nominal))));
        }
        self.others = Some(others);
        Some(Box::new(course))
    }

    /// The machine's errors along a way, evenly and wherever an axis turns or has its play taken up.
    fn real(&mut self, common: &Common, way: &Way, samples: f64) -> SmallVec<[(f64, Vector); 4]> {
        let mut cuts: SmallVec<[f64; 4]> = (1..=samples as u32).map(|k| f64::from(k) / samples).collect();
        let command = |s: f64| common.command(way.at(s), way.rotary_rad(s));
        let Some(mut play) = self.play else {
            let all = std::iter::once(0.0).chain(cuts);
            return all.map(|s| (s, self.model.error_mm(&command(s)))).collect();
        };
        let turns = way.turns();
        if !turns.is_empty() {
            cuts.extend(turns);
            cuts.sort_by(f64::total_cmp);
        }
        let mut at = command(0.0);
        play.go(self.model, &at);
        play.turn(self.model, &at, [true; 3]);
        let mut found: SmallVec<[(f64, Vector); 4]> = SmallVec::new();
        found.push((0.0, play.error_mm(self.model, &at)));
        let mut from = 0.0;
        for cut in cuts {
            let to = command(cut);
            let way_mm: [f64; 3] = (to.linear_mm - at.linear_mm).into();
            let direction = way_mm.map(|mm| i8::from(mm > 0.0) - i8::from(mm < 0.0));
            let (side, lag_mm) = (play.side(), play.lag_mm(self.model, &at, direction));
            let mut taken_up: SmallVec<[f64; 6]> = SmallVec::new();
            for axis in 0..3 {
                // Of an axis whose side nobody knows nobody knows either where it changes.
                let turns = direction[axis] != 0 && side[axis] != direction[axis] && side[axis] != 0;
                if turns && way_mm[axis].abs() > lag_mm[axis] + TURN_MM {
                    // What lies across the axis changes there, at once.
                    let around = [lag_mm[axis] - TURN_MM, lag_mm[axis] + TURN_MM];
                    let before_and_behind = around.iter().filter(|mm| **mm > 0.0);
                    taken_up.extend(before_and_behind.map(|mm| where_gone(way, from, cut, axis, *mm)));
                }
            }
            let way_rad: [f64; 3] = (to.rotary_rad - at.rotary_rad).into();
            let heading = way_rad.map(|rad| i8::from(rad > 0.0) - i8::from(rad < 0.0));
            let lag_rad = play.rotary_lag_rad(self.model, &at, heading);
            for axis in (0..3).filter(|axis| lag_rad[*axis] > 0.0) {
                let share = lag_rad[axis] / way_rad[axis].abs();
                // The turn runs evenly, and what changes at once is met from both sides.
                let around = [share - TURN_SHARE, share, share + TURN_SHARE];
                taken_up.extend(
                    around.iter().filter(|s| (0.0..1.0).contains(*s)).map(|s| from + (cut - from) * s),
                );
            }
            taken_up.sort_by(f64::total_cmp);
            for s in taken_up.into_iter().chain([cut]) {
                let here = command(s);
                play.go(self.model, &here);
                play.turn(self.model, &here, [true; 3]);
                found.push((s, play.error_mm(self.model, &here)));
            }
            (from, at) = (cut, to);
        }
        self.play = Some(play);
        found
    }
}

/// Into how many pieces a way has to be cut, so that a parabola through the ends and the middle of each is near it.
fn pieces(way: &Way) -> f64 {
    let (radius_mm, steep) = way.radius_and_steepness();
    let square_rad = (512.0 * PARABOLA_MM / radius_mm.max(1e-9)).sqrt().sqrt();
    let along_rad = units::math::powf(125.0 * PARABOLA_MM / (radius_mm * steep).max(1e-9), 1.0 / 3.0);
    let turn_rad = square_rad.min(along_rad).min(SAMPLE_RAD);
    (way.turning_rad() / turn_rad).max(way.rotary_turn_rad() / TURN_RAD)
}

/// Where between two places an axis, going one way, has gone so far.
fn where_gone(way: &Way, from: f64, to: f64, axis: usize, mm: f64) -> f64 {
    let start = way.at(from)[axis];
    let (mut low, mut high) = (from, to);
    // To below a picometre of any way.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if (way.at(middle)[axis] - start).abs() < mm { low = middle } else { high = middle }
    }
    high
}
