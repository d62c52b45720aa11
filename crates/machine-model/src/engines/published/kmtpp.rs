//! KMTPP as listed (Pimushkin 2023, §4.2 and §4.3).
//!
//! The listing differs from its own equation 4.9 in two places, and both are needed to get its numbers:
//! it accumulates `Δq·Q_i` (Gᵀ instead of G), and it starts the last step from the rounded node instead of
//! from `q[m]`, which costs up to half a grid step.

use nalgebra::Matrix3;

use crate::engine::inside;
use crate::engines::tangential::PUBLISHED_INTERVAL;
use crate::engines::traverses::Traverses;
use crate::engines::{BuildError, ParametricTable};
use crate::finite_rotations::rodrigues_displacement;
use crate::{Command, Engine, EngineId, Range, Solution, SolveError, Traverse, Vector, Volume};

/// Steps after which the astatic law counts as not settling.
const MOST_STEPS: u32 = 100_000;

/// The published trace of model time.
#[derive(Clone, Debug)]
pub struct KmtppPublished {
    tables: [ParametricTable; 3],
    /// Steps of the three tables, mm.
    step_mm: Vector,
    /// Columns l_i: tracker cosines of interval 1, absolute.
    directions: Matrix3<f64>,
    offset_mm: Vector,
    /// Gain K.
    gain: f64,
    /// Step l of model time.
    time_step: f64,
}

/// Where a trace ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trace {
    /// Number of steps m.
    pub steps: u32,
    /// Last command of the trace, mm.
    pub last_mm: Vector,
    /// The table rows nearest to it, as positions, mm: the base of the published solution.
    pub node_mm: Vector,
    /// `R = r01 + s`, mm.
    pub reached_mm: Vector,
    /// Columns: directions of the axes at the end.
    pub directions: Matrix3<f64>,
}

impl KmtppPublished {
    /// The gain K of the published runs.
    pub const GAIN: f64 = 1.5;
    /// The step l that the publication recommends.
    pub const TIME_STEP: f64 = 0.1;

    /// * `tables` – rows at equal steps from 0
    /// * `gain`, `time_step` – K and l of the astatic law `q[m+1] = q[m] - l·K·(q[m] - q_d)`
    ///
    /// # Errors
    /// [`BuildError`] where the traverses do not belong together or the rows have no equal step from 0.
    pub fn new(
        tables: [ParametricTable; 3],
        traverses: &[Traverse; 3],
        gain: f64,
        time_step: f64,
    ) -> Result<Self, BuildError> {
        let traverses = Traverses::new(traverses)?;
        let mut step_mm = Vector::zeros();
        for (i, axis) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            let step = tables[i].equal_step_mm().filter(|_| tables[i].positions_mm()[0] == 0.0);
            step_mm[i] = step.ok_or(BuildError::UnequalSteps { axis })?;
        }
        Ok(Self {
            tables,
            step_mm,
            directions: traverses.directions([PUBLISHED_INTERVAL; 3]).abs(),
            offset_mm: traverses.offset_mm(PUBLISHED_INTERVAL),
            gain,
            time_step,
        })
    }

    /// Follows the astatic law from 0 until the target is within one table step on every axis.
    ///
    /// # Errors
    /// [`SolveError::Undefined`] where the trace leaves the tables, [`SolveError::NotConverged`] where it
    /// does not settle.
    pub fn trace(&self, target_mm: &Vector) -> Result<Trace, SolveError> {
        let mut trace = Trace {
            steps: 0,
            last_mm: Vector::zeros(),
            node_mm: Vector::zeros(),
            reached_mm: self.offset_mm,
            directions: self.directions,
        };
        while trace.steps < MOST_STEPS {
            let change = (trace.last_mm - target_mm) * (-self.gain * self.time_step);
            trace.last_mm += change;
            trace.reached_mm += trace.directions.transpose() * change;
            trace.steps += 1;
            let mut rotation = Vector::zeros();
            for (i, table) in self.tables.iter().enumerate() {
                let row = (trace.last_mm[i] / self.step_mm[i]).round();
                if row < 0.0 || row >= table.positions_mm().len() as f64 {
                    return Err(SolveError::Undefined(
                        "the published trace leaves the interferometer tables on its way to the target",
                        "опубликованный путь на пути к цели выходит из таблиц интерферометра",
                    ));
                }
                trace.node_mm[i] = row * self.step_mm[i];
                rotation += table.angular_rad(row as usize);
            }
            for mut direction in &mut trace.directions.column_iter_mut().zip(self.directions.column_iter()) {
                let start = direction.1.into_owned();
                direction.0.copy_from(&(start + rodrigues_displacement(&rotation, &start)));
            }
            if (0..3).all(|i| (target_mm[i] - trace.last_mm[i]).abs() <= self.step_mm[i]) {
                return Ok(trace);
            }
        }
        Err(SolveError::NotConverged {
            iterations: MOST_STEPS,
            residual_mm: (target_mm - trace.last_mm).norm(),
        })
    }
}

impl Engine for KmtppPublished {
    fn id(&self) -> EngineId {
        EngineId::KmtppPublished
    }

    fn volume(&self) -> Volume {
        Volume([0, 1, 2].map(|i| {
            let positions = self.tables[i].positions_mm();
            Range { low: positions[0], high: positions[positions.len() - 1] }
        }))
    }

    /// `iterations` is the m of the publication; `residual_mm` what the last matrix solution leaves.
    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        let target = &target.linear_mm;
        inside(target, &self.volume())?;
        let trace = self.trace(target)?;
        let wanted = target - trace.reached_mm;
        let within = trace.directions.lu().solve(&wanted).ok_or(SolveError::Undefined(
            "the axis directions do not span space",
            "направления осей лежат в одной плоскости",
        ))?;
        Ok(Solution {
            linear_mm: trace.node_mm + within,
            iterations: trace.steps,
            residual_mm: (trace.directions * within - wanted).norm(),
        })
    }
}
