//! The short way to correct a short line says what the long way says, word for word and figure for figure.

use correction::{Block, Corrector, Goal, Options, Outside, Run, Stated};
use machine_model::{
    AxisTables, Chain, Command, Description, Engine, EngineId, Everywhere, Interpolation, LANES, LinearAxis,
    Move, PathModel, Range, RigidBody, RotaryAxis, Solution, SolveError, Squareness, Table, Vector, Volume,
};
use proptest::prelude::*;
use toolpath::{Division, Feed, FeedRate, Frame, Motion, Partial, Position, Shape};

/// A model of which nothing is known everywhere: the short way is never taken.
struct Bare(RigidBody);

impl Engine for Bare {
    fn id(&self) -> EngineId {
        self.0.id()
    }
    fn volume(&self) -> Volume {
        self.0.volume()
    }
    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        self.0.solve(target)
    }
}

impl PathModel for Bare {
    fn error_mm(&self, command: &Command) -> Vector {
        self.0.error_mm(command)
    }
    fn chord_bound_mm(&self, stretch: &Move) -> f64 {
        self.0.chord_bound_mm(stretch)
    }
    fn everywhere(&self, _state: &Command) -> Option<Everywhere> {
        None
    }
    fn depends_on_direction(&self) -> bool {
        self.0.depends_on_direction()
    }
    fn reversal_mm(&self, axis: usize, command: &Command) -> f64 {
        self.0.reversal_mm(axis, command)
    }
}

fn machine(values: &[f64], backlash_mm: f64, interpolation: Interpolation) -> RigidBody {
    let mut values = values.iter().copied().cycle();
    let mut linear = [0, 1, 2].map(|_| LinearAxis::perfect(Range { low: 0.0, high: 120.0 }));
    for axis in &mut linear {
        let functions: [Option<Table>; 6] = std::array::from_fn(|i| {
            let size = if i < 3 { 0.004 } else { 2e-5 };
            let nodes = [0.0, 27.0, 63.0, 90.0, 120.0];
            let values = nodes.iter().map(|_| values.next().unwrap_or(0.0) * size).collect();
            Some(Table::new(nodes.to_vec(), values, interpolation).expect("a table"))
        });
        axis.errors = AxisTables::new(&functions);
        axis.backlash_mm = backlash_mm;
    }
    RigidBody::new(Description {
        chain: Chain::parse("[w X Y b Z t]").expect("a chain"),
        linear,
        rotary: std::array::from_fn(|_| RotaryAxis::perfect(Vector::zeros())),
        squareness: Squareness { ec0y_rad: 8e-4, eb0z_rad: -3e-4, ea0z_rad: 5e-4 },
    })
    .expect("a machine")
}

fn block() -> Block {
    Block {
        frame: Frame::shift([60.0, 60.0, 60.0]),
        stated: Stated { axes: [true; 3], ..Stated::default() },
        tool_mm: [1.0, -2.0, -40.0],
        ..Block::default()
    }
}

/// One step of a program: how far along X, Y, Z in output steps, and which axes are named though they stand.
type Way = ([i32; 3], u8);

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn the_short_way_says_what_the_long_way_says(
        values in proptest::collection::vec(-1.0f64..1.0, 90),
        ways in proptest::collection::vec((prop::array::uniform3(-900i32..900), 0u8..8), 1..60),
        play in prop_oneof![Just(0.0), Just(0.006)],
        monotone: bool,
        one_way: bool,
        incremental: bool,
        own_axes: bool,
    ) {
        let ways: Vec<Way> = ways;
        let interpolation = if monotone { Interpolation::Monotone } else { Interpolation::Linear };
        let model = machine(&values, play, interpolation);
        let bare = Bare(model.clone());
        let options = Options { tolerance_mm: 1e-3, accept_mm: 0.0, outside: Outside::Refuse, minimum_segment_mm: 0.0, orientation_rad: 5e-5, orientation: correction::Orientation::Tip };
        let (mut short, mut long) = (Corrector::new(&model, options), Corrector::new(&bare, options));
        let mut block = block();
        let at = |steps: [i32; 3]| Position {
            linear_mm: steps.map(|step| f64::from(step) / 1000.0 + 60.0),
            rotary_deg: [0.0; 3],
        };
        let unknown = Partial::default();
        let rapid = Motion::Rapid { start: unknown, end: at([0; 3]).into() };
        prop_assert_eq!(short.correct(&rapid, &block).unwrap().pieces, long.correct(&rapid, &block).unwrap().pieces);
        if incremental {
            block.incremental = [true; 3];
        }
        // Where each line leads, and which axes it names: those that move at least.
        let (mut steps, mut lines) = ([0; 3], Vec::new());
        for (way, named) in ways {
            let from = steps;
            for i in 0..3 {
                let moves = !own_axes || (named | 1) >> i & 1 == 1;
                steps[i] += if !moves { 0 } else if one_way { way[i].abs() } else { way[i] };
                steps[i] = steps[i].clamp(-50_000, 50_000);
            }
            lines.push((from, steps, [0, 1, 2].map(|i| steps[i] != from[i] || (named | 1) >> i & 1 == 1)));
        }
        let (mut taken, mut next) = (0, 0);
        while next < lines.len() {
            // As many as there are lanes, at once; what is not taken goes the long way.
            let group = &lines[next..lines.len().min(next + LANES)];
            let ends_mm = std::array::from_fn(|k| at(group[k.min(group.len() - 1)].1).linear_mm);
            let mut names = [[false; 3]; LANES];
            names.iter_mut().zip(group).for_each(|(names, line)| *names = line.2);
            let run = Run { start_mm: at(group[0].0).linear_mm, ends_mm: &ends_mm, names, count: group.len() };
            let alone = short.clone();
            let found = short.short_lines(&block, [0.0; 3]);
            // Not before each axis has moved, where it has play.
            prop_assert!(found.is_some() || play > 0.0);
            let found = found.and_then(|found| short.short_run(&found, &block, &run));
            let count = found.as_ref().map_or(0, |found| found.count);
            prop_assert!(count <= group.len());
            let mut alone = if count > 0 { alone } else { short.clone() };
            for (lane, (from, to, names)) in group[..count.max(1)].iter().enumerate() {
                block.stated.axes = *names;
                let feed = Feed {
                    start: at(*from),
                    end: at(*to),
                    shape: Shape::Line,
                    rate: FeedRate::PerMinute,
                    division: Division::Any,
                };
                let (a, b) = (alone.correct(&Motion::Feed(feed), &block).unwrap(), long.correct(&Motion::Feed(feed), &block).unwrap());
                prop_assert_eq!(&a.pieces, &b.pieces);
                prop_assert!((a.correction.largest_mm - b.correction.largest_mm).abs() < 1e-9);
                prop_assert_eq!(a.correction.approach, b.correction.approach);
                prop_assert_eq!(a.correction.unknown_side_mm, b.correction.unknown_side_mm);
                // Bounds that were looked up are no less than those of the stretch.
                let pairs = [(a.correction.before_mm, b.correction.before_mm), (a.correction.after_mm, b.correction.after_mm)];
                prop_assert!(pairs.iter().all(|(rough, own)| rough >= &(own - 1e-9)), "{:?}", pairs);
                let Some(found) = found.as_ref().filter(|found| lane < found.count) else { continue };
                let words = b.pieces.first().map_or([Goal::Stays; 3], |piece| piece.axes);
                let counts = words.map(|word| if let Goal::Steps(counts) = word { Some(counts) } else { None });
                prop_assert_eq!(counts, found.counts[lane]);
                let own = short.correction_of(found, lane);
                prop_assert_eq!(own, a.correction);
                let pairs = [(own.largest_mm, found.worst.largest_mm), (own.before_mm, found.worst.before_mm), (own.after_mm, found.worst.after_mm)];
                prop_assert!(pairs.iter().all(|(own, worst)| own <= worst), "{:?}", pairs);
            }
            if count > 0 {
                prop_assert!(alone.continues_as(&short));
            }
            (short, taken, next) = (alone, taken + count, next + count.max(1));
        }
        // Else this test would say nothing.
        prop_assert!(taken * 10 >= lines.len() * 9 || play > 0.0, "{} of {}", taken, lines.len());
    }
}
