//! What people install: archives and a Debian package, the same bytes from the same commit.

mod notices;

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, bail, ensure};
use clap::ValueEnum;
use diagnostic::Language;

/// Linux as far back as the C library of December 2012: older than what any supported distribution has.
const LINUX: &str = "x86_64-unknown-linux-gnu.2.17";

/// How to pack.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Rust's name of the machine, where the C library is glibc with its oldest version behind a point.
    #[arg(long, default_value = LINUX)]
    target: String,
    /// Make a Debian package too.
    #[arg(long)]
    deb: bool,
    /// Where everything goes.
    #[arg(long, default_value = "target/packages")]
    folder: PathBuf,
}

impl Options {
    /// What people of most computers take: an archive and a Debian package.
    pub(crate) fn of_this_version(folder: &Path) -> Self {
        Self { target: LINUX.to_owned(), deb: true, folder: folder.to_owned() }
    }
}

/// The project's folder, entered.
pub(crate) fn root() -> anyhow::Result<PathBuf> {
    let root = PathBuf::from(
        crate::house::text_of(Command::new("git").args(["rev-parse", "--show-toplevel"]))?.trim(),
    );
    std::env::set_current_dir(&root)?;
    Ok(root)
}

/// Builds, packs, and says what was made and how large it is.
pub(crate) fn run(options: &Options) -> anyhow::Result<String> {
    let root = root()?;
    let triple = options.target.split('.').next().unwrap_or_default();
    ensure!(
        !options.deb || triple == "x86_64-unknown-linux-gnu",
        "--deb packs for Debian's amd64 and links to its C library: take --target {LINUX}"
    );
    let epoch = epoch()?;
    build(&root, &options.target)?;
    let parts = root.join("target/parts");
    write_parts(&parts, triple, epoch)?;

    let windows = triple.contains("windows");
    let binary = if windows { "vpost.exe" } else { "vpost" };
    let built = root.join("target").join(triple).join("dist").join(binary);
    let name = format!("vpost-{}-{}", env!("CARGO_PKG_VERSION"), triple);
    std::fs::create_dir_all(&options.folder)?;
    let folder = options.folder.canonicalize()?;
    let stage = tempfile::tempdir()?;
    fill(&stage.path().join(&name), &built, binary, &parts)?;
    if windows {
        zip(stage.path(), &name, &folder, epoch)?;
    } else {
        tar(stage.path(), &name, &folder, epoch)?;
    }
    if options.deb {
        run_to_end(
            Command::new("cargo")
                .args([
                    "deb",
                    "--quiet",
                    "--package",
                    "vpost",
                    "--no-build",
                    "--no-strip",
                    "--profile",
                    "dist",
                ])
                .args(["--target", triple, "--output"])
                .arg(&folder)
                .env("SOURCE_DATE_EPOCH", epoch.to_string()),
        )?;
    }
    sums(&folder)
}

/// Seconds since 1970 that all files are from: `SOURCE_DATE_EPOCH`, or when the commit was made.
pub(crate) fn epoch() -> anyhow::Result<u64> {
    let text = match std::env::var("SOURCE_DATE_EPOCH") {
        Ok(text) => text,
        Err(_) => crate::house::text_of(Command::new("git").args(["log", "-1", "--format=%ct"]))?,
    };
    text.trim().parse().with_context(|| format!("SOURCE_DATE_EPOCH: `{}` are no seconds", text.trim()))
}

/// The command, stripped, with no path of this computer in it.
///
/// Zig's C compiler links, for it has every C library that is asked for.
fn build(root: &Path, target: &str) -> anyhow::Result<()> {
    run_to_end(
        Command::new("cargo")
            .args(["zigbuild", "--locked", "--quiet", "--profile", "dist", "--package", "vpost", "--target", target])
            .env("CARGO_ENCODED_RUSTFLAGS", pathless(root)?.join("\u{1f}")),
    )
    .context("`cargo zigbuild` comes with `pip install cargo-zigbuild ziglang`, other targets with `rustup target add`")
}

/// What the compiler is told so that no path of this computer gets into what it makes.
pub(crate) fn pathless(root: &Path) -> anyhow::Result<Vec<String>> {
    let home = std::env::var_os("CARGO_HOME")
        .map(PathBuf::from)
        .or_else(|| std::env::home_dir().map(|home| home.join(".cargo")))
        .context("neither CARGO_HOME nor a home folder")?;
    let mut flags = vec![format!("--remap-path-prefix={}=vpost", root.display())];
    // The registry's folder bears the name of the host that the crates came from.
    for entry in std::fs::read_dir(home.join("registry/src")).into_iter().flatten() {
        flags.push(format!("--remap-path-prefix={}=crates", entry?.path().display()));
    }
    Ok(flags)
}

/// What is made of the command line and of the crates, for archives and Debian package alike.
fn write_parts(parts: &Path, triple: &str, epoch: u64) -> anyhow::Result<()> {
    if parts.exists() {
        std::fs::remove_dir_all(parts)?;
    }
    // Where `man` looks for its reader's language.
    for (folder, language) in [("man/man1", Language::English), ("man/ru/man1", Language::Russian)] {
        let man = parts.join(folder);
        std::fs::create_dir_all(&man)?;
        for page in vpost::manual::pages(language)? {
            std::fs::write(man.join(&page.file), page.text)?;
        }
    }
    let completions = parts.join("completions");
    std::fs::create_dir_all(&completions)?;
    for shell in clap_complete::Shell::value_variants() {
        let file = clap_complete::Generator::file_name(shell, "vpost");
        std::fs::write(completions.join(file), vpost::manual::completions(*shell))?;
    }
    std::fs::write(parts.join("THIRD-PARTY.md"), notices::page(triple)?)?;
    write_debian(parts, epoch)
}

/// What a Debian package has besides: two changelogs and the statement of licences.
fn write_debian(parts: &Path, epoch: u64) -> anyhow::Result<()> {
    let date = crate::house::text_of(Command::new("date").args(["-u", "-R", "-d"]).arg(format!("@{epoch}")))?;
    let version = env!("CARGO_PKG_VERSION");
    let debian = format!(
        "vpost ({version}-1) unstable; urgency=medium\n\n  * Version {version}: see changelog.gz.\n\n -- {}  {}\n",
        maintainer()?,
        date.trim()
    );
    std::fs::write(parts.join("changelog.Debian"), debian)?;
    std::fs::copy("CHANGELOG.md", parts.join("changelog"))?;
    run_to_end(Command::new("gzip").args(["--force", "--no-name", "--best"]).arg(parts.join("changelog")))?;
    let mit = std::fs::read_to_string("LICENSE-MIT")?;
    let copyright = mit.lines().find(|line| line.starts_with("Copyright")).context("LICENSE-MIT: whose?")?;
    // A text inside a field stands one blank in, and a point stands for an empty line.
    let text: Vec<String> =
        mit.lines().map(|line| if line.is_empty() { " .".to_owned() } else { format!(" {line}") }).collect();
    std::fs::write(
        parts.join("copyright"),
        format!(
            "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n\
             Upstream-Name: vpost\n\
             Comment: The crates that are linked in, with their licences: /usr/share/doc/vpost/THIRD-PARTY.md\n\n\
             Files: *\nCopyright: {}\nLicense: Expat or Apache-2.0\n\n\
             License: Expat\n{}\n\n\
             License: Apache-2.0\n On Debian systems the full text of the Apache License, version 2.0,\n\
             \x20is in /usr/share/common-licenses/Apache-2.0.\n",
            copyright.trim_start_matches("Copyright").trim(),
            text.join("\n")
        ),
    )?;
    Ok(())
}

/// Who the Debian package says made it, as `crates/vpost/Cargo.toml` has it.
fn maintainer() -> anyhow::Result<String> {
    let manifest = std::fs::read_to_string("crates/vpost/Cargo.toml")?;
    let line = manifest.lines().find_map(|line| line.strip_prefix("maintainer = \"")?.strip_suffix('"'));
    Ok(line.context("crates/vpost/Cargo.toml: no maintainer")?.to_owned())
}

/// Fills the folder that an archive unpacks to.
fn fill(folder: &Path, built: &Path, binary: &str, parts: &Path) -> anyhow::Result<()> {
    for part in ["man", "completions", "THIRD-PARTY.md"] {
        copy(&parts.join(part), &folder.join(part))?;
    }
    std::fs::copy(built, folder.join(binary)).with_context(|| format!("{}: not built", built.display()))?;
    // What a clone has and a folder of work has not: nothing that lies about is packed.
    let listed = crate::house::text_of(Command::new("git").args(["ls-files", "-z", "--"]).args([
        "README.md",
        "README.ru.md",
        "CHANGELOG.md",
        "LICENSE-APACHE",
        "LICENSE-MIT",
        "docs",
        "machine-profiles",
        "samples",
    ]))?;
    for file in listed.split_terminator('\0') {
        copy(Path::new(file), &folder.join(file))?;
    }
    Ok(())
}

/// Copies a file or a folder, making what is above it.
fn copy(from: &Path, to: &Path) -> anyhow::Result<()> {
    if from.is_dir() {
        for entry in std::fs::read_dir(from)? {
            let name = entry?.file_name();
            copy(&from.join(&name), &to.join(&name))?;
        }
        return Ok(());
    }
    std::fs::create_dir_all(to.parent().context("a file in a folder")?)?;
    std::fs::copy(from, to).with_context(|| format!("{}: cannot be copied", from.display()))?;
    Ok(())
}

/// Packs a folder with one order, owner, time and set of rights, whoever made the files and when.
fn tar(above: &Path, name: &str, to: &Path, epoch: u64) -> anyhow::Result<()> {
    let archive = to.join(format!("{name}.tar"));
    run_to_end(
        Command::new("tar")
            .args(["--create", "--format=ustar", "--sort=name", "--owner=0", "--group=0", "--numeric-owner"])
            .args(["--mode=u=rwX,go=rX".to_owned(), format!("--mtime=@{epoch}")])
            .arg("--file")
            .arg(&archive)
            .arg("--directory")
            .arg(above)
            .arg(name)
            .env("LC_ALL", "C"),
    )?;
    run_to_end(Command::new("gzip").args(["--force", "--no-name", "--best"]).arg(archive))
}

/// The same for Windows, which opens no other archive with a double click.
fn zip(above: &Path, name: &str, to: &Path, epoch: u64) -> anyhow::Result<()> {
    let archive = to.join(format!("{name}.zip"));
    if archive.exists() {
        std::fs::remove_file(&archive)?;
    }
    let time = std::time::UNIX_EPOCH + std::time::Duration::from_secs(epoch);
    let mut files = Vec::new();
    list(&above.join(name), Path::new(name), &mut files)?;
    files.sort();
    for file in &files {
        std::fs::File::options().write(true).open(above.join(file))?.set_modified(time)?;
    }
    run_to_end(
        Command::new("zip")
            .args(["--quiet", "-X", "-9", "-D"])
            .arg(archive)
            .args(files)
            .current_dir(above)
            // The times in it are local ones.
            .env("TZ", "UTC"),
    )
}

/// The files below a folder.
fn list(folder: &Path, name: &Path, files: &mut Vec<PathBuf>) -> anyhow::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let name = name.join(entry.file_name());
        if entry.path().is_dir() {
            list(&entry.path(), &name, files)?;
        } else {
            files.push(name);
        }
    }
    Ok(())
}

/// Writes `SHA256SUMS` of all packages in the folder; says how large they are.
pub(crate) fn sums(folder: &Path) -> anyhow::Result<String> {
    let mut packages: Vec<String> = Vec::new();
    let mut said = String::new();
    for entry in std::fs::read_dir(folder)? {
        let name = entry?
            .file_name()
            .into_string()
            .map_err(|name| anyhow::anyhow!("{}: no UTF-8", name.display()))?;
        if [".tar.gz", ".zip", ".deb", ".whl", ".html"].iter().any(|ending| name.ends_with(ending)) {
            packages.push(name);
        }
    }
    packages.sort();
    let text = crate::house::text_of(Command::new("sha256sum").args(&packages).current_dir(folder))?;
    std::fs::write(folder.join("SHA256SUMS"), &text)?;
    for package in packages {
        let bytes = folder.join(&package).metadata()?.len();
        said += &format!("{package}: {:.1} MB\n", bytes as f64 / 1e6);
    }
    Ok(said)
}

pub(crate) fn run_to_end(command: &mut Command) -> anyhow::Result<()> {
    let name = command.get_program().to_string_lossy().into_owned();
    let status = command.status().with_context(|| format!("{name}: cannot be started"))?;
    if !status.success() {
        bail!("{name}: {status}");
    }
    Ok(())
}
