//! The steps that every block goes through, one by one: `cargo bench -p xtask`. Whole programs: `xtask bench`.

use std::hint::black_box;
use std::path::Path;

use correction::{Block as Info, Corrector, Options, Outside, Stated};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use machine_model::{Command, EngineId};
use nc_program::{Interpreter, Setup};
use nc_syntax::{Block, PlainLine, Reader};
use toolpath::{Division, Feed, FeedRate, Motion, Position, Shape};
use units::decimal::{Spelling, write};

const POINTS: usize = 4096;

/// Points of a spiral on a bowl, 0.4 mm apart, in the calibrated volume of the STAN S500.
fn points() -> Vec<[f64; 3]> {
    let mut turned = 0.0;
    (0..POINTS)
        .map(|k| {
            let radius = 5.0 + k as f64 * 0.01;
            turned += 0.4 / radius;
            let (sin, cos) = units::math::sin_cos(turned);
            [200.0 + radius * cos, 140.0 + radius * sin, 90.0 + radius * radius * 0.02]
        })
        .collect()
}

fn blocks(points: &[[f64; 3]]) -> String {
    let line = |p: &[f64; 3]| format!("X{:.3} Y{:.3} Z{:.3}\n", p[0], p[1], p[2]);
    points.iter().fold("G21 G90 G54\nG0 X0. Y0. Z0.\nG1 F1000.\n".to_owned(), |text, p| text + &line(p))
}

fn hot_path(c: &mut Criterion) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machine-profiles");
    let text = std::fs::read_to_string(folder.join("stan_s500.toml")).expect("a shipped profile");
    let read = |table: &str| std::fs::read(folder.join(table));
    let profile = machine_profile::load(&text, &read).expect("a shipped profile");
    let engine = profile.engine(EngineId::RigidBody, &Default::default()).expect("rigid-body");
    let model = engine.path_model().expect("rigid-body corrects paths");
    let dialect = nc_dialect::builtin("fanuc").expect("a shipped dialect");
    let setup = Setup { work_offsets: vec![("G54".to_owned(), [0.0; 3])], ..Setup::default() };

    let points = points();
    let program = blocks(&points);
    let mut group = c.benchmark_group("block");
    group.throughput(Throughput::Elements(POINTS as u64));
    group.bench_function("lexing", |b| {
        b.iter(|| {
            let mut reader = Reader::new(program.as_bytes(), dialect);
            let mut block = Block::default();
            while reader.next(&mut block) {
                black_box(&block);
            }
        });
    });
    group.bench_function("lexing and modal step", |b| {
        b.iter(|| {
            let mut interpreter = Interpreter::new(dialect, &setup);
            let mut reader = Reader::new(program.as_bytes(), dialect);
            let (mut block, mut line) = (Block::default(), PlainLine::default());
            loop {
                while let Some((feeds, start)) = interpreter.plain_feeds()
                    && reader.plain_line(&mut line)
                {
                    let end = feeds.end_of(&line, start).expect("coordinates");
                    interpreter.go_to(black_box(&end), end.feed);
                }
                if !reader.next(&mut block) {
                    break;
                }
                black_box(interpreter.step(&block).expect("a program"));
            }
        });
    });
    let options = Options {
        tolerance_mm: 1e-3,
        accept_mm: 5e-3,
        outside: Outside::Refuse,
        minimum_segment_mm: 0.0,
        orientation_rad: 5e-5,
        orientation: correction::Orientation::Tip,
    };
    let info = Info { stated: Stated { axes: [true; 3], ..Stated::default() }, ..Info::default() };
    let at = |linear_mm: [f64; 3]| Position { linear_mm, rotary_deg: [0.0; 3] };
    let feeds: Vec<Motion> = points
        .windows(2)
        .map(|ends| Feed {
            start: at(ends[0]),
            end: at(ends[1]),
            shape: Shape::Line,
            rate: FeedRate::PerMinute,
            division: Division::Any,
        })
        .map(Motion::Feed)
        .collect();
    group.bench_function("inverse, rounding and proof", |b| {
        b.iter(|| {
            let mut corrector = Corrector::new(model, options);
            for feed in &feeds {
                black_box(corrector.correct(feed, &info).expect("inside the volume"));
            }
        });
    });
    group.bench_function("printing three coordinates", |b| {
        let mut out = Vec::with_capacity(64);
        b.iter(|| {
            for point in &points {
                out.clear();
                for value in point {
                    write(&mut out, (value * 1000.0) as i64, 3, black_box(Spelling::FIXED));
                }
                black_box(&out);
            }
        });
    });
    group.finish();

    let commands: Vec<Command> =
        points.iter().map(|point| Command { linear_mm: (*point).into(), ..Default::default() }).collect();
    let everywhere = model.everywhere(&commands[0]).expect("three linear axes");
    let mut group = c.benchmark_group("point");
    group.throughput(Throughput::Elements(POINTS as u64));
    group.bench_function("forward", |b| {
        b.iter(|| commands.iter().for_each(|command| _ = black_box(model.error_mm(command))));
    });
    group.bench_function("inverse", |b| {
        b.iter(|| commands.iter().for_each(|command| _ = black_box(model.command_for(command, &everywhere))));
    });
    group.finish();
}

criterion_group!(benches, hot_path);
criterion_main!(benches);
