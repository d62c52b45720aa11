//! What the options of `vpost map` mean.

use error_map::{Grid, Nodes, Plane};
use machine_model::{Command, Range, Vector, Volume};
use machine_profile::Profile;

use super::Map;
use crate::arguments::Shared;
use crate::message::Failure;

/// What is asked for, in the mathematics' words.
pub(super) struct Asked {
    pub grid: Grid,
    pub tool_mm: Vector,
    pub rotary_rad: Vector,
    pub within_mm: f64,
    pub regions: Vec<(String, [Range; 3])>,
    /// A layer at a place of the normal, or all layers.
    pub planes: Vec<(Plane, Option<f64>)>,
    pub part_box_mm: Option<[Range; 3]>,
    pub clamp_mm: Option<Vector>,
    pub second_order: bool,
}

/// Reads the options.
pub(super) fn read(
    arguments: &Map,
    shared: &Shared,
    profile: &Profile,
    volume: Volume,
) -> Result<Asked, Failure> {
    let within = arguments.within;
    if !(within > 0.0 && within.is_finite()) {
        return Err(Failure::option(
            format!("`--within {within}`: no error is within that"),
            "give micrometres above zero: `--within 20`",
        ));
    }
    Ok(Asked {
        grid: grid(&arguments.grid, volume)?,
        tool_mm: tool(arguments.tool_vector.as_deref(), shared, profile)?,
        rotary_rad: rotary(arguments.rotary.as_deref(), profile)?,
        within_mm: within * 1e-3,
        regions: arguments.region.iter().map(|given| region(given)).collect::<Result<_, _>>()?,
        planes: arguments.plane.iter().map(|given| plane(given)).collect::<Result<_, _>>()?,
        part_box_mm: arguments
            .part_box
            .as_deref()
            .map(|given| ranges(given).ok_or_else(|| wrong("--part-box", given, "100..220,50..130,20..60")))
            .transpose()?,
        clamp_mm: arguments.clamp.as_deref().map(clamp).transpose()?,
        second_order: arguments.second_order,
    })
}

fn wrong(option: &str, given: &str, example: &str) -> Failure {
    Failure::option(
        format!("`{option} {given}` cannot be read"),
        format!("write millimetres as in `{option} {example}`"),
    )
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|v| v.is_finite())
}

fn three<T>(text: &str, of: impl Fn(&str) -> Option<T>) -> Option<[T; 3]> {
    let mut parts = text.split(',').map(of);
    let found = [parts.next()??, parts.next()??, parts.next()??];
    parts.next().is_none().then_some(found)
}

/// `X0..X1,Y0..Y1,Z0..Z1`, the lower end first.
fn ranges(text: &str) -> Option<[Range; 3]> {
    three(text, |part| {
        let (low, high) = part.split_once("..")?;
        let range = Range { low: number(low)?, high: number(high)? };
        (range.low <= range.high).then_some(range)
    })
}

fn region(given: &str) -> Result<(String, [Range; 3]), Failure> {
    let example = "table=0..200,0..140,0..100";
    // Names may hold anything; the ranges hold no equals sign.
    let (name, text) = given.rsplit_once('=').ok_or_else(|| wrong("--region", given, example))?;
    let ranges = ranges(text).ok_or_else(|| wrong("--region", given, example))?;
    Ok((name.trim().to_owned(), ranges))
}

fn plane(given: &str) -> Result<(Plane, Option<f64>), Failure> {
    let (name, at) = match given.split_once('=') {
        Some((name, at)) => (name, Some(number(at).ok_or_else(|| wrong("--plane", given, "XY=100"))?)),
        None => (given, None),
    };
    let known = Plane::ALL.into_iter().find(|plane| plane.name().eq_ignore_ascii_case(name.trim()));
    known.map(|plane| (plane, at)).ok_or_else(|| wrong("--plane", given, "XY=100"))
}

fn clamp(given: &str) -> Result<Vector, Failure> {
    let size = three(given, |part| number(part).filter(|v| *v >= 0.0));
    size.map(Vector::from).ok_or_else(|| wrong("--clamp", given, "120,80,40"))
}

/// `22x22x21` nodes over the volume, or `from:to:step` of each axis.
pub(crate) fn grid(given: &str, volume: Volume) -> Result<Grid, Failure> {
    let refuse = |why: String| {
        Failure::option(
            format!("`--grid {given}`: {why}"),
            "write numbers of nodes as in `--grid 22x22x21`, or from:to:step in mm as in `--grid 40:880:40,30:450:20,5:505:25`",
        )
    };
    let nodes: [Nodes; 3] = if given.contains(':') {
        let stepped = three(given, |part| {
            let mut numbers = part.split(':').map(number);
            let found = (numbers.next()??, numbers.next()??, numbers.next()??);
            numbers.next().is_none().then_some(found)
        });
        let stepped = stepped.ok_or_else(|| refuse("three times from:to:step are expected".to_owned()))?;
        let mut nodes = Vec::new();
        for (from, to, step) in stepped {
            nodes.push(Nodes::stepped(from, to, step).map_err(|error| refuse(error.to_string()))?);
        }
        nodes.try_into().expect("three of three")
    } else {
        let counts = three(&given.replace(['x', 'X', '×'], ","), |part| part.trim().parse::<u64>().ok());
        let counts = counts.ok_or_else(|| refuse("three whole numbers are expected".to_owned()))?;
        let mut nodes = Vec::new();
        for (axis, count) in counts.into_iter().enumerate() {
            nodes.push(Nodes::over(volume.0[axis], count).map_err(|error| refuse(error.to_string()))?);
        }
        nodes.try_into().expect("three of three")
    };
    Grid::new(nodes).map_err(|error| refuse(error.to_string()))
}

/// An H number stands for minus its length vector, as under G43.
pub(crate) fn tool(given: Option<&str>, shared: &Shared, profile: &Profile) -> Result<Vector, Failure> {
    let Some(given) = given else {
        return Ok(Vector::from(profile.default_tool_mm));
    };
    if let Some(number) = given.strip_prefix(['H', 'h']).and_then(|digits| digits.parse::<u32>().ok()) {
        let tools = crate::settings::tools(shared, profile)?;
        return tools
            .iter()
            .find(|(known, _)| *known == number)
            .map(|(_, length)| -Vector::from(*length))
            .ok_or_else(|| {
                Failure::option(
                    format!("`--tool-vector {given}`: neither the profile nor `--tool` has an H{number}"),
                    format!("add `--tool H{number}=120`"),
                )
            });
    }
    three(given, number).map(Vector::from).ok_or_else(|| wrong("--tool-vector", given, "0,0,-120"))
}

/// `A=30,C=90`; axes that are not named stand at 0.
pub(crate) fn rotary(given: Option<&str>, profile: &Profile) -> Result<Vector, Failure> {
    let mut angles = Vector::zeros();
    let Some(given) = given else { return Ok(angles) };
    for part in given.split(',') {
        let refuse = |why: &str| {
            Failure::option(format!("`--rotary {given}`: {why}"), "write degrees as in `--rotary A=30,C=90`")
        };
        let (name, value) = part.split_once('=').ok_or_else(|| refuse("AXIS=DEGREES is expected"))?;
        let axis = ["A", "B", "C"].iter().position(|known| known.eq_ignore_ascii_case(name.trim()));
        let axis = axis.ok_or_else(|| refuse("the rotary axes are A, B and C"))?;
        if !profile.has_rotary()[axis] {
            return Err(refuse("the profile's chain has no such axis"));
        }
        angles[axis] = number(value).ok_or_else(|| refuse("that is no number"))?.to_radians();
    }
    let turned = Command {
        linear_mm: Vector::zeros(),
        rotary_rad: angles,
        tool_mm: Vector::zeros(),
        direction: [0; 3],
    };
    profile.rigid_body_without_effects().rotary_inside(&turned).map_err(|error| {
        Failure::option(format!("`--rotary {given}`: {error}"), "give angles inside its travel and its table")
    })?;
    Ok(angles)
}
