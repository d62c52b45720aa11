//! Full circles of a ball bar with several faults at once, as ISO 230-4 measures them and ball-bar practice reads them.
//!
//! Each fault is made from what happens in the machine: drives are closed loops with a gain and a damping, friction holds an
//! axis until its spring has wound up, play is taken up over a soft flank. None is of the library's form.

use std::f64::consts::{PI, TAU};

use crate::AXES;
use crate::dice::Dice;

/// Radius of the circles, mm, and readings of one.
const RADIUS_MM: f64 = 150.0;
const READINGS: usize = 180;
/// Feeds of the circles, mm/min.
const FEEDS: [f64; 3] = [500.0, 2000.0, 6000.0];
/// A reading's standard deviation, µm.
const NOISE_UM: f64 = 0.25;
/// Place of the ball, mm.
const BALL_MM: [f64; 3] = [300.0, 250.0, 200.0];
const UM: f64 = 1e-3;

/// A case: files, and what the machine has that its profile does not say.
#[derive(Clone, Debug)]
pub struct Circles {
    /// Text of the profile.
    pub profile: String,
    /// Text of the measurement.
    pub measurement: String,
    /// Ids of the faults.
    pub faults: Vec<String>,
    /// An axis sticks and slips: nothing may be named for it, and it must be told.
    pub jerks: Option<char>,
}

/// Where the machine is on a circle.
struct State {
    /// Axis command, mm from the centre, and speed, mm/s; zero for the axis that stands.
    place_mm: [f64; 3],
    speed_mm_s: [f64; 3],
    /// Travel of each axis since it turned, mm, and time, s.
    travel_mm: [f64; 3],
    since_s: [f64; 3],
    /// Radians per second.
    omega: f64,
}

type Fault = Box<dyn Fn(&State) -> [f64; 3]>;

fn along(axis: usize, value: f64) -> [f64; 3] {
    let mut v = [0.0; 3];
    v[axis] = value;
    v
}

/// Play with a soft flank: full only after some tenths of a millimetre.
fn flank(state: &State, axis: usize, soft_mm: f64) -> f64 {
    state.speed_mm_s[axis].signum() * libm::tanh(state.travel_mm[axis] / soft_mm - 1.0)
}

/// Faults of two axes, by their ids.
fn faults(dice: &mut Dice, plane: [usize; 2]) -> Vec<(String, Fault)> {
    let [u, v] = plane;
    let mut found: Vec<(String, Fault)> = Vec::new();
    for (a, b) in [(u, v), (v, u)] {
        let (name, other) = (AXES[a], AXES[b]);
        let (half, soft) = (dice.between(3.0, 7.0), dice.between(0.1, 0.5));
        found.push((format!("backlash.{name}"), Box::new(move |s| along(a, -UM * half * flank(s, a, soft)))));
        let (half, soft) = (dice.sign() * dice.between(3.0, 7.0), dice.between(0.1, 0.5));
        let sideways = move |s: &State| along(b, -UM * half * flank(s, a, soft));
        found.push((format!("lost-motion.E{other}{name}"), Box::new(sideways)));
        let grade = dice.sign() * dice.between(30.0, 80.0);
        found.push((format!("scale.{name}"), Box::new(move |s| along(a, 1e-6 * grade * s.place_mm[a]))));
        // A bow of the guideway and a half wave on it.
        let (bow, wave) = (dice.sign() * dice.between(6.0, 12.0), dice.between(-2.0, 2.0));
        let bent = move |s: &State| {
            let w = s.place_mm[a] / RADIUS_MM;
            along(b, UM * (bow * (1.0 - w * w) + wave * libm::sin(PI * w)))
        };
        found.push((format!("straightness.E{other}{name}"), Box::new(bent)));
        let (lead, phase, size) =
            (dice.pick(&[8.0, 10.0, 12.0, 16.0, 20.0]), dice.phase(), dice.between(2.5, 6.0));
        let skew = dice.between(0.0, 0.3);
        let turned = move |s: &State| {
            let angle = TAU * s.place_mm[a] / lead + phase;
            along(a, UM * size * libm::sin(angle + skew * libm::sin(angle)))
        };
        found.push((format!("pitch.{name}"), Box::new(turned)));
        // Friction holds the axis until the drive has wound up; it lets go and falls back within a millimetre or two.
        let (peak, release) = (dice.between(8.0, 14.0), dice.between(15.0, 40.0));
        let held = move |s: &State| {
            let wound = (s.travel_mm[a] / 0.02).min(1.0);
            let way_mm = s.since_s[a] * s.omega * RADIUS_MM;
            let released = libm::exp(-way_mm * way_mm / (release * 0.5));
            along(a, -UM * peak * s.speed_mm_s[a].signum() * wound * released)
        };
        found.push((format!("spike.{name}"), Box::new(held)));
    }
    let (low, high) = (u.min(v), u.max(v));
    let lean = dice.sign() * dice.between(40.0, 100.0);
    found.push((
        format!("squareness.{}{}", AXES[low], AXES[high]),
        Box::new(move |s| along(low, 1e-6 * lean * s.place_mm[high])),
    ));
    // Two position loops of unlike gain, their mean fed forward: what is left is half the difference of the two lags each.
    let apart_s = dice.sign() * 1e-3 * dice.between(0.1, 0.25);
    found.push((
        format!("servo-mismatch.{}{}", AXES[low], AXES[high]),
        Box::new(move |s| {
            let own = |a: usize, half: f64| {
                let (sine, cosine) = libm::sincos(s.omega * half);
                (cosine - 1.0) * s.place_mm[a] - sine * s.speed_mm_s[a] / s.omega
            };
            let mut e = [0.0; 3];
            (e[low], e[high]) = (own(low, 0.5 * apart_s), own(high, -0.5 * apart_s));
            e
        }),
    ));
    // Loops with velocity feed-forward: in step with their command, but of less amplitude the faster it swings.
    let (gain, damping) = (dice.between(60.0, 100.0), dice.between(0.8, 1.1));
    found.push((
        "contraction".to_owned(),
        Box::new(move |s| {
            let ratio = s.omega / gain;
            let (real, imaginary) = (1.0 - 0.1 * ratio * ratio, damping * ratio);
            let amplitude = 1.0 / (real * real + imaginary * imaginary).sqrt();
            s.place_mm.map(|p| (amplitude - 1.0) * p)
        }),
    ));
    found
}

/// Below a speed the axis waits until its spring has wound up, jumps, and waits again.
fn stick_slip(dice: &mut Dice, axis: usize) -> Fault {
    let (wound_um, below_mm_s) = (dice.between(3.0, 6.0), dice.between(3.0, 8.0));
    let step_mm = UM * wound_um * dice.between(0.9, 1.1);
    Box::new(move |s| {
        let speed = s.speed_mm_s[axis];
        let stuck = if speed.abs() < below_mm_s { (s.travel_mm[axis] / step_mm).fract() } else { 0.5 };
        along(axis, -UM * wound_um * speed.signum() * (stuck - 0.5))
    })
}

/// The `index`-th case of a seed: one plane, both senses, three feeds; `count` faults of fifteen, in every fifth case an axis
/// that sticks and slips beside them.
#[must_use]
pub fn circles(count: usize, index: u64, seed: u64) -> Circles {
    /// "circ" in ASCII.
    const PURPOSE: u64 = 0x6369_7263;
    let mut dice = Dice::new(seed, index, PURPOSE + count as u64);
    let plane = dice.pick(&[[0, 1], [0, 2], [1, 2]]);
    let mut all = faults(&mut dice, plane);
    dice.shuffle(&mut all);
    all.truncate(count);
    let names: Vec<String> = all.iter().map(|(name, _)| name.clone()).collect();
    let mut acting: Vec<Fault> = all.into_iter().map(|(_, fault)| fault).collect();
    let jerks = index.is_multiple_of(5).then(|| dice.pick(&plane));
    if let Some(axis) = jerks {
        acting.push(stick_slip(&mut dice, axis));
    }
    // Not quite where it is said to be.
    let beside = [0; 3].map(|_| 3.0 * UM * dice.normal());
    let mut text =
        "run,x_mm,y_mm,z_mm,length_mm,bx_mm,by_mm,bz_mm,dir_x,dir_y,dir_z,feed_mm_min,time_s,repeat\n"
            .to_owned();
    let (mut run, mut clock) = (0, 0.0);
    for feed in FEEDS {
        for sense in [1.0, -1.0] {
            for repeat in 1..=2 {
                circle(
                    &mut text,
                    &mut clock,
                    (run, repeat),
                    plane,
                    (feed, sense),
                    &acting,
                    beside,
                    &mut dice,
                );
                run += 1;
            }
        }
    }
    let jerks = jerks.map(|axis| AXES[axis]);
    Circles { profile: profile(), measurement: text, faults: names, jerks }
}

/// Rows of one circle.
#[expect(clippy::too_many_arguments, reason = "one circle is all of these")]
fn circle(
    text: &mut String,
    clock: &mut f64,
    (run, repeat): (usize, usize),
    [u, v]: [usize; 2],
    (feed, sense): (f64, f64),
    acting: &[Fault],
    beside: [f64; 3],
    dice: &mut Dice,
) {
    let omega = feed / 60.0 / RADIUS_MM;
    for k in 0..READINGS {
        // Half a step off the quadrant, where the sign of the direction would be undefined.
        let swept = TAU * (k as f64 + 0.5) / READINGS as f64;
        let (sine, cosine) = libm::sincos(sense * swept);
        let (mut state, mut command) = (
            State { place_mm: [0.0; 3], speed_mm_s: [0.0; 3], travel_mm: [0.0; 3], since_s: [0.0; 3], omega },
            BALL_MM,
        );
        let speed = feed / 60.0;
        // u turns where the circle begins and half way round, v a quarter later.
        for (axis, at, moves, from) in [(u, cosine, -sense * sine, 0.0), (v, sine, sense * cosine, 0.5 * PI)]
        {
            let since = (swept - from).rem_euclid(PI);
            state.place_mm[axis] = RADIUS_MM * at;
            state.speed_mm_s[axis] = speed * moves;
            state.travel_mm[axis] = RADIUS_MM * (1.0 - libm::cos(since));
            state.since_s[axis] = since / omega;
            command[axis] += (1e4 * RADIUS_MM * at).round() / 1e4;
        }
        let mut tip = command;
        for fault in acting {
            let moved = fault(&state);
            (0..3).for_each(|i| tip[i] += moved[i]);
        }
        let square: f64 = (0..3).map(|i| (tip[i] - BALL_MM[i] - beside[i]).powi(2)).sum();
        let length = square.sqrt() + UM * NOISE_UM * dice.normal();
        *clock += TAU / READINGS as f64 / omega;
        let mut words = vec![format!("c{run}")];
        words.extend(command.map(|c| format!("{c:.4}")));
        words.push(format!("{length:.6}"));
        words.extend(BALL_MM.map(|b| format!("{b:.4}")));
        words.extend(
            state.speed_mm_s.map(|s| if s == 0.0 { "0".to_owned() } else { format!("{:.0}", s.signum()) }),
        );
        words.extend([format!("{feed:.0}"), format!("{clock:.2}"), repeat.to_string()]);
        text.push_str(&words.join(","));
        text.push('\n');
    }
    *clock += 60.0;
}

fn profile() -> String {
    let mut text = "format  = 1\nname    = \"circles\"\ncontrol = \"fanuc\"\nchain   = \"[w X Y b Z t]\"\n\
        calibrated = { date = \"2026-01-15\", temperature_c = 20.0, instrument = \"simulated\" }\n"
        .to_owned();
    for (axis, travel_mm) in AXES.into_iter().zip([600, 500, 400]) {
        text += &format!("\n[axis.{axis}]\ntravel_mm     = [0, {travel_mm}]\nresolution_mm = 0.001\n");
    }
    text + "\n[tool]\ndefault_mm = [0.0, 0.0, 0.0]\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(omega: f64) -> State {
        let at = |a: usize, value: f64| along(a, value);
        State {
            place_mm: at(0, RADIUS_MM),
            speed_mm_s: at(1, omega * RADIUS_MM),
            travel_mm: [0.0, RADIUS_MM, 0.0],
            since_s: [0.0, 0.5 * PI / omega, 0.0],
            omega,
        }
    }

    #[test]
    fn a_circle_shrinks_with_the_square_of_the_feed() {
        let all = faults(&mut Dice::new(1, 1, 1), [0, 1]);
        let (_, shrinks) = all.iter().find(|(name, _)| name == "contraction").expect("it is there");
        let (slow, fast) = (shrinks(&state(0.2))[0], shrinks(&state(0.4))[0]);
        assert!(slow < 0.0 && (fast / slow - 4.0).abs() < 0.05, "{slow} {fast}");
    }

    #[test]
    fn cases_repeat_and_hold_what_they_say() {
        let one = circles(3, 5, 1);
        assert_eq!(one.measurement, circles(3, 5, 1).measurement);
        assert_eq!((one.faults.len(), one.jerks.is_some()), (3, true));
        assert_eq!(one.measurement.lines().count(), 1 + 12 * READINGS);
        assert!(circles(3, 6, 1).jerks.is_none());
    }
}
