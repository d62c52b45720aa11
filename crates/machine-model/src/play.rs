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
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{
        AxisTables, Chain, Description, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis, Squareness,
        Table,
    };

    fn command(x: f64, y: f64) -> Command {
        Command { linear_mm: Vector::new(x, y, 0.0), ..Default::default() }
    }

    /// X with tables for each direction, 6 to 14 µm apart along it and 3 µm across; Y with lost motion in Z only.
    fn machine() -> RigidBody {
        let mut linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 100.0 }));
        let nodes = vec![0.0, 40.0, 100.0];
        let table = |values: [f64; 3]| Table::new(nodes.clone(), values.into(), Interpolation::Linear).ok();
        let set = |along: [f64; 3], across: [f64; 3]| {
            AxisTables::new(&[table(along), None, table(across), None, None, None])
        };
        linear[0].errors = set([0.001, 0.002, -0.003], [0.0; 3]);
        linear[0].errors_negative = set([0.007, 0.012, 0.011], [0.003; 3]);
        linear[1].errors = AxisTables::new(&[None, None, table([0.005; 3]), None, None, None]);
        linear[1].errors_negative = AxisTables::new(&[None, None, table([-0.005; 3]), None, None, None]);
        RigidBody::new(Description {
            chain: Chain::parse("[w X Y b Z t]").unwrap(),
            linear,
            rotary: [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros())),
            squareness: Squareness::default(),
        })
        .unwrap()
    }

    #[test]
    fn reversal_values_are_those_of_the_tables() {
        let model = machine();
        assert!((model.reversal_mm(0, &command(40.0, 0.0)) - 0.010).abs() < 1e-15);
        assert!((model.reversal_mm(0, &command(100.0, 0.0)) - 0.014).abs() < 1e-15);
        assert_eq!(model.reversal_mm(1, &command(40.0, 0.0)), 0.0);
    }

    #[test]
    fn what_lies_across_turns_with_the_carriage() {
        let model = machine();
        let mut play = Play::unknown();
        let mut error = |x: f64, y: f64| {
            play.go(&model, &command(x, y));
            play.error_mm(&model, &command(x, y))
        };
        error(10.0, 10.0);
        assert_eq!(error(20.0, 20.0).z, 0.005);
        // X goes back, but not by its play; Y has none.
        assert_eq!(error(19.997, 20.0).z, 0.005);
        assert!((error(19.0, 20.0).z - 0.008).abs() < 1e-15);
        assert!((error(19.0, 19.999).z - -0.002).abs() < 1e-15);
    }

    #[test]
    fn a_side_is_known_once_all_play_is_taken_up_for_certain() {
        let model = machine();
        let mut play = Play::unknown();
        let mut unsure_um = |x: f64| {
            play.go(&model, &command(x, 5.0));
            (play.unsure_mm(&model, &command(x, 5.0))[0] * 1e3 * 10.0).round() / 10.0
        };
        // At 40 mm the reversal value is 10 µm.
        assert_eq!([40.0, 40.003, 40.009, 40.011, 39.0].map(&mut unsure_um), [5.0, 7.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn play_is_taken_up_where_it_changes_on_the_way() {
        let model = machine();
        for (from, to) in [(9.0, 30.0), (41.0, 20.0)] {
            let (mut play, heading) = (Play::unknown(), if to > from { 1 } else { -1 });
            for x in [from - 10.0 * f64::from(heading), to] {
                play.go(&model, &command(x, 0.0));
            }
            let back = [-heading, 0, 0];
            let lag_mm = play.lag_mm(&model, &command(to, 0.0), back)[0];
            let side_behind = |mm: f64| {
                let mut gone = play;
                gone.go(&model, &command(to - f64::from(heading) * mm, 0.0));
                gone.side()[0]
            };
            assert!(lag_mm > 1e-3, "{lag_mm}");
            assert_eq!([lag_mm - 1e-8, lag_mm + 1e-8].map(side_behind), [heading, -heading]);
        }
    }

    /// C, whose tables lie 60 µrad apart about its line, and 4 µm in X.
    fn swivel() -> RigidBody {
        let linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: -500.0, high: 500.0 }));
        let mut rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
        let travel = Range { low: -4.0, high: 4.0 };
        rotary[2].errors = Some(AxisTables::constant(travel, [0.0; 6]));
        rotary[2].errors_negative = Some(AxisTables::constant(travel, [0.004, 0.0, 0.0, 0.0, 0.0, 60e-6]));
        let chain = Chain::parse("[w C b X Y Z t]").unwrap();
        RigidBody::new(Description { chain, linear, rotary, squareness: Squareness::default() }).unwrap()
    }

    #[test]
    fn a_table_stands_until_its_play_is_taken_up() {
        let model = swivel();
        let at = |c: f64| Command { rotary_rad: Vector::new(0.0, 0.0, c), ..command(100.0, 0.0) };
        let mut play = Play::unknown();
        // The tool at X 100 as the workpiece sees it, µm: where the table stands further, it lies behind in Y, but for a hundredth.
        let mut seen_um = |c: f64| {
            play.turn(&model, &at(c), [true; 3]);
            let tip = model.tip_mm(&(at(c).linear_mm + play.error_mm(&model, &at(c))), &at(c));
            let turned = at(c).rotary_rad.z;
            [tip.x - 100.0 * units::math::cos(turned), tip.y + 100.0 * units::math::sin(turned)]
                .map(|mm| (mm * 1e5).round() * 1e-2)
        };
        let near = |seen: [f64; 2], wanted: [f64; 2]| (0..2).all(|i| (seen[i] - wanted[i]).abs() < 0.08);
        // From the middle of its play: off by half of it, until that is taken up.
        assert!(near(seen_um(0.0), [-2.0, -3.0]), "{:?}", seen_um(0.0));
        assert!(near(seen_um(20e-6), [-2.0, -1.0]), "{:?}", seen_um(20e-6));
        assert!(near(seen_um(0.010), [0.0, 0.0]));
        // Back by 20 and 59 µrad: it has not moved, and is off by that at an arm of 100 mm.
        assert!(near(seen_um(0.010 - 20e-6), [0.0, -2.0]), "{:?}", seen_um(0.010 - 20e-6));
        assert!(near(seen_um(0.010 - 59e-6), [0.0, -5.9]));
        // Then it follows, 60 µrad behind and on the other side.
        assert!(near(seen_um(0.009), [-4.0, -6.0]), "{:?}", seen_um(0.009));
        // And forth again.
        assert!(near(seen_um(0.009 + 30e-6), [-4.0, -3.0]));
        assert!(near(seen_um(0.010), [0.0, 0.0]));
    }

    proptest! {
        /// At the side of its play a machine is what the model says for that direction.
        #[test]
        fn behind_a_long_way_the_direction_tells_all(from in 0.0f64..45.0, way in 0.02f64..50.0, back: bool) {
            let model = machine();
            let (from, to) = if back { (from + way, from) } else { (from, from + way) };
            let mut play = Play::unknown();
            for x in [50.0, from, to] {
                play.go(&model, &command(x, 5.0));
            }
            let direction = [if back { -1 } else { 1 }, 0, 0];
            prop_assert_eq!(play.side(), direction);
            prop_assert_eq!(play.lag_mm(&model, &command(to, 5.0), direction), [0.0; 3]);
            let told = model.error_mm(&Command { direction, ..command(to, 5.0) });
            prop_assert!((play.error_mm(&model, &command(to, 5.0)) - told).norm() < 1e-12);
        }

        /// However often it is asked on the way, the carriage ends where it ends, and never goes against the command.
        #[test]
        fn the_way_counts_and_not_its_pieces(places in prop::collection::vec(10.0f64..10.03, 2..12), pieces in 1u32..9) {
            let model = machine();
            // From a side that is known.
            let mut once = Play::unknown();
            [5.0, 9.0].into_iter().for_each(|x| once.go(&model, &command(x, 0.0)));
            let mut often = once;
            let mut before: Option<f64> = None;
            for to in places {
                let tip = |play: &Play, x: f64| x + play.error_mm(&model, &command(x, 0.0)).x;
                if let Some(from) = before {
                    let mut last = tip(&often, from);
                    for k in 1..=pieces {
                        let x = from + (to - from) * f64::from(k) / f64::from(pieces);
                        often.go(&model, &command(x, 0.0));
                        let now = tip(&often, x);
                        // It stands but for what the mean curve changes by over the play.
                        prop_assert!((now - last) * (to - from).signum() >= -1e-8, "{} {}", last, now);
                        last = now;
                    }
                } else {
                    often.go(&model, &command(to, 0.0));
                }
                once.go(&model, &command(to, 0.0));
                prop_assert!((tip(&once, to) - tip(&often, to)).abs() < 1e-12);
                before = Some(to);
            }
        }
    }
}
