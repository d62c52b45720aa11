//! Inputs made to exhaust: each is refused soon, in bounded memory, through the command.
//!
//! The bounds here are for a debug build on a busy machine. The second that users are promised is measured on the
//! release build: `VPOST_HOSTILE_SECONDS=1 cargo test --release -p vpost --test hostile -- --nocapture --test-threads=1`.

mod common;

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use common::vpost;

const PROFILE: &str = "tests/profiles/corpus.toml";
const HEAD: &str = "G17 G21 G40 G49 G54 G80 G90\nG0 X10. Y10. Z60.\n";
/// Peak memory of a refusal, MB: the flat program may grow to 64 MB, three times, beside the input.
const LARGEST_MB: u64 = 400;

fn longest() -> Duration {
    let seconds = std::env::var("VPOST_HOSTILE_SECONDS").ok().and_then(|text| text.parse().ok());
    Duration::from_secs_f64(seconds.unwrap_or(60.0))
}

/// How a run ended.
struct Ended {
    status: Option<i32>,
    said: String,
    took: Duration,
    peak_mb: Option<u64>,
}

/// Peak memory so far, where the system tells (Linux).
fn peak_mb(child: &Child) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().trim_end_matches(" kB").parse::<u64>().ok().map(|kb| kb / 1024)
}

/// Runs the command with `feed` writing its standard input, and watches its memory.
fn ended(arguments: &[&str], feed: impl FnOnce(&mut dyn Write) + Send) -> Ended {
    let start = Instant::now();
    let mut child = vpost()
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command starts");
    let mut input = child.stdin.take().expect("a pipe");
    let mut output = BufReader::new(child.stdout.take().expect("a pipe"));
    let mut messages = child.stderr.take().expect("a pipe");
    std::thread::scope(|scope| {
        scope.spawn(move || feed(&mut input));
        let said = scope.spawn(move || {
            let mut said = String::new();
            messages.read_to_string(&mut said).map(|_| said).expect("UTF-8")
        });
        let written = scope.spawn(move || output.fill_buf().map_or(0, <[u8]>::len));
        let mut peak = None;
        let status = loop {
            peak = peak_mb(&child).max(peak);
            if let Some(status) = child.try_wait().expect("a child") {
                break status;
            }
            assert!(start.elapsed() < 2 * longest(), "no end of {arguments:?}");
            std::thread::sleep(Duration::from_millis(2));
        };
        let took = start.elapsed();
        assert_eq!(written.join().expect("a reader"), 0, "a refusal writes no program");
        Ended { status: status.code(), said: said.join().expect("a reader"), took, peak_mb: peak }
    })
}

#[expect(clippy::print_stdout, reason = "the figures that docs/testing.md asks for")]
fn refused(name: &str, ran: &Ended, code: &str) {
    println!("{name}: {code} after {:.3} s, {} MB", ran.took.as_secs_f64(), ran.peak_mb.unwrap_or_default());
    let said: String = ran.said.chars().take(600).collect();
    assert_eq!(ran.status, Some(1), "{name}: {said}");
    assert!(ran.said.starts_with(&format!("error[{code}")), "{name}: {said}");
    assert!(ran.said.len() < 10_000, "{name}: a message of {} bytes", ran.said.len());
    assert!(ran.took < longest(), "{name}: {:?}", ran.took);
    assert!(ran.peak_mb.is_none_or(|mb| mb < LARGEST_MB), "{name}: {:?} MB", ran.peak_mb);
}

fn program_refused(name: &str, dialect: &str, text: &str, code: &str) {
    let ran = ended(&["-", "-m", PROFILE, "-d", dialect], |input| {
        // The command may have seen enough.
        let _ = input.write_all(text.as_bytes());
    });
    refused(name, &ran, code);
}

#[test]
fn a_line_of_a_gigabyte() {
    // From a pipe …
    let ran = ended(&["-", "-m", PROFILE, "-d", "fanuc"], |input| {
        let part = b"G1 X1. ".repeat(10_000);
        let mut written = 0_u64;
        while written < 1 << 30 && input.write_all(&part).is_ok() {
            written += part.len() as u64;
        }
    });
    refused("a line of a gigabyte, piped", &ran, "VP0106");
    // … and from a file: a sparse one, of digits first and of NULs to the end.
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("long.nc");
    let mut file = std::fs::File::create(&path).expect("writable");
    file.write_all(&b"G1 X1. ".repeat(300_000)).expect("writable");
    file.set_len(1 << 30).expect("sparse files");
    drop(file);
    let ran = ended(&[path.to_str().expect("a plain path"), "-m", PROFILE, "-d", "fanuc"], |_| {});
    refused("a line of a gigabyte, in a file", &ran, "VP0106");
}

#[test]
fn a_million_nested_brackets() {
    let deep = |count: usize| format!("{HEAD}G1 X{}1{} F200.\nM30\n", "[".repeat(count), "]".repeat(count));
    for dialect in ["fanuc", "linuxcnc"] {
        program_refused("a million nested brackets", dialect, &deep(1_000_000), "VP0106");
        // As many as a block may hold.
        program_refused("thirty thousand nested brackets", dialect, &deep(30_000), "VP0120");
        let spread = format!("{HEAD}{}M30\n", format!("G1 X{}1\n", "[".repeat(1_000)).repeat(1_000));
        program_refused("a million brackets in a thousand blocks", dialect, &spread, "VP01");
    }
    let comment = format!("{HEAD}{}{}\nM30\n", "(".repeat(1_000_000), ")".repeat(1_000_000));
    program_refused("a million nested comments", "linuxcnc", &comment, "VP0106");
}

#[test]
fn calls_that_multiply() {
    let bodies = |last: u32| -> String {
        (2..last).map(|n| format!("O{n}\nG1 X{n}0. F200.\nM98 P{} L99\nM99\n", n + 1)).collect()
    };
    let ten = format!("{HEAD}M98 P2 L99\nM30\n{}O10\nG1 X1. F200.\nM99\n", bodies(10));
    program_refused("99 to the power of nine calls", "fanuc", &ten, "VP013");
    let words: String = (2..10)
        .map(|n| format!("o{} sub\n{}o{} endsub\n", n + 1, format!("o{n} call\n").repeat(99), n + 1))
        .collect();
    let words = format!("o2 sub\nG1 X1 F200\no2 endsub\n{words}{HEAD}o10 call\nM2\n");
    program_refused("99 to the power of eight calls", "linuxcnc", &words, "VP013");
    let long = format!("{HEAD}o1 repeat [1000000]\n({})\no1 endrepeat\nM2\n", "x".repeat(60_000));
    program_refused("sixty gigabytes of comments", "linuxcnc", &long, "VP0131");
}

#[test]
fn a_loop_of_a_million_million_turns() {
    let turns = "1000000000000";
    let fanuc = format!("{HEAD}#1=0\nWHILE[#1LT{turns}]DO1\nG1 X[20+#1] F200.\n#1=#1+1\nEND1\nM30\n");
    program_refused("a loop of 10^12 turns that move", "fanuc", &fanuc, "VP013");
    let idle = format!("{HEAD}#1=0\nWHILE[#1LT{turns}]DO1\n#1=#1+1\nEND1\nM30\n");
    program_refused("a loop of 10^12 turns", "fanuc", &idle, "VP0130");
    let repeat = format!("{HEAD}o1 repeat [{turns}]\n#1=1\no1 endrepeat\nM2\n");
    program_refused("a repeat of 10^12 turns", "linuxcnc", &repeat, "VP0130");
    program_refused("a jump to itself", "fanuc", &format!("{HEAD}N1 GOTO1\n"), "VP0130");
    // One block may repeat as well.
    let holes = format!("{HEAD}G91 G81 X0.001 Z-5. R-2. K{turns} F100.\nG80\nM30\n");
    program_refused("a cycle of 10^12 holes", "fanuc", &holes, "VP0");
}

#[test]
fn paths_that_leave_their_folder() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let inside = folder.path().join("inside");
    std::fs::create_dir(&inside).expect("writable");
    let sub = "o<x> sub\nG1 X20 F200\no<x> endsub\nM2\n";
    std::fs::write(folder.path().join("x.ngc"), sub).expect("writable");
    let include = inside.to_str().expect("a plain path").to_owned();
    let calls = |name: &str| {
        let text = format!("{HEAD}o<{name}> call\nM2\n");
        ended(&["-", "-m", PROFILE, "-d", "linuxcnc", "--include", &include], move |input| {
            let _ = input.write_all(text.as_bytes());
        })
    };
    for name in ["../x", "../../x", "/x", "a/../../x", "..\\x"] {
        refused(&format!("a call of {name}"), &calls(name), "VP012");
    }
    links(folder.path(), &inside);
    #[cfg(unix)]
    for name in ["linked", "way/x", "endless"] {
        refused(&format!("a call of {name}"), &calls(name), "VP012");
    }
}

/// A link to a file outside, one to a folder outside, and a device without end.
#[cfg(unix)]
fn links(outside: &Path, inside: &Path) {
    std::os::unix::fs::symlink(outside.join("x.ngc"), inside.join("linked.ngc")).expect("links");
    std::os::unix::fs::symlink(outside, inside.join("way")).expect("links");
    std::os::unix::fs::symlink("/dev/zero", inside.join("endless.ngc")).expect("links");
}
#[cfg(not(unix))]
fn links(_: &Path, _: &Path) {}
