//! Where the time of one block goes: the work is done in ever longer parts, and the differences are the parts.

use std::hint::black_box;

use correction::{Corrector, Options};
use machine_model::{Command, LANES, Move, PathModel, Range, Vector};
use nc_dialect::Dialect;
use nc_program::Interpreter;
use nc_syntax::{Block, PlainLine, Reader};
use rewrite::{Job, correct};

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

/// The clock of a thread's processor time goes by ticks: what is shorter than this is done again and again, s.
const SHORTEST_S: f64 = 0.1;

/// Least of some repetitions, seconds of the processor.
fn best(repetitions: usize, mut work: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..repetitions {
        let (started, mut times) = (own_cpu_s(), 0.0);
        loop {
            work();
            times += 1.0;
            let took = own_cpu_s() - started;
            if took >= SHORTEST_S {
                best = best.min(took / times);
                break;
            }
        }
    }
    best
}

/// Measures a program that is straight feed motion.
pub(crate) fn measure(text: &[u8], job: &Job<'_>, repetitions: usize) -> anyhow::Result<Budget> {
    let mut blocks = 0_u64;
    let lex = best(repetitions, || blocks = lines(text, job.dialect));
    let modal = best(repetitions, || ends(text, job));
    let mut whole = Ok(0);
    let all = best(repetitions, || {
        whole =
            correct::<Vec<diagnostic::Diagnostic>>(text, job, |line| line, |_| Ok(())).map(|c| c.text.len());
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
        ("read plain lines", lex),
        ("modal step", modal),
        ("inverse, rounding and proof", correction),
        ("copy", copy),
        ("learn the spelling, write words, and all else", all - lex - modal - correction - copy),
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

/// Reads plain lines, and what else there is as blocks; their number.
fn lines(text: &[u8], dialect: &Dialect) -> u64 {
    let mut reader = Reader::new(text, dialect);
    let (mut line, mut block, mut count) = (PlainLine::default(), Block::default(), 0);
    while reader.plain_line(&mut line) || reader.next(&mut block) {
        black_box(&line);
        count += 1;
    }
    count
}

/// The same, with what they mean.
fn ends(text: &[u8], job: &Job<'_>) {
    let mut interpreter = Interpreter::new(job.dialect, job.setup);
    let mut reader = Reader::new(text, job.dialect);
    let (mut line, mut block) = (PlainLine::default(), Block::default());
    loop {
        while let Some((feeds, start_mm)) = interpreter.plain_feeds()
            && reader.plain_line(&mut line)
        {
            let Some(end) = feeds.end_of(&line, start_mm) else {
                reader.unread(&line);
                break;
            };
            interpreter.go_to(black_box(&end), end.feed);
        }
        if !reader.next(&mut block) {
            return;
        }
        _ = black_box(interpreter.step(&block));
    }
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
    let mut corrector = Corrector::new(job.models.axes, Options { ..job.options });
    let block = correction::Block {
        decimals: job.decimals_mm,
        stated: correction::Stated { axes: [true; 3], ..correction::Stated::default() },
        tool_mm: [0.0, 0.0, -120.0],
        ..correction::Block::default()
    };
    // The first lines bring the axes to where short lines start.
    let (first, rest) = feeds.split_at(feeds.len().min(2));
    for feed in first {
        _ = black_box(corrector.correct(&toolpath::Motion::Feed(*feed), &block));
    }
    for group in rest.chunks(LANES) {
        let ends_mm = std::array::from_fn(|k| group[k.min(group.len() - 1)].end.linear_mm);
        let start_mm = group[0].start.linear_mm;
        let short = corrector.short_lines(&block, [0.0; 3]);
        let run =
            correction::Run { start_mm, ends_mm: &ends_mm, names: [[true; 3]; LANES], count: group.len() };
        let run = short.and_then(|short| corrector.short_run(&short, &block, &run));
        for feed in &group[run.as_ref().map_or(0, |run| run.count)..] {
            _ = black_box(corrector.correct(&toolpath::Motion::Feed(*feed), &block));
        }
        black_box(&run);
    }
}

fn points(feeds: &[toolpath::Feed], job: &Job<'_>, repetitions: usize) -> Vec<(&'static str, f64)> {
    let commands: Vec<Command> = feeds.iter().take(1 << 16).map(|feed| command(feed.end.linear_mm)).collect();
    let moves: Vec<Move> = feeds.iter().take(1 << 16).map(stretch).collect();
    let per = |count: usize, seconds: f64| seconds * 1e9 / count.max(1) as f64;
    let model: &dyn PathModel = job.models.axes;
    let forward =
        best(repetitions, || commands.iter().for_each(|c| _ = black_box(model.error_mm(black_box(c)))));
    let inverse =
        best(repetitions, || commands.iter().for_each(|c| _ = black_box(model.solve(black_box(c)))));
    let everywhere = commands.first().and_then(|command| model.everywhere(command));
    let together = best(repetitions, || {
        let Some(everywhere) = &everywhere else { return };
        for group in commands.chunks_exact(LANES) {
            let ends_mm = std::array::from_fn(|k| group[k].linear_mm.into());
            let directions = [group[0].direction; LANES];
            _ = black_box(model.commands_for(black_box(&ends_mm), &directions, &group[0], everywhere));
        }
    });
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
        ("inverse as `vpost solve` takes it, residual evaluated, a point", per(commands.len(), inverse)),
        ("inverse as correction takes it, four points at once, a point", per(commands.len(), together)),
        ("interval bound, a stretch", per(moves.len(), bound)),
        ("printing three coordinates", per(commands.len(), print)),
    ]
}

fn command(linear_mm: [f64; 3]) -> Command {
    Command { linear_mm: linear_mm.into(), tool_mm: Vector::new(0.0, 0.0, -120.0), ..Default::default() }
}

fn stretch(feed: &toolpath::Feed) -> Move {
    let (a, b) = (feed.start.linear_mm, feed.end.linear_mm);
    Move {
        range_mm: [0, 1, 2].map(|i| Range { low: a[i].min(b[i]), high: a[i].max(b[i]) }),
        speed_mm: [0, 1, 2].map(|i| (b[i] - a[i]).abs()),
        acceleration_mm: [0.0; 3],
        passes: 1,
        turn: None,
        state: command(b),
    }
}
