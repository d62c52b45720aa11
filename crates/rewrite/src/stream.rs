//! One large program on several threads: chunks are corrected ahead of their turn and proven to fit when it comes.
//!
//! What a chunk becomes depends on the state in which the one before it ended ([`State`]). A thread that takes a
//! chunk before that is known starts from a guess: the last state known for certain, led through the last lines
//! before the chunk. When its turn comes, the guess is compared with the truth. Where they differ, the blocks are done
//! again from the true state until both agree; from there on all that follows is the same. So the bytes are those
//! of one pass from the first block to the last, for any number of threads, and nothing has to be known about what a
//! code does to the state: a guess that never comes right costs time, not truth.

use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use diagnostic::Diagnostic;
use nc_syntax::{Block, Envelope, Reader};

use crate::chunks::{Chunk, Chunks, Unread};
use crate::job::{Job, Warning};
use crate::pass::Pass;
use crate::sink::Sink;
use crate::state::State;
use crate::tally::Tally;

/// How much of the chunk before leads a guess.
const LEAD_BYTES: usize = 2048;
/// Bytes into a chunk where its state is kept for comparison; beyond the last, every [`FAR_BYTES`].
const NEAR_BYTES: [usize; 5] = [512, 1024, 2048, 4096, 8192];
const FAR_BYTES: usize = 1 << 15;

/// What the work is done with.
pub(crate) struct Plan<'a> {
    pub(crate) job: &'a Job<'a>,
    pub(crate) envelope: Envelope,
    /// The state at the start of the program.
    pub(crate) start: State<'a>,
    pub(crate) threads: usize,
    pub(crate) chunk_bytes: usize,
}

/// Why the work ended before the program did.
pub(crate) enum End {
    /// A block of this chunk cannot be corrected.
    Refused(Chunk, Vec<Diagnostic>),
    /// The text ends inside what takes several blocks.
    Unfinished(Box<Warning>),
    /// A block computes or jumps: the program is not plain.
    Flows,
    /// The program cannot be read in chunks.
    Unread(Unread),
    /// The output cannot be written.
    Unwritten(io::Error),
    /// The caller wants no more.
    Stopped,
}

impl From<Unread> for End {
    fn from(unread: Unread) -> Self {
        Self::Unread(unread)
    }
}

/// Why a chunk was not done to its end.
enum Stop {
    Refused(Vec<Diagnostic>),
    Flows,
}

impl From<Vec<Diagnostic>> for Stop {
    fn from(diagnostics: Vec<Diagnostic>) -> Self {
        Self::Refused(diagnostics)
    }
}

/// A chunk that was done from some state.
struct Done<'a> {
    chunk: Chunk,
    out: Vec<u8>,
    /// In order; the first starts where the chunk does.
    stretches: Vec<Stretch<'a>>,
    end: Result<State<'a>, Stop>,
}

/// A part of a chunk, and the state it started from.
struct Stretch<'a> {
    /// Bytes of the program before it.
    offset: u64,
    /// Bytes of the chunk's output before it.
    out: usize,
    state: State<'a>,
    tally: Tally,
}

struct Board<'a> {
    /// Where the last chunk that had its turn ended.
    state: State<'a>,
    /// Figures of all that had their turn.
    tally: Tally,
    /// Whose turn it is.
    turn: usize,
    /// Done before their turn.
    waiting: BTreeMap<usize, Done<'a>>,
    /// A thread is at work on the one whose turn it is.
    busy: bool,
    end: Option<End>,
}

struct Source<R> {
    chunks: Chunks<R>,
    /// The last lines of the chunk taken last.
    lead: Vec<u8>,
}

struct Work<'w, 'a, R, W, I, P> {
    plan: &'w Plan<'a>,
    source: Mutex<Source<R>>,
    board: Mutex<Board<'a>>,
    turned: Condvar,
    sink: Mutex<&'w mut Sink<W>>,
    again: &'w I,
    progress: &'w P,
}

/// Corrects a program from a reader to a sink; `again` opens the program anew, `progress` is told the bytes that are
/// done and may end the work.
///
/// # Errors
/// [`End`]; what the sink then holds is of no use.
pub(crate) fn correct<R, W, A>(
    plan: &Plan<'_>,
    source: R,
    sink: &mut Sink<W>,
    again: &(impl Fn() -> io::Result<A> + Sync),
    progress: &(impl Fn(u64) -> bool + Sync),
) -> Result<Tally, End>
where
    R: Read + Send,
    W: Write + Send,
    A: Read,
{
    let work = Work {
        plan,
        source: Mutex::new(Source { chunks: Chunks::new(source, plan.chunk_bytes), lead: Vec::new() }),
        board: Mutex::new(Board {
            state: plan.start.clone(),
            tally: Tally::default(),
            turn: 0,
            waiting: BTreeMap::new(),
            busy: false,
            end: None,
        }),
        turned: Condvar::new(),
        sink: Mutex::new(sink),
        again,
        progress,
    };
    std::thread::scope(|scope| {
        for _ in 1..plan.threads {
            scope.spawn(|| work.run());
        }
        work.run();
    });
    let board = work.board.into_inner().unwrap_or_else(PoisonError::into_inner);
    match board.end {
        Some(end) => Err(end),
        None => match board.state.interpreter.unfinished() {
            Some(unfinished) => Err(End::Unfinished(Box::new(unfinished))),
            None => Ok(board.tally),
        },
    }
}

/// A thread that panics ends the program; the others may read what it left meanwhile.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<'a, R, W, A, I, P> Work<'_, 'a, R, W, I, P>
where
    R: Read,
    W: Write,
    A: Read,
    I: Fn() -> io::Result<A>,
    P: Fn(u64) -> bool,
{
    fn run(&self) {
        while let Some((chunk, lead)) = self.take() {
            let index = chunk.index;
            let (guess, known) = {
                let board = lock(&self.board);
                (board.state.clone(), board.turn == index)
            };
            let guess = if known { guess } else { self.led(guess, &lead, &chunk) };
            let done = self.through(chunk, guess, !known);
            let mut board = lock(&self.board);
            board.waiting.insert(index, done);
            self.settle(board);
        }
    }

    /// The next chunk and the lines before it, once there is room for it.
    fn take(&self) -> Option<(Chunk, Vec<u8>)> {
        let mut source = lock(&self.source);
        let next = match source.chunks.next() {
            Ok(next) => next?,
            Err(unread) => {
                lock(&self.board).end.get_or_insert(End::Unread(unread));
                return None;
            }
        };
        let lead = std::mem::replace(&mut source.lead, last_lines(&next.text));
        // All of what is in work at a time is to fit into memory.
        let room = self.plan.threads * 2 + 2;
        let mut board = lock(&self.board);
        while board.end.is_none() && next.index >= board.turn + room {
            board = self.turned.wait(board).unwrap_or_else(PoisonError::into_inner);
        }
        board.end.is_none().then_some((next, lead))
    }

    /// Leads a state through the lines before a chunk.
    fn led(&self, guess: State<'a>, lead: &[u8], chunk: &Chunk) -> State<'a> {
        let mut pass = Pass::new(self.plan.job, guess, lead.len());
        let place = nc_syntax::Place {
            offset: chunk.offset - lead.len() as u64,
            line: chunk.line.saturating_sub(1).max(1),
            expects_name: false,
        };
        let mut reader = Reader::part(lead, self.plan.job.dialect, self.plan.envelope, place);
        // A block that makes no sense from here makes no better guess.
        pass.next_stop = u64::MAX;
        while pass.run::<Vec<Diagnostic>>(&mut reader, |_, _| Ok(false), |_| Ok(())).is_err() {}
        pass.state
    }

    /// Corrects a chunk from a state; where that is a guess, with states kept on the way.
    fn through(&self, chunk: Chunk, state: State<'a>, guessed: bool) -> Done<'a> {
        let mut stretches = Vec::new();
        let first = state.clone();
        let mut pass = Pass::new(self.plan.job, state, chunk.text.len());
        let mut open = Stretch { offset: chunk.offset, out: 0, state: first, tally: Tally::default() };
        let mut near = NEAR_BYTES.iter();
        let mut next_stop = |at: u64| near.next().map_or(at + FAR_BYTES as u64, |near| *near as u64);
        pass.next_stop = if guessed { chunk.offset + next_stop(0) } else { u64::MAX };
        let end = each(self.plan, &chunk, &mut pass, |pass, offset| {
            let next =
                Stretch { offset, out: pass.out.len(), state: pass.state.clone(), tally: Tally::default() };
            let mut closed = std::mem::replace(&mut open, next);
            closed.tally = std::mem::take(&mut pass.tally);
            stretches.push(closed);
            pass.next_stop = chunk.offset + next_stop(offset - chunk.offset);
            false
        });
        open.tally = std::mem::take(&mut pass.tally);
        stretches.push(open);
        let Pass { out, state, .. } = pass;
        Done { chunk, out, stretches, end: end.map(|_| state) }
    }

    /// Takes the chunks whose turn it is, one after the other.
    fn settle<'s>(&'s self, mut board: MutexGuard<'s, Board<'a>>) {
        while !board.busy && board.end.is_none() {
            let turn = board.turn;
            let Some(done) = board.waiting.remove(&turn) else { return };
            board.busy = true;
            let state = board.state.clone();
            drop(board);
            let settled = self.settle_one(done, state);
            board = lock(&self.board);
            board.busy = false;
            match settled {
                Ok((state, tally)) => {
                    board.state = state;
                    board.tally.add(&tally);
                    board.turn += 1;
                }
                Err(end) => _ = board.end.get_or_insert(end),
            }
            self.turned.notify_all();
        }
    }

    /// Makes a chunk true to the state it starts from, and writes it.
    fn settle_one(&self, done: Done<'a>, state: State<'a>) -> Result<(State<'a>, Tally), End> {
        let (chunk, out, tally, end) = self.made_true(done, state);
        let end = match end {
            Ok(state) => state,
            Err(Stop::Refused(diagnostics)) => return Err(End::Refused(chunk, diagnostics)),
            Err(Stop::Flows) => return Err(End::Flows),
        };
        lock(&self.sink).put(&chunk.text, &out, self.again).map_err(End::Unwritten)?;
        if (self.progress)(chunk.offset + chunk.text.len() as u64) {
            Ok((end, tally))
        } else {
            Err(End::Stopped)
        }
    }

    /// The output of a chunk, its figures and its end, as they are from `state` on.
    fn made_true(
        &self,
        done: Done<'a>,
        state: State<'a>,
    ) -> (Chunk, Vec<u8>, Tally, Result<State<'a>, Stop>) {
        let Done { chunk, mut out, stretches, end } = done;
        let mut tally = Tally::default();
        let mut meets = 0;
        let mut again = Vec::new();
        if !stretches[0].state.continues_as(&state) {
            let mut pass = Pass::new(self.plan.job, state, LEAD_BYTES);
            let mut next = 1;
            let begins = |next: usize| stretches.get(next).map_or(u64::MAX, |stretch| stretch.offset);
            pass.next_stop = begins(next);
            let ended = each(self.plan, &chunk, &mut pass, |pass, _| {
                let stretch = &stretches[next];
                next += 1;
                pass.next_stop = begins(next);
                stretch.state.continues_as(&pass.state)
            });
            tally = pass.tally;
            again = pass.out;
            match ended {
                Ok(true) => meets = next - 1,
                Ok(false) => return (chunk, again, tally, Ok(pass.state)),
                Err(stop) => return (chunk, again, tally, Err(stop)),
            }
        }
        stretches[meets..].iter().for_each(|stretch| tally.add(&stretch.tally));
        if meets == 0 {
            return (chunk, out, tally, end);
        }
        // What was done again takes the place of what it replaces.
        out.splice(..stretches[meets].out, again);
        (chunk, out, tally, end)
    }
}

/// Corrects the blocks of a chunk until `met` says so before one of them (it is told its offset); true where it did.
fn each<'a>(
    plan: &Plan<'a>,
    chunk: &Chunk,
    pass: &mut Pass<'a>,
    mut met: impl FnMut(&mut Pass<'a>, u64) -> bool,
) -> Result<bool, Stop> {
    let place = chunk.place(pass.state.expects_name);
    let mut reader = Reader::part(&chunk.text, plan.job.dialect, plan.envelope, place);
    // What is plain does not compute.
    let flows = |block: &Block<'_>| {
        if nc_expand::computes(block, plan.job.dialect) { Err(Stop::Flows) } else { Ok(()) }
    };
    pass.run(&mut reader, |pass, offset| Ok(met(pass, offset)), flows)
}

/// The last lines of a chunk.
fn last_lines(text: &[u8]) -> Vec<u8> {
    let from = text.len().saturating_sub(LEAD_BYTES);
    let start = match memchr::memchr2(b'\n', b'\r', &text[from..]) {
        Some(at) if from > 0 => from + at + 1,
        _ => from,
    };
    text[start..].to_vec()
}

#[cfg(test)]
mod tests {
    use correction::{Options, Outside};
    use machine_model::EngineId;
    use nc_emit::BlockNumbers;
    use nc_program::Setup;
    use nc_syntax::EnvelopeFinder;
    use proptest::prelude::*;

    use super::*;
    use crate::figures::{Corrected, Figures};

    /// The pieces of programs: what a state can be carried through.
    const PARTS: [&str; 16] = [
        "G1 X10. Y5. Z3. F500\n",
        "G1 X11.5 Y5.25 Z2.5\nX12. Y6.\nX12.5\nY7.125\nZ2.\nX13.25 Y8.5 Z1.75\n",
        "(A COMMENT)\nG0 Z20.\nX-5. Y-5.\nG1 Z1. F300\n",
        "G1 X-5. Y-5.\nG3 X-10. Y-5. I-2.5 J0.\n",
        "G91\nG1 X1. Y.5\nX-2. Z.25\nG90\n",
        "G91\nG1 X.4 Y.5\nX-.2 Z.25\nY.3(AT ONCE)\nZ-.125 X.1\nX.1 Y-.1 Z.1\nX-.2\nG90\n",
        "G1 X3.5\nY2.5 (A)\nZ.75\nX4.\nN7 Y3.\nZ1. X4.5\nZ1.5 X5. F300.\nY3.5\n",
        "x7. y2. z1.\nx7.5\ny2.25(b)\nZ1.25Y2.5\nX8.\n",
        "G1 X20. Y0.\nG17 G2 X0. Y0. R30.\n",
        "G0 Z25.\nG98 G81 X5. Y5. Z-3. R8. F100\nX15.\nY15.\nG80\n",
        "G55\nG0 X0. Y0. Z30.\nG1 X1. Y2.\n",
        "G54\nG0 X0. Y0. Z30.\nG1 X2. Y1. Z4.\n",
        "G49\nG43 H2\nG0 X0. Y0. Z30.\nG1 Z5. F200\n",
        "N100 G1 X30. Y10.\r\nN110 X31.\r\n",
        "G1 X90. Y-60. Z12.\nX-90.\nY60.\n",
        "G1 X5. Y5. Z3.\nG6.2 P3 K0. X5. Y5. Z3.\nK0. X7. Y5. Z3. (POINT)\nK0. X7. Y8. Z2.5\nM8\nK1.\nN9 K1.\nK1. F400\nG1 X6.\n",
    ];

    fn in_chunks(
        text: &[u8],
        job: &Job<'_>,
        chunk_bytes: usize,
        threads: usize,
    ) -> Result<(Vec<u8>, Figures), Vec<Diagnostic>> {
        let mut numbers = BlockNumbers::new();
        crate::whole::each_block(text, job.dialect, |block| _ = numbers.see(block));
        let mut finder = EnvelopeFinder::new(job.dialect);
        finder.see(text);
        let start = State::new(job, &numbers);
        let plan = Plan { job, envelope: finder.finish(), start, threads, chunk_bytes };
        let mut out = Vec::new();
        let mut sink = Sink::new(&mut out, None, (0, Vec::new()));
        let tally = match correct(&plan, text, &mut sink, &|| Ok(text), &|_| true) {
            Ok(tally) => tally,
            Err(End::Refused(_, diagnostics)) => return Err(diagnostics),
            Err(_) => panic!("neither corrected nor refused"),
        };
        sink.finish(|| Ok(text), text.len() as u64).unwrap();
        let warnings = tally.warnings(job).into_iter().map(|(warning, _)| warning).collect();
        let figures = Figures { warnings, ..tally.figures };
        Ok((out, figures))
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

        #[test]
        fn chunks_and_threads_change_no_byte_and_no_figure(
            parts in proptest::collection::vec(0..PARTS.len(), 1..120),
            chunk_bytes in 200_usize..3000,
            threads in 1_usize..5,
            crooked: bool,
        ) {
            let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../machine-profiles");
            let name = if crooked { "generic_vmc.toml" } else { "stan_s500.toml" };
            let profile = std::fs::read_to_string(folder.join(name)).unwrap();
            let profile = machine_profile::load(&profile, &|t| std::fs::read(folder.join(t))).unwrap();
            let engine = profile.engine(EngineId::RigidBody, &Default::default()).unwrap();
            let Ok(engine) = machine_model::FromDatum::new(engine) else { panic!("it corrects programs") };
            let offset = if crooked { [-440.0, -250.0, -350.0] } else { [140.0, 110.0, 20.0] };
            let setup = Setup {
                work_offsets: vec![("G54".to_owned(), offset), ("G55".to_owned(), offset.map(|v| v + 10.0))],
                tools: vec![(1, [0.0, 0.0, 120.0]), (2, [0.0, 0.0, 130.0])],
                ..Setup::default()
            };
            let job = Job {
                dialect: nc_dialect::builtin("fanuc").unwrap(),
                setup: &setup,
                models: machine_model::Models { axes: &engine, tip: None },
                datums: &crate::datum::Datums::touched(Default::default()),
                options: Options { tolerance_mm: 1e-3, accept_mm: 0.0, outside: Outside::Clamp, minimum_segment_mm: 0.0, orientation_rad: 5e-5, orientation: correction::Orientation::Tip },
                interpolator: Default::default(),
                path_mode: Default::default(),
                decimals_mm: [3; 3],
                rotary_steps: [(3, 1); 3],
                force: true,
                provenance: "",
                guards: crate::job::Guards::None,
            };
            let mut text = "%\nO1\nG21 G90 G54 G43 H1\nG0 X0. Y0. Z30.\nG1 Z10. F500.\n".to_owned();
            parts.iter().for_each(|part| text.push_str(PARTS[*part]));
            text.push_str("M30\n%\n");
            let whole: Result<Option<Corrected>, Vec<Diagnostic>> =
                crate::whole::pass(text.as_bytes(), &job, |_| false, |line| line, |_| Ok(()));
            let chunked = in_chunks(text.as_bytes(), &job, chunk_bytes, threads);
            // A jump that cannot be hidden is refused, in one piece as in chunks.
            if let (Err(one), Err(other)) = (&whole, &chunked) {
                prop_assert_eq!(one, other);
                return Ok(());
            }
            let whole = whole.unwrap().unwrap();
            let (out, figures) = chunked.unwrap();
            prop_assert_eq!(String::from_utf8_lossy(&out), String::from_utf8_lossy(&whole.text));
            prop_assert_eq!(&figures, &whole.figures);

            // The short way through plain blocks is the long way, without its detours.
            let mut numbers = BlockNumbers::new();
            crate::whole::each_block(text.as_bytes(), job.dialect, |block| _ = numbers.see(block));
            let mut pass = Pass::new(&job, State::new(&job, &numbers), text.len());
            crate::whole::each_block(text.as_bytes(), job.dialect, |block| pass.block(block).unwrap());
            prop_assert_eq!(String::from_utf8_lossy(&pass.out), String::from_utf8_lossy(&whole.text));
            prop_assert_eq!(pass.tally.figures.blocks_out, figures.blocks_out);
        }
    }
}
