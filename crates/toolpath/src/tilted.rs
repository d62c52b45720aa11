//! Tilted working planes, and which way rotary axes turn the tool to them.

use units::math;

/// The coordinates of a tilted working plane (G68.2).
///
/// Its axes are the columns of `turn`, its zero is `zero_mm`, both in the frame of the workpiece, which turns with the table
/// and is the machine's with all rotary axes at 0.
///
/// ```
/// use toolpath::TiltedPlane;
///
/// // Tilted by a quarter turn about X: its Z lies along -Y.
/// let turn = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
/// let plane = TiltedPlane { turn, zero_mm: [10.0, 20.0, 30.0] };
/// assert_eq!(plane.normal(), [0.0, -1.0, 0.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltedPlane {
    /// Rows of the rotation from the plane's coordinates to the workpiece's.
    pub turn: [[f64; 3]; 3],
    /// The plane's zero, mm.
    pub zero_mm: [f64; 3],
}

impl TiltedPlane {
    /// Its Z, a unit vector in the workpiece: where the tool points, from the tip up.
    #[must_use]
    pub fn normal(&self) -> [f64; 3] {
        self.turn.map(|row| row[2])
    }

    /// The angle between its Z and a direction, a unit vector of the workpiece, rad: exact to the last bits also where it is
    /// small.
    #[must_use]
    pub fn off_normal_rad(&self, direction: [f64; 3]) -> f64 {
        2.0 * math::asin((0.5 * size(plus(direction, -1.0, self.normal()))).min(1.0))
    }

    /// The turn of Euler angles, degrees: about Z, about the new X, about the new Z.
    #[must_use]
    pub fn turn_by_euler([first, second, third]: [f64; 3]) -> [[f64; 3]; 3] {
        let turn = product(Self::turn_about(2, first), Self::turn_about(0, second));
        product(turn, Self::turn_about(2, third))
    }

    /// The turn of angles one after the other, degrees, each about that axis of the coordinates as they then lie: X, Y, Z by
    /// index.
    #[must_use]
    pub fn turn_by_axes(axes: [usize; 3], angles_deg: [f64; 3]) -> [[f64; 3]; 3] {
        let [first, second, third] = [0, 1, 2].map(|i| Self::turn_about(axes[i], angles_deg[i]));
        product(product(first, second), third)
    }

    /// A plane that is given in the coordinates of this one: its zero goes to `before_mm`, turns there, and goes on to
    /// `behind_mm` along the axes that lie turned then.
    #[must_use]
    pub fn then(&self, before_mm: [f64; 3], turn: [[f64; 3]; 3], behind_mm: [f64; 3]) -> Self {
        let on = |turn: [[f64; 3]; 3], from: [f64; 3], by: [f64; 3]| {
            let by = turn.map(|row| dot(row, by));
            plus(from, 1.0, by)
        };
        let turned = product(self.turn, turn);
        Self { turn: turned, zero_mm: on(turned, on(self.turn, self.zero_mm, before_mm), behind_mm) }
    }

    /// The turn about X, Y or Z by index, degrees.
    #[must_use]
    pub fn turn_about(axis: usize, angle_deg: f64) -> [[f64; 3]; 3] {
        let (sin, cos) = math::sin_cos_deg(angle_deg);
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut turn = [[0.0; 3]; 3];
        turn[axis][axis] = 1.0;
        (turn[u][u], turn[u][v]) = (cos, -sin);
        (turn[v][u], turn[v][v]) = (sin, cos);
        turn
    }

    /// The turn of three points, mm: the plane's zero, one on its +X, one on the side of its +Y. `None` where two of them,
    /// or the third and the line of the others, are nearer than 0.1 mm.
    #[must_use]
    pub fn turn_by_points([zero, on_x, beside]: [[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
        const LEAST_MM: f64 = 0.1;
        let (x, other) = (plus(on_x, -1.0, zero), plus(beside, -1.0, zero));
        let z = cross(x, other);
        let spans = size(x) >= LEAST_MM && size(z) >= LEAST_MM * size(x);
        spans.then(|| by_columns(x.map(|v| v / size(x)), z.map(|v| v / size(z))))
    }

    /// The turn of the directions of X and Z, unit vectors ([`unit()`]); what they lack of a right angle Z gives.
    ///
    /// # Errors
    /// The angle that they lack, rad, where it is above two microradians, as much as vectors of six decimals may lack: which
    /// of the two stays, controls differ.
    pub fn turn_by_directions(x: [f64; 3], z: [f64; 3]) -> Result<[[f64; 3]; 3], f64> {
        const SQUARE_RAD: f64 = 2e-6;
        let lean = dot(x, z);
        if lean.abs() > SQUARE_RAD {
            return Err(lean);
        }
        let z = plus(z, -lean, x);
        Ok(by_columns(x, z.map(|v| v / size(z))))
    }
}

/// The direction of a vector; `None` of one without length.
///
/// ```
/// assert_eq!(toolpath::unit([0.0, 0.0, -2.0]), Some([0.0, 0.0, -1.0]));
/// assert_eq!(toolpath::unit([0.0; 3]), None);
/// ```
#[must_use]
pub fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = size(v);
    (length != 0.0).then(|| v.map(|part| part / length))
}

/// A rotary axis as far as directions go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotaryLink {
    /// A, B, C by index.
    pub axis: usize,
    /// Unit vector of the axis of rotation with all rotary axes at 0.
    pub direction: [f64; 3],
    /// It carries the workpiece; else the tool.
    pub carries_workpiece: bool,
    /// Lowest and highest command, degrees.
    pub travel_deg: [f64; 2],
}

/// The rotary axes of a machine from the workpiece to the tool.
///
/// ```
/// use toolpath::{RotaryChain, RotaryLink, TiltRule};
///
/// // A rotary table C on a tilting table A.
/// let link = |axis: usize, carries_workpiece| {
///     let direction = [0, 1, 2].map(|k| f64::from(u8::from(k == axis)));
///     RotaryLink { axis, direction, carries_workpiece, travel_deg: [-110.0, 110.0] }
/// };
/// let table = RotaryChain(vec![link(2, true), link(0, true)]);
/// let rule = TiltRule { branch: Some((0, true)), ..TiltRule::default() };
/// // To point along +Y the table tilts by 90 degrees, or by -90 behind half a turn, which is beyond this travel.
/// let angles = table.angles_for([0.0, 1.0, 0.0], &rule, [Some(0.0); 3]).unwrap();
/// assert!((angles[0] - 90.0).abs() < 1e-12 && angles[2].abs() < 1e-12);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RotaryChain(pub Vec<RotaryLink>);

/// Which angle of the reference axis a swivel cycle takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleValue {
    /// `_DIR` of 1.
    Higher,
    /// `_DIR` of -1.
    Lower,
}

/// By which rule a control chooses among the angles that bring the tool to a plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TiltRule {
    /// An axis by index, and whether its angle is above 0 then (else below); `None`: not said.
    pub branch: Option<(usize, bool)>,
    /// Which of the angles that differ by whole turns; `None`: not said.
    pub turns: Option<WholeTurns>,
    /// The axis, by index, whose higher or lower angle a swivel cycle asks for (CYCLE800); `None`: not said.
    pub reference: Option<usize>,
}

/// Which of several angles that differ by whole turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WholeTurns {
    /// The one that is nearest to where the axis stands.
    Shortest,
    /// The one above -180 and up to 180 degrees.
    Principal,
}

/// Why no angles are certain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoAngles {
    /// The machine has not two rotary axes that turn the tool's direction.
    NotTwoAxes,
    /// No angles lead there, or none within travel.
    OutOfReach,
    /// Which of two ways is not said, or the rule does not tell them apart.
    TwoWays,
    /// The tool stands along this axis, which may stand anywhere, and the rule does not say where.
    Free(usize),
    /// Whole turns of this axis are not said.
    Turns(usize),
    /// The nearest place of this axis is half a turn away, to either side.
    HalfTurn(usize),
    /// Whole turns away this axis has a higher angle, or a lower one, which nothing within its travel excludes.
    Travel(usize),
    /// Where this axis stands nobody knows, and the rule asks for it.
    Unknown(usize),
    /// The tool stands along this axis, which would have to turn before the other tilts the tool: by so many degrees.
    Start(usize, i32),
}

/// Angles of a search are not exact, degrees.
const SLACK_DEG: f64 = 1e-9;
/// Whether two ways are told apart by how far they are, degrees.
const NEARER_DEG: f64 = 1e-3;
/// A tool nearer to an axis than this stands along it, rad.
const ALONG_RAD: f64 = 1e-3;

/// Directions nearer than this are one, rad.
const SAME_RAD: f64 = 1e-9;

type Three = [f64; 3];

fn dot(a: Three, b: Three) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Three, b: Three) -> Three {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn size(v: Three) -> f64 {
    dot(v, v).sqrt()
}

/// The turn whose columns are X, `z × x` and Z; both unit vectors at right angles.
fn by_columns(x: Three, z: Three) -> [Three; 3] {
    let y = cross(z, x);
    [0, 1, 2].map(|row| [x[row], y[row], z[row]])
}

fn product(a: [Three; 3], b: [Three; 3]) -> [Three; 3] {
    a.map(|row| [0, 1, 2].map(|column| (0..3).map(|k| row[k] * b[k][column]).sum()))
}

/// `a + k b`
fn plus(a: Three, k: f64, b: Three) -> Three {
    [0, 1, 2].map(|i| a[i] + k * b[i])
}

/// Rodrigues: `v` turned about the unit vector `about`.
fn turned(v: Three, about: Three, angle_deg: f64) -> Three {
    let (sin, cos) = math::sin_cos(angle_deg.to_radians());
    let along = dot(v, about) * (1.0 - cos);
    let across = cross(about, v);
    [0, 1, 2].map(|i| v[i] * cos + across[i] * sin + about[i] * along)
}

/// By how many degrees about `about` the one direction turns to the other; `None` where one lies along it.
fn turn_deg(from: Three, to: Three, about: Three) -> Option<f64> {
    let [from, to] = [from, to].map(|v| plus(v, -dot(v, about), about));
    let is_along = |v: Three| dot(v, v) < SAME_RAD * SAME_RAD;
    if is_along(from) || is_along(to) {
        return None;
    }
    Some(math::atan2(dot(about, cross(from, to)), dot(from, to)).to_degrees())
}

const UP: Three = [0.0, 0.0, 1.0];

impl RotaryLink {
    /// By how much an angle of the axis turns the tool against the workpiece: a table does it backwards.
    const fn sense(&self) -> f64 {
        if self.carries_workpiece { -1.0 } else { 1.0 }
    }

    /// Whether the axis could stand whole turns away from this angle, degrees, and point alike.
    fn has_other_turns(&self, angle_deg: f64) -> bool {
        let [low, high] = self.travel_deg;
        [angle_deg - 360.0, angle_deg + 360.0]
            .into_iter()
            .any(|deg| low - SLACK_DEG <= deg && deg <= high + SLACK_DEG)
    }

    /// The angle of whole turns that the rule chooses, degrees.
    fn choose(
        &self,
        angle_deg: f64,
        rule: &TiltRule,
        stands_deg: Option<f64>,
    ) -> Result<Option<f64>, NoAngles> {
        let [low, high] = self.travel_deg;
        let fits = |deg: f64| low - SLACK_DEG <= deg && deg <= high + SLACK_DEG;
        let principal = if angle_deg <= -180.0 + SLACK_DEG { angle_deg + 360.0 } else { angle_deg };
        match rule.turns {
            _ if !self.has_other_turns(principal) => Ok(Some(principal).filter(|deg| fits(*deg))),
            Some(WholeTurns::Principal) => Ok(Some(principal).filter(|deg| fits(*deg))),
            Some(WholeTurns::Shortest) => {
                let stands_deg = stands_deg.ok_or(NoAngles::Unknown(self.axis))?;
                let turns = (stands_deg - principal) / 360.0;
                let nearest = principal + 360.0 * turns.round();
                if (turns - turns.floor() - 0.5).abs() < SLACK_DEG {
                    // Half a turn this way or that.
                    return Err(NoAngles::HalfTurn(self.axis));
                }
                // Beyond travel the next one inwards.
                let beyond = if nearest < low - SLACK_DEG { 360.0 } else { -360.0 };
                Ok([nearest, nearest + beyond].into_iter().find(|deg| fits(*deg)))
            }
            None => Err(NoAngles::Turns(self.axis)),
        }
    }
}

/// Where the reference axis stands for a direction, in degrees, and the angles of the axes A B C, or why they are not certain.
type Way = (Option<f64>, Result<[f64; 3], NoAngles>);

impl RotaryChain {
    /// The tool's direction in the workpiece on an ideal machine, a unit vector from the tip up: Z with all axes at 0.
    #[must_use]
    pub fn tool_direction(&self, rotary_deg: [f64; 3]) -> [f64; 3] {
        self.in_workpiece(UP, rotary_deg)
    }

    /// A direction of the tool, or of the machine where no axis turns the tool, in the workpiece on an ideal machine.
    #[must_use]
    pub fn in_workpiece(&self, direction: [f64; 3], rotary_deg: [f64; 3]) -> [f64; 3] {
        let links = self.0.iter().rev();
        links.fold(direction, |v, link| turned(v, link.direction, link.sense() * rotary_deg[link.axis]))
    }

    /// A, B, C, degrees, that bring the tool from where the axes stand to a direction in the workpiece: of both ways and of all
    /// whole turns within travel those that are nearest, all axes together. Where two are as near `rule` has to say which one.
    /// Angles that point there already stay to the last bit.
    ///
    /// * `direction` – unit vector, workpiece
    ///
    /// # Errors
    /// [`NoAngles`] where not one pair is certain; [`NoAngles::Start`] where the tool stands along the first axis, which would have
    /// to turn before the tool tilts.
    pub fn angles_near(
        &self,
        direction: [f64; 3],
        rule: &TiltRule,
        stand_deg: [f64; 3],
    ) -> Result<[f64; 3], NoAngles> {
        let [first, second] = self.0.as_slice() else { return Err(NoAngles::NotTwoAxes) };
        if size(plus(self.tool_direction(stand_deg), -1.0, direction)) < SAME_RAD {
            return Ok(stand_deg);
        }
        let (mut found, mut tied): (Vec<[f64; 3]>, Option<NoAngles>) = (Vec::new(), None);
        for positive in [true, false] {
            let branch = Some((second.axis, positive));
            let one = TiltRule { branch, turns: Some(WholeTurns::Shortest), ..TiltRule::default() };
            match self.angles_for(direction, &one, stand_deg.map(Some)) {
                Ok(angles) => found.push(angles),
                Err(NoAngles::OutOfReach) => {}
                // Half a turn away to either side, as the other way is wherever the tool tilts alone.
                Err(why @ NoAngles::HalfTurn(_)) => tied = Some(why),
                Err(why) => return Err(why),
            }
        }
        let far = |angles: &[f64; 3]| -> f64 { (0..3).map(|i| (angles[i] - stand_deg[i]).abs()).sum() };
        if let Some(why) = tied
            && !found.iter().any(|angles| far(angles) < 180.0 - NEARER_DEG)
        {
            return Err(why);
        }
        let along = cross(self.tool_direction(stand_deg), first.direction);
        found.sort_by(|a, b| far(a).total_cmp(&far(b)));
        // Along the first axis the two ways are one.
        found.dedup_by(|a, b| (0..3).all(|i| (a[i] - b[i]).abs() < NEARER_DEG));
        let chosen = match found.as_slice() {
            [] => return Err(NoAngles::OutOfReach),
            [one] => *one,
            [one, other, ..] if far(other) - far(one) > NEARER_DEG => *one,
            all => {
                let on_branch = |angles: &&[f64; 3]| match rule.branch {
                    Some((axis, positive)) => (angles[axis] > 0.0) == positive,
                    None => false,
                };
                let mut fitting = all.iter().filter(on_branch);
                match (fitting.next(), fitting.next()) {
                    (Some(one), None) => *one,
                    _ => return Err(NoAngles::TwoWays),
                }
            }
        };
        let turn_deg = chosen[first.axis] - stand_deg[first.axis];
        if size(along) < ALONG_RAD && turn_deg.abs() > NEARER_DEG {
            return Err(NoAngles::Start(first.axis, turn_deg.round() as i32));
        }
        Ok(chosen)
    }

    /// Both ways to a direction in the workpiece, one where they are the same: the angle of the first axis, `None` where it may
    /// be anything, and of the second, degrees, whole turns aside.
    ///
    /// With the axes' unit vectors a and b, from the workpiece on, the direction is `Rot(a, α) Rot(b, β) z`. The vector
    /// `v = Rot(b, β) z` has `v·b = z·b` and `v·a = n·a`, and so lies in one of two places beside the plane of a and b
    /// (Paden 1986, second subproblem).
    fn ways(&self, direction: [f64; 3]) -> Result<Vec<(Option<f64>, f64)>, NoAngles> {
        let [first, second] = self.0.as_slice() else { return Err(NoAngles::NotTwoAxes) };
        let (a, b) = (first.direction, second.direction);
        let normal = cross(a, b);
        let (k, size) = (dot(a, b), dot(normal, normal));
        if size < SAME_RAD || turn_deg(UP, UP, b).is_none() {
            return Err(NoAngles::NotTwoAxes);
        }
        let (along_a, along_b) = (dot(direction, a), dot(UP, b));
        let in_plane = [(along_a - k * along_b) / size, (along_b - k * along_a) / size];
        let middle = plus([0, 1, 2].map(|i| in_plane[0] * a[i]), in_plane[1], b);
        let beside = (1.0 - dot(middle, middle)) / size;
        if beside < -SAME_RAD {
            return Err(NoAngles::OutOfReach);
        }
        let beside = beside.max(0.0).sqrt();
        // Nearer to each other than anybody turns, the two are one.
        let sides: &[f64] = if beside < 1e-7 { &[0.0] } else { &[beside, -beside] };
        let way = |side: &f64| {
            let between = plus(middle, *side, normal);
            let second_turn = turn_deg(UP, between, b).ok_or(NoAngles::Free(second.axis))?;
            let first_deg = turn_deg(between, direction, a).map(|turn| first.sense() * turn);
            Ok((first_deg, second.sense() * second_turn))
        };
        sides.iter().map(way).collect()
    }

    /// The angle of the first axis where the tool stands along it, degrees: where it stands the way is shortest.
    fn free(&self, rule: &TiltRule, stand_deg: [Option<f64>; 3]) -> Result<f64, NoAngles> {
        let first = &self.0[0];
        match (rule.turns, stand_deg[first.axis]) {
            (Some(WholeTurns::Shortest), Some(stands_deg)) => Ok(stands_deg),
            _ => Err(NoAngles::Free(first.axis)),
        }
    }

    /// A, B, C, degrees, that bring the tool to a direction in the workpiece; axes that the chain does not have at 0.
    ///
    /// * `direction` – unit vector, workpiece
    /// * `stand_deg` – where the axes stand, where known
    ///
    /// # Errors
    /// [`NoAngles`] where not one pair is certain.
    pub fn angles_for(
        &self,
        direction: [f64; 3],
        rule: &TiltRule,
        stand_deg: [Option<f64>; 3],
    ) -> Result<[f64; 3], NoAngles> {
        let ways = self.ways(direction)?;
        let (first, second) = (&self.0[0], &self.0[1]);
        let on_branch = |axis: usize, deg: f64| match rule.branch {
            Some((one, positive)) if one == axis => deg.abs() < 1e-7 || (deg > 0.0) == positive,
            _ => true,
        };
        let mut found: Option<[f64; 3]> = None;
        for (first_deg, second_deg) in &ways {
            if !on_branch(second.axis, *second_deg) {
                continue;
            }
            let first_deg = first_deg.map_or_else(|| self.free(rule, stand_deg), Ok)?;
            if !on_branch(first.axis, first_deg) {
                continue;
            }
            let chosen = [(first, first_deg), (second, *second_deg)]
                .map(|(link, deg)| link.choose(deg, rule, stand_deg[link.axis]));
            let [Some(first_deg), Some(second_deg)] = [chosen[0]?, chosen[1]?] else { continue };
            let mut angles = [0.0; 3];
            (angles[first.axis], angles[second.axis]) = (first_deg, second_deg);
            if found.replace(angles).is_some() {
                return Err(NoAngles::TwoWays);
            }
        }
        match (found, rule.branch) {
            (Some(_), None) if ways.len() > 1 => Err(NoAngles::TwoWays),
            (Some(angles), _) => Ok(angles),
            (None, _) => Err(NoAngles::OutOfReach),
        }
    }

    /// A, B, C, degrees, as a swivel cycle chooses them: of both ways within travel that one on which the rule's reference axis
    /// has the higher angle, or the lower; the only one where the other is beyond travel.
    ///
    /// ```
    /// use toolpath::AngleValue::{Higher, Lower};
    /// use toolpath::{RotaryChain, RotaryLink, TiltRule, WholeTurns};
    ///
    /// let link = |axis: usize, most_deg: f64| {
    ///     let direction = [0, 1, 2].map(|k| f64::from(u8::from(k == axis)));
    ///     RotaryLink { axis, direction, carries_workpiece: true, travel_deg: [-most_deg, most_deg] }
    /// };
    /// let table = RotaryChain(vec![link(2, 200.0), link(0, 110.0)]);
    /// let rule = TiltRule { reference: Some(0), turns: Some(WholeTurns::Principal), ..TiltRule::default() };
    /// let ask = |value| table.angles_by_value([0.0, 1.0, 0.0], value, &rule, [None; 3]).unwrap();
    /// assert!((ask(Higher)[0] - 90.0).abs() < 1e-12 && (ask(Lower)[0] + 90.0).abs() < 1e-12);
    /// ```
    ///
    /// # Errors
    /// [`NoAngles`] where not one pair is certain: also where the reference axis could stand at several whole turns, of which
    /// either value may be the higher.
    pub fn angles_by_value(
        &self,
        direction: [f64; 3],
        value: AngleValue,
        rule: &TiltRule,
        stand_deg: [Option<f64>; 3],
    ) -> Result<[f64; 3], NoAngles> {
        let ways = self.ways(direction)?;
        let (first, second) = (&self.0[0], &self.0[1]);
        // Where each way has the reference axis, and its angles; not certain counts only of the way that is taken.
        let mut reachable: Vec<Way> = Vec::new();
        for (first_deg, second_deg) in ways {
            let first_deg = first_deg.map_or_else(|| self.free(rule, stand_deg), Ok)?;
            let chosen = [(first, first_deg), (second, second_deg)]
                .map(|(link, deg)| link.choose(deg, rule, stand_deg[link.axis]));
            let of_reference = [first, second].iter().position(|link| Some(link.axis) == rule.reference);
            let reference_deg = of_reference.and_then(|at| chosen[at].ok().flatten());
            match chosen {
                [Ok(Some(first_deg)), Ok(Some(second_deg))] => {
                    let mut angles = [0.0; 3];
                    (angles[first.axis], angles[second.axis]) = (first_deg, second_deg);
                    reachable.push((reference_deg, Ok(angles)));
                }
                [Ok(None), _] | [_, Ok(None)] => {}
                [Err(why), _] | [_, Err(why)] => reachable.push((reference_deg, Err(why))),
            }
        }
        match reachable.as_slice() {
            [] => Err(NoAngles::OutOfReach),
            [(_, only)] => *only,
            [(one_deg, one), (other_deg, other), ..] => {
                let (Some(one_deg), Some(other_deg), Some(reference)) =
                    (*one_deg, *other_deg, rule.reference)
                else {
                    return one.and(*other).and(Err(NoAngles::TwoWays));
                };
                let link = if first.axis == reference { first } else { second };
                if [one_deg, other_deg].into_iter().any(|deg| link.has_other_turns(deg)) {
                    return Err(NoAngles::Travel(reference));
                }
                if (one_deg - other_deg).abs() < NEARER_DEG {
                    return Err(NoAngles::TwoWays);
                }
                if (one_deg > other_deg) == (value == AngleValue::Higher) { *one } else { *other }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::AngleValue::{Higher, Lower};
    use super::*;

    fn link(axis: usize, direction: Three, carries_workpiece: bool, most_deg: f64) -> RotaryLink {
        let size = dot(direction, direction).sqrt();
        let direction = direction.map(|v| v / size);
        RotaryLink { axis, direction, carries_workpiece, travel_deg: [-most_deg, most_deg] }
    }

    const X: Three = [1.0, 0.0, 0.0];
    const Y: Three = [0.0, 1.0, 0.0];

    #[test]
    fn vectors_of_six_decimals_are_at_right_angles() {
        let unit = |v| unit(v).expect("a direction");
        let (x, z) = ([0.122216, -0.500205, -0.857239], [-0.518475, -0.76867, 0.374607]);
        assert!(TiltedPlane::turn_by_directions(unit(x), unit(z)).is_ok());
        let lean = TiltedPlane::turn_by_directions(unit(x), unit([-0.518475, -0.76868, 0.374607]));
        assert!(lean.is_err_and(|lean| (lean.abs() - 5e-6).abs() < 2e-6), "{lean:?}");
    }

    #[test]
    fn the_angles_bring_the_tool_there_on_the_branch_that_was_asked_for() {
        let chains = [
            vec![link(2, UP, true, 1000.0), link(0, X, true, 110.0)],
            vec![link(2, UP, true, 1000.0), link(1, Y, true, 110.0)],
            vec![link(2, UP, true, 1000.0), link(1, Y, false, 110.0)],
            vec![link(2, UP, false, 1000.0), link(1, [0.0, 1.0, 1.0], false, 190.0)],
            vec![link(0, X, false, 80.0), link(1, Y, false, 80.0)],
        ];
        for chain in chains {
            let chain = RotaryChain(chain);
            let tilting = chain.0[1].axis;
            let mut met = 0;
            for step in 0..200 {
                let step = f64::from(step);
                let mut wanted = [0.0; 3];
                wanted[chain.0[0].axis] = (37.0 * step).rem_euclid(150.0) - 75.0;
                wanted[tilting] = (23.0 * step).rem_euclid(150.0) - 75.0;
                let direction = chain.tool_direction(wanted);
                if wanted[tilting].abs() < 0.5 {
                    continue;
                }
                for positive in [true, false] {
                    let rule = TiltRule {
                        branch: Some((tilting, positive)),
                        turns: Some(WholeTurns::Principal),
                        reference: None,
                    };
                    let Ok(angles) = chain.angles_for(direction, &rule, [None; 3]) else { continue };
                    met += 1;
                    assert_eq!(angles[tilting] > 0.0, positive, "{chain:?} {wanted:?}");
                    let there = chain.tool_direction(angles);
                    assert!((0..3).all(|i| (there[i] - direction[i]).abs() < 1e-12), "{chain:?} {wanted:?}");
                    if (wanted[tilting] > 0.0) == positive {
                        assert!((0..3).all(|i| (angles[i] - wanted[i]).abs() < 1e-6), "{chain:?} {wanted:?}");
                    }
                }
            }
            assert!(met >= 190, "{chain:?}: {met}");
        }
    }

    #[test]
    fn what_the_rule_leaves_open_is_not_guessed() {
        let chain = RotaryChain(vec![link(2, UP, true, 1000.0), link(0, X, true, 110.0)]);
        let tilted = chain.tool_direction([30.0, 0.0, 40.0]);
        let rule =
            TiltRule { branch: Some((0, true)), turns: Some(WholeTurns::Shortest), ..TiltRule::default() };
        let ask = |direction, rule: TiltRule, stand| chain.angles_for(direction, &rule, stand);
        assert_eq!(
            ask(
                tilted,
                TiltRule { branch: None, turns: Some(WholeTurns::Principal), reference: None },
                [None; 3]
            ),
            Err(NoAngles::TwoWays)
        );
        assert_eq!(ask(tilted, TiltRule { turns: None, ..rule }, [None; 3]), Err(NoAngles::Turns(2)));
        assert_eq!(ask(tilted, rule, [None; 3]), Err(NoAngles::Unknown(2)));
        assert_eq!(ask([0.0, 0.0, -1.0], rule, [Some(0.0); 3]), Err(NoAngles::OutOfReach));
        assert_eq!(
            ask(UP, TiltRule { turns: Some(WholeTurns::Principal), ..rule }, [Some(7.0); 3]),
            Err(NoAngles::Free(2))
        );
        let near = ask(tilted, rule, [None, None, Some(700.0)]).unwrap();
        assert!((near[2] - 760.0).abs() < 1e-9 && (near[0] - 30.0).abs() < 1e-9, "{near:?}");
        assert_eq!(ask(UP, rule, [Some(0.0), None, Some(7.0)]), Ok([0.0, 0.0, 7.0]));
        let one = RotaryChain(vec![link(0, X, true, 110.0)]);
        assert_eq!(one.angles_for(UP, &rule, [Some(0.0); 3]), Err(NoAngles::NotTwoAxes));
    }

    #[test]
    fn a_vector_that_tilts_the_tool_alone_is_followed() {
        // C goes on for turns: by the other way it would be half a turn away, to either side.
        let chain = RotaryChain(vec![link(2, [0.0, 0.0, 1.0], true, 7200.0), link(0, X, true, 110.0)]);
        let stand_deg = [-20.0, 0.0, 40.0];
        let wanted_deg = [-18.0, 0.0, 40.0];
        let near =
            |stand_deg| chain.angles_near(chain.tool_direction(wanted_deg), &TiltRule::default(), stand_deg);
        let found = near(stand_deg).expect("certain");
        assert!((0..3).all(|i| (found[i] - wanted_deg[i]).abs() < 1e-9), "{found:?}");
        // From half a turn of C away both sides are as near, and the other way is nearer.
        assert!(near([20.0, 0.0, 220.0]).is_ok_and(|found| (found[0] - 18.0).abs() < 1e-9), "the other way");
    }

    #[test]
    fn a_tie_on_the_way_that_is_not_taken_does_not_count() {
        // Tilted about X by 30: A 30 at C 0, or A -30 at half a turn of C, which is as near to either side.
        let chain = RotaryChain(vec![link(2, [0.0, 0.0, 1.0], true, 360.0), link(0, X, true, 120.0)]);
        let rule = TiltRule { reference: Some(0), turns: Some(WholeTurns::Shortest), branch: None };
        let ask = |value| {
            let tilted = [0.0, -0.5, 0.75f64.sqrt()];
            chain.angles_by_value(tilted, value, &rule, [Some(0.0), None, Some(0.0)])
        };
        let [one, other] = [ask(Higher), ask(Lower)];
        let (taken, tied) = if one.is_ok() { (one, other) } else { (other, one) };
        let taken = taken.expect("certain");
        assert!(taken[2].abs() < 1e-9 && (taken[0].abs() - 30.0).abs() < 1e-9, "{taken:?}");
        assert!(matches!(tied, Err(NoAngles::HalfTurn(2))), "{tied:?}");
    }

    #[test]
    fn a_swivel_cycle_takes_the_higher_or_lower_angle_of_its_reference_axis() {
        let chain = RotaryChain(vec![link(2, UP, true, 200.0), link(0, X, true, 110.0)]);
        let tilted = chain.tool_direction([30.0, 0.0, 40.0]);
        let rule = TiltRule { reference: Some(0), turns: Some(WholeTurns::Principal), branch: None };
        let ask = |chain: &RotaryChain, value, rule: TiltRule| {
            chain.angles_by_value(tilted, value, &rule, [None; 3])
        };
        let near = |angles: [f64; 3], a: f64, c: f64| {
            assert!((angles[0] - a).abs() < 1e-9 && (angles[2] - c).abs() < 1e-9, "{angles:?}");
        };
        near(ask(&chain, Higher, rule).unwrap(), 30.0, 40.0);
        near(ask(&chain, Lower, rule).unwrap(), -30.0, -140.0);
        assert_eq!(ask(&chain, Higher, TiltRule { reference: None, ..rule }), Err(NoAngles::TwoWays));
        // C could stand at -140 and at 220: which of its angles is the higher one nobody says.
        let wide = RotaryChain(vec![link(2, UP, true, 300.0), link(0, X, true, 110.0)]);
        let of_c = TiltRule { reference: Some(2), ..rule };
        assert_eq!(ask(&wide, Higher, of_c), Err(NoAngles::Travel(2)));
        // Where only one way is within travel it is taken, whichever was asked for.
        let mut short = chain;
        short.0[1].travel_deg = [-5.0, 110.0];
        near(ask(&short, Lower, TiltRule { reference: None, ..rule }).unwrap(), 30.0, 40.0);
    }

    #[test]
    fn turns_follow_each_other_about_axes_that_turn() {
        // A quarter turn about Z, then about the X that lies along Y now: Z ends along X.
        let turn = TiltedPlane::turn_by_axes([2, 0, 1], [90.0, 90.0, 0.0]);
        let base = TiltedPlane { turn: TiltedPlane::turn_about(2, 0.0), zero_mm: [100.0, 0.0, 0.0] };
        let plane = base.then([10.0, 20.0, 30.0], turn, [0.0, 0.0, 5.0]);
        assert_eq!(plane.normal().map(f64::round), [1.0, 0.0, 0.0]);
        assert_eq!(plane.zero_mm.map(f64::round), [115.0, 20.0, 30.0]);
    }
}
