//! A picture for the README: one level of a sample program, its path on the measured machine before and
//! after correction, errors magnified.
//!
//! Everything drawn is computed: the library corrects the program, the interpreter says where the axes are
//! commanded, the profile's rigid-body model where the tool goes.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context, bail};
use clap::Args;
use correction::Curve;
use diagnostic::Diagnostic;
use machine_model::effects::Conditions;
use machine_model::{Command, PathModel};
use machine_profile::Profile;
use nc_dialect::Dialect;
use nc_program::{Interpreter, Setup};
use nc_syntax::{Block, Reader};
use rewrite::Datums;
use toolpath::{Feed, Motion};
use units::math::hypot;

/// Options of the picture.
#[derive(Debug, Args)]
pub(crate) struct Options {
    /// Where it goes.
    #[arg(default_value = "docs/img/plate_before_after.svg")]
    file: std::path::PathBuf,
}

const PROGRAM: &str = "samples/plate_linuxcnc.nc";
const PROFILE: &str = "machine-profiles/stan_s500.toml";
const DIALECT: &str = "linuxcnc";
/// The level drawn, program coordinates, mm; corrected programs leave it by less than the half width.
const LEVEL_MM: f64 = 15.0;
const LEVEL_HALF_WIDTH_MM: f64 = 0.1;
/// How many times larger errors are drawn than the path.
const MAGNIFICATION: f64 = 40.0;
/// Longest step between computed points, mm.
const STEP_MM: f64 = 0.5;
/// The same of the programmed path where distances from it are measured: chords of the smallest arc, of 2 mm, leave it by
/// 0.16 µm.
const FINE_STEP_MM: f64 = 0.05;
const PIXELS_PER_MM: f64 = 3.0;

/// What is drawn ends here: later operations pass the same level again, in thousands of short moves.
const LAST: &[u8] = b"begin operation: Drilling";

/// A feed motion as points of the tool in program coordinates, mm.
struct Stroke {
    /// Where the axes are commanded.
    commanded: Vec<[f64; 3]>,
    /// Where the machine takes the tool.
    real: Vec<[f64; 3]>,
}

/// A machine on which the program's zero was touched.
struct Touched<'m> {
    machine: &'m dyn PathModel,
    datums: Datums,
}

/// One side of the picture.
struct Side<'a> {
    title: &'a str,
    class: &'a str,
    /// Lines in the plane, errors magnified, mm.
    lines: Vec<Vec<[f64; 2]>>,
    /// Largest distance from the programmed path, mm.
    largest_mm: f64,
}

/// Writes the picture; returns what it shows.
pub(crate) fn write(options: &Options) -> anyhow::Result<String> {
    std::fs::write(&options.file, picture()?)
        .with_context(|| format!("cannot write {}", options.file.display()))?;
    Ok(format!("{}\n", options.file.display()))
}

/// The SVG.
pub(crate) fn picture() -> anyhow::Result<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let text = std::fs::read(root.join(PROGRAM))?;
    let folder = root.join("machine-profiles");
    let profile = std::fs::read_to_string(root.join(PROFILE))?;
    let profile = machine_profile::load(&profile, &|table: &str| std::fs::read(folder.join(table)))
        .map_err(|errors| anyhow::anyhow!("{PROFILE}: {errors:?}"))?;
    let dialect = nc_dialect::builtin(DIALECT).context("the dialect is shipped")?;
    let setup = crate::bench::setup(&profile);
    let engine = profile.engine(profile.correction.engine, &Conditions::default())?;
    let machine =
        machine_model::FromDatum::new(engine).ok().context("the profile's engine corrects paths")?;
    let machine = Touched { machine: &machine, datums: Datums::touched(rewrite::TouchTool::default()) };
    let corrected = corrected(&text, &machine, &profile, dialect, &setup)?;
    let before = strokes(&text, &machine, dialect, &setup, STEP_MM)?;
    let after = strokes(&corrected, &machine, dialect, &setup, STEP_MM)?;
    let fine = strokes(&text, &machine, dialect, &setup, FINE_STEP_MM)?;
    let (drawn, programmed) = (commanded(&before), commanded(&fine));
    // As posted, the command is the programmed point; corrected, the nearest programmed point is meant.
    let before = side("As posted", "before", &before, &programmed, |_, commanded| commanded);
    let after = side("Corrected", "after", &after, &programmed, |real, _| nearest(&programmed, real));
    Ok(draw(&drawn, &[before, after]))
}

fn commanded(strokes: &[Stroke]) -> Vec<&[[f64; 3]]> {
    strokes.iter().map(|stroke| &stroke.commanded[..]).collect()
}

/// `meant`: the programmed point that a real and a commanded one belong to.
fn side<'a>(
    title: &'a str,
    class: &'a str,
    strokes: &[Stroke],
    programmed: &[&[[f64; 3]]],
    meant: impl Fn([f64; 3], [f64; 3]) -> [f64; 3],
) -> Side<'a> {
    let mut side = Side { title, class, lines: Vec::new(), largest_mm: 0.0 };
    for stroke in strokes {
        let mut line = Vec::new();
        for (real, commanded) in stroke.real.iter().zip(&stroke.commanded) {
            let foot = nearest(programmed, *real);
            let off: [f64; 3] = std::array::from_fn(|i| real[i] - foot[i]);
            side.largest_mm = side.largest_mm.max(hypot(hypot(off[0], off[1]), off[2]));
            let from = meant(*real, *commanded);
            line.push([0, 1].map(|i| from[i] + MAGNIFICATION * (real[i] - from[i])));
        }
        side.lines.push(line);
    }
    side
}

fn corrected(
    text: &[u8],
    machine: &Touched<'_>,
    profile: &Profile,
    dialect: &Dialect,
    setup: &Setup,
) -> anyhow::Result<Vec<u8>> {
    let models = machine_model::Models { axes: machine.machine, tip: None };
    let job = crate::bench::job(profile, dialect, setup, models, &machine.datums);
    let result = rewrite::correct(text, &job, |line| line, |_| Ok::<(), Vec<Diagnostic>>(()));
    Ok(result.map_err(refused)?.text)
}

#[expect(clippy::needless_pass_by_value, reason = "the form `map_err` asks for")]
fn refused(diagnostics: Vec<Diagnostic>) -> anyhow::Error {
    let words: Vec<String> = diagnostics.iter().map(ToString::to_string).collect();
    anyhow::anyhow!("{PROGRAM}: {}", words.join("; "))
}

/// The feed motions of a program that lie in the level.
fn strokes(
    text: &[u8],
    machine: &Touched<'_>,
    dialect: &Dialect,
    setup: &Setup,
    step_mm: f64,
) -> anyhow::Result<Vec<Stroke>> {
    let mut found = Vec::new();
    let mut interpreter = Interpreter::new(dialect, setup);
    let mut reader = Reader::new(text, dialect);
    let mut block = Block::default();
    while reader.next(&mut block) && !block.bytes.windows(LAST.len()).any(|bytes| bytes == LAST) {
        let step =
            interpreter.step(&block).map_err(|diagnostics| refused(diagnostics.into_iter().collect()))?;
        for motion in &step.motions {
            let Motion::Feed(feed) = motion else { continue };
            let height = |mm: [f64; 3]| step.context.frame.to_program(mm)[2] - LEVEL_MM;
            let ends = [height(feed.start.linear_mm), height(feed.end.linear_mm)];
            if ends.iter().all(|z| z.abs() < LEVEL_HALF_WIDTH_MM) {
                let datum = machine.datums.placement(machine.machine, dialect, &step.context);
                found.push(stroke(feed, (&step.context, datum), machine.machine, step_mm));
            }
        }
        if step.ends_program {
            break;
        }
    }
    if found.is_empty() {
        bail!("{PROGRAM} has no feed motion at Z{LEVEL_MM}");
    }
    Ok(found)
}

fn stroke(
    feed: &Feed,
    (context, datum): (&nc_program::Context, machine_model::Placement),
    model: &dyn PathModel,
    step_mm: f64,
) -> Stroke {
    let curve = Curve::new(feed.start.linear_mm.into(), feed.end.linear_mm.into(), &feed.shape);
    let count = (curve.length_mm() / step_mm).ceil().max(1.0) as usize;
    let mut stroke = Stroke { commanded: Vec::new(), real: Vec::new() };
    for k in 0..=count {
        let commanded = curve.at(k as f64 / count as f64);
        let command =
            Command { linear_mm: commanded, tool_mm: context.tool_mm.into(), datum, ..Default::default() };
        let real = commanded + model.error_mm(&command);
        stroke.commanded.push(context.frame.to_program(commanded.into()));
        stroke.real.push(context.frame.to_program(real.into()));
    }
    stroke
}

/// The nearest point of the programmed lines, mm.
fn nearest(programmed: &[&[[f64; 3]]], point: [f64; 3]) -> [f64; 3] {
    let mut best = (f64::INFINITY, point);
    for pair in programmed.iter().flat_map(|line| line.windows(2)) {
        let (a, b) = (pair[0], pair[1]);
        let along: [f64; 3] = std::array::from_fn(|i| b[i] - a[i]);
        let to: [f64; 3] = std::array::from_fn(|i| point[i] - a[i]);
        let length = dot(along, along);
        let share = if length > 0.0 { (dot(to, along) / length).clamp(0.0, 1.0) } else { 0.0 };
        let foot: [f64; 3] = std::array::from_fn(|i| a[i] + share * along[i]);
        let off: [f64; 3] = std::array::from_fn(|i| point[i] - foot[i]);
        if dot(off, off) < best.0 {
            best = (dot(off, off), foot);
        }
    }
    best.1
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Program coordinates to pixels.
struct Panel {
    left: f64,
    top: f64,
    low: [f64; 2],
    high: [f64; 2],
}

impl Panel {
    fn path(&self, points: &[[f64; 2]]) -> String {
        let pixels: Vec<[f64; 2]> = points
            .iter()
            .map(|mm| {
                let x = self.left + (mm[0] - self.low[0]) * PIXELS_PER_MM;
                [x, self.top + (self.high[1] - mm[1]) * PIXELS_PER_MM]
            })
            .collect();
        let mut data = String::new();
        for (k, [x, y]) in thinned(&pixels).into_iter().enumerate() {
            let _ = write!(data, "{}{x:.1} {y:.1}", if k == 0 { "M" } else { "L" });
        }
        data
    }
}

/// The points that matter at a tenth of a pixel: halves are kept while a point lies off the chord.
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Vec::new() };
    let (dx, dy) = (last[0] - first[0], last[1] - first[1]);
    let length = hypot(dx, dy).max(1e-9);
    let off = |p: &[f64; 2]| ((p[0] - first[0]) * dy - (p[1] - first[1]) * dx).abs() / length;
    let farthest =
        (1..points.len().saturating_sub(1)).max_by(|a, b| off(&points[*a]).total_cmp(&off(&points[*b])));
    match farthest.filter(|at| off(&points[*at]) > 0.1) {
        None => vec![*first, *last],
        Some(at) => {
            let mut kept = thinned(&points[..=at]);
            kept.pop();
            kept.extend(thinned(&points[at..]));
            kept
        }
    }
}

/// Colours that can be read on white and on black; nothing depends on the theme.
const STYLE: &str = "text{font:13px system-ui,sans-serif;fill:#848d97}.title{font-size:15px;font-weight:600}\
path{fill:none;stroke-linejoin:round;stroke-linecap:round}.wanted{stroke:#848d97;stroke-width:3}\
.before{stroke:#e5534b;stroke-width:1.3}.after{stroke:#2da44e;stroke-width:1.3}.bar{stroke:#848d97;stroke-width:2}";

fn draw(programmed: &[&[[f64; 3]]], sides: &[Side<'_>]) -> String {
    const MARGIN_MM: f64 = 5.0;
    let flat: Vec<Vec<[f64; 2]>> =
        programmed.iter().map(|line| line.iter().map(|p| [p[0], p[1]]).collect()).collect();
    let all = || flat.iter().chain(sides.iter().flat_map(|side| &side.lines)).flatten();
    let low = [0, 1].map(|i| all().map(|p| p[i]).fold(f64::INFINITY, f64::min) - MARGIN_MM);
    let high = [0, 1].map(|i| all().map(|p| p[i]).fold(f64::NEG_INFINITY, f64::max) + MARGIN_MM);
    let size = [0, 1].map(|i| (high[i] - low[i]) * PIXELS_PER_MM);
    let (head, foot) = (44.0, 40.0);
    let (width, height) = (size[0] * sides.len() as f64, head + size[1] + foot);
    let indent = MARGIN_MM * PIXELS_PER_MM;
    let mut svg = String::new();
    // Writing to a String cannot fail.
    let _ = write!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
         height=\"{height:.0}\" role=\"img\">\n<title>{PROGRAM} at Z{LEVEL_MM} on the machine of {PROFILE}</title>\n\
         <style>{STYLE}</style>\n"
    );
    for (k, side) in sides.iter().enumerate() {
        let panel = Panel { left: k as f64 * size[0], top: head, low, high };
        let (x, title, class, um) = (panel.left + indent, side.title, side.class, side.largest_mm * 1e3);
        let _ = writeln!(svg, "<text class=\"title\" x=\"{x:.0}\" y=\"20\">{title}</text>");
        let _ = writeln!(svg, "<text x=\"{x:.0}\" y=\"39\">the tool is up to {um:.1} µm off its path</text>");
        // One opacity for all of them: strokes that overlap do not darken.
        svg += "<g opacity=\".55\">\n";
        for line in &flat {
            let _ = writeln!(svg, "<path class=\"wanted\" d=\"{}\"/>", panel.path(line));
        }
        svg += "</g>\n";
        for line in &side.lines {
            let _ = writeln!(svg, "<path class=\"{class}\" d=\"{}\"/>", panel.path(line));
        }
    }
    let y = head + size[1] + 18.0;
    let below = y + 4.5;
    let bars = [
        (indent, 20.0 * PIXELS_PER_MM, "20 mm of path"),
        (indent + 185.0, 0.2 * MAGNIFICATION * PIXELS_PER_MM, "200 µm of error"),
    ];
    for (x, length, words) in bars {
        let _ = writeln!(svg, "<path class=\"bar\" d=\"M{x:.1} {y:.1}h{length:.1}\"/>");
        let _ = writeln!(svg, "<text x=\"{:.1}\" y=\"{below:.1}\">{words}</text>", x + length + 8.0);
    }
    let x = size[0] + indent;
    let words = format!("grey: programmed; colour: real, errors drawn ×{MAGNIFICATION}");
    let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{below:.1}\">{words}</text>\n</svg>");
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_in_docs_is_the_one_that_is_made() {
        assert!(
            include_str!("../../docs/img/plate_before_after.svg")
                == picture().expect("the sample is correctable"),
            "run `cargo run -p xtask -- picture`"
        );
    }

    #[test]
    fn the_nearest_point_lies_on_a_segment() {
        let line: &[[f64; 3]] = &[[0.0; 3], [10.0, 0.0, 0.0], [10.0, 10.0, 0.0]];
        assert_eq!(nearest(&[line], [12.0, 5.0, 1.0]), [10.0, 5.0, 0.0]);
    }

    #[test]
    fn thinning_keeps_corners() {
        let points = [[0.0, 0.0], [1.0, 0.01], [2.0, 0.0], [2.0, 2.0]];
        assert_eq!(thinned(&points), [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]]);
    }
}
