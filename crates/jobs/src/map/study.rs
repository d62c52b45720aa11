//! The map and everything that is found in it.

use super::evaluated;
use diagnostic::{Speaks, Text, both, notice};
use error_map::diagonals::{Diagonal, body_diagonals};
use error_map::placement::{self, Freedom, Place};
use error_map::zero_point::{best_node, best_share, geometric_median, smallest_ball};
use error_map::{Block, ErrorMap, Grid, Nodes, Plane, Statistics};
use machine_model::{EngineId, PathModel, Range, Vector};
use machine_profile::Profile;
use rayon::prelude::*;

use super::asked::Asked;
use super::curves::{Curve, curves};
use super::deformation::{self, Deformation};
use super::second_order::{self, SecondOrder};
use crate::message::{Failure, OPTION};

/// Targets along each body diagonal.
const TARGETS: u32 = 41;
/// Samples of a workpiece along each axis.
const PART_NODES: u64 = 11;

/// What the map shows.
pub struct Study {
    /// Its name.
    pub machine: String,
    /// By which model.
    pub engine: EngineId,
    /// What was asked.
    pub asked: Asked,
    /// Output step of each axis.
    pub resolution_mm: [f64; 3],
    /// Of the profile.
    pub work_offsets: Vec<WorkOffset>,
    /// The error of every node.
    pub map: ErrorMap,
    /// The volume first, then regions, planes, the workpiece.
    pub parts: Vec<Part>,
    /// Of the volume (ISO 230-6).
    pub diagonals: Vec<Diagonal>,
    /// Where a workpiece errs least, by what its set-up can do.
    pub places: Vec<(Freedom, Place)>,
    /// What products of errors do.
    pub second_order: Option<SecondOrder>,
    /// Errors along each axis through the middle.
    pub curves: Vec<Curve>,
    /// Of each cell of the grid, where the model is a field.
    pub cells: Vec<Deformation>,
}

/// A work offset of the profile.
pub struct WorkOffset {
    /// `G54`
    pub name: String,
    /// Machine coordinates.
    pub zero_mm: Vector,
    /// What is in it of the machine's error already; `None` where it is true.
    pub touched_mm: Option<Vector>,
}

impl WorkOffset {
    /// What to enter for it, mm, where errors are to count from the zero point.
    pub fn to_enter_mm(&self, zero: &ZeroPoint, study: &Study) -> Vector {
        self.zero_mm + study.rounded(&(self.touched_mm.unwrap_or_default() - zero.shift_mm))
    }

    /// How it was found.
    pub fn how(&self) -> Text {
        match self.touched_mm {
            None => Text::pair("true", "точное"),
            Some(_) => Text::pair("touched", "найдено касанием"),
        }
    }
}

/// A part of the volume, its figures and its zero points.
pub struct Part {
    /// As people call it.
    pub name: Text,
    /// Where its nodes are.
    pub box_mm: [Range; 3],
    /// As it is.
    pub figures: Statistics,
    /// All four answers.
    pub zero_points: Vec<ZeroPoint>,
}

/// One answer to "where to put the zero point".
pub struct ZeroPoint {
    /// What it is best in.
    pub kind: Kind,
    /// The error that is taken away, mm.
    pub shift_mm: Vector,
    /// What is left with it.
    pub figures: Statistics,
    /// How good it is.
    pub proof: Proof,
}

/// The questions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A node from which all others are nearest.
    Node,
    /// Least sum of what is left.
    Median,
    /// Least largest of what is left.
    Minimax,
    /// Most nodes within the tolerance.
    Share,
}

/// How good the answer is.
#[expect(missing_docs, reason = "each case says its numbers")]
pub enum Proof {
    /// The node's place; sums computed of all nodes.
    Node { place_mm: Vector, sum_mm: f64, examined: usize },
    /// The sum, and what no shift is below.
    Sum { sum_mm: f64, lower_bound_mm: f64 },
    /// The ball's radius, and how many errors hold it.
    Radius { radius_mm: f64, support: usize },
    /// Nodes within, and what no shift exceeds.
    Count { within: usize, at_most: usize },
}

impl Kind {
    /// In words.
    pub fn name(self) -> Text {
        match self {
            Self::Node => Text::pair("best node", "лучший узел"),
            Self::Median => Text::pair("geometric median", "геом. медиана"),
            Self::Minimax => Text::pair("minimax", "минимакс"),
            Self::Share => Text::pair("best share", "лучшая доля"),
        }
    }
}

impl Study {
    /// The map, and what is found in it.
    ///
    /// # Errors
    /// A region without nodes, a workpiece that fits nowhere, rotary axes under `second_order`.
    pub fn new(
        profile: &Profile,
        engine: EngineId,
        model: &dyn PathModel,
        work_offsets: Vec<WorkOffset>,
        asked: Asked,
    ) -> Result<Self, Failure> {
        let error = |q: &Vector, direction: [i8; 3]| model.error_mm(&asked.command(*q, direction));
        let map = evaluated(asked.grid.clone(), |q| error(q, [0; 3]));
        let parts = parts(&map, &asked, |q| error(q, [0; 3]))?;
        let box_mm = map.grid().axes().each_ref().map(Nodes::range_mm);
        let mut places = Vec::new();
        if let Some(size) = &asked.clamp_mm {
            for freedom in [Freedom::Shift, Freedom::ShiftAndTurn, Freedom::Rigid] {
                let found =
                    placement::search(&model.volume(), size, freedom, asked.within_mm, |q| error(q, [0; 3]));
                places.push((
                    freedom,
                    found.map_err(|too_large| {
                        let too_large = too_large.text();
                        Failure::usage(notice!(OPTION;
                            "`--clamp`: {too_large}", "`--clamp`: {too_large:#}";
                            "give the size of a box that fits, X,Y,Z in mm",
                            "дайте габарит, который помещается: X,Y,Z в мм"
                        ))
                    })?,
                ));
            }
        }
        Ok(Self {
            machine: profile.name.clone(),
            engine,
            resolution_mm: profile.resolution_mm,
            work_offsets,
            parts,
            diagonals: body_diagonals(&box_mm, TARGETS, error),
            places,
            second_order: asked.second_order.then(|| second_order::of(profile, &map, &asked)).transpose()?,
            curves: curves(&map, model, &asked),
            cells: deformation::cells(&map, model, &asked),
            map,
            asked,
        })
    }
}

fn parts(
    map: &ErrorMap,
    asked: &Asked,
    error_mm: impl Fn(&Vector) -> Vector + Sync,
) -> Result<Vec<Part>, Failure> {
    let grid = map.grid();
    let mut blocks = vec![(Text::pair("volume", "объём"), grid.all())];
    for (name, ranges) in &asked.regions {
        let block = grid.region(ranges);
        if block.is_empty() {
            return Err(Failure::usage(notice!(OPTION;
                "`--region {name}`: no node of the grid lies in it",
                "`--region {name}`: в ней нет ни одного узла сетки";
                "make it larger, or the grid finer with `--grid`",
                "увеличьте её или сделайте сетку мельче ключом `--grid`"
            )));
        }
        blocks.push((Text::same(name.as_str()), block));
    }
    for (plane, at) in &asked.planes {
        let places = grid.axes()[plane.normal()].places_mm();
        let wanted = at.map_or_else(|| places.to_vec(), |at| vec![at]);
        blocks.extend(wanted.into_iter().map(|at| layer(grid, *plane, at)));
    }
    let mut parts: Vec<Part> =
        blocks.into_par_iter().map(|(name, block)| part(name, map, &block, asked.within_mm)).collect();
    if let Some(ranges) = &asked.part_box_mm {
        let nodes = ranges.map(|range| {
            let count = if range.low < range.high { PART_NODES } else { 1 };
            Nodes::over(range, count).expect("a range in order")
        });
        let own = evaluated(Grid::new(nodes).expect("few nodes"), error_mm);
        parts.push(part(Text::pair("part box", "деталь"), &own, &own.grid().all(), asked.within_mm));
    }
    Ok(parts)
}

fn layer(grid: &Grid, plane: Plane, at_mm: f64) -> (Text, Block) {
    let block = grid.layer(plane, at_mm);
    let axis = plane.normal();
    let place = grid.axes()[axis].places_mm()[block.ranges()[axis].start];
    let (plane, axis) = (plane.name(), ['X', 'Y', 'Z'][axis]);
    (both!("{plane} at {axis} {place}", "{plane} при {axis} {place}"), block)
}

fn part(name: Text, map: &ErrorMap, block: &Block, within_mm: f64) -> Part {
    let errors = map.errors_of(block);
    let some = "a part has nodes: empty ones were refused";
    let answer = |kind: Kind, shift_mm: Vector, proof: Proof| ZeroPoint {
        kind,
        shift_mm,
        figures: Statistics::shifted(&errors, &shift_mm, within_mm).expect(some),
        proof,
    };
    let node = best_node(&errors).expect(some);
    let place_mm = map.grid().place_mm(block.indices(map.grid()).nth(node.index).expect(some));
    let median = geometric_median(&errors).expect(some);
    let ball = smallest_ball(&errors).expect(some);
    let share = best_share(&errors, within_mm).expect(some);
    let zero_points = vec![
        answer(
            Kind::Node,
            node.shift_mm,
            Proof::Node { place_mm, sum_mm: node.sum_mm, examined: node.examined },
        ),
        answer(
            Kind::Median,
            median.shift_mm,
            Proof::Sum { sum_mm: median.sum_mm, lower_bound_mm: median.lower_bound_mm },
        ),
        answer(
            Kind::Minimax,
            ball.centre_mm,
            Proof::Radius { radius_mm: ball.radius_mm, support: ball.support.len() },
        ),
        answer(Kind::Share, share.shift_mm, Proof::Count { within: share.within, at_most: share.at_most }),
    ];
    let box_mm = [0, 1, 2].map(|axis| {
        let places = &map.grid().axes()[axis].places_mm()[block.ranges()[axis].clone()];
        Range { low: places[0], high: places[places.len() - 1] }
    });
    Part { name, box_mm, figures: Statistics::of(&errors, within_mm).expect(some), zero_points }
}

impl ZeroPoint {
    /// What to add to a work offset: minus the error, in whole output steps. Equation (41).
    pub fn to_enter_mm(&self, study: &Study) -> Vector {
        study.rounded(&-self.shift_mm)
    }
}

impl Part {
    /// The answer that most work wants.
    pub fn median(&self) -> &ZeroPoint {
        self.zero_points
            .iter()
            .find(|zero| zero.kind == Kind::Median)
            .expect("every part has all four answers")
    }
}

impl Study {
    /// In whole output steps.
    pub fn rounded(&self, mm: &Vector) -> Vector {
        // A negative zero would be printed as one.
        Vector::from_fn(|axis, _| {
            (mm[axis] / self.resolution_mm[axis]).round() * self.resolution_mm[axis] + 0.0
        })
    }

    /// Decimals that show the finest output step.
    pub fn decimals(&self) -> usize {
        let finest = self.resolution_mm.iter().copied().fold(f64::INFINITY, f64::min);
        (3..6).find(|d| finest * 10f64.powi(*d) >= 1.0 - 1e-9).map_or(6, |d| d as usize)
    }
}

/// What the set-up can do, in words.
pub fn freedom_name(freedom: Freedom) -> Text {
    match freedom {
        Freedom::Shift => Text::pair("shift the zero point", "сдвинуть нулевую точку"),
        Freedom::ShiftAndTurn => Text::pair("shift, and turn about Z", "сдвинуть и повернуть вокруг Z"),
        Freedom::Rigid => Text::pair("shift, and turn about X, Y and Z", "сдвинуть и повернуть вокруг XYZ"),
    }
}
