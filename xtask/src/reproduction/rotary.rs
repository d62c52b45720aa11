//! Zhang 2024: a rotary table by ball bar; the printed formulas beside the chain that they come from.

use crate::markdown::{fixed, table};
use crate::zhang::{BAR_MM, MODES, Mode, NAMES, OF_THE_EXPERIMENT, OF_THE_SIMULATION, Table, angles_deg};

/// What Table 2 shows: for each error the tests in which its plot is not blank (section 2.3 says the same in words).
const SHOWN: [[bool; 4]; 8] = [
    [true, true, true, true],
    [true, true, false, false],
    [false, true, false, true],
    [false, true, false, false],
    [false, false, true, true],
    [false, false, true, true],
    [false, false, false, true],
    [false, false, false, true],
];

/// A length over all angles of a test, mm.
fn over(mode: Mode, length: impl Fn(f64) -> f64) -> Vec<f64> {
    angles_deg(mode).map(|degrees| length(f64::from(degrees).to_radians())).collect()
}

fn largest_um(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max) * 1e3
}

/// How far a printed length of the bar is off the chain's, um.
fn off_um(table: &Table, mode: Mode, printed: impl Fn(f64) -> f64) -> f64 {
    let exact = over(mode, |angle| table.length_mm(mode, angle));
    largest_um(exact.iter().zip(over(mode, printed)).map(|(a, b)| a - b))
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// What each error alone does to each test.
fn influence() -> String {
    let row = |k: usize| {
        let mut alone = Table::PERFECT;
        alone.errors[k] = OF_THE_SIMULATION.errors[k];
        let cells = MODES.iter().zip(SHOWN[k]).map(|(mode, shown)| {
            let lengths = over(*mode, |angle| alone.length_mm(*mode, angle) - BAR_MM);
            let range = lengths.iter().copied().fold(f64::MIN, f64::max)
                - lengths.iter().copied().fold(f64::MAX, f64::min);
            format!("{} ({})", fixed(range * 1e3, 2), if shown { "shown" } else { "blank" })
        });
        [format!("{} ({})", NAMES[k].0, NAMES[k].1)].into_iter().chain(cells).collect()
    };
    table(&["error", "test 1", "test 2", "test 3", "test 4"], &(0..8).map(row).collect::<Vec<_>>())
}

/// The printed lengths beside the chain's.
fn formulas() -> String {
    let whole = ["(6)", "(9)", "(15)", "(18)"];
    let first = ["(19)", "(20)", "(21)", "(22)"];
    let mut rows = Vec::new();
    for (k, mode) in MODES.into_iter().enumerate() {
        let square = |t: &Table| off_um(t, mode, |angle| norm(t.printed_bar_mm(mode, angle)));
        let linear = |t: &Table| off_um(t, mode, |angle| BAR_MM + t.printed_change_mm(mode, angle));
        let both = |of: &dyn Fn(&Table) -> f64| {
            [&OF_THE_SIMULATION, &OF_THE_EXPERIMENT].map(|t| fixed(of(t), 3)).to_vec()
        };
        if mode == Mode::Three {
            let as_printed = |t: &Table| {
                off_um(t, mode, |angle| {
                    let [x, y, z] = t.printed_bar_mm(mode, angle);
                    // The second bracket without its square.
                    (x * x + y + z * z).max(0.0).sqrt()
                })
            };
            rows.push([vec!["(15) as printed".to_owned()], both(&as_printed)].concat());
        }
        let name = if mode == Mode::Three { "(15), both brackets squared" } else { whole[k] };
        rows.push([vec![name.to_owned()], both(&square)].concat());
        rows.push([vec![first[k].to_owned()], both(&linear)].concat());
    }
    table(&["formula", "Table 1, µm", "the experiment's size, µm"], &rows)
}

/// The section.
pub(super) fn section() -> String {
    let at_zero = OF_THE_SIMULATION.x_of_the_first_test_mm(0.0).map(|x| x * 1e3);
    let shortest = angles_deg(Mode::Three)
        .map(|d| (OF_THE_EXPERIMENT.spindle_length_mm(f64::from(d).to_radians()), d))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(0, |(_, d)| d);
    format!(
        "\n## A rotary table by ball bar\n\n\
         Zhang 2024 (China Mechanical Engineering 35(6)): C on A, four tests, a spindle turn. The page's matrices are (2) and (11) of the \
         publication, multiplied and inverted without leaving out anything (`xtask/src/zhang.rs`; nothing of the model). Tables 1, 2, \
         4 and 5 are pictures in the copy that was read: of their numbers those that the text repeats can be compared.\n\n\
         Which error shows in which test, each alone at the size of Table 1 (10 µm, 0.005°): range of the bar's length, µm, and what Table \
         2 shows. A over ±90°, C over the turn:\n\n{}\n\
         Blank are exactly those below 0.01 µm. The printed formulas beside the chain, largest difference over a test, µm; the cup at \
         eX = -40.3, eY = -76.5 µm:\n\n{}\n\
         Of the experiment the text prints the largest position error before and after compensation (203.5 and 5.1 µm) and the \
         cup; [five-axis.md](five-axis.md#from-the-ball-bar-to-an-impeller) has what `vpost calibrate ballbar` finds of a table of \
         that size.\n\n\
         **Defects**\n\n\
         1. (15): the second bracket lacks its square; as printed the formula is no length.\n\
         2. (4): x has the wrong sign before its second bracket; at αA = 0 it gives {} µm where the ball is at {} µm (Table 1's sizes). (6) is \
         right, and x is of second order in the length.\n\
         3. (26): with the spindle's angle right-handed about +Z the shortest reading of the printed cup stands at θ2 = {shortest}°, and the \
         formula makes eY +76.5 µm of it. Its sign holds for an angle that counts clockwise from above, as M3 turns. The columns of \
         `vpost calibrate ballbar` are right-handed.\n\
         4. Section 3.2 fits the fourth test by (18) and (23); (23) is the spindle turn, (22) is meant.\n\
         5. (23) to (26) take the cup from three readings, so their noise goes into every position error that is found with it.\n",
        influence(),
        formulas(),
        fixed(at_zero[0], 2),
        fixed(at_zero[1], 2),
    )
}
