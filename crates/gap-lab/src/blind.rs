//! Deliberately blind plans, one for each alias.

use crate::alias::Alias;
use crate::design::{Block, Columns, Layout, Pitch, Recorder, Ways, axis_line, record};
use crate::dice::Dice;
use crate::machine::Machine;
use crate::row::Sight;

/// Rows of a deliberately blind plan.
pub(crate) fn layout(alias: Alias, turn: usize, machine: &Machine, dice: &mut Dice) -> Layout {
    blind(&blind_plan(alias, turn, dice), machine, dice)
}

/// The plan of an alias for the `turn`-th case.
fn blind_plan(alias: Alias, turn: usize, dice: &mut Dice) -> BlindPlan {
    let everywhere = vec![
        (0, [0.1, 0.2]),
        (1, [0.9, 0.2]),
        (2, [0.1, 0.9]),
        (0, [0.9, 0.8]),
        (1, [0.2, 0.9]),
        (2, [0.8, 0.2]),
    ];
    let mut plan = BlindPlan {
        feed: dice.pick(&[1000.0, 2000.0, 3000.0]),
        tool: [0.0, 0.0, -(dice.between(10.0, 20.0).round() * 10.0)],
        temperature: None,
        late_load: 0.0,
        lines: everywhere,
        seen: [true; 3],
        runs: 6,
    };
    match alias {
        Alias::LagOrBacklash | Alias::SquarenessOrAngle => {}
        Alias::ScaleOrThermal => plan.temperature = Some(dice.pick(&[16.5, 23.5, 25.0])),
        Alias::StraightnessOrRoll => {
            let height = dice.between(0.2, 0.8);
            plan.lines = vec![(0, [0.0, height]); 3];
            plan.runs = 3;
        }
        Alias::LoadOrStep => {
            plan.late_load = 120.0;
            plan.runs = 2;
        }
        Alias::WarmupOrDrift => {
            let axis = alias.axis(turn);
            plan.lines = vec![(axis, [0.5, 0.5]); 4];
            plan.seen = [0, 1, 2].map(|i| i == axis);
            plan.runs = 2;
        }
    }
    plan
}

/// What a deliberately blind plan is made of.
struct BlindPlan {
    /// One feed for all.
    feed: f64,
    /// One tool for all.
    tool: [f64; 3],
    /// Temperature at every row, where it does not move.
    temperature: Option<f64>,
    /// Load that comes on after a third of the lines, kg.
    late_load: f64,
    /// The axes that get lines, and the fractions of the other two axes at which they run.
    lines: Vec<(usize, [f64; 2])>,
    /// Components that are measured.
    seen: [bool; 3],
    /// Number of runs.
    runs: usize,
}

/// Records a blind plan: lines in both directions, three repeats, even steps.
fn blind(plan: &BlindPlan, machine: &Machine, dice: &mut Dice) -> Layout {
    let mut blocks = Vec::new();
    for (k, (axis, offset)) in plan.lines.iter().enumerate() {
        // Not where a run begins: its offset would take the change.
        let load = if 3 * k >= plan.lines.len() { plan.late_load } else { 0.0 };
        let targets = axis_line(dice, machine, *axis, *offset, 11, Pitch::Even);
        blocks.push(Block { targets, tool: plan.tool, feed: plan.feed, load, repeats: 3, ways: Ways::Both });
    }
    let recorder = Recorder::new(dice, Sight::Components(plan.seen));
    let mut layout = record(recorder, &blocks, plan.runs, Columns::ALL, dice);
    if let Some(temperature) = plan.temperature {
        layout.rows.iter_mut().for_each(|row| row.temperature = temperature);
    }
    layout
}
