//! Does every reader of this room know what the one reader of programs knows, or nothing? Asked after every block of the
//! corpus, of LinuxCNC's own programs and of programs put together by chance.
//!
//! `VPOST_AGREEMENT=20000` tries so many programs by chance.

use std::path::{Path, PathBuf};

use nc_program::modal::{Distance, Modal, MotionMode, Units};
use nc_program::{Interpreter, Setup};
use nc_syntax::dialect::{DrillPecks, DrillR, TurningParameters};
use nc_syntax::{Block, Dialect, Reader};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::known::{self, Motion, Rewriting};
use crate::output::Segment;
use crate::{Environment, Expanded, Limits, expand};

#[path = "../../../tests/fuzz/src/generate.rs"]
#[expect(unreachable_pub, dead_code, reason = "the fuzz crate uses all of it")]
mod generate;

/// What a reader takes for granted behind so many bytes of the text it has written; `None`: it does not know.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Belief {
    pub(crate) at: u64,
    pub(crate) places: [Option<f64>; 3],
    pub(crate) inch: Option<bool>,
    pub(crate) absolute: Option<bool>,
    pub(crate) plane: Option<[usize; 3]>,
    pub(crate) motion: Option<Motion>,
}

impl Belief {
    pub(crate) const NONE: Self =
        Self { at: 0, places: [None; 3], inch: None, absolute: None, plane: None, motion: None };

    pub(crate) const fn of_flow(at: u64, inch: bool) -> Self {
        Self { at, inch: Some(inch), ..Self::NONE }
    }
}

impl known::State {
    pub(crate) const fn belief(&self) -> Belief {
        Belief {
            places: self.at,
            inch: Some(self.inch),
            absolute: Some(self.absolute),
            plane: Some(self.plane),
            motion: Some(self.motion),
            ..Belief::NONE
        }
    }
}

impl Rewriting<'_> {
    pub(crate) fn believe(&mut self, belief: Belief) {
        let at = self.length();
        self.beliefs.push(Belief { at, ..belief });
    }
}

/// Six decimals are written, of inches too.
const ROUNDED_MM: f64 = 26e-6;

/// Where bytes of a step's text stand in the next step's; `None` where that wrote its blocks in another order, or others.
fn further(segments: &[Segment], at: u64) -> Option<u64> {
    let within = segments.iter().find(|segment| segment.source < at && at < segment.source + segment.length);
    if let Some(segment) = within {
        return segment.exact.then(|| segment.flat + (at - segment.source));
    }
    let (before, behind): (Vec<&Segment>, Vec<&Segment>) =
        segments.iter().partition(|segment| segment.source < at);
    let end = behind.iter().map(|segment| segment.flat).min();
    let last = before.iter().map(|segment| segment.flat).max();
    match (last, end) {
        (Some(last), Some(end)) if last >= end => None,
        (_, end) => Some(end.unwrap_or(u64::MAX)),
    }
}

/// What the one reader knows, behind each block that ends at a byte; to the first block that it refuses.
fn knowledge(text: &[u8], dialect: &Dialect, setup: &Setup) -> Vec<(u64, Modal)> {
    let (mut reader, mut block) = (Reader::new(text, dialect), Block::default());
    let mut interpreter = Interpreter::new(dialect, setup);
    let mut known = vec![(0, interpreter.modal().clone())];
    while reader.next(&mut block) && interpreter.step(&block).is_ok() {
        known.push((block.offset + block.bytes.len() as u64, interpreter.modal().clone()));
    }
    known
}

/// What a belief has wrong.
fn wrong(belief: &Belief, modal: &Modal, turns: bool) -> Vec<String> {
    let mut wrong = Vec::new();
    let frame = modal.frame.clone().unwrap_or_default();
    let stands = modal.axes.linear.map(nc_program::modal::Axis::known);
    let there = frame.to_program(stands.map(Option::unwrap_or_default));
    let lacks =
        |axis: usize| (0..3).any(|other| frame.inverse()[axis][other] != 0.0 && stands[other].is_none());
    for axis in (0..3).filter(|axis| !(turns && *axis == 1)) {
        let Some(word) = belief.places[axis] else { continue };
        let diameters = axis == 0 && modal.x_words.are_diameters(modal.distance);
        let mm = word * modal.units.mm() * if diameters { 0.5 } else { 1.0 };
        if modal.aside.is_some() || (mm - there[axis]).abs() > ROUNDED_MM || lacks(axis) {
            wrong.push(format!("{} at {mm}, {}", ["X", "Y", "Z"][axis], there[axis]));
        }
    }
    let mut compare = |what: &str, believed: bool| {
        if believed {
            wrong.push(what.to_owned());
        }
    };
    compare("unit", belief.inch.is_some_and(|inch| inch != (modal.units == Units::Inch)));
    compare("G90", belief.absolute.is_some_and(|it| it != (modal.distance == Distance::Absolute)));
    compare("plane", belief.plane.is_some_and(|it| it != modal.plane.axes()));
    let motion = match modal.motion {
        _ if modal.cycle.is_some() => Motion::Cycle,
        MotionMode::Rapid(_) => Motion::Rapid,
        MotionMode::Line(_) | MotionMode::Thread(_) => Motion::Line,
        MotionMode::Arc(..) | MotionMode::Curve(..) => Motion::Arc,
        MotionMode::None | MotionMode::Undecided { .. } => Motion::None,
    };
    compare("motion", belief.motion.is_some_and(|it| it != motion));
    wrong
}

/// Lines that are taken out of a program because they are refused, at most.
const MOST_TAKEN_OUT: usize = 60;

/// A program without the lines for which it is refused.
fn sound(text: &[u8], dialect: &Dialect) -> Vec<u8> {
    let (mut text, setup) = (text.to_vec(), setup(dialect));
    let environment = Environment { variables: &[], read_external: &nothing, setup: &setup, limits: LIMITS };
    for _ in 0..MOST_TAKEN_OUT {
        let refused = match expand(&text, dialect, &environment) {
            Err(refusal) => refusal.diagnostics[0].span.clone(),
            Ok(expanded) => {
                let end = knowledge(expanded.text(), dialect, &setup).last().map_or(0, |(end, _)| *end);
                (end < expanded.text().len() as u64).then(|| expanded.origin(&(end..end + 1)).span)
            }
        };
        let Some(at) = refused.map(|span| (span.start as usize).min(text.len())) else { return text };
        let start = text[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |before| before + 1);
        let end =
            text[at..].iter().position(|byte| *byte == b'\n').map_or(text.len(), |length| at + length + 1);
        drop(text.drain(start..end));
    }
    text
}

/// Work for one program ends here.
const LIMITS: Limits = Limits { steps: 2_000, output_bytes: 64 << 10, depth: 10 };

/// How many beliefs were compared; what is wrong.
fn judged(
    text: &[u8],
    dialect: &Dialect,
    read: &dyn Fn(&str) -> std::io::Result<Vec<u8>>,
) -> Result<usize, String> {
    let setup = setup(dialect);
    let environment = Environment { variables: &[], read_external: read, setup: &setup, limits: LIMITS };
    let Ok(expanded) = expand(text, dialect, &environment) else { return Ok(0) };
    let Expanded { text: plain, shorthand, beliefs, .. } = &expanded;
    let known = knowledge(plain, dialect, &setup);
    let mut compared = 0;
    for (step, beliefs) in beliefs.iter().enumerate() {
        for belief in beliefs {
            let at = shorthand[step..].iter().try_fold(belief.at, |at, segments| further(segments, at));
            let Some(at) = at else { continue };
            let behind = known.partition_point(|(end, _)| *end <= at);
            // Behind a block that is refused nothing is known.
            if behind == known.len()
                && known.last().is_none_or(|(end, _)| *end < (plain.len() as u64).min(at))
            {
                continue;
            }
            compared += 1;
            let wrong = wrong(belief, &known[behind - 1].1, dialect.turning.is_some());
            if !wrong.is_empty() {
                let source = String::from_utf8_lossy(text);
                let plain = String::from_utf8_lossy(&plain[..plain.len().min(at as usize)]);
                return Err(format!("step {step}: {}\n{source}\n--- so far\n{plain}", wrong.join(", ")));
            }
        }
    }
    Ok(compared)
}

/// Work offsets, and tools of which some have a length.
fn setup(dialect: &Dialect) -> Setup {
    let named = (54..60).map(|code| format!("G{code}")).chain(["G500".to_owned()]);
    let numbered = (1..20).flat_map(|number| [format!("G15H{number}"), format!("G54.1P{number}")]);
    let offset = |(index, name): (usize, String)| (name, [100.0, 80.0 + index as f64, 40.0]);
    Setup {
        work_offsets: named.chain(numbered).enumerate().map(offset).collect(),
        tools: (1..100).map(|number| (number, [0.0, 0.0, f64::from(number % 3)])).collect(),
        noses_mm: (1..100).map(|number| (number, 0.4)).collect(),
        edge_at_change: Some(1),
        diameters: dialect.turning.as_ref().and_then(|turning| turning.diameters),
        ..Setup::default()
    }
}

/// Every shipped dialect, lathes with each system of G codes.
fn dialects() -> Vec<(String, Dialect)> {
    let mut dialects = Vec::new();
    for name in nc_dialect::builtin_names() {
        let dialect = nc_dialect::builtin(name).expect("shipped");
        if dialect.turning.is_none() {
            dialects.push((name.to_owned(), dialect.clone()));
            continue;
        }
        for system in ["A", "B", "C"].into_iter().filter(|system| *system == "A" || name == "fanuc-lathe") {
            let dialect = dialect.in_system(system).unwrap_or_else(|| dialect.clone());
            dialects.push((format!("{name} {system}"), with_parameters(dialect)));
        }
    }
    dialects
}

/// A lathe whose control's parameters are known.
fn with_parameters(mut dialect: Dialect) -> Dialect {
    let turning = dialect.turning.as_mut().expect("a lathe");
    turning.diameters = Some(true);
    turning.cycles = TurningParameters {
        thread_chamfer_leads: Some(0.0),
        roughing_escape_mm: Some(0.5),
        groove_return_mm: Some(0.5),
        drill_pecks: Some(DrillPecks::Full),
        drill_return_mm: Some(0.5),
        drill_r: turning.cycles.drill_r.or(if turning.increments { None } else { Some(DrillR::Place) }),
        bore_return_percent: Some(200.0),
        ..turning.cycles
    };
    dialect
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.filter_map(|entry| entry.ok().map(|entry| entry.path())) {
        if path.is_dir() {
            files(&path, found);
        } else {
            found.push(path);
        }
    }
    found.sort();
}

fn nothing(_: &str) -> std::io::Result<Vec<u8>> {
    Err(std::io::Error::from(std::io::ErrorKind::NotFound))
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[test]
fn after_every_block_of_the_corpus() {
    let (mut compared, mut programs, mut failed) = (0, 0, Vec::new());
    let dialects = dialects();
    let folders = ["tests/corpus", "tests/fuzz/lathes", "samples"].map(|folder| root().join(folder));
    for folder in folders.iter().map(PathBuf::as_path).chain([Path::new("/usr/share/linuxcnc/ncfiles")]) {
        let mut found = Vec::new();
        files(folder, &mut found);
        for path in found.iter().filter(|path| is_program(path)) {
            let shown = path.display().to_string();
            let text = std::fs::read(path).expect("readable");
            if text.len() > 200_000 {
                continue;
            }
            let beside = path.parent().expect("in a folder").to_owned();
            let read = move |name: &str| std::fs::read(beside.join(name));
            let is_of = |name: &str| {
                shown.contains(&format!("/{name}/"))
                    || (name == "linuxcnc" && shown.contains("/linuxcnc/ncfiles"))
            };
            for (name, dialect) in dialects.iter().filter(|(name, _)| {
                let name = name.split(' ').next().unwrap_or(name);
                is_of(name) || shown.contains(&format!("_{name}"))
            }) {
                programs += 1;
                match judged(&text, dialect, &read) {
                    Ok(count) => compared += count,
                    Err(why) => failed.push(format!("{shown} as {name}: {why}")),
                }
            }
        }
    }
    println!("{programs} programs, {compared} beliefs compared");
    assert!(
        failed.is_empty(),
        "{} of {programs}:\n{}",
        failed.len(),
        failed[..failed.len().min(5)].join("\n\n")
    );
    assert!(programs > 900 && compared > 4_000, "{programs} {compared}");
}

fn is_program(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    matches!(ending.as_deref(), Some("nc" | "ngc" | "mpf" | "min" | "tap"))
}

#[test]
fn after_every_block_of_programs_by_chance() {
    let count = std::env::var("VPOST_AGREEMENT").map_or(400, |count| count.parse().expect("a number"));
    let seed = std::env::var("VPOST_FUZZ_SEED").map_or(1, |seed| seed.parse().expect("a number"));
    let dialects = dialects();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (mut compared, mut expanded, mut failed) = (0, 0, Vec::new());
    for index in 0..count {
        let (name, dialect) = &dialects[index % dialects.len()];
        let mut bytes = vec![0; random.random_range(40..400)];
        random.fill(&mut bytes[..]);
        let text = sound(generate::shorthand(&bytes, name).as_bytes(), dialect);
        match judged(&text, dialect, &nothing) {
            Ok(beliefs) => {
                compared += beliefs;
                expanded += usize::from(beliefs > 0);
            }
            Err(why) => failed.push(format!("{index} as {name}: {why}")),
        }
    }
    println!("{count} programs, {expanded} of them with beliefs, {compared} compared");
    assert!(
        failed.is_empty(),
        "{} of {count}:\n{}",
        failed.len(),
        failed[..failed.len().min(3)].join("\n\n")
    );
    assert!(expanded * 4 > count, "only {expanded} of {count} were written out");
}
