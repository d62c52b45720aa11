//! The rigid-body chain of a synthetic machine.
//!
//! Written as products of homogeneous matrices, workpiece to tool. An axis' error functions are the tool
//! side relative to the workpiece side as read along the measured line, so an axis has no lever arm of
//! its own travel: its matrix translates first and rotates second.

use crate::dice::Dice;
use crate::matrix::{IDENTITY, Matrix, carry, shift, tilt, times, turn};
use crate::row::Row;

/// What effects add to the chain at one row; everything is small.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Contribution {
    /// Translations of each axis X, Y, Z, mm.
    pub(crate) linear: [[f64; 3]; 3],
    /// Rotations of each axis about X, Y, Z, rad.
    pub(crate) angular: [[f64; 3]; 3],
    /// Displacement of the tip itself, workpiece frame, mm.
    pub(crate) tip: [f64; 3],
    /// Where the axis of C really stands against where it should, mm.
    pub(crate) centre: [f64; 2],
    /// Angle that C really has beyond its command, rad.
    pub(crate) spin: f64,
}

impl Contribution {
    /// Adds `k` times another contribution.
    pub(crate) fn add(&mut self, other: &Self, k: f64) {
        for axis in 0..3 {
            for i in 0..3 {
                self.linear[axis][i] += k * other.linear[axis][i];
                self.angular[axis][i] += k * other.angular[axis][i];
            }
            self.tip[axis] += k * other.tip[axis];
        }
        self.centre[0] += k * other.centre[0];
        self.centre[1] += k * other.centre[1];
        self.spin += k * other.spin;
    }
}

/// Measured errors of one axis that the profile knows.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// Commands at which the errors are given, mm, rising.
    pub(crate) nodes: Vec<f64>,
    /// Errors at each node: three translations in µm, three rotations in µrad, as they stand in the file.
    pub(crate) values: Vec<[f64; 6]>,
}

impl Table {
    /// Errors at a command, linear between the nodes; mm and rad.
    fn at(&self, position: f64) -> ([f64; 3], [f64; 3]) {
        let last = self.nodes.len() - 1;
        let right = self.nodes.iter().position(|n| *n > position).unwrap_or(last).max(1);
        let (a, b) = (self.nodes[right - 1], self.nodes[right]);
        let w = (position - a) / (b - a);
        let value = |k: usize| (1.0 - w) * self.values[right - 1][k] + w * self.values[right][k];
        ([0, 1, 2].map(|k| value(k) * 1e-3), [3, 4, 5].map(|k| value(k) * 1e-6))
    }
}

/// A machine without its withheld effects: what the profile says.
#[derive(Clone, Debug)]
pub(crate) struct Machine {
    /// Axes in chain order from the workpiece.
    pub(crate) order: [usize; 3],
    /// First axis on the tool's side of the bed, counted in the chain.
    pub(crate) bed_before: usize,
    /// Travel of each axis, mm.
    pub(crate) travel: [[f64; 2]; 3],
    /// Known tables.
    pub(crate) tables: [Option<Table>; 3],
    /// Known squareness EC0Y, EB0Z, EA0Z, µrad.
    pub(crate) squareness_urad: [f64; 3],
    /// Where the rotary axis C stands, if the machine has one: between workpiece and the first linear axis.
    pub(crate) centre: Option<[f64; 2]>,
}

impl Machine {
    /// A machine of random size and chain, of which nothing is known.
    pub(crate) fn random(dice: &mut Dice) -> Self {
        let order = dice.pick(&[[0, 1, 2], [1, 0, 2], [0, 1, 2], [1, 0, 2], [2, 0, 1], [0, 2, 1]]);
        let round = |v: f64| (v / 10.0).round() * 10.0;
        let sizes = [dice.between(400.0, 900.0), dice.between(300.0, 600.0), dice.between(250.0, 500.0)];
        let starts = [0.0, 0.0, dice.pick(&[0.0, -1.0])];
        let travel = [0, 1, 2].map(|a| {
            let low = if starts[a] < 0.0 { -round(sizes[a]) } else { 0.0 };
            [low, low + round(sizes[a])]
        });
        Self {
            order,
            bed_before: dice.below(4),
            travel,
            tables: [None, None, None],
            squareness_urad: [0.0; 3],
            centre: None,
        }
    }

    /// The same with tables and squarenesses that are known.
    pub(crate) fn with_known_errors(mut self, dice: &mut Dice) -> Self {
        self.tables = [0, 1, 2].map(|a| Some(known_table(dice, self.travel[a], a)));
        self.squareness_urad = [0; 3].map(|_| (dice.between(-30.0, 30.0) * 10.0).round() / 10.0);
        self
    }

    /// Position of the command within the travel, 0 … 1.
    pub(crate) fn fraction(&self, axis: usize, position: f64) -> f64 {
        (position - self.travel[axis][0]) / (self.travel[axis][1] - self.travel[axis][0])
    }

    /// The chain as a profile writes it.
    pub(crate) fn chain_text(&self) -> String {
        let mut words = vec!["w".to_owned()];
        if self.centre.is_some() {
            words.push("C".into());
        }
        for (place, axis) in self.order.iter().enumerate() {
            if place == self.bed_before {
                words.push("b".into());
            }
            words.push(crate::AXES[*axis].to_string());
        }
        if self.bed_before >= 3 {
            words.push("b".into());
        }
        words.push("t".into());
        format!("[{}]", words.join(" "))
    }

    /// Where the tip should be, seen from the workpiece, mm.
    pub(crate) fn nominal(&self, row: &Row) -> [f64; 3] {
        carry(&self.table_turned(row.turn, [0.0; 2]), row.tip())
    }

    /// Where the tip is, seen from the workpiece, when the chain carries `extra` beyond what is known, mm.
    pub(crate) fn position(&self, row: &Row, extra: &Contribution) -> [f64; 3] {
        let mut chain = self.table_turned(row.turn + extra.spin, extra.centre);
        for axis in self.order {
            let mut along = self.axis_vector(axis, row.command[axis]);
            let mut angles = extra.angular[axis];
            for (value, more) in along.iter_mut().zip(extra.linear[axis]) {
                *value += more;
            }
            if let Some(table) = &self.tables[axis] {
                let (linear, angular) = table.at(row.command[axis]);
                for i in 0..3 {
                    along[i] += linear[i];
                    angles[i] += angular[i];
                }
            }
            chain = times(&chain, &times(&shift(along), &tilt(angles)));
        }
        let tip = carry(&chain, row.tool);
        [0, 1, 2].map(|i| tip[i] + extra.tip[i])
    }

    /// Displacement that `extra` causes, mm.
    pub(crate) fn displacement(&self, row: &Row, extra: &Contribution) -> [f64; 3] {
        let (with, without) = (self.position(row, extra), self.position(row, &Contribution::default()));
        [0, 1, 2].map(|i| with[i] - without[i])
    }

    /// Command times the direction of the axis, which known squareness tilts (ISO 230-1 signs), mm.
    fn axis_vector(&self, axis: usize, command: f64) -> [f64; 3] {
        let [ec0y, eb0z, ea0z] = self.squareness_urad.map(|v| v * 1e-6);
        let direction = [[1.0, 0.0, 0.0], [-ec0y, 1.0, 0.0], [eb0z, -ea0z, 1.0]][axis];
        direction.map(|c| c * command)
    }

    /// Machine frame seen from a workpiece that the table has turned.
    fn table_turned(&self, angle: f64, off: [f64; 2]) -> Matrix {
        let Some(centre) = self.centre else { return IDENTITY };
        let back = shift([-centre[0] - off[0], -centre[1] - off[1], 0.0]);
        times(&shift([centre[0], centre[1], 0.0]), &times(&turn(2, -angle), &back))
    }
}

/// A smooth table of moderate size, as an interferometer would have given it.
fn known_table(dice: &mut Dice, travel: [f64; 2], axis: usize) -> Table {
    let sizes = [0, 1, 2, 3, 4, 5].map(|k| {
        if k == axis {
            8.0
        } else if k < 3 {
            4.0
        } else {
            12.0
        }
    });
    let waves =
        sizes.map(|size| [size * dice.normal() * 0.6, size * dice.normal() * 0.4, dice.between(0.0, 6.0)]);
    let count = ((travel[1] - travel[0]) / 10.0).round() as usize + 1;
    let nodes: Vec<f64> = (0..count).map(|k| travel[0] + 10.0 * k as f64).collect();
    let values = nodes
        .iter()
        .map(|x| {
            let s = (x - travel[0]) / (travel[1] - travel[0]);
            waves.map(|[slope, wave, phase]| {
                let value = slope * s + wave * (libm::sin(4.0 * s + phase) - libm::sin(phase));
                (value * 1000.0).round() / 1000.0
            })
        })
        .collect();
    Table { nodes, values }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row::Sight;

    pub(crate) fn row(command: [f64; 3], tool: [f64; 3]) -> Row {
        Row {
            run: 0,
            command,
            turn: 0.0,
            tool,
            approach: [1.0, 0.0, 0.0],
            tangent: [1.0, 0.0, 0.0],
            since_reversal: [50.0; 3],
            feed: 1000.0,
            load: 0.0,
            time: 0.0,
            temperature: 20.0,
            repeat: 1,
            sight: Sight::Components([true; 3]),
        }
    }

    fn plain(order: [usize; 3]) -> Machine {
        Machine {
            order,
            bed_before: 2,
            travel: [[0.0, 500.0], [0.0, 400.0], [0.0, 300.0]],
            tables: [None, None, None],
            squareness_urad: [0.0; 3],
            centre: None,
        }
    }

    #[test]
    fn a_perfect_machine_goes_where_it_is_told() {
        let row = row([100.0, 200.0, 50.0], [3.0, -4.0, -120.0]);
        assert_eq!(plain([1, 0, 2]).position(&row, &Contribution::default()), [103.0, 196.0, -70.0]);
    }

    #[test]
    fn a_rotation_acts_on_the_axes_beyond_and_on_the_tool_only() {
        let row = row([100.0, 200.0, 50.0], [0.0, 0.0, -120.0]);
        let mut yaw = Contribution::default();
        yaw.angular[0][2] = 1e-5; // ECX: about Z, along X
        let first = plain([0, 1, 2]).displacement(&row, &yaw);
        assert!((first[0] + 1e-5 * 200.0).abs() < 1e-7 && first[1].abs() < 1e-7, "lever Y: {first:?}");
        let second = plain([1, 0, 2]).displacement(&row, &yaw);
        assert!(second[0].abs() < 1e-7, "Y stands before X, no lever: {second:?}");
    }

    #[test]
    fn squareness_has_the_signs_of_iso_230_1() {
        let mut machine = plain([0, 1, 2]);
        machine.squareness_urad = [10.0, 20.0, 30.0];
        let row = row([0.0, 100.0, 200.0], [0.0; 3]);
        let p = machine.position(&row, &Contribution::default());
        assert!((p[0] - (-10e-6 * 100.0 + 20e-6 * 200.0)).abs() < 1e-12);
        assert!((p[1] - (100.0 - 30e-6 * 200.0)).abs() < 1e-12);
    }

    #[test]
    fn the_table_turns_the_workpiece_backwards() {
        let mut machine = plain([0, 1, 2]);
        machine.centre = Some([10.0, 20.0]);
        let mut row = row([110.0, 20.0, 0.0], [0.0; 3]);
        row.turn = std::f64::consts::FRAC_PI_2;
        let p = machine.nominal(&row);
        assert!((p[0] - 10.0).abs() < 1e-9 && (p[1] + 80.0).abs() < 1e-9, "{p:?}");
    }

    #[test]
    fn tables_are_read_linearly_between_nodes() {
        let table = Table { nodes: vec![0.0, 10.0], values: vec![[0.0; 6], [2.0, 0.0, 0.0, 4.0, 0.0, 0.0]] };
        let (linear, angular) = table.at(5.0);
        assert!((linear[0] - 1e-3).abs() < 1e-15 && (angular[0] - 2e-6).abs() < 1e-18);
    }
}
