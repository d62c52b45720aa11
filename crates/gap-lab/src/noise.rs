//! What the instrument adds.

use crate::design::Layout;
use crate::dice::Dice;

/// The kind of noise of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoiseKind {
    /// Independent and normal; no offset between runs.
    Plain,
    /// Every run has an offset of its own, 0.4 to 3 σ.
    RunOffsets,
    /// Student's t with three degrees of freedom.
    HeavyTails,
    /// The instrument drifts slowly, in a random direction.
    Drift,
    /// Two rows in a hundred are wrong by 8 to 30 σ.
    Outliers,
    /// The declared uncertainty is half of the true one.
    DeclaredHalf,
    /// The declared uncertainty is twice the true one.
    DeclaredDouble,
}

impl NoiseKind {
    /// All kinds.
    pub const ALL: [Self; 7] = [
        Self::Plain,
        Self::RunOffsets,
        Self::HeavyTails,
        Self::Drift,
        Self::Outliers,
        Self::DeclaredHalf,
        Self::DeclaredDouble,
    ];

    /// A word for tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::RunOffsets => "run offsets",
            Self::HeavyTails => "heavy tails",
            Self::Drift => "instrument drift",
            Self::Outliers => "2 % outliers",
            Self::DeclaredHalf => "declared × 0.5",
            Self::DeclaredDouble => "declared × 2",
        }
    }

    /// What the file declares, as a multiple of the truth; `None` where it declares nothing.
    pub(crate) fn declared(self, dice: &mut Dice) -> Option<f64> {
        match self {
            Self::DeclaredHalf => Some(0.5),
            Self::DeclaredDouble => Some(2.0),
            _ => dice.chance(0.5).then_some(1.0),
        }
    }

    /// Size of the run offsets as a multiple of σ.
    pub(crate) fn run_offset(self, dice: &mut Dice) -> f64 {
        match self {
            Self::Plain => 0.0,
            Self::RunOffsets => dice.scale(0.4, 3.0),
            _ => 0.4,
        }
    }
}

/// Noise of every row in three directions, in units of σ, run offsets and drift included.
pub(crate) fn draw(kind: NoiseKind, offset: f64, layout: &Layout, dice: &mut Dice) -> Vec<[f64; 3]> {
    let runs = layout.rows.iter().map(|r| r.run).max().unwrap_or(0) + 1;
    let offsets: Vec<[f64; 3]> = (0..runs).map(|_| [0; 3].map(|_| offset * dice.normal())).collect();
    let (towards, size) = (dice.direction(), dice.between(1.0, 3.0));
    let (phase, bend) = (dice.phase(), dice.between(1.0, 3.0));
    layout
        .rows
        .iter()
        .map(|row| {
            let mut noise = [0; 3].map(|_| match kind {
                NoiseKind::HeavyTails => dice.heavy(),
                _ => dice.normal(),
            });
            if kind == NoiseKind::Outliers && dice.chance(0.02) {
                noise[dice.below(3)] += dice.sign() * dice.between(8.0, 30.0);
            }
            let t = row.time / layout.span;
            let drift = size * (t + 0.3 * libm::sin(bend * t + phase));
            [0, 1, 2].map(|i| {
                let drifted = if kind == NoiseKind::Drift { drift * towards[i] } else { 0.0 };
                noise[i] + offsets[row.run][i] + drifted
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::Plan;
    use crate::machine::Machine;
    use crate::plans::lay_out;

    fn noise(kind: NoiseKind) -> Vec<f64> {
        let machine = Machine::random(&mut Dice::new(1, 0, 0), false);
        let layout = lay_out(Plan::Good, &machine, false, &mut Dice::new(1, 0, 1));
        draw(kind, 0.0, &layout, &mut Dice::new(1, 0, 2)).into_iter().flatten().collect()
    }

    #[test]
    fn kinds_differ_as_their_names_say() {
        let far = |v: &[f64]| v.iter().filter(|x| x.abs() > 6.0).count() as f64 / v.len() as f64;
        let (plain, outliers) = (noise(NoiseKind::Plain), noise(NoiseKind::Outliers));
        assert!((crate::linear::rms(&plain) - 1.0).abs() < 0.05);
        assert!(far(&plain) == 0.0 && (0.003..0.012).contains(&far(&outliers)), "{}", far(&outliers));
        assert!(crate::linear::rms(&noise(NoiseKind::Drift)) > 1.1);
        assert!(far(&noise(NoiseKind::HeavyTails)) > 0.001);
    }
}
