//! The withheld effects: physics that keeps the library's name and sign but not its formula.

use crate::dice::Dice;
use crate::effect::Effect;
use crate::machine::{Contribution, Machine};
use crate::row::Row;

/// Contribution of an effect of unit size at a row.
pub(crate) type Form = Box<dyn Fn(&Row) -> Contribution + Send + Sync>;

/// An effect that the machine has and its profile does not mention.
pub(crate) struct Withheld {
    /// Its name; `None` for effects outside the library.
    pub(crate) effect: Option<Effect>,
    /// Size in units of its form (about 1 µm or 1 µrad or 1 µm/m each).
    pub(crate) amplitude: f64,
    /// Contribution at unit size.
    pub(crate) form: Form,
}

/// How far a shape may bend away from the textbook.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bend {
    /// As a worn or warm machine would: the normal case.
    Natural,
    /// As straight as the name allows; used where a design shall make two names exactly equal.
    Plain,
}

/// One micrometre, or one microradian, or one micrometre per metre.
const UNIT: f64 = 1e-3;
const MICRO: f64 = 1e-6;

/// A curve over an axis' travel without constant and linear part, of unit root mean square: a sum of
/// half sine waves with falling, random amplitudes.
fn wavy(dice: &mut Dice, bend: Bend) -> impl Fn(f64) -> f64 + Send + Sync + use<> {
    let count = if bend == Bend::Plain { 1 } else { 4 };
    let terms: Vec<(f64, f64)> = (1..=count)
        .map(|k| {
            let falling = 1.0 / libm::pow(f64::from(k), 0.8);
            let size = if k == 1 { dice.sign() } else { dice.normal() * falling * 0.8 };
            (std::f64::consts::PI * f64::from(k), size)
        })
        .collect();
    let raw = move |s: f64| terms.iter().map(|(wave, size)| size * libm::sin(wave * s)).sum::<f64>();
    // Least squares of constant and slope over an even grid of the travel.
    const GRID: usize = 201;
    let at = |k: usize| k as f64 / (GRID - 1) as f64;
    let mean = (0..GRID).map(|k| raw(at(k))).sum::<f64>() / GRID as f64;
    let (mut along, mut weight) = (0.0, 0.0);
    for k in 0..GRID {
        along += (at(k) - 0.5) * raw(at(k));
        weight += (at(k) - 0.5) * (at(k) - 0.5);
    }
    let slope = along / weight;
    let straight = move |s: f64| raw(s) - mean - slope * (s - 0.5);
    let square = (0..GRID).map(|k| straight(at(k))).map(|v| v * v).sum::<f64>() / GRID as f64;
    let size = square.sqrt();
    move |s| straight(s) / size
}

/// Play with a soft spring: after a reversal the axis needs some travel to lean on the other flank
/// (closed form of a Bouc–Wen loop driven monotonically). -1 … 1, sign of the direction.
fn play(row: &Row, axis: usize, softness_mm: f64) -> f64 {
    row.approach[axis] * (1.0 - 2.0 * libm::exp(-row.since_reversal[axis] / softness_mm))
}

/// A contribution with one translation of one axis.
fn linear(axis: usize, direction: usize, value: f64) -> Contribution {
    let mut c = Contribution::default();
    c.linear[axis][direction] = value;
    c
}

fn tip(direction: usize, value: f64) -> Contribution {
    let mut c = Contribution::default();
    c.tip[direction] = value;
    c
}

/// Makes the effect's form with random shape parameters. `span_s` is the duration of the measurement.
pub(crate) fn form(effect: Effect, machine: &Machine, span_s: f64, dice: &mut Dice, bend: Bend) -> Form {
    let natural = bend == Bend::Natural;
    let fraction = {
        let travel = machine.travel;
        move |axis: usize, x: f64| (x - travel[axis][0]) / (travel[axis][1] - travel[axis][0])
    };
    match effect {
        Effect::Scale(a) => Box::new(move |r| linear(a, a, MICRO * r.command[a])),
        Effect::Thermal(a) => {
            let fixed = machine.travel[a][0]
                + dice.between(-0.2, 0.6) * (machine.travel[a][1] - machine.travel[a][0]);
            let curve = if natural { 0.02 } else { 0.0 };
            Box::new(move |r| {
                let warmer = r.temperature - 20.0;
                linear(a, a, MICRO * warmer * (1.0 + curve * warmer) * (r.command[a] - fixed))
            })
        }
        Effect::Warmup(a) => {
            let (fast, slow) = if natural {
                (span_s * dice.between(0.06, 0.12), span_s * dice.between(0.25, 0.5))
            } else {
                (span_s * 3.0, span_s * 5.0)
            };
            let part = dice.between(0.25, 0.5);
            Box::new(move |r| {
                let rise = |tau: f64| 1.0 - libm::exp(-r.time / tau);
                linear(a, a, UNIT * (part * rise(fast) + (1.0 - part) * rise(slow)))
            })
        }
        Effect::Backlash(a) => {
            let (soft, worn) = (dice.between(0.3, 1.2), if natural { dice.between(0.0, 0.25) } else { 0.0 });
            let phase = dice.between(0.0, 3.0);
            Box::new(move |r| {
                let wear = 1.0 + worn * libm::sin(3.0 * fraction(a, r.command[a]) + phase);
                linear(a, a, -UNIT * wear * play(r, a, soft))
            })
        }
        Effect::LostMotion(d, a) => {
            let (soft, worn) = (dice.between(0.3, 1.5), if natural { dice.between(0.0, 0.25) } else { 0.0 });
            Box::new(move |r| {
                let wear = 1.0 + worn * (fraction(a, r.command[a]) - 0.5);
                linear(a, d, -UNIT * wear * play(r, a, soft))
            })
        }
        Effect::Squareness(a, b) => {
            let sign = if (a, b) == (0, 2) { 1.0 } else { -1.0 };
            Box::new(move |r| linear(b, a, sign * MICRO * r.command[b]))
        }
        Effect::Positioning(a) => {
            let curve = wavy(dice, bend);
            Box::new(move |r| linear(a, a, UNIT * curve(fraction(a, r.command[a]))))
        }
        Effect::Straightness(d, a) => {
            let curve = wavy(dice, bend);
            Box::new(move |r| linear(a, d, UNIT * curve(fraction(a, r.command[a]))))
        }
        Effect::Pitch(a) => {
            let pitch = dice.pick(&[5.0, 8.0, 10.0, 12.0, 16.0, 20.0]);
            let (phase, skew, grows) = (dice.phase(), dice.between(0.0, 0.4), dice.between(-0.4, 0.4));
            Box::new(move |r| {
                let angle = std::f64::consts::TAU * r.command[a] / pitch + phase;
                let grown = 1.0 + grows * (fraction(a, r.command[a]) - 0.5);
                linear(a, a, UNIT * grown * libm::sin(angle + skew * libm::sin(angle)))
            })
        }
        Effect::Angular(about, a) => {
            let curve = wavy(dice, bend);
            let (slope, bow) =
                if natural { (dice.sign() * dice.between(1.5, 4.0), 0.7) } else { (4.0, 0.05) };
            Box::new(move |r| {
                let s = fraction(a, r.command[a]);
                let mut c = Contribution::default();
                c.angular[a][about] = MICRO * (slope * (s - 0.5) + bow * curve(s));
                c
            })
        }
        Effect::Sag(a) => {
            let support = if natural { dice.between(-0.2, 0.15) } else { 0.0 };
            Box::new(move |r| {
                let u = ((fraction(a, r.command[a]) - support) / (1.0 - support)).max(0.0);
                linear(a, 2, -UNIT * u * u * (3.0 - u) / 2.0)
            })
        }
        Effect::Load(d) => {
            let full = if natural { dice.between(500.0, 1500.0) } else { 1e9 };
            Box::new(move |r| tip(d, -UNIT * r.load / 100.0 / (1.0 + r.load / full)))
        }
        Effect::ServoLag(a) => {
            let (settle, stiffening) =
                (dice.between(0.5, 2.0), if natural { dice.between(0.0, 0.1) } else { 0.0 });
            Box::new(move |r| {
                let speed = r.feed / 1000.0 * r.tangent[a].abs();
                // A second-order loop: the lag builds up over a few time constants after the reversal.
                let lead = r.since_reversal[a] / settle;
                let built = 1.0 - libm::exp(-lead) * (1.0 + lead);
                linear(a, a, -UNIT * r.approach[a] * speed * (1.0 - stiffening * speed / 4.0) * built)
            })
        }
        Effect::ServoMismatch(a, b) => Box::new(move |r| {
            // A path that moves both axes: one lags by half the difference more, the other by half less.
            let speed = r.feed / 1000.0;
            let mut c = Contribution::default();
            if r.approach[a] != 0.0 && r.approach[b] != 0.0 {
                c.linear[a][a] = -0.5 * UNIT * speed * r.tangent[a];
                c.linear[b][b] = 0.5 * UNIT * speed * r.tangent[b];
            }
            c
        }),
        Effect::Step(d) => {
            let at = span_s * dice.between(0.3, 0.7);
            Box::new(move |r| tip(d, UNIT / (1.0 + libm::exp(-(r.time - at) / 4.0))))
        }
        Effect::Local(a) => {
            let (centre, half) = (dice.between(0.25, 0.75), dice.between(0.06, 0.12));
            let direction = dice.direction();
            Box::new(move |r| {
                let u = (fraction(a, r.command[a]) - centre) / half;
                let dent = if u.abs() < 1.0 { 0.5 + 0.5 * libm::cos(std::f64::consts::PI * u) } else { 0.0 };
                let mut c = Contribution::default();
                c.linear[a] = direction.map(|k| UNIT * k * dent);
                c
            })
        }
        Effect::RotaryC(d) => Box::new(move |_| {
            let mut c = Contribution::default();
            c.centre[d] = UNIT;
            c
        }),
        Effect::Eccentricity => {
            let phase = dice.phase();
            Box::new(move |r| Contribution {
                spin: MICRO * libm::sin(r.turn + phase),
                ..Contribution::default()
            })
        }
        Effect::ProbeLobing => {
            let (phase, third) = (dice.phase(), dice.between(0.5, 1.0));
            Box::new(move |r| {
                // Three lobes over the direction in the plane plus a pole term, along the approach.
                let around = libm::atan2(r.tangent[1], r.tangent[0]);
                let flat = (r.tangent[0] * r.tangent[0] + r.tangent[1] * r.tangent[1]).sqrt();
                let pre = flat * libm::cos(3.0 * around + phase) + third * r.tangent[2] * r.tangent[2];
                Contribution { tip: r.tangent.map(|t| UNIT * pre * t), ..Contribution::default() }
            })
        }
        Effect::InstrumentDrift => {
            let direction = dice.direction();
            let bow = if natural { dice.between(-0.35, 0.35) } else { 0.0 };
            Box::new(move |r| {
                let t = r.time / span_s;
                let drift = t + bow * 4.0 * t * (1.0 - t);
                Contribution { tip: direction.map(|k| UNIT * k * drift), ..Contribution::default() }
            })
        }
    }
}
