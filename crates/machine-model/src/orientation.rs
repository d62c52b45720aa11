//! Where rotary axes have to stand so that the tool points where the program says: equations (118) and (119).

use crate::{Command, PathModel, SolveError, Vector};

/// Half the step of difference quotients of ideal directions, rad: what they leave out is its square, what rounding adds far
/// less.
const STEP_RAD: f64 = 1e-5;
/// Directions that are nearer are one, rad.
const SAME_RAD: f64 = 1e-12;
/// Rounds of Newton's method; each leaves about a thousandth.
const ROUNDS: u32 = 12;

/// Where the tool's direction says too little of a rotary axis to be corrected by it.
///
/// ```
/// use machine_model::Singularity;
///
/// assert_eq!(Singularity::default().least_sin, 0.02);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Singularity {
    /// [`singular_sin`] below which directions are not corrected.
    pub least_sin: f64,
    /// The most by which a rotary axis is corrected, rad.
    pub most_turn_rad: f64,
    /// The most by which that may change on a way, as a share of what the rotary axes turn on it.
    pub most_share: f64,
}

impl Default for Singularity {
    fn default() -> Self {
        Self { least_sin: 0.02, most_turn_rad: 0.5_f64.to_radians(), most_share: 0.1 }
    }
}

/// Why rotary axes stay as they are programmed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// The tool stands too nearly along the axis that would have to turn.
    Singular,
    /// One would have to turn by more than it may.
    TooFar,
    /// One would leave its travel.
    BeyondTravel,
}

/// Where the rotary axes have to stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// A, B, C, rad.
    At(Vector),
    /// Where the program says.
    Held(Held),
}

/// How the ideal tool's direction changes with A, B, C, a column each.
fn columns(model: &dyn PathModel, at: &Command) -> Option<[Vector; 3]> {
    let ideal = |axis: usize, by: f64| {
        let programmed_rad = at.rotary_rad + Vector::ith(axis, by);
        model
            .tool_directions(&Command { rotary_rad: programmed_rad, ..*at }, &programmed_rad)
            .map(|both| both[0])
    };
    let has = model.rotary_axes();
    let mut all = [Vector::zeros(); 3];
    for axis in (0..3).filter(|axis| has[*axis]) {
        all[axis] = (ideal(axis, STEP_RAD)? - ideal(axis, -STEP_RAD)?) / (2.0 * STEP_RAD);
    }
    Some(all)
}

/// The two rotary axes of the machine; `None` where it has not two.
fn pair(model: &dyn PathModel) -> Option<[usize; 2]> {
    let has = model.rotary_axes();
    let mut axes = (0..3).filter(|axis| has[*axis]);
    match (axes.next(), axes.next(), axes.next()) {
        (Some(first), Some(second), None) => Some([first, second]),
        _ => None,
    }
}

/// `|n · (a × b)|`, n the ideal tool's direction and a, b those of the two rotary axes as they stand: the sine of the tilt
/// on a machine whose rotary axes are at right angles, 0 where no turn tips the tool to one side. Equation (118).
///
/// `None` where the machine has not two rotary axes, or the model knows no directions.
#[must_use]
pub fn singular_sin(model: &dyn PathModel, at: &Command) -> Option<f64> {
    let [first, second] = pair(model)?;
    let columns = columns(model, at)?;
    Some(columns[first].cross(&columns[second]).norm())
}

/// Where the two rotary axes have to stand so that the tool, its tip at the programmed place, points where an ideal machine
/// points at the programmed command. Equation (119), Newton's method on five axes.
///
/// It starts from the programmed angles and goes no further than [`Singularity::most_turn_rad`], so that it stays on their
/// branch and on their turn. Where nothing is off the programmed angles come back to the last bit.
///
/// * `target` – programmed command, its linear axes as for [`crate::Engine::solve`]
///
/// # Errors
/// Those of [`crate::Engine::solve`]. [`SolveError::Undefined`] where the model knows no directions or the machine has not
/// two rotary axes.
pub fn aim(model: &dyn PathModel, target: &Command, limits: &Singularity) -> Result<Aim, SolveError> {
    let undefined = || {
        SolveError::Undefined(
            "this machine has no two rotary axes by which the tool's direction could be corrected",
            "у этого станка нет двух поворотных осей, которыми можно исправить направление инструмента",
        )
    };
    let [first, second] = pair(model).ok_or_else(undefined)?;
    let programmed_rad = target.rotary_rad;
    let mut at = *target;
    let off = |at: &Command| -> Result<Vector, SolveError> {
        let linear_mm = model.same_tip_mm(&target.linear_mm, at, &programmed_rad);
        let linear_mm = model.solve(&Command { linear_mm, ..*at })?.linear_mm;
        let both = model.tool_directions(&Command { linear_mm, ..*at }, &programmed_rad);
        both.map(|[ideal, real]| real - ideal).ok_or_else(undefined)
    };
    let mut left = off(&at)?;
    if left == Vector::zeros() {
        return Ok(Aim::At(programmed_rad));
    }
    let columns = columns(model, &at).ok_or_else(undefined)?;
    let [one, other] = [columns[first], columns[second]];
    if one.cross(&other).norm() < limits.least_sin {
        return Ok(Aim::Held(Held::Singular));
    }
    // The difference of two unit vectors lies across them but for second order: least squares in two unknowns.
    let (aa, ab, bb) = (one.dot(&one), one.dot(&other), other.dot(&other));
    let determinant = aa * bb - ab * ab;
    for _ in 0..ROUNDS {
        let (u, v) = (one.dot(&left), other.dot(&left));
        at.rotary_rad[first] -= (bb * u - ab * v) / determinant;
        at.rotary_rad[second] -= (aa * v - ab * u) / determinant;
        let turned_rad = (at.rotary_rad - programmed_rad).amax();
        if turned_rad.is_nan() || turned_rad > limits.most_turn_rad {
            return Ok(Aim::Held(Held::TooFar));
        }
        if !model.may_turn_to(&at) {
            return Ok(Aim::Held(Held::BeyondTravel));
        }
        let before = left.norm();
        left = off(&at)?;
        if left.norm() <= SAME_RAD || left.norm() > 0.5 * before {
            break;
        }
    }
    Ok(Aim::At(at.rotary_rad))
}
