//! The whole path, from the words alone: a control is played here that knows nothing but the pieces,
//! and the machine's real path is sampled against the programmed one.

use crate::control;

use control::{ALLOWED_MM, OPTIONS, begin, block, distance, feed, position, tried};
use correction::{CorrectionError, Corrector, Curve, Goal, Options, PieceKind};
use machine_model::{
    AxisTables, Chain, Command, Description, Engine, EngineId, Interpolation, LinearAxis, Move, PathModel,
    Range, RigidBody, RotaryAxis, Solution, SolveError, Squareness, Table, Vector, Volume,
};
use proptest::prelude::*;
use toolpath::{Arc, Cycle, CycleKind, FeedRate, Hole, Motion, Plane, Shape};

/// A smooth crooked machine in closed form, so that its bounds are known exactly: squareness and scale
/// (a matrix) and a wave along each axis that moves all three.
#[derive(Debug, Clone)]
struct Wavy {
    matrix: nalgebra::Matrix3<f64>,
    amplitude_mm: f64,
    wavelength_mm: f64,
}

impl Wavy {
    fn wave(&self, q: f64) -> f64 {
        self.amplitude_mm * units::math::sin(q * std::f64::consts::TAU / self.wavelength_mm)
    }
}

impl Engine for Wavy {
    fn id(&self) -> EngineId {
        EngineId::RigidBody
    }
    fn volume(&self) -> Volume {
        Volume([Range { low: -1000.0, high: 1000.0 }; 3])
    }
    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        let mut q = target.linear_mm;
        for _ in 0..40 {
            q = target.linear_mm - self.error_mm(&Command { linear_mm: q, ..*target });
        }
        for (i, axis) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            if !self.volume().0[i].contains(q[i]) {
                return Err(SolveError::OutsideVolume {
                    axis,
                    value_mm: q[i],
                    low_mm: -1000.0,
                    high_mm: 1000.0,
                });
            }
        }
        Ok(Solution { linear_mm: q, iterations: 40, residual_mm: 0.0 })
    }
    fn path_model(&self) -> Option<&dyn PathModel> {
        Some(self)
    }
}

impl PathModel for Wavy {
    fn error_mm(&self, command: &Command) -> Vector {
        let q = command.linear_mm;
        self.matrix * q + Vector::new(self.wave(q.y), self.wave(q.z), self.wave(q.x))
    }
    fn chord_bound_mm(&self, stretch: &Move) -> f64 {
        let k = std::f64::consts::TAU / self.wavelength_mm;
        let bend = |i: usize| k * k * stretch.speed_mm[i].powi(2) + k * stretch.acceleration_mm[i];
        let wave = self.amplitude_mm * (bend(0).powi(2) + bend(1).powi(2) + bend(2).powi(2)).sqrt();
        let a: Vector = stretch.acceleration_mm.into();
        (wave + self.matrix.abs().row_sum().max() * 3.0 * a.norm()) / 8.0
    }
}

fn worst(model: &dyn PathModel, wanted: &Curve, commanded: &[Curve]) -> f64 {
    let mut worst: f64 = 0.0;
    for curve in commanded {
        for k in 0..=40 {
            let q = curve.at(f64::from(k) / 40.0);
            let command = Command { linear_mm: q, ..Default::default() };
            worst = worst.max(distance(wanted, &(q + model.error_mm(&command))));
        }
    }
    let last = commanded.last().map(|curve| curve.at(1.0));
    if let Some(q) = last {
        let command = Command { linear_mm: q, ..Default::default() };
        worst = worst.max((q + model.error_mm(&command) - wanted.at(1.0)).norm());
    }
    worst
}

/// A machine of one kind or the other.
#[derive(Clone)]
struct Crooked(std::sync::Arc<dyn PathModel>);

impl std::fmt::Debug for Crooked {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.0.id())
    }
}

fn wavy() -> impl Strategy<Value = Crooked> {
    (prop::array::uniform9(-1.2e-3f64..1.2e-3), 0.0f64..0.03, 40.0f64..400.0).prop_map(
        |(m, amplitude_mm, wavelength_mm)| {
            let matrix = nalgebra::Matrix3::from_row_slice(&m);
            Crooked(std::sync::Arc::new(Wavy { matrix, amplitude_mm, wavelength_mm }))
        },
    )
}

/// The rigid-body model with random tables, linear or monotone, random squareness and tool.
fn tabled() -> impl Strategy<Value = Crooked> {
    let values = prop::collection::vec(-1.0f64..1.0, 18 * 41);
    (values, any::<bool>(), prop::array::uniform3(-1e-3f64..1e-3)).prop_map(|(values, monotone, square)| {
        let interpolation = if monotone { Interpolation::Monotone } else { Interpolation::Linear };
        let nodes: Vec<f64> = (-20..=20).map(|k| f64::from(k) * 32.5).collect();
        let linear = [0, 1, 2].map(|axis| {
            let functions = [0, 1, 2, 3, 4, 5].map(|function| {
                let at = (axis * 6 + function) * 41;
                // Up to 8 µm and 25 µrad from node to node: rougher than machines are.
                let scale = if function < 3 { 4e-3 } else { 12e-6 };
                let row = values[at..at + 41].iter().map(|v| v * scale).collect();
                Some(Table::new(nodes.clone(), row, interpolation).expect("a good table"))
            });
            let mut data = LinearAxis::perfect(Range { low: -600.0, high: 600.0 });
            data.errors = AxisTables::new(&functions);
            data
        });
        let description = Description {
            chain: Chain::parse("[w X Y b Z t]").expect("a chain"),
            linear,
            rotary: [0, 1, 2].map(|_| RotaryAxis::perfect(Vector::zeros())),
            squareness: Squareness { ec0y_rad: square[0], eb0z_rad: square[1], ea0z_rad: square[2] },
        };
        Crooked(std::sync::Arc::new(RigidBody::new(description).expect("a machine")))
    })
}

fn machine() -> impl Strategy<Value = Crooked> {
    prop_oneof![wavy(), tabled()]
}

/// Places on the output grid, as programs have them.
fn place() -> impl Strategy<Value = Vector> {
    prop::array::uniform3(-300_000i32..300_000).prop_map(|p| Vector::from(p.map(|v| f64::from(v) * 1e-3)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(192))]

    #[test]
    fn lines_keep_the_promise(model in machine(), places in prop::collection::vec(place(), 2..5), incremental: bool) {
        let model = &*model.0;
        let mut corrector = Corrector::new(model, OPTIONS);
        let mut control = begin(&mut corrector, places[0]);
        for pair in places.windows(2) {
            let ran = feed(&mut corrector, &mut control, pair[0], pair[1], Shape::Line, &block("XYZ", incremental));
            let found = worst(model, &Curve::Line(pair[0], pair[1]), &ran.curves);
            prop_assert!(found <= ALLOWED_MM, "{found} after {:?}", ran.corrected.correction);
            prop_assert!(found <= ran.corrected.correction.after_mm + 1e-9, "proof {} found {found}", ran.corrected.correction.after_mm);
            prop_assert!(ran.corrected.pieces.len() < 400);
        }
    }

    #[test]
    fn arcs_and_helices_keep_the_promise(
        model in machine(), start in place(), angle in -3.1f64..3.1, sweep in -6.25f64..6.25, radius in 0.05f64..150.0,
        rise in -20.0f64..20.0, plane in prop::sample::select(vec![Plane::Xy, Plane::Zx, Plane::Yz]), incremental: bool, full: bool,
    ) {
        let grid = |v: f64| (v * 1e3).round() * 1e-3;
        let [u, v, n] = plane.axes();
        let mut centre = start;
        centre[u] -= grid(radius * units::math::cos(angle));
        centre[v] -= grid(radius * units::math::sin(angle));
        let mut end = start;
        if !full {
            end[u] = grid(centre[u] + radius * units::math::cos(angle + sweep));
            end[v] = grid(centre[v] + radius * units::math::sin(angle + sweep));
            end[n] = grid(start[n] + rise);
        }
        let clockwise = sweep < 0.0;
        let (from, to) = (units::math::atan2(start[v] - centre[v], start[u] - centre[u]), units::math::atan2(end[v] - centre[v], end[u] - centre[u]));
        let mut swept = if full { 0.0 } else { to - from };
        if clockwise { while swept >= 0.0 { swept -= std::f64::consts::TAU } } else { while swept <= 0.0 { swept += std::f64::consts::TAU } }
        prop_assume!((centre - start).norm() > 0.01);
        let shape = Shape::Arc(Arc { plane, centre_mm: [centre[u], centre[v]], sweep_rad: swept });
        let model = &*model.0;
        let mut corrector = Corrector::new(model, OPTIONS);
        let mut control = begin(&mut corrector, start);
        let text = format!("XYZ{}{}", plane.centre_letters()[0] as char, plane.centre_letters()[1] as char);
        let ran = feed(&mut corrector, &mut control, start, end, shape, &block(&text, incremental));
        let wanted = Curve::new(start, end, &shape);
        let found = worst(model, &wanted, &ran.curves);
        prop_assert!(found <= ALLOWED_MM, "{found} after {:?}", ran.corrected.correction);
        prop_assert!(found <= ran.corrected.correction.after_mm + 1e-7, "proof {} found {found}", ran.corrected.correction.after_mm);
    }

    #[test]
    fn no_piece_is_shorter_than_the_profile_allows(
        model in wavy(), start in place(), end in place(), minimum_segment_mm in 2.0f64..60.0,
    ) {
        let model = &*model.0;
        let mut corrector = Corrector::new(model, Options { minimum_segment_mm, ..OPTIONS });
        let mut control = begin(&mut corrector, start);
        match tried(&mut corrector, &mut control, start, end, Shape::Line, &block("XYZ", false)) {
            // What the limit makes impossible is refused, never left beyond the tolerance.
            Err(error) => prop_assert!(matches!(error, CorrectionError::NotWithinTolerance { .. }), "{error}"),
            Ok(ran) => {
                prop_assert!(worst(model, &Curve::Line(start, end), &ran.curves) <= ALLOWED_MM);
                let shortest = ran.curves.iter().map(Curve::length_mm).fold(f64::INFINITY, f64::min);
                // The real machine's commands are longer or shorter than the program's by its errors and rounding.
                let least = 0.99 * minimum_segment_mm.min((end - start).norm()) - 2e-3;
                prop_assert!(shortest >= least, "{shortest} of {}", ran.curves.len());
            }
        }
    }

    #[test]
    fn a_perfect_machine_changes_nothing(start in place(), end in place(), incremental: bool) {
        let model = Wavy { matrix: nalgebra::Matrix3::zeros(), amplitude_mm: 0.0, wavelength_mm: 1.0 };
        let mut corrector = Corrector::new(&model, OPTIONS);
        let mut control = begin(&mut corrector, start);
        let ran = feed(&mut corrector, &mut control, start, end, Shape::Line, &block("XYZ", incremental));
        prop_assert!(ran.corrected.pieces.is_empty());
    }
}

/// Three hundred thousand increments of a tenth: the output stands where the sum stands.
#[test]
fn incremental_moves_do_not_drift() {
    let model = Wavy {
        matrix: nalgebra::Matrix3::from_diagonal_element(3.3e-4),
        amplitude_mm: 0.004,
        wavelength_mm: 90.0,
    };
    let mut corrector = Corrector::new(&model, OPTIONS);
    let start = Vector::new(-250.0, 1.0, 2.0);
    let mut control = begin(&mut corrector, start);
    let block = block("X", true);
    let mut at = start;
    for _ in 0..3000 {
        let mut next = at;
        next.x += 0.1;
        feed(&mut corrector, &mut control, at, next, Shape::Line, &block);
        at = next;
    }
    let q = control.at;
    let command = Command { linear_mm: q, ..Default::default() };
    assert!((q + model.error_mm(&command) - at).norm() < 8.7e-4, "{}", q + model.error_mm(&command) - at);
}

/// Squareness of 1.1 mrad turns a circle of 50 mm into an ellipse 27 µm off: a few arcs hold it.
#[test]
fn a_full_circle_becomes_a_few_arcs() {
    let mut matrix = nalgebra::Matrix3::zeros();
    matrix[(0, 1)] = -1.1e-3;
    let model = Wavy { matrix, amplitude_mm: 0.0, wavelength_mm: 1.0 };
    let mut corrector = Corrector::new(&model, OPTIONS);
    let start = Vector::new(50.0, 0.0, 0.0);
    let mut control = begin(&mut corrector, start);
    let shape =
        Shape::Arc(Arc { plane: Plane::Xy, centre_mm: [0.0, 0.0], sweep_rad: -std::f64::consts::TAU });
    let ran = feed(&mut corrector, &mut control, start, start, shape, &block("I", false));
    assert!(ran.corrected.pieces.iter().all(|piece| matches!(piece.kind, PieceKind::Arc { .. })));
    assert!((4..=16).contains(&ran.curves.len()), "{}", ran.curves.len());
    assert!(worst(&model, &Curve::new(start, start, &shape), &ran.curves) <= ALLOWED_MM);
}

/// A shift alone keeps the circle one block.
#[test]
fn a_shifted_circle_stays_one_arc() {
    struct Shifted;
    impl Engine for Shifted {
        fn id(&self) -> EngineId {
            EngineId::RigidBody
        }
        fn volume(&self) -> Volume {
            Volume([Range { low: -500.0, high: 500.0 }; 3])
        }
        fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
            Ok(Solution {
                linear_mm: target.linear_mm - Vector::new(0.1, 0.2, 0.3),
                iterations: 1,
                residual_mm: 0.0,
            })
        }
        fn path_model(&self) -> Option<&dyn PathModel> {
            Some(self)
        }
    }
    impl PathModel for Shifted {
        fn error_mm(&self, _: &Command) -> Vector {
            Vector::new(0.1, 0.2, 0.3)
        }
        fn chord_bound_mm(&self, _: &Move) -> f64 {
            0.0
        }
    }
    let model = Shifted;
    let mut corrector = Corrector::new(&model, OPTIONS);
    let start = Vector::new(50.0, 0.0, 0.0);
    let mut control = begin(&mut corrector, start);
    let shape = Shape::Arc(Arc { plane: Plane::Xy, centre_mm: [0.0, 0.0], sweep_rad: std::f64::consts::TAU });
    let ran = feed(&mut corrector, &mut control, start, start, shape, &block("I", false));
    assert!(ran.corrected.pieces.is_empty(), "{:?}", ran.corrected.pieces);
}

fn hole(kind: CycleKind, start: Vector, at_r: Vector, bottom_mm: f64) -> Motion {
    Motion::Hole(Hole {
        plane: Plane::Xy,
        start: position(start),
        at_r: position(at_r),
        bottom_mm,
        first: true,
        began_mm: start.z,
        initial_mm: start.z,
        cycle: Cycle { kind, peck_mm: Some(3.0), dwell: None, return_to_initial: true },
        rate: FeedRate::PerMinute,
    })
}

/// A lean of 0.5 mrad over 20 mm is 10 µm: a drilling cycle becomes moves, a tapping cycle stays and says so.
#[test]
fn a_leaning_hole_is_written_as_moves_where_it_can_be() {
    let mut matrix = nalgebra::Matrix3::zeros();
    matrix[(0, 2)] = 5e-4;
    let model = Wavy { matrix, amplitude_mm: 0.0, wavelength_mm: 1.0 };
    let (start, top) = (Vector::new(0.0, 0.0, 30.0), Vector::new(40.0, 10.0, 2.0));
    let moves =
        [CycleKind::Drill, CycleKind::Bore, CycleKind::BoreOut, CycleKind::PeckFull, CycleKind::PeckChip];
    for kind in moves {
        let mut corrector = Corrector::new(&model, OPTIONS);
        begin(&mut corrector, start);
        let corrected = corrector.correct(&hole(kind, start, top, -18.0), &block("XYZRQ", false)).unwrap();
        assert!(corrected.pieces.len() >= 4 && corrected.correction.leaning_mm.is_none(), "{kind:?}");
        assert!(corrected.correction.after_mm <= ALLOWED_MM);
    }
    let mut corrector = Corrector::new(&model, OPTIONS);
    begin(&mut corrector, start);
    let corrected =
        corrector.correct(&hole(CycleKind::Synchronised, start, top, -18.0), &block("XYZR", false)).unwrap();
    assert_eq!(corrected.pieces.len(), 1);
    let lean = corrected.correction.leaning_mm.unwrap();
    assert!((4.5e-3..=6.0e-3).contains(&lean), "half of 10 µm either way and rounding: {lean}");
}

/// After a hole under G99 the next one under G98: written as moves, its way across lies no lower than the level
/// it returns to.
#[test]
fn a_hole_under_g98_goes_across_at_the_initial_level() {
    let mut matrix = nalgebra::Matrix3::zeros();
    matrix[(0, 2)] = 5e-4;
    let model = Wavy { matrix, amplitude_mm: 0.0, wavelength_mm: 1.0 };
    let (at_r, top) = (Vector::new(0.0, 0.0, 2.0), Vector::new(40.0, 10.0, 2.0));
    let mut corrector = Corrector::new(&model, OPTIONS);
    begin(&mut corrector, at_r);
    let Motion::Hole(mut drilled) = hole(CycleKind::Drill, at_r, top, -18.0) else { unreachable!() };
    drilled.initial_mm = 30.0;
    let corrected = corrector.correct(&Motion::Hole(drilled), &block("XYZRQ", false)).unwrap();
    let [first, second, ..] = corrected.pieces.as_slice() else { panic!("{:?}", corrected.pieces) };
    assert_eq!((first.kind, second.kind), (PieceKind::Rapid, PieceKind::Rapid));
    // 30 mm in a frame shifted by 5.5.
    assert_eq!(first.axes[2], Goal::Steps(24_500), "up first: {first:?}");
    assert!(matches!(second.axes, [Goal::Steps(_), _, Goal::Stays]), "across: {second:?}");
}

/// An upright machine keeps the cycle and moves it.
#[test]
fn an_upright_hole_stays_a_cycle() {
    let mut matrix = nalgebra::Matrix3::zeros();
    matrix[(0, 0)] = 1e-3;
    let model = Wavy { matrix, amplitude_mm: 0.0, wavelength_mm: 1.0 };
    let (start, top) = (Vector::new(0.0, 0.0, 30.0), Vector::new(40.0, 10.0, 2.0));
    let mut corrector = Corrector::new(&model, OPTIONS);
    begin(&mut corrector, start);
    let corrected =
        corrector.correct(&hole(CycleKind::PeckFull, start, top, -18.0), &block("XYZRQ", false)).unwrap();
    let [piece] = corrected.pieces.as_slice() else { panic!("{:?}", corrected.pieces) };
    assert!(matches!(piece.kind, PieceKind::Cycle { r: Goal::AsStated }));
    // 40 mm in a frame shifted by 10: 30 programmed, 40/1.001 - 10 needed.
    assert_eq!(piece.axes, [Goal::Steps(29_960), Goal::AsStated, Goal::AsStated]);
}

/// A full turn of a helix on a machine that leans ends micrometres beside its start. One block would leave it
/// to the last digit whether the control makes a turn or none (found by random programs against LinuxCNC).
#[test]
fn a_full_turn_whose_ends_no_longer_meet_is_cut() {
    let mut matrix = nalgebra::Matrix3::zeros();
    for (sx, sy) in [(4e-4, 4e-4), (-4e-4, 4e-4), (4e-4, -4e-4), (-4e-4, -4e-4)] {
        matrix[(0, 2)] = sx;
        matrix[(1, 2)] = sy;
        let model = Wavy { matrix, amplitude_mm: 0.0, wavelength_mm: 1.0 };
        for turn in [std::f64::consts::TAU, -std::f64::consts::TAU] {
            let mut corrector = Corrector::new(&model, OPTIONS);
            let (start, mut end) = (Vector::new(1.2, -0.1, 0.0), Vector::new(1.2, -0.1, 0.0));
            end.z = -5.0;
            let mut control = begin(&mut corrector, start);
            let shape = Shape::Arc(Arc { plane: Plane::Xy, centre_mm: [0.0, 0.0], sweep_rad: turn });
            let ran = feed(&mut corrector, &mut control, start, end, shape, &block("ZIJ", false));
            assert!(ran.corrected.pieces.len() >= 2, "{:?}", ran.corrected.pieces);
            let swept: f64 = ran
                .curves
                .iter()
                .map(|curve| match curve {
                    Curve::Arc { sweep, .. } => *sweep,
                    Curve::Line(..) | Curve::Turn { .. } => 0.0,
                })
                .sum();
            assert!((swept - turn).abs() < 0.02, "{swept}");
            assert!(worst(&model, &Curve::new(start, end, &shape), &ran.curves) <= ALLOWED_MM);
        }
    }
}
