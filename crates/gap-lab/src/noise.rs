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
    /// The components scatter in the ratio 1 : 2 : 3, in any order.
    Uneven,
    /// Every reading keeps a share of 0.5 to 0.9 of the one before in its run (first order autoregression).
    Serial,
    /// White noise on a walk of 0.1 to 0.4 σ per reading that begins anew in every run.
    Walk,
    /// The display shows steps of 1 to 4 σ.
    Rounded,
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

    /// Kinds that are not what a least-squares fit takes for granted.
    pub const DOUBTFUL: [Self; 4] = [Self::Uneven, Self::Serial, Self::Walk, Self::Rounded];

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
            Self::Uneven => "uneven components",
            Self::Serial => "serial correlation",
            Self::Walk => "random walk",
            Self::Rounded => "coarse display",
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
    let mut character = Character::of(kind, dice);
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
            character.act(row.run, &mut noise, dice);
            let t = row.time / layout.span;
            let drift = size * (t + 0.3 * libm::sin(bend * t + phase));
            [0, 1, 2].map(|i| {
                let drifted = if kind == NoiseKind::Drift { drift * towards[i] } else { 0.0 };
                noise[i] + offsets[row.run][i] + drifted
            })
        })
        .collect()
}

/// What makes noise neither independent nor alike in all components, and where it stands.
struct Character {
    kind: NoiseKind,
    /// Sizes of the components, mean square 1.
    sizes: [f64; 3],
    /// Share kept, step of the walk, or step of the display.
    number: f64,
    run: usize,
    state: [f64; 3],
}

impl Character {
    /// Draws nothing for the older kinds: their cases stay what they were.
    fn of(kind: NoiseKind, dice: &mut Dice) -> Self {
        let mut sizes = [1.0; 3];
        let number = match kind {
            NoiseKind::Uneven => {
                let first = dice.below(3);
                let size = |k: usize| (1 + (k + first) % 3) as f64 / (14.0_f64 / 3.0).sqrt();
                sizes = [size(0), size(1), size(2)];
                0.0
            }
            NoiseKind::Serial => dice.between(0.5, 0.9),
            NoiseKind::Walk => dice.between(0.1, 0.4),
            NoiseKind::Rounded => dice.between(1.0, 4.0),
            _ => 0.0,
        };
        Self { kind, sizes, number, run: usize::MAX, state: [0.0; 3] }
    }

    fn act(&mut self, run: usize, noise: &mut [f64; 3], dice: &mut Dice) {
        let new = run != self.run;
        self.run = run;
        let number = self.number;
        match self.kind {
            NoiseKind::Uneven => (0..3).for_each(|i| noise[i] *= self.sizes[i]),
            NoiseKind::Serial if new => self.state = *noise,
            NoiseKind::Serial => {
                let fresh = (1.0 - number * number).sqrt();
                (0..3).for_each(|i| self.state[i] = number * self.state[i] + fresh * noise[i]);
                *noise = self.state;
            }
            NoiseKind::Walk => {
                for (noise, state) in noise.iter_mut().zip(&mut self.state) {
                    *state = if new { 0.0 } else { *state + number * dice.normal() };
                    *noise += *state;
                }
            }
            NoiseKind::Rounded => (0..3).for_each(|i| noise[i] = (noise[i] / number).round() * number),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::Plan;
    use crate::machine::Machine;
    use crate::plans::{Runs, lay_out};

    fn noise(kind: NoiseKind) -> Vec<f64> {
        let machine = Machine::random(&mut Dice::new(1, 0, 0));
        let layout = lay_out(Plan::Good, &machine, Runs::OfOneLine, &mut Dice::new(1, 0, 1));
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

    /// Correlation of a component with itself a row later, and size by component.
    #[test]
    fn doubtful_kinds_are_what_they_are_called() {
        let later = |v: &[f64]| {
            let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
            sum(&v[3..], &v[..v.len() - 3]) / sum(v, v)
        };
        assert!(later(&noise(NoiseKind::Plain)).abs() < 0.1);
        assert!((0.4..0.95).contains(&later(&noise(NoiseKind::Serial))));
        assert!(later(&noise(NoiseKind::Walk)) > 0.1);
        let uneven = noise(NoiseKind::Uneven);
        let size = |c: usize| uneven.iter().skip(c).step_by(3).map(|v| v * v).sum::<f64>();
        let (most, least) = (size(0).max(size(1)).max(size(2)), size(0).min(size(1)).min(size(2)));
        // Variances 1 : 9.
        assert!((7.0..11.0).contains(&(most / least)), "{}", most / least);
        let mut rounded = noise(NoiseKind::Rounded);
        rounded.sort_by(f64::total_cmp);
        rounded.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        assert!(rounded.len() < 10, "{}", rounded.len());
    }
}
