//! From three axis traverses of a laser tracker to directions, squareness and error tables: equations (32) to (36).
//!
//! A tracker that follows a point sees where it goes, not how the carriage turns: angles (roll, pitch, yaw) are not in
//! three traverses, and so nothing is known of what happens beside the measured lines with other tool vectors.

use diagnostic::{Text, both};
use machine_model::{Description, Squareness, Vector};
use nalgebra::Matrix3;

use crate::error::{CalibrationError, LETTERS};
use crate::known_places::known_places;
use crate::layout::Plan;
use crate::machine_change::find;
use crate::mistakes;
use crate::points::{Base, ChangedAxis, Point, SetUp};
use crate::student::quantile_95;
use crate::traverse::{MeanTraverse, Noise};
use crate::volumetric::{field_commands, plays};

/// Instrument and machine frame may differ by this much before the difference is a question, rad.
const LARGEST_FRAME_TURN_RAD: f64 = 0.01;

/// How instrument and machine frame belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// The instrument was aligned to the machine: its readings are taken as they are.
    AsMeasured,
    /// Readings are turned so that the three lines lie as near as possible to the three axes.
    Fitted,
}

/// Direction of one interval of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cosines {
    /// Commands at its ends, mm.
    pub from_mm: f64,
    /// Upper end.
    pub to_mm: f64,
    /// Direction cosines with their signs.
    pub cosines: Vector,
    /// Standard uncertainty of the two transverse ones and, to second order zero, of the one along the axis.
    pub uncertainty: Vector,
}

/// Least-squares line of one traverse against its commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// d(measured)/d(command) per component; 1 + scale error along the axis itself.
    pub slope: Vector,
    /// Standard uncertainties of the slopes.
    pub uncertainty: Vector,
}

/// What chords of this length do at the far corner: equation (36).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FarCorner {
    /// The corner of the measured box farthest from the common origin, mm.
    pub corner_mm: Vector,
    /// Deviation found there, mm.
    pub deviation_mm: f64,
    /// Half width of the 95 % interval of the deviation where positions are added (engines `rigid-body`, `tracker`), mm.
    pub positions_u95_mm: f64,
    /// The same where one interval's directions are carried there (cosines, G and r01; the tangential engines), mm.
    pub chord_u95_mm: f64,
    /// Half width of the 95 % interval of a chord's direction, the worst axis, rad.
    pub direction_u95_rad: f64,
    /// Usual length of a chord, mm.
    pub chord_mm: f64,
    /// From standard uncertainties of this measurement to half widths of 95 % intervals.
    pub coverage_factor: f64,
}

/// What the uncertainty at the far corner means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The uncertainty is below half of the deviation it is to correct.
    Sound,
    /// It is below the deviation, but not by half.
    Doubtful,
    /// It exceeds the deviation: corrected or not, the machine would be as far off, or farther.
    Unfit,
}

impl FarCorner {
    /// The verdict on the chords.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        if self.chord_u95_mm > self.deviation_mm {
            Verdict::Unfit
        } else if self.chord_u95_mm > 0.5 * self.deviation_mm {
            Verdict::Doubtful
        } else {
            Verdict::Sound
        }
    }
    /// Length of chords with which the uncertainty would be half of the deviation, same scatter, mm.
    #[must_use]
    pub fn sufficient_chord_mm(&self) -> f64 {
        self.chord_mm * self.chord_u95_mm / (0.5 * self.deviation_mm)
    }
}

/// Everything three traverses say.
#[derive(Clone, Debug)]
pub struct TrackerCalibration {
    /// The traverses, in the frame that was chosen.
    pub traverses: [MeanTraverse; 3],
    /// Command where the three lines meet, mm.
    pub origin_mm: Vector,
    /// Rotation that was taken off the readings (only with [`Frame::Fitted`]), as a matrix.
    pub turned: Matrix3<f64>,
    /// Lines of X, Y, Z.
    pub lines: [Line; 3],
    /// Directions of every interval of X, Y, Z.
    pub cosines: [Vec<Cosines>; 3],
    /// Angles between the lines, ISO 230-1 signs.
    pub squareness: Squareness,
    /// Their standard uncertainties, rad, in the order EC0Y, EB0Z, EA0Z.
    pub squareness_uncertainty_rad: [f64; 3],
    /// What the chords are good for.
    pub far_corner: FarCorner,
}

impl TrackerCalibration {
    /// Directions of one interval per axis as columns: the G of the tangential methods.
    ///
    /// `None` where an axis has no such interval.
    #[must_use]
    pub fn directions(&self, interval: usize) -> Option<Matrix3<f64>> {
        let column = |axis: usize| self.cosines[axis].get(interval).map(|c| c.cosines);
        Some(Matrix3::from_columns(&[column(0)?, column(1)?, column(2)?]))
    }

    /// r01 of the tangential methods: node `interval` of the X traverse, followed back by its own command, mm; equation
    /// (2.5) ff of Pimushkin 2023.
    #[must_use]
    pub fn offset_mm(&self, interval: usize) -> Option<Vector> {
        let node = self.traverses[0].nodes.get(interval)?;
        let direction = self.cosines[0].get(interval)?.cosines;
        let zero = self.traverses[0].at(self.origin_mm.x);
        Some(node.measured_mm - zero - direction * (node.commanded_mm - self.origin_mm.x))
    }
}

/// Evaluates the traverses of X, Y and Z.
///
/// # Errors
/// [`CalibrationError::Axes`] where they have no common origin, where the measured motion does not follow the
/// commanded axis, or where the frame is mirrored.
pub fn calibrate(traverses: [MeanTraverse; 3], frame: Frame) -> Result<TrackerCalibration, CalibrationError> {
    let origin_mm = common_origin(&traverses)?;
    let mut traverses = traverses;
    let turned = match frame {
        Frame::AsMeasured => Matrix3::identity(),
        Frame::Fitted => {
            let lines = [0, 1, 2].map(|i| line(&traverses[i]).slope);
            let turn = nearest_rotation(&Matrix3::from_columns(&lines))?;
            let squares = turn.transpose().map(|c| c * c);
            for node in traverses.iter_mut().flat_map(|t| &mut t.nodes) {
                node.measured_mm = turn.transpose() * node.measured_mm;
                node.uncertainty_mm = (squares * node.uncertainty_mm.map(|u| u * u)).map(f64::sqrt);
            }
            turn
        }
    };
    let lines = [0, 1, 2].map(|i| line(&traverses[i]));
    check_frame(&lines)?;
    let cosines = [0, 1, 2].map(|i| cosines(&traverses[i]));
    let u = |axis: usize, component: usize| lines[axis].uncertainty[component];
    let [x, y, z] = [0, 1, 2].map(|i| lines[i].slope.normalize());
    let squareness = Squareness { ec0y_rad: -x.dot(&y), eb0z_rad: x.dot(&z), ea0z_rad: -y.dot(&z) };
    let both = |a: f64, b: f64| (a * a + b * b).sqrt();
    let squareness_uncertainty_rad = [both(u(1, 0), u(0, 1)), both(u(2, 0), u(0, 2)), both(u(2, 1), u(1, 2))];
    let far_corner = far_corner(&traverses, &origin_mm);
    Ok(TrackerCalibration {
        traverses,
        origin_mm,
        turned,
        lines,
        cosines,
        squareness,
        squareness_uncertainty_rad,
        far_corner,
    })
}

/// The command where the three lines meet.
fn common_origin(traverses: &[MeanTraverse; 3]) -> Result<Vector, CalibrationError> {
    let mut origin = Vector::zeros();
    for i in 0..3 {
        let [a, b] = [(i + 1) % 3, (i + 2) % 3].map(|other| traverses[other].start_mm[i]);
        let nodes = &traverses[i].nodes;
        let inside = (nodes[0].commanded_mm..=nodes[nodes.len() - 1].commanded_mm).contains(&a);
        if (a - b).abs() > 1e-6 || !inside {
            return Err(CalibrationError::Axes(both!(
                "the three traverses have no common point: {} stands at {a} mm in one and at {b} mm in another, and its own \
                 traverse runs from {} to {} mm",
                "у трёх проходов нет общей точки: {} стоит в одном на {a} мм, в другом на {b} мм, а её собственный проход идёт \
                 от {} до {} мм",
                LETTERS[i],
                nodes[0].commanded_mm,
                nodes[nodes.len() - 1].commanded_mm
            )));
        }
        origin[i] = a;
    }
    Ok(origin)
}

/// Least-squares line with intercept and its slopes' uncertainties: equation (32).
fn line(traverse: &MeanTraverse) -> Line {
    let nodes = &traverse.nodes;
    let n = nodes.len() as f64;
    let mean = nodes.iter().map(|v| v.commanded_mm).sum::<f64>() / n;
    let spread: f64 = nodes.iter().map(|v| (v.commanded_mm - mean) * (v.commanded_mm - mean)).sum();
    let slope: Vector =
        nodes.iter().map(|v| v.measured_mm * (v.commanded_mm - mean)).sum::<Vector>() / spread;
    let variance: Vector = nodes
        .iter()
        .map(|v| v.uncertainty_mm.map(|u| u * u) * (v.commanded_mm - mean) * (v.commanded_mm - mean))
        .sum::<Vector>()
        / (spread * spread);
    Line { slope, uncertainty: variance.map(f64::sqrt) }
}

/// Signed direction cosines of every interval: equation (33).
fn cosines(traverse: &MeanTraverse) -> Vec<Cosines> {
    let interval = |w: &[crate::Node]| {
        let chord = w[1].measured_mm - w[0].measured_mm;
        let length = chord.norm();
        let cosines = chord / length;
        let own = w[0].uncertainty_mm.zip_map(&w[1].uncertainty_mm, |a, b| (a * a + b * b).sqrt());
        // d(c_i) = (I - c cᵀ)·d(chord) / length, readings of the components independent.
        let uncertainty = Vector::from_fn(|i, _| {
            let part = |k: usize| f64::from(u8::from(i == k)) - cosines[i] * cosines[k];
            (0..3).map(|k| part(k) * part(k) * own[k] * own[k]).sum::<f64>().sqrt() / length
        });
        Cosines { from_mm: w[0].commanded_mm, to_mm: w[1].commanded_mm, cosines, uncertainty }
    };
    traverse.nodes.windows(2).map(interval).collect()
}

/// The rotation nearest to three measured directions (columns), by their singular vectors.
fn nearest_rotation(directions: &Matrix3<f64>) -> Result<Matrix3<f64>, CalibrationError> {
    let svd = directions.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Err(CalibrationError::Axes(Text::pair(
            "the three measured lines span no space",
            "три измеренные линии не образуют пространства",
        )));
    };
    let turn = u * v_t;
    if turn.determinant() < 0.0 {
        return Err(CalibrationError::Axes(Text::pair(
            "the three measured lines form a left-handed frame: one axis has the opposite sign in the measurement, or two are exchanged",
            "три измеренные линии образуют левую систему: у одной оси в измерении обратный знак или две переставлены",
        )));
    }
    Ok(turn)
}

/// The measured motion must follow the commanded axis, with its sign.
fn check_frame(lines: &[Line; 3]) -> Result<(), CalibrationError> {
    for (axis, line) in lines.iter().enumerate() {
        let main = line.slope.iamax();
        if main != axis {
            return Err(CalibrationError::Axes(both!(
                "where {} is commanded, the measured {} moves",
                "задаётся {}, а по измерению движется {}",
                LETTERS[axis],
                LETTERS[main]
            )));
        }
        if line.slope[axis] < 0.0 {
            return Err(CalibrationError::Axes(both!(
                "where {} is commanded upwards, the measured {} falls",
                "{} задаётся вверх, а измеренная {} убывает",
                LETTERS[axis],
                LETTERS[axis]
            )));
        }
        let tilt = (0..3).filter(|&k| k != axis).map(|k| line.slope[k].abs()).fold(0.0, f64::max);
        if tilt > LARGEST_FRAME_TURN_RAD {
            return Err(CalibrationError::Axes(both!(
                "the line of {} leans by {:.1} mrad in the measuring frame: the instrument was not aligned to the machine",
                "линия {} наклонена в системе измерения на {:.1} мрад: прибор не выверен по станку",
                LETTERS[axis],
                tilt * 1e3
            )));
        }
    }
    Ok(())
}

/// Equation (36).
fn far_corner(traverses: &[MeanTraverse; 3], origin_mm: &Vector) -> FarCorner {
    let factor = match traverses[0].noise {
        Noise::Repeats(free) => quantile_95(Some(free)),
        Noise::Given => quantile_95(None),
        Noise::Roughness => quantile_95(Some(traverses[0].nodes.len().saturating_sub(2))),
    };
    let mut corner_mm = Vector::zeros();
    let mut deviation = Vector::zeros();
    let (mut positions, mut chords, mut direction): (f64, f64, f64) = (0.0, 0.0, 0.0);
    let mut chord_mm = f64::INFINITY;
    for (axis, traverse) in traverses.iter().enumerate() {
        let nodes = &traverse.nodes;
        let (first, last) = (&nodes[0], &nodes[nodes.len() - 1]);
        let end = if origin_mm[axis] - first.commanded_mm > last.commanded_mm - origin_mm[axis] {
            first
        } else {
            last
        };
        let reach = (end.commanded_mm - origin_mm[axis]).abs();
        corner_mm[axis] = end.commanded_mm;
        let mut along = Vector::zeros();
        along[axis] = end.commanded_mm - origin_mm[axis];
        deviation += end.measured_mm - traverse.at(origin_mm[axis]) - along;
        // The end counts against the common origin: two readings.
        positions += 2.0 * end.uncertainty_mm.norm_squared();
        let mut steps: Vec<f64> = nodes.windows(2).map(|w| w[1].commanded_mm - w[0].commanded_mm).collect();
        steps.sort_by(f64::total_cmp);
        let chord = steps[steps.len() / 2];
        chord_mm = chord_mm.min(chord);
        let across: f64 =
            (0..3).filter(|&k| k != axis).map(|k| last.uncertainty_mm[k] * last.uncertainty_mm[k]).sum();
        let angle = (2.0 * across).sqrt() / chord;
        direction = direction.max(angle);
        chords += (angle * reach) * (angle * reach);
    }
    FarCorner {
        corner_mm,
        deviation_mm: deviation.norm(),
        positions_u95_mm: factor * positions.sqrt(),
        chord_u95_mm: factor * chords.sqrt(),
        direction_u95_rad: factor * direction,
        chord_mm,
        coverage_factor: factor,
    }
}

/// The machine that the traverses change the base into.
#[derive(Clone, Debug)]
pub struct TrackerMachine {
    /// The tables of the changed machine.
    pub axes: [ChangedAxis; 3],
    /// The changed machine.
    pub description: Description,
    /// How the instrument stood.
    pub setups: Vec<Option<SetUp>>,
    /// Reversal value of X, Y, Z and the half width of its 95 % interval, mm; `None` where not read from both sides.
    pub play_mm: [Option<(f64, f64)>; 3],
    /// Half width that 95 % of the volume's points keep, mm: equation (51c).
    pub field_u95_mm: f64,
    /// What 95 % of the volume's points deviate by at most, as found, from an ideal machine in the best frame, mm.
    pub field_p95_mm: f64,
    /// Readings minus the changed machine, RMS, mm.
    pub rms_mm: f64,
    /// Readings outside the base's volume, which were left out.
    pub left_out: usize,
}

/// Fits positioning, straightness and play of the three axes to all readings: equation (51) with the nodes of the traverses and
/// without angles, which three lines do not show.
///
/// * `points` – readings of all traverses, one run, from [`crate::PointReading::Position`]
///
/// # Errors
/// [`CalibrationError`]: places outside the base's volume, a mirror image, an outlier, play of the wrong sign.
pub fn machine(
    points: &[Point],
    base: &Base,
    found: &TrackerCalibration,
    frame: Frame,
) -> Result<TrackerMachine, CalibrationError> {
    let kept = known_places(points, base)?;
    let left_out = points.len() - kept.len();
    let points: &[Point] = &kept.iter().map(|k| points[*k]).collect::<Vec<Point>>();
    let turned = frame == Frame::Fitted;
    let still = Plan { nodes_mm: Default::default(), functions: 0, turned };
    mistakes::plausible(points, base, &find(points, base, &still)?)?;
    let read =
        |t: &MeanTraverse, q: f64| points.iter().any(|p| (p.command.linear_mm[t.axis] - q).abs() < 1e-6);
    let nodes = |t: &MeanTraverse| {
        t.nodes.iter().map(|node| node.commanded_mm).filter(|q| read(t, *q)).collect::<Vec<f64>>()
    };
    let plan = Plan { nodes_mm: found.traverses.each_ref().map(nodes), functions: 3, turned };
    let change = find(points, base, &plan)?;
    mistakes::outlier(points, &change).map_err(|error| error.with_points(&kept))?;
    let play_mm = plays(base, &change);
    mistakes::play(&play_mm)?;
    let groups = field_commands(points, &change);
    let (axes, description, setups) = change.changed(base);
    let commands: Vec<_> = groups.iter().flatten().copied().collect();
    Ok(TrackerMachine {
        axes,
        field_u95_mm: change.layout.field_u95_mm(base, &change.estimate, &groups)?,
        field_p95_mm: crate::change::departure_p95_mm(&description, &commands)?,
        description,
        setups,
        play_mm,
        rms_mm: change.estimate.rms(),
        left_out,
    })
}
