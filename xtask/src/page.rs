//! The command as one file for a browser.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, ensure};

use crate::dist;

/// What the command is compiled for.
const TARGET: &str = "wasm32-wasip1";
/// A program, and the profile of its machine with the tables that this names: for whoever has no file yet.
const PROGRAM: &str = "samples/plate_linuxcnc.nc";
const PROFILE: &str = "machine-profiles/stan_s500.toml";
/// A wrong program may call itself as deep as the reader lets it.
const STACK: [&str; 2] = ["-C", "link-arg=-zstack-size=8388608"];

/// How to make it.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// The page.
    #[arg(long, default_value = "target/page/vpost.html")]
    output: PathBuf,
}

/// Makes the page, and says how large it is.
pub(crate) fn run(options: &Options) -> anyhow::Result<String> {
    write(&options.output)
}

/// Builds the command for a browser, and puts the page together.
pub(crate) fn write(output: &Path) -> anyhow::Result<String> {
    let root = dist::root()?;
    let mut flags = dist::pathless(&root)?;
    flags.extend(STACK.map(str::to_owned));
    let built = Command::new("cargo")
        .args(["build", "--locked", "--quiet", "--profile", "dist", "--package", "vpost", "--target", TARGET])
        .env("CARGO_ENCODED_RUSTFLAGS", flags.join("\u{1f}"))
        .status()
        .context("cargo does not start")?;
    ensure!(
        built.success(),
        "the command cannot be built for {TARGET}: `rustup target add {TARGET}` brings what the compiler lacks"
    );
    let folder = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let module = folder.join(TARGET).join("dist/vpost.wasm");
    let module = std::fs::read(&module).with_context(|| format!("{}: unreadable", module.display()))?;
    let page = page::assembled(&module, &example()?)?;
    if let Some(folder) = output.parent() {
        std::fs::create_dir_all(folder)?;
    }
    std::fs::write(output, &page)?;
    let [page, module] = [page.len(), module.len()].map(|bytes| bytes as f64 / 1e6);
    Ok(format!("{}: {page:.1} MB, the command {module:.1} MB of it unpacked\n", output.display()))
}

/// The example's files by the names that they have for each other.
fn example() -> anyhow::Result<BTreeMap<String, String>> {
    let read = |path: &Path| {
        std::fs::read_to_string(path).with_context(|| format!("{}: unreadable", path.display()))
    };
    let profile = PathBuf::from(PROFILE);
    let text = read(&profile)?;
    let folder = profile.parent().context("a folder")?;
    let mut files = BTreeMap::new();
    for table in text.split('"').filter(|quoted| quoted.ends_with(".csv")) {
        files.insert(table.to_owned(), read(&folder.join(table))?);
    }
    for (path, text) in [(Path::new(PROGRAM), read(Path::new(PROGRAM))?), (&profile, text)] {
        files.insert(path.file_name().context("a name")?.to_string_lossy().into_owned(), text);
    }
    Ok(files)
}
