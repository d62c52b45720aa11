//! The rigid-body model with effects beyond its tables: equation (23) of `docs/equations.md`.

use crate::effects::{Conditions, EffectKind, EffectTerm, MissingCondition};
use crate::solve::{FIXED_POINT_ROUNDS, TOLERANCE_MM, solve};
use crate::{
    Command, Engine, EngineId, Everywhere, LANES, Move, PathModel, Prediction, RigidBody, Solution,
    SolveError, Vector, Volume,
};

/// An effect cannot be evaluated: what it depends on is not known.
///
/// ```
/// use machine_model::WithEffects;
/// use machine_model::effects::{Conditions, EffectTerm};
/// # use machine_model::{AxisTables, Chain, Command, Description, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis, Squareness, Table, Vector};
/// # fn machine() -> RigidBody {
/// #     let mut linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 100.0 }));
/// #     let long = Table::new(vec![0.0, 100.0], vec![0.0, 0.020], Interpolation::Linear).unwrap();
/// #     linear[0].errors = AxisTables::new(&[Some(long), None, None, None, None, None]);
/// #     let rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
/// #     let chain = Chain::parse("[w X Y b Z t]").unwrap();
/// #     RigidBody::new(Description { chain, linear, rotary, squareness: Squareness::default() }).unwrap()
/// # }
/// # fn at(x: f64, y: f64, z: f64) -> Command {
/// #     Command { linear_mm: Vector::new(x, y, z), rotary_rad: Vector::zeros(), tool_mm: Vector::zeros(), direction: [0; 3], ..Default::default() }
/// # }
/// let parameters = [("expansion_um_per_m_k".to_owned(), 11.5)];
/// let warm = EffectTerm::from_entry("thermal.X", &parameters).unwrap();
/// let error = WithEffects::new(machine(), vec![warm], Conditions::default()).unwrap_err();
/// assert_eq!(error.effect.to_string(), "thermal.X");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the effect {effect} depends on the {}, which is not known here", condition.0)]
pub struct UnknownCondition {
    /// The effect.
    pub effect: EffectKind,
    /// What is missing.
    pub condition: MissingCondition,
}

/// A machine whose error is that of its tables plus what its effects displace.
///
/// Both are evaluated at the command; products of the two (nanometres) are left out, as in the diagnosis
/// that finds effects. Faults of the measuring instrument are no part of a machine: see
/// [`EffectKind::is_instrument`] and [`WithEffects::new`].
///
/// ```
/// use machine_model::effects::{Conditions, EffectTerm};
/// use machine_model::{PathModel, WithEffects};
/// # use machine_model::{AxisTables, Chain, Command, Description, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis, Squareness, Table, Vector};
/// # fn machine() -> RigidBody {
/// #     let mut linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 100.0 }));
/// #     let long = Table::new(vec![0.0, 100.0], vec![0.0, 0.020], Interpolation::Linear).unwrap();
/// #     linear[0].errors = AxisTables::new(&[Some(long), None, None, None, None, None]);
/// #     let rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
/// #     let chain = Chain::parse("[w X Y b Z t]").unwrap();
/// #     RigidBody::new(Description { chain, linear, rotary, squareness: Squareness::default() }).unwrap()
/// # }
/// # fn at(x: f64, y: f64, z: f64) -> Command {
/// #     Command { linear_mm: Vector::new(x, y, z), rotary_rad: Vector::zeros(), tool_mm: Vector::zeros(), direction: [0; 3], ..Default::default() }
/// # }
/// // Half a lost motion of 3 µm: the tip lags behind, whichever way X goes.
/// let lost = EffectTerm::from_entry("backlash.X", &[("half_width_um".to_owned(), 3.0)]).unwrap();
/// let machine = WithEffects::new(machine(), vec![lost], Conditions::default()).unwrap();
/// let error = |way| machine.error_mm(&Command { direction: [way, 0, 0], ..at(50.0, 0.0, 0.0) }).x;
/// assert!((error(1) - error(-1)).abs() > 0.0059);
/// assert!((error(1) + error(-1) - 2.0 * machine.base().error_mm(&at(50.0, 0.0, 0.0)).x).abs() < 1e-12);
/// assert!(machine.depends_on_direction());
/// ```
#[derive(Clone, Debug)]
pub struct WithEffects {
    base: RigidBody,
    terms: Vec<EffectTerm>,
    conditions: Conditions,
    depends_on_direction: bool,
}

impl WithEffects {
    /// Puts a machine and its effects together, under fixed conditions.
    ///
    /// `terms` that are faults of the instrument are taken as they come: a caller that corrects leaves
    /// them out.
    ///
    /// # Errors
    /// [`UnknownCondition`] for the first effect that needs a condition that is not known.
    pub fn new(
        base: RigidBody,
        terms: Vec<EffectTerm>,
        conditions: Conditions,
    ) -> Result<Self, UnknownCondition> {
        // Whether a condition is needed depends on the effect and its numbers, never on the place.
        let anywhere = Command {
            linear_mm: base.volume().nearest(&Vector::zeros()),
            direction: [1; 3],
            ..Default::default()
        };
        for term in &terms {
            term.displacement_mm(&anywhere, &conditions)
                .map_err(|condition| UnknownCondition { effect: term.kind(), condition })?;
        }
        let depends_on_direction =
            base.depends_on_direction() || terms.iter().any(EffectTerm::depends_on_direction);
        Ok(Self { base, terms, conditions, depends_on_direction })
    }

    /// The machine as its tables describe it.
    #[must_use]
    pub fn base(&self) -> &RigidBody {
        &self.base
    }

    /// What is added to it.
    #[must_use]
    pub fn terms(&self) -> &[EffectTerm] {
        &self.terms
    }

    /// What the effects depend on besides the command.
    #[must_use]
    pub fn conditions(&self) -> &Conditions {
        &self.conditions
    }

    /// Where the tool tip really goes; see [`RigidBody::predict`].
    #[must_use]
    pub fn predict(&self, command: &Command) -> Prediction {
        let Prediction { position_mm, error_mm } = self.base.predict(command);
        let more = self.displacement(&self.inside(command));
        Prediction { position_mm: position_mm + more, error_mm: error_mm + more }
    }

    /// The command, its linear axes taken to the nearest point of the volume.
    fn inside(&self, command: &Command) -> Command {
        Command { linear_mm: self.base.volume().nearest(&command.linear_mm), ..*command }
    }

    /// Sum of the effects, where the linear axes have to undo it.
    fn undone(&self, command: &Command) -> Vector {
        let seen = self.displacement(command);
        if self.base.description().chain.table().is_empty() {
            return seen;
        }
        self.base.table_turn(command).tr_mul(&seen)
    }

    /// Sum of the effects, as the workpiece sees it.
    fn displacement(&self, command: &Command) -> Vector {
        self.terms.iter().fold(Vector::zeros(), |sum, term| {
            sum + term
                .displacement_mm(command, &self.conditions)
                .expect("conditions were complete when the model was made, and stay what they were")
        })
    }
}

/// What is proven to be left counts as found: the tolerance less what rounding makes of it, mm.
const PROVEN_MM: f64 = 0.9 * TOLERANCE_MM;

impl Engine for WithEffects {
    fn id(&self) -> EngineId {
        EngineId::RigidBody
    }

    fn volume(&self) -> Volume {
        self.base.volume()
    }

    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        self.base.rotary_inside(target)?;
        solve(&target.linear_mm, &self.base.volume(), |q| {
            self.error_mm(&Command { linear_mm: *q, ..*target })
        })
    }

    fn path_model(&self) -> Option<&dyn PathModel> {
        Some(self)
    }
}

impl PathModel for WithEffects {
    fn within(&self) -> Option<&dyn PathModel> {
        Some(&self.base)
    }

    fn error_mm(&self, command: &Command) -> Vector {
        let command = self.inside(command);
        self.base.error_mm(&command) + self.undone(&command)
    }

    /// A sum leaves its chord by no more than its parts do.
    fn chord_bound_mm(&self, stretch: &Move) -> f64 {
        if stretch.turn.is_some() && !self.follows_turns() {
            return f64::INFINITY;
        }
        self.terms.iter().fold(self.base.chord_bound_mm(stretch), |sum, term| {
            sum + term.chord_bound_mm(stretch, &self.conditions)
        })
    }

    /// Effects have bounds for rotary axes that stand.
    fn follows_turns(&self) -> bool {
        self.terms.is_empty()
    }

    fn error_from_mm(&self, command: &Command, programmed_rad: &Vector) -> Vector {
        let command = self.inside(command);
        let programmed = Command { rotary_rad: *programmed_rad, ..command };
        self.base.error_from_mm(&command, programmed_rad)
            + self.base.table_turn(&programmed).tr_mul(&self.displacement(&command))
    }

    /// Nothing is said of what effects turn the tool by.
    fn tool_directions(&self, command: &Command, programmed_rad: &Vector) -> Option<[Vector; 2]> {
        if self.terms.is_empty() { self.base.tool_directions(command, programmed_rad) } else { None }
    }

    fn direction_bound_rad(&self, stretch: &Move) -> f64 {
        if self.terms.is_empty() { self.base.direction_bound_rad(stretch) } else { f64::INFINITY }
    }

    /// Those of the tables, and of every effect over the whole volume: equation (24) grows with the range. `None` on a machine
    /// with play: there the room that a stretch's own bound leaves decides.
    fn everywhere(&self, state: &Command) -> Option<Everywhere> {
        if self.depends_on_direction {
            return None;
        }
        let base = self.base.everywhere(state)?;
        let bound = |speed_mm: f64, acceleration_mm: f64, passes: u8| -> f64 {
            let stretch = Move {
                range_mm: base.volume.0,
                speed_mm: [speed_mm; 3],
                acceleration_mm: [acceleration_mm; 3],
                passes,
                state: *state,
                turn: None,
            };
            self.terms.iter().map(|term| term.chord_bound_mm(&stretch, &self.conditions)).sum()
        };
        // The second derivative of what stands and is accelerated is the gradient's alone; a chord is left by an eighth of it.
        Some(base.with(8.0 * bound(0.0, 1.0, 1), |longest_mm, passes| bound(longest_mm, 0.0, passes)))
    }

    /// The fixed point of [`Engine::solve`], for several targets side by side: the same bits.
    #[inline]
    fn commands_for(
        &self,
        targets_mm: &[[f64; 3]; LANES],
        directions: &[[i8; 3]; LANES],
        state: &Command,
        everywhere: &Everywhere,
    ) -> Option<[[f64; LANES]; 3]> {
        let targets = targets_mm.map(Vector::from);
        let (mut q, mut open) = (targets, [true; LANES]);
        if self.base.is_rotary_outside(state) {
            return None;
        }
        for _ in 0..FIXED_POINT_ROUNDS {
            if !q.iter().all(|q| self.base.volume.contains(q)) {
                return None;
            }
            let errors = self.base.errors_together(&q, directions, &state.tool_mm);
            for lane in 0..LANES {
                if !open[lane] {
                    continue;
                }
                let at = Command { linear_mm: q[lane], direction: directions[lane], ..*state };
                let error = errors[lane] + self.undone(&at);
                let residual = (q[lane] - targets[lane]) + error;
                let squared = residual.norm_squared();
                // A root is asked for only where it may decide.
                if squared <= 2.0 * TOLERANCE_MM * TOLERANCE_MM && residual.norm() <= TOLERANCE_MM {
                    open[lane] = false;
                    continue;
                }
                q[lane] = targets[lane] - error;
                // A step by the residual leaves at most `gradient` of it, which need not be evaluated.
                open[lane] = everywhere.gradient * everywhere.gradient * squared > PROVEN_MM * PROVEN_MM;
            }
            if open == [false; LANES] {
                let inside = q.iter().all(|q| self.base.volume.contains(q));
                return inside.then(|| [0, 1, 2].map(|axis| q.map(|q| q[axis])));
            }
        }
        None
    }

    fn depends_on_direction(&self) -> bool {
        self.depends_on_direction
    }

    /// That of the tables and of every lost motion along the axis. What a servo lags by changes with the direction too,
    /// but with no way in between.
    fn reversal_mm(&self, axis: usize, command: &Command) -> f64 {
        let inside = self.inside(command);
        let along = |term: &EffectTerm, side: i8| {
            let from = Command { direction: [side; 3], ..inside };
            term.displacement_mm(&from, &self.conditions).map_or(0.0, |by| by[axis])
        };
        let plays = self.terms.iter().filter(|term| term.kind() == EffectKind::Backlash(axis));
        plays.fold(self.base.reversal_mm(axis, &inside), |sum, term| sum + along(term, -1) - along(term, 1))
    }
}
