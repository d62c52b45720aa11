//! The fuzz targets without libFuzzer: every seed; and where a time is given, mutations of seeds by chance.
//!
//! `VPOST_FUZZ_SECONDS=120` gives a time, `VPOST_FUZZ_SEED=2` other mutations, `VPOST_FUZZ_RUNS=1000` an end,
//! `VPOST_FUZZ_TARGETS=parse,tables` some targets, `VPOST_FUZZ_DIALECT=fanuc-lathe` the seeds of one dialect. What is found is printed
//! with its bytes. The long runs, which learn from coverage: `tests/fuzz/run`.

mod common;
#[path = "fuzz/src/lib.rs"]
#[expect(unreachable_pub, reason = "the fuzz crate uses all of it")]
mod targets;

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use common::{SAMPLES, files, root};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use targets::Outcome;

type Target = fn(&[u8]) -> Option<Outcome>;

const TARGETS: [(&str, Target); 6] = [
    ("parse", |bytes| {
        targets::parse(bytes);
        None
    }),
    ("round_trip", |bytes| Some(targets::round_trip(bytes))),
    ("correct_check", |bytes| Some(targets::correct_check(bytes))),
    ("generated", |bytes| Some(targets::generated(bytes))),
    ("five_axis", |bytes| Some(targets::five_axis(bytes))),
    ("tables", |bytes| {
        targets::tables(bytes);
        None
    }),
];

/// No input takes longer, on a busy machine and without optimisation; in a release build, a hundredth.
const LONGEST: Duration = Duration::from_secs(60);

/// Seeds of the targets that take programs: the letter of the dialect, then the file.
fn programs() -> Vec<Vec<u8>> {
    let mut seeds = Vec::new();
    let mut take = |dialect: &str, path: &std::path::Path| {
        let text = std::fs::read(path).expect("readable");
        let letter = targets::letter(dialect);
        if text.len() < 4000 {
            seeds.push([&[letter][..], &text].concat());
            seeds.push([&[letter.to_ascii_uppercase()][..], &text].concat());
        }
    };
    for dialect in targets::DIALECTS {
        for kind in ["accept", "reject"] {
            let folder = root().join("tests/corpus").join(dialect).join(kind);
            files(&folder, &["nc", "ngc"]).iter().for_each(|path| take(dialect, path));
        }
    }
    SAMPLES.iter().for_each(|(sample, dialect)| take(dialect, &root().join(sample)));
    for dialect in targets::DIALECTS {
        let folder = root().join("tests/fuzz/lathes").join(dialect);
        files(&folder, &["nc"]).iter().for_each(|path| take(dialect, path));
    }
    // What fuzzing found, the smallest program each, with its letter.
    let found = files(&root().join("tests/fuzz/found"), &["txt"]);
    seeds.extend(found.iter().map(|path| std::fs::read(path).expect("readable")));
    if let Ok(dialect) = std::env::var("VPOST_FUZZ_DIALECT") {
        seeds
            .retain(|seed| seed.first().is_some_and(|b| b.to_ascii_lowercase() == targets::letter(&dialect)));
    }
    seeds
}

/// Seeds of the target that takes tables: what they are, then the file.
fn tables() -> Vec<Vec<u8>> {
    let read = |path: &std::path::Path| std::fs::read(path).expect("readable");
    let opening = |bytes: &[u8], lines: usize| {
        bytes.split_inclusive(|byte| *byte == b'\n').take(lines).collect::<Vec<_>>().concat()
    };
    let table = opening(&read(&root().join("tests/profiles/wavy_x.csv")), 6);
    let mut seeds = Vec::new();
    for folder in ["machine-profiles", "tests/profiles"] {
        for path in files(&root().join(folder), &["toml"]) {
            seeds.push([&b"p"[..], &read(&path), b"\0", &table].concat());
        }
    }
    for path in files(&root().join("grammars"), &["toml"]) {
        seeds.push([&b"g"[..], &read(&path)].concat());
    }
    for path in files(&root().join("samples/diagnosis"), &["csv"]) {
        seeds.push(opening(&read(&path), 12));
    }
    seeds
}

/// A seed with some bytes changed, taken out, doubled, or taken from another seed.
fn mutated(seeds: &[Vec<u8>], random: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = seeds[random.random_range(0..seeds.len())].clone();
    for _ in 0..random.random_range(1..6) {
        let at = random.random_range(0..=bytes.len());
        let end = (at + random.random_range(0..24)).min(bytes.len());
        match random.random_range(0..6) {
            0 if at < bytes.len() => bytes[at] = random.random(),
            1 if at < bytes.len() => bytes[at] ^= 1 << random.random_range(0..8),
            2 => drop(bytes.drain(at..end)),
            3 => {
                let part = bytes[at..end].to_vec();
                let to = random.random_range(0..=bytes.len());
                bytes.splice(to..to, part);
            }
            4 => {
                let other = &seeds[random.random_range(0..seeds.len())];
                let from = random.random_range(0..=other.len());
                let part = &other[from..(from + 24).min(other.len())];
                bytes.splice(at..end, part.iter().copied());
            }
            _ => {
                let digit = b"0123456789.-#[]GXYZIJR,%/;( \nUWPQDK"[random.random_range(0..35)];
                bytes.insert(at, digit);
            }
        }
    }
    bytes
}

/// Runs one input; what it broke, with its bytes.
fn tried(name: &str, target: Target, bytes: &[u8]) -> Result<Option<Outcome>, String> {
    let start = Instant::now();
    let result = catch_unwind(AssertUnwindSafe(|| target(bytes)));
    let found = |what: &str| Err(format!("{name}: {what}\ninput: b\"{}\"", bytes.escape_ascii()));
    match result {
        // The hook has printed what it says.
        Err(_) => found("a promise is broken"),
        Ok(_) if start.elapsed() > LONGEST => found("no answer soon enough"),
        Ok(outcome) => Ok(outcome),
    }
}

fn setting(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).map_or(otherwise, |text| text.parse().expect("a whole number"))
}

#[test]
fn seeds_and_their_mutations_keep_every_promise() {
    let time = Duration::from_secs(setting("VPOST_FUZZ_SECONDS", 0)) / TARGETS.len() as u32;
    let most = setting("VPOST_FUZZ_RUNS", u64::MAX);
    let mut found = Vec::new();
    let chosen = std::env::var("VPOST_FUZZ_TARGETS").ok();
    for (name, target) in TARGETS {
        if chosen.as_deref().is_some_and(|chosen| !chosen.split(',').any(|one| one == name)) {
            continue;
        }
        let seeds = if name == "tables" { tables() } else { programs() };
        let mut random = ChaCha8Rng::seed_from_u64(setting("VPOST_FUZZ_SEED", 1));
        let mut outcomes: BTreeMap<String, u64> = BTreeMap::new();
        let start = Instant::now();
        let mut runs = 0_u64;
        while runs < (seeds.len() as u64).max(300) || (runs < most && start.elapsed() < time) {
            let bytes = match (seeds.get(usize::try_from(runs).unwrap_or(usize::MAX)), name) {
                // Each byte is a choice of the generator: any do.
                (_, "generated") => {
                    let mut bytes = vec![0; random.random_range(20..600)];
                    random.fill_bytes(&mut bytes);
                    bytes[0] = b"fflllpFFLLs"[random.random_range(0..11)];
                    bytes
                }
                (_, "five_axis") => {
                    let mut bytes = vec![0; random.random_range(40..700)];
                    random.fill_bytes(&mut bytes);
                    bytes
                }
                (Some(seed), _) => seed.clone(),
                (None, _) => mutated(&seeds, &mut random),
            };
            runs += 1;
            match tried(name, target, &bytes) {
                Ok(outcome) => {
                    *outcomes.entry(outcome.map_or_else(String::new, |o| format!("{o:?}"))).or_default() += 1;
                }
                Err(what) => {
                    found.push(what);
                    if found.len() > 20 {
                        panic!("{} inputs broke a promise:\n{}", found.len(), found.join("\n\n"));
                    }
                }
            }
        }
        println!("{name}: {runs} inputs {outcomes:?}");
        if name == "generated" || name == "five_axis" {
            // A generator of refused programs shows nothing.
            assert!(12 * outcomes.get("Corrected").copied().unwrap_or_default() > runs, "{outcomes:?}");
        }
    }
    assert!(found.is_empty(), "{} inputs broke a promise:\n{}", found.len(), found.join("\n\n"));
}
