//! Play along a commanded path: equation (25) of `docs/equations.md`.
//!
//! An axis with play does not follow at once when its command turns back: its carriage stands until the command has
//! gone back by the reversal value. Which of its two error curves holds is therefore no question of the direction of a
//! block but of the whole way so far. [`Play`] is that way in three numbers an axis: the play operator of the
//! hysteresis literature (Krasnoselskii and Pokrovskii 1989), its width the reversal value that the model states at the
//! place. The correction proves its blocks with it, and `check` measures with it: there is no other rule.
//!
//! ```
//! use machine_model::{Command, Play, PathModel, RigidBody, Vector};
//! # use machine_model::{Chain, Description, LinearAxis, Range, RotaryAxis, Squareness};
//! # let mut linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 100.0 }));
//! # linear[0].backlash_mm = 0.010;
//! # let model = RigidBody::new(Description {
//! #     chain: Chain::parse("[w X Y b Z t]").unwrap(),
//! #     linear,
//! #     rotary: [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros())),
//! #     squareness: Squareness::default(),
//! # }).unwrap();
//! // X has a reversal value of 10 µm.
//! let at = |x: f64| Command {
//!     linear_mm: Vector::new(x, 0.0, 0.0),
//!     rotary_rad: Vector::zeros(),
//!     tool_mm: Vector::zeros(),
//!     direction: [0; 3],
//!     ..Default::default()
//! };
//! let mut play = Play::unknown();
//! let mut tip_x = |x: f64| {
//!     play.go(&model, &at(x));
//!     x + play.error_mm(&model, &at(x)).x
//! };
//! tip_x(10.0);
//! // From below it stands short by half of the play; back by 4 µm it has not moved, back by 14 µm it has by 4 µm.
//! assert!((tip_x(50.0) - 49.995).abs() < 1e-12);
//! assert!((tip_x(49.996) - 49.995).abs() < 1e-12);
//! assert!((tip_x(49.986) - 49.991).abs() < 1e-12);
//! ```

use crate::{Command, PathModel, RotaryPlay, Vector};

/// Commands nearer than this are one place, mm: far below every output step, far above what a place changes by when it
/// is carried into a frame and back.
pub const SAME_PLACE_MM: f64 = 1e-9;
/// The same for an angle, rad: as far at an arm of a metre.
pub const SAME_PLACE_RAD: f64 = 1e-12;
/// So many steps of a search that gains three digits with each.
const MOST_LAG_STEPS: u32 = 8;

/// Where one axis stands in its play; mm of a linear axis, rad of a rotary one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Carriage {
    /// The last command.
    at: Option<f64>,
    /// The middle of its play, as a command: what the command would be with the carriage where it stands and no play at all.
    stands: Option<f64>,
    /// Between which places it stands for certain, where it came from a side that nobody knows: it is known once both are
    /// one.
    certain: [f64; 2],
    /// Which way it last moved; 0 where unknown.
    side: i8,
}

impl Carriage {
    const UNKNOWN: Self = Self { at: None, stands: None, certain: ANYWHERE, side: 0 };

    /// Brought to a command by a way that nobody knows.
    const fn brought(at: Option<f64>) -> Self {
        Self { at, ..Self::UNKNOWN }
    }

    /// At a command, in the middle of its play as far as anybody knows.
    const fn in_the_middle(at: f64) -> Self {
        Self { at: Some(at), stands: Some(at), ..Self::UNKNOWN }
    }

    /// Taken for one that has come to where it stands in a direction, its play taken up.
    fn rest(at: f64, direction: i8, half: f64) -> Self {
        let behind = at - f64::from(direction) * half;
        Self { at: Some(at), stands: Some(behind), certain: [behind; 2], side: direction }
    }

    /// Goes to a command, one way only.
    ///
    /// * `half` – half its play at a command
    /// * `same` – commands nearer than this are one place
    fn go(&mut self, at: f64, half: impl Fn(f64) -> f64, same: f64) {
        let Some(from) = self.at.replace(at) else {
            *self = Self::brought(Some(at));
            return;
        };
        if (at - from).abs() <= same {
            // The same place; what another axis has done to the reversal value here is no motion of this one.
            return;
        }
        let heading = if at > from { 1 } else { -1 };
        let here = half(at);
        if self.certain == ANYWHERE {
            // Before this, anywhere in its play.
            let half = half(from);
            self.certain = [from - half, from + half];
        }
        let taken = |stood: f64| if heading > 0 { stood.max(at - here) } else { stood.min(at + here) };
        self.certain = self.certain.map(taken);
        // With its play taken up the carriage stands here.
        let behind = at - f64::from(heading) * here;
        let carriage = self.stands.map_or(behind, taken);
        self.stands = Some(carriage);
        if (carriage - behind).abs() <= same {
            self.side = heading;
        }
    }

    /// How far it has yet to go in a direction before it moves that way.
    fn lag(&self, at: f64, direction: i8, half: impl Fn(f64) -> f64, same: f64) -> f64 {
        let Some(carriage) = self.stands.filter(|_| direction != 0) else { return 0.0 };
        let heading = f64::from(direction);
        let ahead = (carriage - at) * heading;
        // The play where it is taken up, which is not quite that of where the axis stands: micrometres of way, on a
        // slope of micrometres a millimetre.
        let mut lag = 0.0f64;
        for _ in 0..MOST_LAG_STEPS {
            let next = ahead + half(at + heading * lag.max(0.0));
            let settled = (next - lag).abs() <= same;
            lag = next;
            if settled {
                break;
            }
        }
        if lag > same { lag } else { 0.0 }
    }

    /// How far it may stand from where it is taken to.
    ///
    /// * `half` – half its play where it stands
    fn unsure(&self, half: f64, same: f64) -> f64 {
        match self.stands {
            None => half,
            Some(_) if self.certain == ANYWHERE => half,
            Some(carriage) => {
                let [low, high] = self.certain;
                let far = (carriage - low).abs().max((high - carriage).abs());
                if far > same { far } else { 0.0 }
            }
        }
    }

    fn is_certain(&self, same: f64) -> bool {
        let stands = |carriage: f64| self.certain.iter().all(|end| (end - carriage).abs() <= same);
        self.side != 0 && self.stands.is_some_and(stands)
    }
}

/// Where the axes stand in their play.
///
/// Two things an axis has, and both are only known once it has moved: where its carriage stands, and on which side of
/// everything else that depends on the direction (what lies across the axis, angles).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Play {
    linear: [Carriage; 3],
    rotary: [Carriage; 3],
}

impl Play {
    /// Nobody knows where the axes are, nor from which side they came.
    #[must_use]
    pub const fn unknown() -> Self {
        Self { linear: [Carriage::UNKNOWN; 3], rotary: [Carriage::UNKNOWN; 3] }
    }

    /// An axis is brought to a command (machine coordinates, mm; `None` where unknown) by a way that nobody knows.
    pub fn forget(&mut self, axis: usize, at_mm: Option<f64>) {
        self.linear[axis] = Carriage::brought(at_mm);
    }

    /// An axis is taken for one that has come to where it stands (`at`) in a direction, its play taken up.
    pub fn rest(&mut self, model: &dyn PathModel, at: &Command, axis: usize, direction: i8) {
        self.linear[axis] = Carriage::rest(at.linear_mm[axis], direction, half_play_mm(model, axis, at));
    }

    /// The linear axes go to a command, each of them one way only.
    ///
    /// A path on which an axis turns is gone to piece by piece, to every place where it does. How often it is asked on
    /// the way makes no difference. An axis whose side is not known counts, once it moves, as lying against the side to
    /// which it goes.
    ///
    /// * `to` – where to, machine coordinates; its direction is not used
    pub fn go(&mut self, model: &dyn PathModel, to: &Command) {
        for (axis, carriage) in self.linear.iter_mut().enumerate() {
            let half = |at: f64| {
                half_play_mm(model, axis, &Command { linear_mm: with(to.linear_mm, axis, at), ..*to })
            };
            carriage.go(to.linear_mm[axis], half, SAME_PLACE_MM);
        }
    }

    /// The rotary axes turn to a command, each of them one way only; as [`Play::go`], but that one whose side is not known
    /// counts as standing in the middle of its play: what it carries is led from there, and there is no leap.
    ///
    /// * `known` – of which axes the command is known; nobody knows where the others are
    pub fn turn(&mut self, model: &dyn PathModel, to: &Command, known: [bool; 3]) {
        for (axis, carriage) in self.rotary.iter_mut().enumerate() {
            let at = to.rotary_rad[axis];
            let half = |at: f64| half_play_rad(model, axis, &turned_to(to, axis, at));
            match (known[axis], carriage.at) {
                (false, _) => *carriage = Carriage::UNKNOWN,
                (true, None) => *carriage = Carriage::in_the_middle(at),
                (true, Some(_)) => carriage.go(at, half, SAME_PLACE_RAD),
            }
        }
    }

    /// Where the rotary axes stand in their play, for [`Command::rotary_play`].
    ///
    /// * `at` – how they are commanded
    #[must_use]
    pub fn rotary(&self, model: &dyn PathModel, at: &Command) -> RotaryPlay {
        self.rotary_on(model, at, self.rotary.map(|carriage| carriage.side))
    }

    /// The same, said of other sides.
    #[must_use]
    pub fn rotary_on(&self, model: &dyn PathModel, at: &Command, direction: [i8; 3]) -> RotaryPlay {
        let lag_rad = Vector::from_fn(|axis, _| {
            let Some(stands) = self.rotary[axis].stands else { return 0.0 };
            let half = half_play_rad(model, axis, at);
            let lag = stands - (at.rotary_rad[axis] - f64::from(direction[axis]) * half);
            if lag.abs() > SAME_PLACE_RAD { lag } else { 0.0 }
        });
        RotaryPlay { direction, lag_rad }
    }

    /// How far each rotary axis has yet to turn in a direction before what it carries moves that way, rad; as
    /// [`Play::lag_mm`].
    #[must_use]
    pub fn rotary_lag_rad(&self, model: &dyn PathModel, at: &Command, direction: [i8; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let half = |angle: f64| half_play_rad(model, axis, &turned_to(at, axis, angle));
            self.rotary[axis].lag(at.rotary_rad[axis], direction[axis], half, SAME_PLACE_RAD)
        })
    }

    /// How far what each rotary axis carries may be turned from where it is taken to, rad; as [`Play::unsure_mm`].
    #[must_use]
    pub fn rotary_unsure_rad(&self, model: &dyn PathModel, at: &Command) -> [f64; 3] {
        std::array::from_fn(|axis| self.rotary[axis].unsure(half_play_rad(model, axis, at), SAME_PLACE_RAD))
    }

    /// Which way what each rotary axis carries last moved; 0 where unknown.
    #[must_use]
    pub fn rotary_side(&self) -> [i8; 3] {
        self.rotary.map(|carriage| carriage.side)
    }

    /// Which way each carriage last moved, 0 where unknown: the direction by which everything that lies across the axis
    /// is to be looked up.
    #[must_use]
    pub fn side(&self) -> [i8; 3] {
        self.linear.map(|carriage| carriage.side)
    }

    /// How far each axis has yet to go in a direction before its carriage moves that way, mm; 0 where its side is not
    /// known, and where it is asked for no direction.
    ///
    /// * `at` – where the axes stand
    #[must_use]
    pub fn lag_mm(&self, model: &dyn PathModel, at: &Command, direction: [i8; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let half = |mm: f64| {
                half_play_mm(model, axis, &Command { linear_mm: with(at.linear_mm, axis, mm), ..*at })
            };
            self.linear[axis].lag(at.linear_mm[axis], direction[axis], half, SAME_PLACE_MM)
        })
    }

    /// How far each carriage may stand from where it is taken to, mm: half its play where the axis has not moved, and all of it
    /// that a first motion has not taken up for certain. 0 once the side is known.
    ///
    /// * `at` – where the axes stand
    #[must_use]
    pub fn unsure_mm(&self, model: &dyn PathModel, at: &Command) -> [f64; 3] {
        std::array::from_fn(|axis| self.linear[axis].unsure(half_play_mm(model, axis, at), SAME_PLACE_MM))
    }

    /// True where every carriage of a linear axis stands for certain, on a side that is known: [`Play::unsure_mm`] is 0
    /// anywhere.
    #[must_use]
    pub fn is_certain(&self) -> bool {
        self.linear.iter().all(|carriage| carriage.is_certain(SAME_PLACE_MM))
    }

    /// Real tip minus nominal tip with the axes standing here after the way they came, mm, as
    /// [`PathModel::error_mm`].
    ///
    /// Along an axis the carriage stands where its play has left it; everything else is that of the side to which it
    /// last moved. Products of play and rotation (a nanometre at 10 µm and 100 µrad) are left out, but for rotary axes.
    ///
    /// * `command` – where the axes stand; its direction is not used
    #[must_use]
    pub fn error_mm(&self, model: &dyn PathModel, command: &Command) -> Vector {
        self.error_on_mm(model, command, self.side())
    }

    /// The same, what does not lie along the linear axes being that of other sides: for those who do not trust a moment at
    /// which it changes.
    #[must_use]
    pub fn error_on_mm(&self, model: &dyn PathModel, command: &Command, side: [i8; 3]) -> Vector {
        let rotary_play =
            if model.has_rotary_play() { self.rotary(model, command) } else { command.rotary_play };
        let command = &Command { direction: side, rotary_play, ..*command };
        let mut error = model.error_mm(command);
        for axis in 0..3 {
            if let Some(carriage) = self.linear[axis].stands {
                let half = half_play_mm(model, axis, command);
                let into_play = (command.linear_mm[axis] - carriage).clamp(-half, half);
                error[axis] += f64::from(side[axis]) * half - into_play;
            }
        }
        error
    }
}

/// What is certain of a carriage of which nothing is known, mm.
const ANYWHERE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// A place, or angles, with another command of one axis.
fn with(mut place: Vector, axis: usize, mm: f64) -> Vector {
    place[axis] = mm;
    place
}

/// Half the width of an axis' play, mm: half the reversal value, and none where that is negative.
fn half_play_mm(model: &dyn PathModel, axis: usize, at: &Command) -> f64 {
    0.5 * model.reversal_mm(axis, at).max(0.0)
}

/// A command with another angle of one rotary axis.
fn turned_to(to: &Command, axis: usize, rad: f64) -> Command {
    Command { rotary_rad: with(to.rotary_rad, axis, rad), ..*to }
}

/// Half the width of a rotary axis' play, rad, as [`half_play_mm`].
fn half_play_rad(model: &dyn PathModel, axis: usize, at: &Command) -> f64 {
    0.5 * model.rotary_reversal_rad(axis, at).max(0.0)
}

/// What changes in the tool's place when an axis turns from down to up, mm, machine directions: along the axis the
/// negative of its reversal value, and what lies across it.
///
/// * `at` – where it turns, with the directions of the other axes
#[must_use]
pub fn turned_by_mm(model: &dyn PathModel, at: &Command, axis: usize) -> Vector {
    let [up, down] = [1, -1].map(|side| {
        let mut state = *at;
        state.direction[axis] = side;
        model.error_mm(&state)
    });
    up - down
}

#[cfg(test)]
mod tests;
