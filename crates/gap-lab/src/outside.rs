//! Gaps that no effect of the library describes.

use crate::dice::Dice;
use crate::machine::{Contribution, Machine};
use crate::shape::Form;

/// Causes without a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outside {
    /// A dent in a place of the XY plane, felt in Z.
    Dent,
    /// Bending of the bed with temperature.
    ThermalBending,
    /// A force that follows feed and position.
    Chatter,
    /// A smooth field over the volume.
    Field,
    /// Friction that grows with load and turns with direction.
    StickSlip,
}

impl Outside {
    pub(crate) const ALL: [Self; 5] =
        [Self::Dent, Self::ThermalBending, Self::Chatter, Self::Field, Self::StickSlip];

    /// A word for tables.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Dent => "outside.dent",
            Self::ThermalBending => "outside.thermal-bending",
            Self::Chatter => "outside.chatter",
            Self::Field => "outside.field",
            Self::StickSlip => "outside.stick-slip",
        }
    }

    /// The displacement of the tip at unit size.
    pub(crate) fn form(self, machine: &Machine, dice: &mut Dice) -> Form {
        let travel = machine.travel;
        let fraction =
            move |p: [f64; 3]| [0, 1, 2].map(|a| (p[a] - travel[a][0]) / (travel[a][1] - travel[a][0]));
        let tip = |direction: [f64; 3], value: f64| Contribution {
            tip: direction.map(|d| 1e-3 * d * value),
            ..Contribution::default()
        };
        match self {
            Self::Dent => {
                let (u, v) = (dice.between(0.3, 0.7), dice.between(0.3, 0.7));
                let wide = dice.between(0.25, 0.4);
                Box::new(move |r| {
                    let s = fraction(r.command);
                    let square = (s[0] - u) * (s[0] - u) + (s[1] - v) * (s[1] - v);
                    tip(
                        [0.0, 0.0, 1.0],
                        -libm::exp(-square / (2.0 * wide * wide)) * (1.0 + 3.0 * s[0] * s[1]),
                    )
                })
            }
            Self::ThermalBending => {
                let towards = dice.pick(&[[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]);
                Box::new(move |r| {
                    let s = fraction(r.command);
                    tip(towards, (r.temperature - 20.0) * (s[0] - 0.5) * (s[0] - 0.5) * (0.3 + s[1]))
                })
            }
            Self::Chatter => {
                let (wave, speed) = (dice.between(25.0, 60.0), dice.between(0.5, 2.0));
                let towards = dice.direction();
                Box::new(move |r| {
                    let along = r.command[0] + 0.7 * r.command[1] - 0.4 * r.command[2];
                    let angle = std::f64::consts::TAU * along / wave + speed * r.feed / 1000.0;
                    tip(towards, libm::sin(angle) * (0.5 + r.feed / 4000.0))
                })
            }
            Self::Field => {
                let waves: Vec<([f64; 3], f64, [f64; 3])> = (0..6)
                    .map(|_| ([0; 3].map(|_| 4.0 * dice.normal()), dice.phase(), dice.direction()))
                    .collect();
                Box::new(move |r| {
                    let s = fraction(r.command);
                    let mut c = Contribution::default();
                    for (k, phase, towards) in &waves {
                        let value = libm::sin(k[0] * s[0] + k[1] * s[1] + k[2] * s[2] + phase);
                        c.add(&tip(*towards, value), 1.0);
                    }
                    c
                })
            }
            Self::StickSlip => {
                let axis = dice.below(3);
                let side = (axis + 1) % 3;
                Box::new(move |r| {
                    let mut towards = [0.0; 3];
                    towards[axis] = 1.0;
                    towards[side] = 0.5;
                    let s = fraction(r.command);
                    let grip = (r.load - 50.0) / 100.0 * libm::cos(7.0 * s[axis]);
                    tip(towards, -grip * r.approach[axis] * (1.0 + 2.0 * (s[side] - 0.5)))
                })
            }
        }
    }
}
