//! How fast one program is corrected: made programs, the release build, ratios within one run.

pub(crate) mod batch;
mod budget;
mod measure;
mod programs;

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Context;
use clap::Args;
use machine_profile::Profile;
use nc_dialect::Dialect;
use nc_program::Setup;
use nc_syntax::{Block, Reader};

use crate::markdown::table;
use measure::{Run, in_turn, own_cpu_s, run_anew};
use programs::Spelling;

/// Options of the benchmark.
#[derive(Debug, Args)]
pub(crate) struct Options {
    /// Where the programs and outputs go; they take 2.5 GB.
    #[arg(long)]
    folder: Option<PathBuf>,
    /// Size of the large program, MB.
    #[arg(long, default_value_t = 1000)]
    large: u64,
    /// Size of the small ones, MB.
    #[arg(long, default_value_t = 134)]
    small: u64,
    /// Repetitions, of which the best counts.
    #[arg(long, default_value_t = 3)]
    repeat: usize,
    /// Machine profile.
    #[arg(long, default_value = "machine-profiles/stan_s500.toml")]
    profile: PathBuf,
    /// Only the budget of one block.
    #[arg(long)]
    budget: bool,
}

/// Measures, and returns a page.
pub(crate) fn run_all(options: &Options) -> anyhow::Result<String> {
    let mut text = budget_page(options)?;
    if options.budget {
        return Ok(text);
    }
    let vpost = crate::gap_bench::released()?;
    let own = tempfile::tempdir()?;
    let folder = options.folder.as_deref().unwrap_or(own.path());
    std::fs::create_dir_all(folder)?;
    let small = made(folder, "dense-small.nc", options.small, programs::dense)?;
    let large = made(folder, "dense-large.nc", options.large, programs::dense)?;
    let mixed = made(folder, "mixed-small.nc", options.small, programs::mixed)?;
    let spelt = |name: &str, spelling| {
        made(folder, name, options.small, move |bytes, out| programs::surface(spelling, bytes, out))
    };
    let commented = spelt("commented-small.nc", Spelling::Commented)?;
    let increments = spelt("increments-small.nc", Spelling::Increments)?;
    let one_axis = spelt("one-axis-small.nc", Spelling::OneAxis)?;
    let with_effect = with_effect(&options.profile, folder)?;
    let wall = |kind: &str| {
        let sample = std::fs::read_to_string(format!("samples/five_axis/s_piece_fanuc_{kind}.nc"))?;
        made(folder, &format!("wall-{kind}.nc"), options.small, move |bytes, out| {
            programs::again(&sample, bytes, out)
        })
    };
    let [led, turned] = [wall("tcp")?, wall("axes")?];
    let five_axes = Path::new("samples/profiles/five_axis_table_table.toml");
    let output = folder.join("out.nc");
    let correct_on = |profile: &Path, input: &Path, threads: usize| {
        let mut command = Command::new(&vpost);
        command.arg(input).arg("-o").arg(&output).arg("-m").arg(profile).args(["-d", "fanuc", "-q"]);
        command.env("RAYON_NUM_THREADS", threads.to_string());
        command
    };
    let correct = |input: &Path, threads: usize| correct_on(&options.profile, input, threads);
    let mut copy = Command::new("cp");
    copy.arg(&small).arg(&output);
    let mut kinds = [
        ("`cp`", &small, copy),
        ("dense, 1 thread", &small, correct(&small, 1)),
        ("dense, 2 threads", &small, correct(&small, 2)),
        ("mixed, 1 thread", &mixed, correct(&mixed, 1)),
        ("mixed, 2 threads", &mixed, correct(&mixed, 2)),
        ("dense, large, 2 threads", &large, correct(&large, 2)),
        ("dense with `(c)`, 1 thread", &commented, correct(&commented, 1)),
        ("dense under G91, 1 thread", &increments, correct(&increments, 1)),
        ("one axis a line, 1 thread", &one_axis, correct(&one_axis, 1)),
        ("dense, a machine with an effect, 1 thread", &small, correct_on(&with_effect, &small, 1)),
        ("S-shaped wall, tip led, 1 thread", &led, correct_on(five_axes, &led, 1)),
        ("S-shaped wall, axes, 1 thread", &turned, correct_on(five_axes, &turned, 1)),
    ];
    let least = in_turn(options.repeat.max(1), |_| {
        let mut runs = [Run::default(); 12];
        for (run, (_, _, command)) in runs.iter_mut().zip(&mut kinds) {
            *run = run_anew(command, &output)?;
        }
        Ok(runs)
    })?;
    let tokenizer = tokenizer(&small, options.repeat)?;
    let mut rows = Vec::new();
    // MB per second on the clock, and of processor time.
    let mut speeds = [[0.0; 2]; 12];
    for ((speeds, least), (what, path, _)) in speeds.iter_mut().zip(least).zip(&kinds) {
        let megabytes = path.metadata()?.len() as f64 / 1e6;
        *speeds = [least.wall_s, least.cpu_s].map(|s| megabytes / s);
        let [speed, per_core] = *speeds;
        rows.push(vec![
            (*what).to_owned(),
            format!("{megabytes:.0}"),
            format!("{:.2}", least.wall_s),
            format!("{speed:.0}"),
            format!("{per_core:.0}"),
            format!("{:.2}", per_core / tokenizer),
            format!("{:.0}", least.peak_mib),
        ]);
    }
    let [_, one, two, mixed_one, _, large_two, others @ ..] = speeds;
    text += &format!("\nTokenizer alone (`nc_syntax::Reader`, one thread): {tokenizer:.0} MB/s\n\n");
    text +=
        &table(&["what", "MB", "s", "MB/s", "MB per CPU s", "of the tokenizer per CPU s", "peak MiB"], &rows);
    text += &format!(
        "\nThe second core adds {:.0} % of the first, {:.0} % with the large program; mixed runs at {:.0} % of dense on the \
         clock, {:.0} % per second of processor time.\n",
        (two[0] / one[0] - 1.0) * 100.0,
        (large_two[0] / one[0] - 1.0) * 100.0,
        mixed_one[0] / one[0] * 100.0,
        mixed_one[1] / one[1] * 100.0
    );
    let [commented, increments, one_axis, effect, led, turned] =
        others.map(|speed| speed[1] / one[1] * 100.0);
    text += &format!(
        "Per second of processor time, of dense: with comments {commented:.0} %, under G91 {increments:.0} %, one axis a line \
         {one_axis:.0} %, with an effect {effect:.0} %, five axes with the tip led {led:.0} %, as axis words {turned:.0} \
         %.\n"
    );
    Ok(text)
}

/// The profile with one effect beyond its tables; they are named by where they lie.
fn with_effect(profile: &Path, folder: &Path) -> anyhow::Result<PathBuf> {
    let mut text: toml_edit::DocumentMut = std::fs::read_to_string(profile)?.parse()?;
    let tables = std::fs::canonicalize(profile.parent().unwrap_or(Path::new(".")))?;
    machine_profile::rename_tables(&mut text, &mut |table| tables.join(table).display().to_string());
    let path = folder.join("with-effect.toml");
    let effect = "\n[[effect]]\nid = \"scale.X\"\nscale_um_per_m = 30.0\n";
    std::fs::write(&path, text.to_string() + effect)?;
    Ok(path)
}

/// A program on disk; one that is there with its size is used again.
fn made(
    folder: &Path,
    name: &str,
    megabytes: u64,
    write: impl FnOnce(u64, &mut BufWriter<std::fs::File>) -> std::io::Result<()>,
) -> anyhow::Result<PathBuf> {
    let path = folder.join(name);
    let bytes = megabytes * 1_000_000;
    if path.metadata().is_ok_and(|found| found.len() >= bytes && found.len() < bytes + 100_000) {
        return Ok(path);
    }
    let mut out = BufWriter::new(std::fs::File::create(&path)?);
    write(bytes, &mut out)?;
    out.flush()?;
    Ok(path)
}

/// Megabytes per second of reading words and nothing else, the file in memory.
fn tokenizer(path: &Path, repetitions: usize) -> anyhow::Result<f64> {
    let text = std::fs::read(path)?;
    let dialect = nc_dialect::builtin("fanuc").context("a shipped dialect")?;
    let mut best = f64::INFINITY;
    for _ in 0..repetitions {
        let started = own_cpu_s();
        let mut reader = Reader::new(&text, dialect);
        let mut block = Block::default();
        while reader.next(&mut block) {
            std::hint::black_box(&block);
        }
        best = best.min(own_cpu_s() - started);
    }
    Ok(text.len() as f64 / 1e6 / best)
}

fn budget_page(options: &Options) -> anyhow::Result<String> {
    let mut program = Vec::new();
    programs::dense(8_000_000, &mut program)?;
    let text = std::fs::read_to_string(&options.profile)?;
    let folder = options.profile.parent().unwrap_or(Path::new("."));
    let profile = machine_profile::load(&text, &|table| std::fs::read(folder.join(table)))
        .map_err(|errors| anyhow::anyhow!("{errors:?}"))?;
    let engine = profile.engine(machine_model::EngineId::RigidBody, &Default::default())?;
    let model = engine.path_model().context("rigid-body corrects paths")?;
    let setup = setup(&profile);
    let models = machine_model::Models { axes: model, tip: None };
    let datums = rewrite::Datums::default();
    let dialect = nc_dialect::builtin("fanuc").context("a shipped dialect")?;
    let job = rewrite::Job { provenance: "BENCHMARK", ..job(&profile, dialect, &setup, models, &datums) };
    let budget = budget::measure(&program, &job, options.repeat.max(5))?;
    let rows = |parts: &[(&str, f64)]| -> Vec<Vec<String>> {
        parts.iter().map(|(what, ns)| vec![(*what).to_owned(), format!("{ns:.0}")]).collect()
    };
    let all = budget.parts.last().map_or(0.0, |part| part.1);
    Ok(format!(
        "One block of the dense program has {:.1} bytes; {:.0} MB/s in memory on one thread.\n\n{}\n{}",
        budget.bytes_per_block,
        budget.bytes_per_block * 1e3 / all,
        table(&["part of a block", "ns"], &rows(&budget.parts)),
        table(&["alone", "ns"], &rows(&budget.points))
    ))
}

/// What a profile says of a program's zeros and tools.
pub(crate) fn setup(profile: &Profile) -> Setup {
    Setup {
        work_offsets: profile.work_offsets.clone(),
        tools: profile.tools.clone(),
        default_tool_mm: profile.default_tool_mm,
        has_rotary: profile.has_rotary(),
        rotary_matters: profile.rotary_matters(),
        ..Default::default()
    }
}

/// A correction as the profile has it, of the tip, in micrometres.
pub(crate) fn job<'j>(
    profile: &Profile,
    dialect: &'j Dialect,
    setup: &'j Setup,
    models: machine_model::Models<'j>,
    datums: &'j rewrite::Datums,
) -> rewrite::Job<'j> {
    let own = &profile.correction;
    let options = correction::Options {
        tolerance_mm: own.tolerance_um * 1e-3,
        accept_mm: 5e-3 * own.tolerance_um,
        outside: correction::Outside::Refuse,
        minimum_segment_mm: own.minimum_segment_mm,
        orientation_rad: own.orientation_urad * 1e-6,
        orientation: correction::Orientation::Tip,
    };
    rewrite::Job {
        dialect,
        setup,
        models,
        datums,
        options,
        interpolator: Default::default(),
        path_mode: Default::default(),
        decimals_mm: [3; 3],
        force: false,
        provenance: "",
        guards: rewrite::Guards::None,
        rotary_steps: [(3, 1); 3],
    }
}
