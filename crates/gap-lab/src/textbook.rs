//! The lab's own textbook columns: what each name means at its simplest.
//!
//! They serve only to say whether a design can tell two names apart. They are written from the table
//! "What each name means", to first order and with explicit lever arms, not with the matrices of
//! [`crate::machine`]: a test compares the two.

use crate::design::Layout;
use crate::effect::Effect;
use crate::machine::Machine;
use crate::row::Row;

/// Displacement per unit of one coefficient, mm.
pub(crate) type Column<'a> = Box<dyn Fn(&Row) -> [f64; 3] + 'a>;

/// True where the file carries what the effect is a function of, and lets it vary.
///
/// A row without direction of approach counts as unknown, so an effect of the reversal needs rows from
/// both sides.
pub(crate) fn visible(effect: Effect, layout: &Layout) -> bool {
    let columns = layout.columns;
    let both =
        |a: usize| [-1.0, 1.0].iter().all(|sign| layout.rows.iter().any(|r| r.approach[a] * sign > 0.5));
    match effect {
        Effect::Backlash(a) | Effect::LostMotion(_, a) => columns.approach && both(a),
        Effect::ProbeLobing => columns.approach && (0..3).all(both),
        Effect::ServoLag(a) => columns.approach && columns.feed && both(a),
        Effect::ServoMismatch(a, b) => columns.approach && columns.feed && both(a) && both(b),
        Effect::Thermal(_) => columns.temperature,
        Effect::Warmup(_) | Effect::Step(_) | Effect::InstrumentDrift => columns.time,
        Effect::Load(_) => columns.load,
        Effect::Scale(_)
        | Effect::Squareness(..)
        | Effect::Positioning(_)
        | Effect::Straightness(..)
        | Effect::Pitch(_)
        | Effect::Angular(..)
        | Effect::Sag(_)
        | Effect::Local(_)
        | Effect::RotaryC(_)
        | Effect::Eccentricity => true,
    }
}

fn along(direction: usize, value: f64) -> [f64; 3] {
    let mut v = [0.0; 3];
    v[direction] = value;
    v
}

/// Legendre polynomial of `order` at `u` in -1 … 1.
fn legendre(order: usize, u: f64) -> f64 {
    let (mut before, mut now) = (1.0, u);
    if order == 0 {
        return before;
    }
    for n in 1..order {
        let next = ((2 * n + 1) as f64 * u * now - n as f64 * before) / (n + 1) as f64;
        (before, now) = (now, next);
    }
    now
}

/// Arm on which the rotation of `axis` acts: the travel of the axes beyond it in the chain, and the tool.
fn lever(machine: &Machine, axis: usize, row: &Row) -> [f64; 3] {
    let mut arm = row.tool;
    let place = machine.order.iter().position(|a| *a == axis).unwrap_or(0);
    for beyond in &machine.order[place + 1..] {
        arm[*beyond] += row.command[*beyond];
    }
    arm
}

fn cross_unit(about: usize, arm: [f64; 3]) -> [f64; 3] {
    let (u, v) = ((about + 1) % 3, (about + 2) % 3);
    let mut out = [0.0; 3];
    out[u] = -arm[v];
    out[v] = arm[u];
    out
}

/// The variants of an effect (one per value of its non-linear parameter); each a set of columns.
pub(crate) fn variants<'a>(effect: Effect, machine: &'a Machine, layout: &Layout) -> Vec<Vec<Column<'a>>> {
    let span = layout.span;
    let centred = move |a: usize, x: f64| 2.0 * machine.fraction(a, x) - 1.0;
    let curve = |d: usize, a: usize| -> Vec<Column<'a>> {
        (2..=6)
            .map(|n| Box::new(move |r: &Row| along(d, legendre(n, centred(a, r.command[a])))) as Column<'a>)
            .collect()
    };
    match effect {
        Effect::Scale(a) => vec![vec![Box::new(move |r| along(a, r.command[a]))]],
        Effect::Thermal(a) => vec![vec![
            Box::new(move |r| along(a, (r.temperature - 20.0) * r.command[a])),
            Box::new(move |r| along(a, r.temperature - 20.0)),
        ]],
        Effect::Warmup(a) => [0.08, 0.2, 0.5, 1.0, 3.0]
            .map(|part| {
                let tau = part * span;
                vec![Box::new(move |r: &Row| along(a, 1.0 - libm::exp(-r.time / tau))) as Column<'a>]
            })
            .into(),
        Effect::Backlash(a) => vec![vec![Box::new(move |r| along(a, -r.approach[a]))]],
        Effect::LostMotion(d, a) => vec![vec![Box::new(move |r| along(d, -r.approach[a]))]],
        Effect::Squareness(a, b) => {
            let sign = if (a, b) == (0, 2) { 1.0 } else { -1.0 };
            vec![vec![Box::new(move |r| along(a, sign * r.command[b]))]]
        }
        Effect::Positioning(a) => vec![curve(a, a)],
        Effect::Straightness(d, a) => vec![curve(d, a)],
        Effect::Pitch(a) => [4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0]
            .map(|pitch| {
                let wave = std::f64::consts::TAU / pitch;
                vec![
                    Box::new(move |r: &Row| along(a, libm::sin(wave * r.command[a]))) as Column<'a>,
                    Box::new(move |r: &Row| along(a, libm::cos(wave * r.command[a]))),
                ]
            })
            .into(),
        Effect::Angular(about, a) => vec![
            (1..=3)
                .map(|n| {
                    Box::new(move |r: &Row| {
                        let angle = legendre(n, centred(a, r.command[a]));
                        cross_unit(about, lever(machine, a, r)).map(|c| angle * c)
                    }) as Column<'a>
                })
                .collect(),
        ],
        Effect::Sag(a) => vec![vec![Box::new(move |r| {
            let u = machine.fraction(a, r.command[a]);
            along(2, -u * u * (3.0 - u))
        })]],
        Effect::Load(d) => vec![vec![Box::new(move |r| along(d, -r.load))]],
        Effect::ServoLag(a) => vec![vec![Box::new(move |r| along(a, -r.feed * r.tangent[a]))]],
        Effect::ServoMismatch(a, b) => vec![vec![Box::new(move |r| {
            let mut v = [0.0; 3];
            if r.approach[a] != 0.0 && r.approach[b] != 0.0 {
                v[a] = -r.feed * r.tangent[a];
                v[b] = r.feed * r.tangent[b];
            }
            v
        })]],
        Effect::Step(d) => (1..30)
            .map(|k| {
                let at = span * f64::from(k) / 30.0;
                vec![Box::new(move |r: &Row| along(d, if r.time >= at { 1.0 } else { 0.0 })) as Column<'a>]
            })
            .collect(),
        Effect::Local(a) => (1..=9)
            .map(|k| {
                let place = 0.1 * f64::from(k);
                (0..3)
                    .map(|d| {
                        Box::new(move |r: &Row| {
                            let u = (machine.fraction(a, r.command[a]) - place) / 0.08;
                            along(d, libm::exp(-u * u))
                        }) as Column<'a>
                    })
                    .collect()
            })
            .collect(),
        Effect::RotaryC(d) => vec![vec![Box::new(move |r| {
            let (sine, cosine) = libm::sincos(r.turn);
            [[-cosine, sine, 0.0], [-sine, -cosine, 0.0]][d]
        })]],
        Effect::Eccentricity => vec![
            (0..2)
                .map(|k| {
                    Box::new(move |r: &Row| {
                        let seen = machine.nominal(r);
                        let centre = machine.centre.unwrap_or([0.0; 2]);
                        let (sine, cosine) = libm::sincos(r.turn);
                        let angle = [sine, cosine][k];
                        [angle * (seen[1] - centre[1]), -angle * (seen[0] - centre[0]), 0.0]
                    }) as Column<'a>
                })
                .collect(),
        ],
        Effect::ProbeLobing => vec![
            (0..3)
                .map(|k| {
                    Box::new(move |r: &Row| {
                        let around = libm::atan2(r.tangent[1], r.tangent[0]);
                        let flat = (r.tangent[0] * r.tangent[0] + r.tangent[1] * r.tangent[1]).sqrt();
                        let pole = r.tangent[2] * r.tangent[2];
                        let pre = [flat * libm::cos(3.0 * around), flat * libm::sin(3.0 * around), pole][k];
                        r.tangent.map(|t| pre * t)
                    }) as Column<'a>
                })
                .collect(),
        ],
        Effect::InstrumentDrift => {
            vec![(0..3).map(|d| Box::new(move |r: &Row| along(d, r.time / span)) as Column<'a>).collect()]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::Plan;
    use crate::dice::Dice;
    use crate::plans::{Runs, lay_out};
    use crate::shape::{Bend, form};

    /// Every withheld effect points the way its textbook column does.
    #[test]
    fn withheld_effects_have_the_sign_of_their_name() {
        let machine = Machine::random(&mut Dice::new(5, 0, 0));
        let layout = lay_out(Plan::Good, &machine, Runs::Long, &mut Dice::new(5, 0, 1));
        for effect in Effect::linear() {
            let mut dice = Dice::new(5, 0, 2);
            let withheld = form(effect, &machine, layout.span, &mut dice, Bend::Natural);
            let one_signed = variants(effect, &machine, &layout);
            if one_signed.iter().any(|variant| variant.len() != 1) || matches!(effect, Effect::Step(_)) {
                continue;
            }
            let (mut product, mut ours, mut theirs) = (0.0, 0.0, 0.0);
            for row in &layout.rows {
                let d = machine.displacement(row, &withheld(row));
                let t = one_signed[one_signed.len() / 2][0](row);
                product += (0..3).map(|i| d[i] * t[i]).sum::<f64>();
                ours += (0..3).map(|i| d[i] * d[i]).sum::<f64>();
                theirs += (0..3).map(|i| t[i] * t[i]).sum::<f64>();
            }
            let cosine = product / (ours * theirs).sqrt();
            assert!(cosine > 0.9, "{}: {cosine}", effect.id());
        }
    }

    /// The lever arms written by hand agree with the product of matrices.
    #[test]
    fn levers_agree_with_the_chain() {
        for order in [[0, 1, 2], [1, 0, 2], [2, 0, 1]] {
            let mut machine = Machine::random(&mut Dice::new(5, 0, 0));
            machine.order = order;
            let layout = lay_out(Plan::Good, &machine, Runs::Long, &mut Dice::new(6, 0, 1));
            for (about, a) in [(0, 0), (1, 0), (2, 1), (0, 2), (1, 2), (2, 0)] {
                for row in layout.rows.iter().step_by(50) {
                    let mut c = crate::machine::Contribution::default();
                    c.angular[a][about] = 1e-6;
                    let exact = machine.displacement(row, &c);
                    let first_order = cross_unit(about, lever(&machine, a, row));
                    for i in 0..3 {
                        assert!((exact[i] - 1e-6 * first_order[i]).abs() < 1e-8, "{order:?} {about} {a} {i}");
                    }
                }
            }
        }
    }

    #[test]
    fn legendre_polynomials() {
        assert!((legendre(2, 0.5) + 0.125).abs() < 1e-15 && (legendre(3, 0.5) + 0.4375).abs() < 1e-15);
    }
}
