//! The same tables and parameters, read by LinuxCNC's own interpreter.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use control_files::{tool_lengths, work_offsets};

/// LinuxCNC prints four decimals of an inch here.
const PRINTED_MM: f64 = 0.5e-4 * 25.4 + 1e-9;

/// The numbers of each line of the interpreter's that begins so.
fn printed(output: &str, call: &str) -> Vec<Vec<f64>> {
    let of_line = |line: &str| {
        let inside = line.split_once(call)?.1.split(')').next()?;
        let numbers = inside.split([',', ' ']).filter(|part| !part.is_empty());
        numbers.map(|part| part.parse().ok()).collect()
    };
    output.lines().filter_map(of_line).collect()
}

#[test]
fn linuxcnc_reads_the_same() {
    if Command::new("rs274").arg("-h").output().is_err() {
        assert!(std::env::var_os("CI").is_none(), "rs274 of linuxcnc-uspace is missing");
        eprintln!("skipped: rs274 of linuxcnc-uspace is not installed");
        return;
    }
    // Numbers without order, as of any generator.
    let mut state = 7u64;
    let mut next = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((state >> 33) % 200_001) as f64 / 1e4 - 10.0
    };
    let mut table = String::from(";Tool table\nT0 P0 ;no tool\n\n");
    let numbers: Vec<u32> = (1..40).map(|k| k * 7 % 41 + 1).collect();
    for (at, number) in numbers.iter().enumerate() {
        let line = match at % 5 {
            0 => format!("T{number} P{} Z{:+.6} D{:+.4} ;end mill", at + 1, next(), next().abs()),
            1 => format!("t{number}  p{}   z{:.4}  x{:.3} y.25", at + 1, next(), next()),
            2 => format!("T{number} P{} D.5 ; no length", at + 1),
            3 => format!("T{number} P{} X+{} Z-5. I90 J-15 Q2;turned T99 Z9", at + 1, next().abs()),
            _ => format!("Z{:.5} P{} T{number} A1 W2", next(), at + 1),
        };
        // With a space in front of CR LF LinuxCNC passes over the line, and its G43 then ends in an error.
        table += &(line + if at % 3 == 0 { "\r\n" } else { "\n" });
    }
    let mut kept = String::from("5161\t1.000000\n5210\t0.000000\n5211\t3.000000\n5220\t1.000000\n");
    for system in 0..9 {
        for axis in 0..3 {
            let _ = writeln!(kept, "{}\t{:.6}", 5221 + 20 * system + axis, next());
        }
    }
    let mut program = String::from("G20\n");
    for code in ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"] {
        program += &format!("{code}\n");
    }
    for number in &numbers {
        program += &format!("G43 H{number}\n");
    }
    program += "M2\n";

    let folder = std::env::temp_dir().join(format!("vpost-control-files-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("writable");
    let write = |name: &str, text: &str| {
        std::fs::write(folder.join(name), text).expect("writable");
        folder.join(name)
    };
    let [tools, variables, file] = [write("a.tbl", &table), write("a.var", &kept), write("a.ngc", &program)];
    let ran = Command::new("rs274")
        // It keeps its tools under HOME.
        .env("HOME", &folder)
        .args([Path::new("-g"), Path::new("-t"), &tools, Path::new("-v"), &variables, &file])
        .output()
        .expect("it starts");
    let output = String::from_utf8_lossy(&ran.stdout).into_owned();
    let _ = std::fs::remove_dir_all(&folder);

    let lengths = tool_lengths("a.tbl", table.as_bytes(), Some(25.4)).expect("a tool table");
    let theirs = printed(&output, "USE_TOOL_LENGTH_OFFSET(");
    assert_eq!(theirs.len(), numbers.len(), "{output}");
    for (number, theirs) in numbers.iter().zip(theirs) {
        let (_, ours) = lengths.iter().find(|(known, _)| known == number).expect("in the table");
        for axis in 0..3 {
            assert!((ours[axis] - theirs[axis] * 25.4).abs() <= PRINTED_MM, "T{number}: {ours:?} {theirs:?}");
        }
    }
    let offsets = work_offsets("a.var", kept.as_bytes(), 25.4, [false; 3]).expect("parameters");
    // The first is printed at the start, in millimetres.
    let theirs: Vec<Vec<f64>> = printed(&output, "SET_G5X_OFFSET(").into_iter().skip(1).collect();
    let mut seen = [false; 9];
    for line in theirs {
        let system = line[0] as usize - 1;
        let (code, ours) = &offsets[system];
        seen[system] = true;
        for axis in 0..3 {
            assert!((ours[axis] - line[axis + 1] * 25.4).abs() <= PRINTED_MM, "{code}: {ours:?} {line:?}");
        }
    }
    assert_eq!(seen, [true; 9]);
}
