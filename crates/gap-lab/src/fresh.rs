//! Points that no fit has seen, with the truth about them.

use std::fmt::Write;

use crate::collinearity::View;
use crate::design::Layout;
use crate::linear::dot;
use crate::machine::Machine;

/// The hold-out of a case, as only the lab knows it.
#[derive(Clone, Debug)]
pub struct Fresh {
    pub(crate) machine: Machine,
    pub(crate) layout: Layout,
    /// Displacement by the withheld effects, µm.
    pub(crate) field_um: Vec<[f64; 3]>,
    /// Noise with run offsets and drift, µm.
    pub(crate) noise_um: Vec<[f64; 3]>,
}

/// Root mean square per row of the gap on fresh points, set-up and run offsets removed, µm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shrink {
    /// With the profile as handed out.
    pub before_um: f64,
    /// With the explained displacement taken away.
    pub after_um: f64,
}

impl Shrink {
    /// The part of the gap that went away.
    #[must_use]
    pub fn share(self) -> f64 {
        1.0 - self.after_um / self.before_um
    }
}

impl Fresh {
    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.layout.rows.len()
    }

    /// True without rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.layout.rows.is_empty()
    }

    /// The commands as points for `vpost predict`.
    ///
    /// With the angle of the table where the machine has one: what the linear axes do wrong is seen from a workpiece that it
    /// has turned.
    #[must_use]
    pub fn points_csv(&self) -> String {
        let table = self.machine.centre.is_some();
        let mut text = String::from("x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm,dir_x,dir_y,dir_z");
        text.push_str(if table { ",c_deg\n" } else { "\n" });
        for row in &self.layout.rows {
            let ([x, y, z], [tx, ty, tz], [dx, dy, dz]) = (row.command, row.tool, row.approach);
            write!(text, "{x:.4},{y:.4},{z:.4},{tx:.1},{ty:.1},{tz:.1},{dx:.0},{dy:.0},{dz:.0}")
                .expect("writing to a string cannot fail");
            if table {
                write!(text, ",{:.3}", row.turn.to_degrees()).expect("writing to a string cannot fail");
            }
            text.push('\n');
        }
        text
    }

    /// What the machine model of the profile alone predicts at every row, by the lab's own kinematics, µm.
    #[must_use]
    pub fn known_um(&self) -> Vec<[f64; 3]> {
        let none = crate::machine::Contribution::default();
        let rows = self.layout.rows.iter();
        rows.map(|row| {
            let (p, q) = (self.machine.position(row, &none), self.machine.nominal(row));
            [0, 1, 2].map(|i| (p[i] - q[i]) * 1e3)
        })
        .collect()
    }

    /// What is left of the true gap, noise included, when `explained_um` is predicted at every row.
    #[must_use]
    pub fn shrink(&self, explained_um: &[[f64; 3]]) -> Shrink {
        let view = View::new(&self.machine, &self.layout);
        let size = |field: &[[f64; 3]]| {
            let clean = view.clean_rows(field);
            (dot(&clean, &clean) / self.layout.rows.len() as f64).sqrt()
        };
        let sum = |sign: f64| -> Vec<[f64; 3]> {
            let rows = self.field_um.iter().zip(&self.noise_um).zip(explained_um);
            rows.map(|((f, n), e)| [0, 1, 2].map(|i| f[i] + n[i] - sign * e[i])).collect()
        };
        Shrink { before_um: size(&sum(0.0)), after_um: size(&sum(1.0)) }
    }

    /// Root mean square per row of the noise alone after the same removal, µm.
    #[must_use]
    pub fn noise_rms_um(&self) -> f64 {
        let view = View::new(&self.machine, &self.layout);
        let clean = view.clean_rows(&self.noise_um);
        (dot(&clean, &clean) / self.layout.rows.len() as f64).sqrt()
    }

    /// Displacement by the withheld effects at every row, µm.
    #[must_use]
    pub fn field_um(&self) -> &[[f64; 3]] {
        &self.field_um
    }
}

#[cfg(test)]
mod tests {
    use crate::{Kind, catalogue};

    #[test]
    fn points_of_a_turned_table_tell_its_angle() {
        let list = catalogue(1200, 8);
        let spec = list.iter().find(|s| s.kind == Kind::Rotary).unwrap();
        let fresh = spec.build().fresh;
        let points = fresh.points_csv();
        let lines: Vec<Vec<&str>> = points.lines().map(|line| line.split(',').collect()).collect();
        let angle = lines[0].iter().position(|head| *head == "c_deg").expect("a column of the table's angle");
        for (line, row) in lines[1..].iter().zip(&fresh.layout.rows) {
            assert!((line[angle].parse::<f64>().unwrap() - row.turn.to_degrees()).abs() < 1e-3);
        }
        assert!(
            fresh.layout.rows.iter().any(|row| row.turn != 0.0),
            "a table that stands still shows nothing"
        );
    }

    #[test]
    fn the_truth_explains_the_gap_down_to_the_noise() {
        let list = catalogue(1200, 8);
        let spec = list.iter().find(|s| s.kind == Kind::Single && s.snr[0] > 5.0).unwrap();
        let fresh = spec.build().fresh;
        let all = fresh.shrink(fresh.field_um());
        let nothing = fresh.shrink(&vec![[0.0; 3]; fresh.len()]);
        assert!((all.after_um - fresh.noise_rms_um()).abs() < 1e-9);
        assert!((nothing.after_um - nothing.before_um).abs() < 1e-12);
        assert!(all.share() > 0.5, "{all:?}");
    }
}
