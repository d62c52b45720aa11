//! The machines that programs are corrected for.

use std::cell::OnceCell;
use std::path::Path;

use vpost::session::Session;

use super::LIMITS;

/// Every shipped dialect, each with the letter that chooses it: small for one machine, capital for the other.
pub const DIALECTS: [&str; 9] = [
    "fanuc",
    "linuxcnc",
    "perspektiva",
    "sinumerik",
    "balt-system",
    "centroid",
    "fanuc-lathe",
    "linuxcnc-lathe",
    "sinumerik-turn",
];
const LETTERS: [u8; 9] = *b"flpsbctmn";

/// For whom a program is corrected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Machine {
    /// Crooked in everything, the place at the start given.
    Crooked,
    /// Backlash, and tables of slopes without jumps.
    Backlash,
    /// Without errors.
    Perfect,
    /// A tilting rotary table, crooked in everything; the tip is corrected.
    Table,
    /// The same; the tool's direction is corrected too.
    Pointed,
    /// A tilting rotary table without errors.
    PerfectTable,
}

/// Dialect and machine of an input, and the rest of it. A first byte that is none of the letters chooses too.
#[must_use]
pub fn split(bytes: &[u8]) -> (&'static str, Machine, &[u8]) {
    let Some((first, rest)) = bytes.split_first() else { return (DIALECTS[0], Machine::Crooked, bytes) };
    let small = first.to_ascii_lowercase();
    let index =
        LETTERS.iter().position(|letter| *letter == small).unwrap_or(usize::from(*first) % LETTERS.len());
    let machine = if first.is_ascii_uppercase() { Machine::Backlash } else { Machine::Crooked };
    (DIALECTS[index], machine, rest)
}

/// The session of a dialect and machine, loaded once.
pub(crate) fn session(dialect: &str, machine: Machine) -> &'static Session {
    thread_local! {
        static LOADED: [OnceCell<&'static Session>; 54] = const { [const { OnceCell::new() }; 54] };
    }
    let row = DIALECTS.iter().position(|known| *known == dialect).expect("a shipped dialect");
    LOADED.with(|loaded| {
        *loaded[6 * row + machine as usize].get_or_init(|| Box::leak(Box::new(load(dialect, machine))))
    })
}

fn load(dialect: &str, machine: Machine) -> Session {
    // From `crates/vpost` and from `tests/fuzz` alike.
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let file = |name: &str| root.join(name).to_str().expect("a plain path").to_owned();
    // Coarse: the number of pieces goes with the root of the tolerance, and shows nothing new.
    let tolerance = ["--tolerance", "4", "-d", dialect];
    let offsets = ["--work-offset", "G54=100,80,40", "--work-offset", "G55=110,75,41"];
    let is_lathe = nc_dialect::builtin(dialect).is_some_and(|dialect| dialect.turning.is_some());
    let options = match machine {
        Machine::Table | Machine::Pointed | Machine::PerfectTable => {
            let (profile, more): (_, &[&str]) = match machine {
                Machine::Table => ("tests/profiles/fuzz_five_axis.toml", &[]),
                Machine::Pointed => ("tests/profiles/five_axis_vectors.toml", &["--orientation", "full"]),
                _ => ("tests/profiles/perfect_five_axis.toml", &[]),
            };
            let profile = file(profile);
            [&["-m", &profile][..], &tolerance, more].concat().into_iter().map(str::to_owned).collect()
        }
        _ if is_lathe => {
            let profile = file(match machine {
                Machine::Crooked => "tests/profiles/lathe.toml",
                Machine::Backlash => "machine-profiles/generic_lathe.toml",
                _ => "tests/profiles/perfect_lathe.toml",
            });
            [&["-m", &profile][..], &tolerance].concat().into_iter().map(str::to_owned).collect()
        }
        Machine::Crooked => {
            let profile = file("tests/profiles/corpus.toml");
            [&["-m", &profile, "--start-at", "100,80,300"][..], &tolerance]
                .concat()
                .into_iter()
                .map(str::to_owned)
                .collect::<Vec<_>>()
        }
        Machine::Backlash => {
            let profile = file("machine-profiles/generic_vmc.toml");
            [&["-m", &profile][..], &tolerance].concat().into_iter().map(str::to_owned).collect()
        }
        Machine::Perfect => {
            let profile = file("machine-profiles/perfect.toml");
            [&["-m", &profile, "--start-at", "100,80,300"][..], &offsets, &tolerance]
                .concat()
                .into_iter()
                .map(str::to_owned)
                .collect()
        }
    };
    let options: Vec<&str> = options.iter().map(String::as_str).collect();
    Session::new(&options, LIMITS).unwrap_or_else(|refusal| panic!("{}", refusal.0))
}

/// The letter that chooses a dialect.
#[must_use]
pub fn letter(dialect: &str) -> u8 {
    DIALECTS.iter().position(|known| *known == dialect).map_or(LETTERS[0], |at| LETTERS[at])
}
