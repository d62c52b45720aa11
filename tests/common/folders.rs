//! Folders of many programs, and what must be true of the outputs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The machine of these tests.
pub(crate) const PROFILE: &str = "machine-profiles/stan_s500.toml";

/// A program of `blocks` lines inside the machine's volume; another for each seed.
pub(crate) fn program(seed: u64, blocks: u64) -> String {
    let mut text =
        format!("%\n(PART {seed})\nG21 G90 G17\nG54\nG43 H1\nT1 M6\nS3000 M3\nG0 X10 Y10 Z30\nG1 Z15 F600\n");
    for k in 0..blocks {
        // A wandering path of plain arithmetic: 0 to 110 mm in X and Y.
        let x = (seed * 7919 + k * 137) % 110_000;
        let y = (seed * 104_729 + k * 211) % 110_000;
        text.push_str(&format!("N{k} G1 X{}.{:03} Y{}.{:03}\n", x / 1000, x % 1000, y / 1000, y % 1000));
    }
    text + "G0 Z30\nM30\n%\n"
}

/// Writes `count` programs into a tree.
pub(crate) fn release(folder: &Path, count: u64, blocks: u64) {
    for seed in 0..count {
        let below = folder.join(["", "op10", "op20/left"][(seed % 3) as usize]);
        std::fs::create_dir_all(&below).expect("a new folder");
        std::fs::write(below.join(format!("part{seed:04}.nc")), program(seed, blocks)).expect("a new file");
    }
}

/// Every file below a folder with its bytes; vpost's own folder apart.
pub(crate) fn tree(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    collect(folder, Path::new(""), &mut found);
    found
}

fn collect(root: &Path, below: &Path, found: &mut BTreeMap<PathBuf, Vec<u8>>) {
    for entry in std::fs::read_dir(root.join(below)).expect("a readable folder") {
        let path = below.join(entry.expect("a readable folder").file_name());
        if path == Path::new(".vpost") {
            continue;
        }
        if root.join(&path).is_dir() {
            collect(root, &path, found);
        } else {
            let bytes = std::fs::read(root.join(&path)).expect("a readable file");
            found.insert(path, bytes);
        }
    }
}

/// Temporaries that lie about in an output folder.
pub(crate) fn temporaries(output: &Path) -> Vec<PathBuf> {
    let folder = output.join(".vpost/tmp");
    std::fs::read_dir(folder)
        .map(|entries| entries.map(|entry| entry.expect("a readable folder").path()).collect())
        .unwrap_or_default()
}

/// Copies a file, or a folder with everything in it.
pub(crate) fn copy(from: &Path, to: &Path) {
    if from.is_dir() {
        std::fs::create_dir_all(to).expect("a new folder");
        for entry in std::fs::read_dir(from).expect("a readable folder") {
            let name = entry.expect("a readable folder").file_name();
            copy(&from.join(&name), &to.join(&name));
        }
    } else {
        std::fs::copy(from, to).expect("a copy");
    }
}
