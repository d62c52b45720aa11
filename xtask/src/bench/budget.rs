//! Where the time of one block goes: the work is done in ever longer parts, and the differences are the parts.

use std::hint::black_box;

use correction::{Corrector, Options};
use machine_model::{Command, Move, PathModel, Range, Vector};
use nc_program::Interpreter;
use nc_syntax::{Block, Dialect, Reader};
use vpost::correct::{Job, correct};

use super::measure::own_cpu_s;

/// Nanoseconds per block of each part.
pub(crate) struct Budget {
    /// What the part is, and its nanoseconds per block.
    pub(crate) parts: Vec<(&'static str, f64)>,
    /// Nanoseconds per point: forward, inverse; per three coordinates: printing; per stretch: bound.
    pub(crate) points: Vec<(&'static str, f64)>,
    /// Bytes per block of the program measured.
    pub(crate) bytes_per_block: f64,
}

/// Least of some repetitions, seconds of the processor.
fn best(repetitions: usize, mut work: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..repetitions {
        let started = own_cpu_s();
        work();
        best = best.min(own_cpu_s() - started);
    }
    best
}

/// Measures a program that is straight feed motion.
pub(crate) fn measure(text: &[u8], job: &Job<'_>, repetitions: usize) -> anyhow::Result<Budget> {
    let mut blocks = 0_u64;
    let lex =
        best(repetitions, || blocks = each(text, job.dialect, |block| _ = black_box(block.items.len())));
    let modal = best(repetitions, || {
        let mut interpreter = Interpreter::new(job.dialect, job.setup);
        each(text, job.dialect, |block| _ = black_box(interpreter.step(block)));
    });
    let mut whole = Ok(0);
    let all = best(repetitions, || {
        whole = correct::<Vec<diagnostic::Diagnostic>>(text, job, |_| Ok(())).map(|c| c.text.len());
    });
    whole.map_err(|found| anyhow::anyhow!("the benchmark's program was refused: {found:?}"))?;
    let positions = positions(text, job);
    let correction = best(repetitions, || correct_moves(&positions, job));
    let copy = best(repetitions, || _ = black_box(black_box(text).to_vec()));
    let per_block = |seconds: f64| seconds * 1e9 / blocks as f64;
    let (lex, modal, correction, copy, all) = (
        per_block(lex),
        per_block(modal) - per_block(lex),
        per_block(correction),
        per_block(copy),
        per_block(all),
    );
    let parts = vec![
        ("read words", lex),
        ("modal step", modal),
        ("inverse, rounding and proof", correction),
        ("copy", copy),
        ("write words, and all else", all - lex - modal - correction - copy),
        ("in all", all),
    ];
    Ok(Budget {
        parts,
        points: points(&positions, job, repetitions),
        bytes_per_block: text.len() as f64 / blocks as f64,
    })
}

fn each<'a>(text: &'a [u8], dialect: &'a Dialect, mut f: impl FnMut(&Block<'a>)) -> u64 {
    let mut reader = Reader::new(text, dialect);
    let mut block = Block::default();
    let mut blocks = 0;
    while reader.next(&mut block) {
        f(&block);
        blocks += 1;
    }
    blocks
}

/// The ends of the feed motions, in axis commands.
fn positions(text: &[u8], job: &Job<'_>) -> Vec<toolpath::Feed> {
    let mut interpreter = Interpreter::new(job.dialect, job.setup);
    let mut found = Vec::new();
    each(text, job.dialect, |block| {
        if let Ok(step) = interpreter.step(block) {
            found.extend(step.motions.iter().filter_map(|motion| match motion {
                toolpath::Motion::Feed(feed) => Some(*feed),
                _ => None,
            }));
        }
    });
    found
}

fn correct_moves(feeds: &[toolpath::Feed], job: &Job<'_>) {
    let mut corrector = Corrector::new(job.model, Options { ..job.options });
    let mut letters = correction::Letters::default();
    b"XYZ".iter().for_each(|letter| letters.insert(*letter));
    let block = correction::Block {
        frame: toolpath::Frame::default(),
        unit_mm: 1.0,
        decimals: job.decimals_mm,
        incremental: false,
        arc_centres_absolute: false,
        letters,
        whole: [false; 3],
        tool_mm: [0.0, 0.0, -120.0],
        centre_words: true,
        arc_radius_tolerance_mm: 0.02,
        peck_clearance_mm: 0.25,
        chip_retreat_mm: 0.5,
    };
    for feed in feeds {
        _ = black_box(corrector.correct(&toolpath::Motion::Feed(*feed), &block));
    }
}

fn points(feeds: &[toolpath::Feed], job: &Job<'_>, repetitions: usize) -> Vec<(&'static str, f64)> {
    let commands: Vec<Command> = feeds.iter().take(1 << 16).map(|feed| command(feed.end.linear_mm)).collect();
    let moves: Vec<Move> = feeds.iter().take(1 << 16).map(stretch).collect();
    let per = |count: usize, seconds: f64| seconds * 1e9 / count.max(1) as f64;
    let model: &dyn PathModel = job.model;
    let forward =
        best(repetitions, || commands.iter().for_each(|c| _ = black_box(model.error_mm(black_box(c)))));
    let inverse =
        best(repetitions, || commands.iter().for_each(|c| _ = black_box(model.solve(black_box(c)))));
    let bound =
        best(repetitions, || moves.iter().for_each(|m| _ = black_box(model.chord_bound_mm(black_box(m)))));
    let mut out = Vec::with_capacity(64);
    let print = best(repetitions, || {
        for command in &commands {
            out.clear();
            for value in command.linear_mm.iter() {
                units::decimal::write(
                    &mut out,
                    (value * 1000.0) as i64,
                    3,
                    black_box(units::decimal::Spelling::FIXED),
                );
            }
            black_box(&out);
        }
    });
    vec![
        ("forward, a point", per(commands.len(), forward)),
        ("inverse, a point", per(commands.len(), inverse)),
        ("interval bound, a stretch", per(moves.len(), bound)),
        ("printing three coordinates", per(commands.len(), print)),
    ]
}

fn command(linear_mm: [f64; 3]) -> Command {
    Command {
        linear_mm: linear_mm.into(),
        rotary_rad: Vector::zeros(),
        tool_mm: Vector::new(0.0, 0.0, -120.0),
        direction: [0; 3],
    }
}

fn stretch(feed: &toolpath::Feed) -> Move {
    let (a, b) = (feed.start.linear_mm, feed.end.linear_mm);
    Move {
        range_mm: [0, 1, 2].map(|i| Range { low: a[i].min(b[i]), high: a[i].max(b[i]) }),
        speed_mm: [0, 1, 2].map(|i| (b[i] - a[i]).abs()),
        acceleration_mm: [0.0; 3],
        passes: 1,
        state: command(b),
    }
}
