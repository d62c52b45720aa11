//! The budget and what follows from it.

use crate::datums::FromZero;
use diagnostic::{Text, both};
use error_budget::mending::{self, Mending};
use error_budget::tolerances::{Figure, Tolerances, equal_influence};
use error_budget::{
    Budget, Criteria, Extreme, Field, Machine, Unit, balanced_signs, root_sum_of_squares, worst_case,
};
use machine_model::{Command, PathModel, Placement, Vector, WithEffects, counted_from_datum};
use rayon::prelude::*;

use super::control_points::ControlPoints;

/// What is known of a machine's accuracy, deviation by deviation.
pub struct Study {
    /// Of the machine.
    pub name: String,
    /// Its deviations.
    pub machine: Machine,
    /// Where its error counts.
    pub points: ControlPoints,
    /// From where errors count.
    pub from_zero: FromZero,
    /// What each deviation costs.
    pub budget: Budget,
    /// Every function as measured or mirrored.
    pub mirrored: Combined,
    /// Every function anywhere within ± its size.
    pub within_sizes: Combined,
    /// What it takes to reach what is wanted.
    pub target: Option<Target>,
}

/// What deviations with free signs may come to, and the whole model beside the sums.
pub struct Combined {
    /// What no choice of signs is above.
    pub worst: Extreme,
    /// M of the whole model with the worst signs, mm.
    pub worst_whole_mm: f64,
    /// What machines with independent signs have in the mean of squares, mm.
    pub squares_mm: f64,
    /// At which point.
    pub squares_at: usize,
    /// Root mean square of the whole model at that point over balanced signs, mm.
    pub squares_whole_mm: f64,
}

/// What it takes to reach a wanted M.
pub struct Target {
    /// Wanted, mm.
    pub mm: f64,
    /// By deviation: it stays as it is.
    pub keep: Vec<bool>,
    /// M as measured is not above it.
    pub met: bool,
    /// What to mend on this machine.
    pub mending: Mending,
    /// What each may be in the worst case.
    pub worst_case: Option<Tolerances>,
    /// The same where signs are independent.
    pub statistical: Option<Tolerances>,
}

impl Target {
    /// Why something of what was asked for cannot be had; `None` where all can.
    pub fn out_of_reach(&self) -> Option<Text> {
        let parts = [
            (self.mending.steps.is_none(), MENDING_OUT_OF_REACH.clone()),
            (
                self.worst_case.is_none(),
                both!(
                    "the worst case of what is kept leaves nothing for the others",
                    "наихудший случай сохраняемого не оставляет остальным ничего"
                ),
            ),
            (
                self.statistical.is_none(),
                both!(
                    "the root sum of squares of what is kept leaves nothing for the others",
                    "корень из суммы квадратов сохраняемого не оставляет остальным ничего"
                ),
            ),
        ];
        let said: Vec<Text> = parts.into_iter().filter_map(|(is, words)| is.then_some(words)).collect();
        (!said.is_empty()).then(|| Text::join(&said, "; "))
    }
}

/// Said on the page and in the warning.
pub static MENDING_OUT_OF_REACH: Text = Text::pair(
    "M as measured stays above it, whichever of the others are mended",
    "M, как измерено, остаётся больше, что бы из остального ни исправить",
);

fn counted(model: &WithEffects, command: &Command, datum: Placement) -> Vector {
    counted_from_datum(model, model.error_mm(command), &Command { datum, ..*command })
}

impl Study {
    /// All that follows from a machine at these points.
    pub fn new(
        name: String,
        machine: Machine,
        points: ControlPoints,
        from_zero: FromZero,
        target: Option<(f64, Vec<bool>)>,
    ) -> Self {
        let commands = &points.commands;
        // Each point is computed by itself, so the number of threads changes nothing.
        let evaluate = |model: &WithEffects| -> Vec<Vector> {
            // Each would have been touched by itself.
            let datum = from_zero.placement(model);
            commands.par_iter().with_min_len(256).map(|command| counted(model, command, datum)).collect()
        };
        let some = "there are control points: files without any were refused";
        let budget = Budget::new(&machine, evaluate).expect(some);
        let sized = machine.at_its_sizes();
        let field = Field {
            contributions_mm: (0..machine.deviations().len())
                .map(|deviation| evaluate(&sized.scaled(&alone(&machine, deviation))))
                .collect(),
        };
        let target = target.map(|(mm, keep)| {
            let tolerances = |figure| {
                let one = |model: &WithEffects, point: usize| {
                    counted(model, &commands[point], from_zero.placement(model))
                };
                equal_influence(&sized, &field, &keep, mm, figure, one, evaluate)
            };
            Target {
                met: budget.measured.largest_mm <= mm,
                mending: mending::shortest(&machine, &budget, &keep, mm, evaluate),
                worst_case: tolerances(Figure::WorstCase),
                statistical: tolerances(Figure::Statistical),
                mm,
                keep,
            }
        });
        Self {
            mirrored: Combined::of(&machine, &budget.field, commands, evaluate),
            within_sizes: Combined::of(&sized, &field, commands, evaluate),
            from_zero,
            name,
            budget,
            target,
            machine,
            points,
        }
    }

    /// All control points stay where they are, whatever the machine does wrong.
    pub fn moves_nothing(&self) -> bool {
        self.budget.items.iter().all(|item| item.alone.largest_mm == 0.0)
    }

    /// Name, size in the unit that is printed, and that unit.
    pub fn deviation(&self, index: usize) -> (&str, f64, Text) {
        let deviation = &self.machine.deviations()[index];
        let (size, unit) = match deviation.unit {
            Unit::Length => (deviation.size * 1e3, Text::pair("um", "мкм")),
            Unit::Angle => (deviation.size * 1e6, Text::pair("urad", "мкрад")),
            Unit::Parameter(name) => (deviation.size, Text::pair(name, name)),
            Unit::Whole => (deviation.size, Text::pair("times as found", "от найденного")),
        };
        (&deviation.name, size, unit)
    }

    /// A tolerance in the unit of the deviation's size, rounded down to three digits: smaller is allowed.
    pub fn tolerance(&self, tolerances: &Tolerances, index: usize) -> Option<f64> {
        let (_, size, _) = self.deviation(index);
        tolerances.factors[index].map(|factor| {
            let value = factor * size;
            let steps = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6];
            let step = steps.into_iter().find(|step| value * step >= 100.0).unwrap_or(1e6);
            (value * step).floor() / step
        })
    }
}

/// Coefficients that leave one deviation.
fn alone(machine: &Machine, deviation: usize) -> Vec<f64> {
    let of = |other: usize| if other == deviation { 1.0 } else { 0.0 };
    (0..machine.deviations().len()).map(of).collect()
}

impl Combined {
    fn of(
        machine: &Machine,
        field: &Field,
        commands: &[Command],
        evaluate: impl Fn(&WithEffects) -> Vec<Vector>,
    ) -> Self {
        let worst = worst_case(field);
        let whole = Criteria::of(&evaluate(&machine.scaled(&worst.signs)));
        let (squares_mm, squares_at) = root_sum_of_squares(field);
        let rows = balanced_signs(field.contributions_mm.len());
        let square = |signs: &Vec<f64>| {
            machine.scaled(signs).error_mm(&commands[squares_at]).norm_squared() / rows.len() as f64
        };
        Self {
            worst_whole_mm: whole.map_or(0.0, |found| found.largest_mm),
            worst,
            squares_mm,
            squares_at,
            squares_whole_mm: rows.iter().map(square).sum::<f64>().sqrt(),
        }
    }
}
