//! The plans, one function each.

use crate::design::{
    ALL_SEEN, Block, Columns, Layout, OFFSETS, Pitch, Plan, Recorder, Ways, axis_line, diagonal, record,
};
use crate::dice::Dice;
use crate::machine::Machine;
use crate::row::{Row, Sight};

/// Tools of a plan: short, long, and one with the tip off the spindle axis.
fn tools(dice: &mut Dice) -> [[f64; 3]; 3] {
    let round = |v: f64| (v / 5.0).round() * 5.0;
    let short = round(dice.between(60.0, 110.0));
    let long = round(dice.between(200.0, 300.0));
    let side = [round(dice.between(40.0, 80.0)), round(dice.between(30.0, 70.0)) * dice.sign()];
    [[0.0, 0.0, -short], [0.0, 0.0, -long], [side[0], side[1], -round(0.5 * (short + long))]]
}

/// Feeds of a plan: slow, fast, and one between.
fn feeds(dice: &mut Dice) -> [f64; 3] {
    [dice.pick(&[500.0, 800.0]), dice.pick(&[4000.0, 5000.0]), dice.pick(&[1500.0, 2000.0])]
}

/// What a run spans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Runs {
    /// Many lines.
    Long,
    /// One line each.
    OfOneLine,
}

impl Runs {
    /// How many there are: few long ones, or one for each of the lines.
    fn count(self, long: usize, lines: usize) -> usize {
        match self {
            Self::Long => long,
            Self::OfOneLine => lines,
        }
    }
}

/// Makes the rows of a plan.
pub(crate) fn lay_out(plan: Plan, machine: &Machine, runs: Runs, dice: &mut Dice) -> Layout {
    match plan {
        Plan::Good => good(machine, runs, dice),
        Plan::Sparse => {
            let (tools, feeds) = (tools(dice), feeds(dice));
            let setups = [(tools[0], feeds[0]), (tools[1], feeds[1]), (tools[0], feeds[1])];
            few(machine, &[0.5], &setups, Ways::Both, 2, runs.count(2, 9), dice)
        }
        Plan::FewLines => {
            let (tools, feeds) = (tools(dice), feeds(dice));
            few(machine, &[0.5], &[(tools[0], feeds[0])], Ways::Both, 5, runs.count(2, 3), dice)
        }
        Plan::Interferometer => {
            let mut layout = lay_out(Plan::FewLines, machine, runs, dice);
            for row in &mut layout.rows {
                row.sight = Sight::Components(row.approach.map(|a| a != 0.0));
            }
            layout
        }
        Plan::OneWay => {
            let (tools, feeds) = (tools(dice), feeds(dice));
            few(machine, &[0.1, 0.9], &[(tools[0], feeds[0])], Ways::One, 5, runs.count(2, 6), dice)
        }
        Plan::Plane => plane(machine, dice),
        Plan::Points => points(machine, dice),
        Plan::Aliased(alias, turn) => crate::blind::layout(alias, turn, machine, dice),
        Plan::BallBar => ball_bar(machine, dice),
        Plan::Turntable => turntable(machine, dice),
    }
}

fn good(machine: &Machine, runs: Runs, dice: &mut Dice) -> Layout {
    let (tools, feeds) = (tools(dice), feeds(dice));
    let lines = dice.pick(&[3, 4, 4]);
    let count = dice.pick(&[7, 9, 11]);
    let repeats = dice.pick(&[2, 2, 3]);
    let mut blocks = Vec::new();
    for axis in 0..3 {
        let mut offsets = OFFSETS;
        dice.shuffle(&mut offsets);
        for (k, offset) in offsets.into_iter().take(lines).enumerate() {
            let targets = axis_line(dice, machine, axis, offset, count, Pitch::Uneven);
            for half in 0..2 {
                blocks.push(Block {
                    targets: targets.clone(),
                    tool: tools[(k + half + axis) % 3],
                    feed: feeds[(k + 2 * half) % 3],
                    load: dice.pick(&[0.0, 0.0, 60.0, 150.0]),
                    repeats,
                    ways: Ways::Both,
                });
            }
        }
    }
    let ways = [
        [1.0, 1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, 0.0, 1.0],
        [1.0, 0.0, -1.0],
        [0.0, 1.0, 1.0],
        [0.0, 1.0, -1.0],
        [1.0, 1.0, 1.0],
    ];
    for signs in ways {
        let targets = diagonal(dice, machine, signs, count);
        for feed in feeds {
            let load = dice.pick(&[0.0, 60.0, 150.0]);
            blocks.push(Block {
                targets: targets.clone(),
                tool: tools[0],
                feed,
                load,
                repeats,
                ways: Ways::Both,
            });
        }
    }
    dice.shuffle(&mut blocks);
    let runs = runs.count(5, blocks.len());
    let recorder = Recorder::new(dice, ALL_SEEN);
    record(recorder, &blocks, runs, Columns::ALL, dice)
}

/// A few lines per axis at the given fractions of the other axes.
fn few(
    machine: &Machine,
    places: &[f64],
    setups: &[([f64; 3], f64)],
    ways: Ways,
    repeats: usize,
    runs: usize,
    dice: &mut Dice,
) -> Layout {
    let count = dice.pick(&[7, 8, 9, 11]);
    let mut blocks = Vec::new();
    for axis in 0..3 {
        for place in places {
            let targets = axis_line(dice, machine, axis, [*place, *place], count, Pitch::Uneven);
            for (tool, feed) in setups {
                let (targets, load) =
                    (targets.clone(), if blocks.len().is_multiple_of(2) { 0.0 } else { 100.0 });
                blocks.push(Block { targets, tool: *tool, feed: *feed, load, repeats, ways });
            }
        }
    }
    if setups.len() > 1 {
        dice.shuffle(&mut blocks);
    }
    let recorder = Recorder::new(dice, ALL_SEEN);
    record(recorder, &blocks, runs, Columns::ALL, dice)
}

fn plane(machine: &Machine, dice: &mut Dice) -> Layout {
    let (tools, feeds) = (tools(dice), feeds(dice));
    let height = dice.between(0.2, 0.8);
    let lines = dice.pick(&[6, 7, 8]);
    let mut blocks = Vec::new();
    for k in 0..lines {
        let across = 0.05 + 0.9 * f64::from(k) / f64::from(lines - 1);
        let targets = axis_line(dice, machine, 0, [across, height], 9, Pitch::Uneven);
        let (tool, feed) = (tools[0], feeds[0]);
        blocks.push(Block { targets, tool, feed, load: 0.0, repeats: 2, ways: Ways::Both });
    }
    let recorder = Recorder::new(dice, ALL_SEEN);
    record(recorder, &blocks, 2, Columns { load: false, ..Columns::ALL }, dice)
}

fn points(machine: &Machine, dice: &mut Dice) -> Layout {
    let (tools, feeds) = (tools(dice), feeds(dice));
    let count = dice.pick(&[120, 200, 300]);
    let mut recorder = Recorder::new(dice, ALL_SEEN);
    for k in 0..count {
        recorder.clock += 20.0;
        let command = machine.travel.map(|[low, high]| {
            let value = low + dice.between(0.03, 0.97) * (high - low);
            (value * 100.0).round() / 100.0
        });
        let tangent = dice.direction();
        recorder.rows.push(Row {
            run: usize::from(k >= count / 2),
            command,
            turn: 0.0,
            tool: tools[k % 2],
            approach: tangent.map(f64::signum),
            tangent,
            since_reversal: [60.0; 3],
            feed: feeds[0],
            load: 0.0,
            time: recorder.clock,
            temperature: recorder.temperature(),
            repeat: 1,
            sight: ALL_SEEN,
        });
    }
    recorder.finish(Columns { approach: false, feed: false, load: false, ..Columns::ALL })
}

/// The hold-out: other lines and other points, the feeds, tools and loads of the measured plan, spread
/// over the same time. Three runs of its own.
pub(crate) fn hold_out(plan: Plan, machine: &Machine, measured: &Layout, dice: &mut Dice) -> Layout {
    if matches!(plan, Plan::BallBar | Plan::Turntable) {
        return lay_out(plan, machine, Runs::Long, dice);
    }
    if matches!(plan, Plan::Aliased(..)) {
        // Blind in the same way: what the measurement could not tell apart must not matter here either.
        let mut layout = lay_out(plan, machine, Runs::Long, dice);
        for (row, twin) in layout.rows.iter_mut().zip(&measured.rows) {
            (row.tool, row.feed, row.load) = (twin.tool, twin.feed, twin.load);
            (row.time, row.temperature) = (twin.time, twin.temperature);
        }
        layout.span = measured.span;
        return layout;
    }
    let mut recorder = Recorder::new(dice, ALL_SEEN);
    let conditions: Vec<&Row> = (0..9).map(|_| &measured.rows[dice.below(measured.rows.len())]).collect();
    let mut blocks: Vec<Block> = Vec::new();
    for (k, from) in conditions.into_iter().enumerate() {
        let offset = [dice.between(0.1, 0.9), dice.between(0.1, 0.9)];
        let axis = if plan == Plan::Plane { 0 } else { k % 3 };
        let targets = if plan == Plan::Good && k >= 7 {
            diagonal(dice, machine, [[1.0, 1.0, 0.0], [0.0, 1.0, 1.0]][k - 7], 9)
        } else {
            axis_line(dice, machine, axis, offset, 9, Pitch::Uneven)
        };
        let ways = if plan == Plan::OneWay { Ways::One } else { Ways::Both };
        blocks.push(Block { targets, tool: from.tool, feed: from.feed, load: from.load, repeats: 1, ways });
    }
    // The same stretch of time, weather and all: the instrument came back between the runs.
    recorder.weather = [0.0; 5];
    let mut layout = record(recorder, &blocks, 3, measured.columns, dice);
    let count = layout.rows.len();
    for (k, row) in layout.rows.iter_mut().enumerate() {
        let twin = &measured.rows[k * (measured.rows.len() - 1) / (count - 1)];
        (row.time, row.temperature) = (twin.time, twin.temperature);
    }
    if plan == Plan::Interferometer {
        for row in &mut layout.rows {
            row.sight = Sight::Components(row.approach.map(|a| a != 0.0));
        }
    }
    layout.span = measured.span;
    layout
}

fn ball_bar(machine: &Machine, dice: &mut Dice) -> Layout {
    let smallest = machine.travel.iter().map(|[low, high]| high - low).fold(f64::INFINITY, f64::min);
    let radius = if smallest > 320.0 { 150.0 } else { 100.0 };
    let feeds = feeds(dice);
    let tool = [0.0, 0.0, -100.0];
    let middle = machine.travel.map(|[low, high]| (0.5 * (low + high)).round());
    let centre = [0, 1, 2].map(|i| middle[i] + tool[i]);
    let mut recorder = Recorder::new(dice, Sight::Ball(centre));
    let step = 5.0f64.to_radians();
    for (run, (u, v)) in [(0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
        for feed in feeds {
            for turn in [1.0, -1.0] {
                recorder.clock += 60.0;
                for k in 0..72 {
                    recorder.clock += step * radius / feed * 60.0;
                    // Half a step off the quadrant, where the sign of the direction would be undefined.
                    let angle = turn * (k as f64 + 0.5) * step;
                    let (sine, cosine) = libm::sincos(angle);
                    let mut command = middle;
                    command[u] += (radius * cosine * 1e4).round() / 1e4;
                    command[v] += (radius * sine * 1e4).round() / 1e4;
                    let mut tangent = [0.0; 3];
                    tangent[u] = -turn * sine;
                    tangent[v] = turn * cosine;
                    let mut since_reversal = [0.0; 3];
                    since_reversal[u] = radius * (1.0 - cosine.abs());
                    since_reversal[v] = radius * (1.0 - sine.abs());
                    // Each axis runs towards its own quadrant point in half of the time.
                    for (axis, towards) in [(u, tangent[u] * cosine > 0.0), (v, tangent[v] * sine > 0.0)] {
                        if towards {
                            since_reversal[axis] = 2.0 * radius - since_reversal[axis];
                        }
                    }
                    recorder.rows.push(Row {
                        run,
                        command,
                        turn: 0.0,
                        tool,
                        approach: tangent.map(|t| if t == 0.0 { 0.0 } else { t.signum() }),
                        tangent,
                        since_reversal,
                        feed,
                        load: 0.0,
                        time: (recorder.clock * 10.0).round() / 10.0,
                        temperature: recorder.temperature(),
                        repeat: 1,
                        sight: recorder.sight,
                    });
                }
            }
        }
    }
    recorder.finish(Columns { load: false, ..Columns::ALL })
}

fn turntable(machine: &Machine, dice: &mut Dice) -> Layout {
    let mut recorder = Recorder::new(dice, ALL_SEEN);
    let centre = machine.centre.unwrap_or([0.0; 2]);
    for run in 0..6 {
        let (radius, height) =
            ([40.0, 80.0, 120.0][run % 3], machine.travel[2][0] + 20.0 + 40.0 * (run / 3) as f64);
        for repeat in 1..=2 {
            for k in 0..24 {
                recorder.clock += 15.0;
                let turn = 15.0 * f64::from(k);
                let (sine, cosine) = libm::sincos(0.7 * run as f64);
                let round = |v: f64| (v * 1000.0).round() / 1000.0;
                recorder.rows.push(Row {
                    run,
                    command: [round(centre[0] + radius * cosine), round(centre[1] + radius * sine), height],
                    turn: turn.to_radians(),
                    tool: [0.0; 3],
                    approach: [0.0; 3],
                    tangent: [0.0; 3],
                    since_reversal: [50.0; 3],
                    feed: 1000.0,
                    load: 0.0,
                    time: recorder.clock,
                    temperature: recorder.temperature(),
                    repeat,
                    sight: ALL_SEEN,
                });
            }
        }
    }
    let columns = Columns { approach: false, feed: false, tool: false, load: false, ..Columns::ALL };
    recorder.finish(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn machine() -> Machine {
        Machine::random(&mut Dice::new(1, 1, 1))
    }

    #[test]
    fn a_good_plan_varies_everything_and_is_neither_small_nor_huge() {
        let layout = lay_out(Plan::Good, &machine(), Runs::OfOneLine, &mut Dice::new(3, 0, 0));
        assert!((300..=3000).contains(&layout.rows.len()), "{}", layout.rows.len());
        let count = |mut values: Vec<i64>| {
            values.sort_unstable();
            values.dedup();
            values.len()
        };
        assert_eq!(count(layout.rows.iter().map(|r| r.feed as i64).collect()), 3);
        assert_eq!(count(layout.rows.iter().map(|r| r.tool[2] as i64).collect()), 3);
        assert_eq!(count(layout.rows.iter().map(|r| r.approach[0] as i64).collect()), 3);
        assert!(count(layout.rows.iter().map(|r| r.temperature as i64).collect()) >= 4);
        assert!(layout.rows.windows(2).all(|w| w[0].time < w[1].time), "time runs forward");
        for row in &layout.rows {
            for a in 0..3 {
                let [low, high] = machine().travel[a];
                assert!(low <= row.command[a] && row.command[a] <= high, "inside the travel");
            }
        }
    }

    #[test]
    fn ball_bar_circles_keep_their_radius_and_know_their_direction() {
        let layout = lay_out(Plan::BallBar, &machine(), Runs::Long, &mut Dice::new(3, 0, 0));
        for row in &layout.rows {
            let Sight::Ball(centre) = row.sight else { panic!("a ball bar") };
            let arm = [0, 1, 2].map(|i| row.tip()[i] - centre[i]);
            let length = (arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2]).sqrt();
            assert!((length - 100.0).abs() < 1e-3 || (length - 150.0).abs() < 1e-3);
            let across: f64 = (0..3).map(|i| arm[i] * row.tangent[i]).sum();
            assert!(across.abs() < 1e-3, "the tangent is square to the radius");
        }
        let next_to_reversal = layout.rows.iter().map(|r| r.since_reversal[0]).fold(f64::INFINITY, f64::min);
        assert!(next_to_reversal < 1.0, "{next_to_reversal}");
    }

    #[test]
    fn one_way_plans_have_one_direction() {
        let layout = lay_out(Plan::OneWay, &machine(), Runs::OfOneLine, &mut Dice::new(5, 0, 0));
        assert!(layout.rows.iter().all(|r| r.approach.iter().all(|a| *a >= 0.0)));
    }
}
