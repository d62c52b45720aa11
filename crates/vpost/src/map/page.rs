//! The map as one page.

use error_map::Plane;
use machine_model::Vector;
use maud::{Markup, html};
use report::chart::solid::{Displacement, Solid, Spot, displacements, spots};
use report::chart::{Curves, Histogram, Slice, curves, histogram, slices};
use report::page::{Page, Section, figure, table};
use report::scale::nice;
use report::text::{number, number_of_digits, percent, shown};

use super::deformation;
use super::drawn::{classes, median};
use super::study::{Part, Study};
use super::text::{freedom_name, proof};

/// Nodes drawn along an axis of the volume, at most: thinned in the drawing, not in the numbers.
const SPOTS: usize = 11;
const ARROWS: usize = 6;
const CELLS: usize = 24;

/// What the page says besides the study.
pub(super) struct Facts {
    pub chain: String,
    pub profile: String,
    pub profile_hash: String,
    /// Conditions and options as they were typed.
    pub options: Vec<(&'static str, String)>,
}

/// The page.
pub(super) fn html(study: &Study, facts: &Facts, json: &str) -> String {
    let mut sections = vec![
        Section { id: "figures", title: "How large the error is", body: figures(study) },
        Section { id: "volume", title: "The volume", body: volume(study) },
        Section { id: "vectors", title: "Error vectors", body: vectors(study) },
        Section { id: "slices", title: "Slices", body: slices_of(study) },
        Section { id: "histogram", title: "How many nodes have which error", body: sizes(study) },
        Section { id: "axes", title: "Along the axes", body: axes(study) },
        Section { id: "diagonals", title: "Body diagonals", body: diagonals(study) },
        Section { id: "zero-point", title: "Where to put the zero point", body: zero_points(study) },
    ];
    if let Some(body) = deformations(study) {
        sections.insert(5, Section { id: "deformation", title: "Stretch, shear and rotation", body });
    }
    if !study.places.is_empty() {
        sections.push(Section { id: "clamp", title: "Where to clamp", body: places(study) });
    }
    if let Some(found) = &study.second_order {
        let body = html! { @for line in super::text::second_order_lines(found) { p { (line) } } };
        sections.push(Section { id: "second-order", title: "Second order of rotations", body });
    }
    sections.push(Section {
        id: "provenance",
        title: "Where this comes from",
        body: provenance(study, facts),
    });
    Page {
        title: &format!("Error map \u{2013} {}", study.machine),
        head: head(study),
        sections,
        json,
        foot: &format!(
            "vpost {} map. This page needs no network, holds no script and is the same for the same files. Its numbers are in it as JSON (vpost.map/1).",
            env!("CARGO_PKG_VERSION")
        ),
    }
    .into_html()
}

fn head(study: &Study) -> Markup {
    let (before, after) = (&study.parts[0].figures, &median(study).figures);
    html! {
        p.muted { "Volumetric error map: " (shown(&study.machine)) }
        h1 {
            "The tool is up to " (um(before.magnitude_mm.high)) " \u{b5}m from where it is told to be; with the zero point moved, up to "
            (um(after.magnitude_mm.high)) " \u{b5}m"
        }
        p {
            "Of " (before.nodes) " nodes " (percent2(before.share_within())) " are within " (within(study)) " \u{b5}m as it is, "
            (percent2(after.share_within())) " after the zero point is moved by the geometric median. Mean (RMS) error "
            (um(before.rms_mm)) " \u{b5}m before, " (um(after.rms_mm)) " \u{b5}m after."
        }
    }
}

fn figures(study: &Study) -> Markup {
    let rows: Vec<Vec<String>> = study
        .parts
        .iter()
        .map(|part| {
            let f = &part.figures;
            let mut row = vec![part.name.clone(), f.nodes.to_string()];
            row.extend(f.component_mm.iter().map(|r| um(r.high - r.low)));
            row.extend([f.rms_mm, f.p95_mm, f.magnitude_mm.low, f.magnitude_mm.high].map(um));
            row.push(percent2(f.share_within()));
            row
        })
        .collect();
    let within = format!("\u{2264} {} \u{b5}m", within(study));
    let header =
        ["part", "nodes", "range X", "range Y", "range Z", "RMS", "95 %", "least", "largest", &within];
    html! {
        p { "\u{b5}m. Ranges per axis are those of ISO 230-1 for the volumetric accuracy of three linear axes; the others are of the length of the error." }
        (table(&header, &[1, 2, 3, 4, 5, 6, 7, 8, 9], &rows))
    }
}

/// What a field does to small boxes of commands.
fn deformations(study: &Study) -> Option<Markup> {
    let figures = deformation::figures(&study.cells)?;
    let rows: Vec<Vec<String>> = figures
        .iter()
        .enumerate()
        .map(|(which, (range, rms))| {
            let unit = if which < 3 { "\u{b5}m/m" } else { "\u{b5}rad" };
            let numbers = [range.low, range.high, *rms].map(|v| number_of_digits(v, 2));
            [deformation::WORDS[which].to_owned(), unit.to_owned()].into_iter().chain(numbers).collect()
        })
        .collect();
    Some(html! {
        p {
            "The Jacobian of the field in the middle of each of " (study.cells.len())
            " cells of the grid. Shear: by how much the right angle between two axes is smaller there. Rotation is that of a small box of commands; how the tool turns, a field does not say. All cells are in the files of --csv and --vtk."
        }
        (table(&["of a cell", "unit", "least", "largest", "RMS"], &[2, 3, 4], &rows))
    })
}

/// Every so many nodes of an axis, ends included.
fn thinned(count: usize, most: usize) -> Vec<usize> {
    let kept = count.min(most);
    (0..kept).map(|k| if kept > 1 { k * (count - 1) / (kept - 1) } else { 0 }).collect()
}

/// Indices of nodes spread over the whole grid.
fn spread(study: &Study, most: usize) -> Vec<usize> {
    let [nx, ny, nz] = study.map.grid().counts();
    let mut all = Vec::new();
    for k in thinned(nz, most) {
        for j in thinned(ny, most) {
            all.extend(thinned(nx, most).into_iter().map(|i| i + nx * (j + ny * k)));
        }
    }
    all
}

fn solid(study: &Study) -> Solid {
    Solid { ranges: study.map.grid().axes().each_ref().map(|n| (n.range_mm().low, n.range_mm().high)) }
}

fn volume(study: &Study) -> Markup {
    let shift = median(study).shift_mm;
    let nodes = spread(study, SPOTS);
    let largest = study.parts[0].figures.magnitude_mm.high * 1e3;
    let drawing = |title: &str, shift: &Vector| {
        let all: Vec<Spot> = nodes
            .iter()
            .map(|index| Spot {
                at: study.map.grid().place_mm(*index).into(),
                value: (study.map.errors_mm()[*index] - shift).norm() * 1e3,
            })
            .collect();
        spots(title, solid(study), &all, largest, "\u{b5}m")
    };
    html! {
        (figure(&drawing("Error over the volume, as it is", &Vector::zeros()),
            &format!("As it is: {} of {} nodes, coloured by the length of the error.", nodes.len(), study.map.grid().len()), None))
        (figure(&drawing("Error over the volume, zero point moved", &shift),
            "The same with the zero point moved by the geometric median, in the same colours.", None))
    }
}

fn vectors(study: &Study) -> Markup {
    let shift = median(study).shift_mm;
    let ranges = solid(study).ranges.map(|(low, high)| high - low);
    let size = ranges.into_iter().fold(0.0, f64::max);
    let largest = study.parts[0].figures.magnitude_mm.high;
    // The longest arrow is an eighth of the volume; the magnification is a round number below that.
    let magnification = if largest > 0.0 { nice(0.6 * size / (8.0 * largest)) } else { 1.0 };
    let all: Vec<Displacement> = spread(study, ARROWS)
        .into_iter()
        .map(|index| {
            let error = study.map.errors_mm()[index];
            Displacement {
                at: study.map.grid().place_mm(index).into(),
                before: (error * magnification).into(),
                after: ((error - shift) * magnification).into(),
            }
        })
        .collect();
    let drawing = displacements("Error vectors", solid(study), &all, magnification);
    figure(
        &drawing,
        &format!(
            "From where the tool is told to be (dots) to where it is, {} times as long as in truth; before and after the zero point is moved by the geometric median.",
            number(magnification)
        ),
        None,
    )
}

fn slices_of(study: &Study) -> Markup {
    let grid = study.map.grid();
    let [nx, ny, _] = grid.counts();
    let largest = study.parts[0].figures.magnitude_mm.high * 1e3;
    let mut all = Vec::new();
    for plane in Plane::ALL {
        let normal = plane.normal();
        let (right, up) = if normal == 0 { (1, 2) } else { (0, if normal == 1 { 2 } else { 1 }) };
        for layer in thinned(grid.counts()[normal], 3) {
            let columns = thinned(grid.counts()[right], CELLS);
            let rows = thinned(grid.counts()[up], CELLS);
            let value = |row: usize, column: usize| {
                let mut at = [0; 3];
                (at[normal], at[right], at[up]) = (layer, column, row);
                let index = at[0] + nx * (at[1] + ny * at[2]);
                Some(study.map.errors_mm()[index].norm() * 1e3)
            };
            let range = |axis: usize| (grid.axes()[axis].range_mm().low, grid.axes()[axis].range_mm().high);
            let place = grid.axes()[normal].places_mm()[layer];
            all.push(Slice {
                title: format!("{} at {} {} mm", plane.name(), AXES[normal], number_of_digits(place, 0)),
                axes: [AXES[right], AXES[up]],
                ranges: [range(right), range(up)],
                cells: [columns.len(), rows.len()],
                values: rows
                    .iter()
                    .flat_map(|row| columns.iter().map(move |column| (*row, *column)))
                    .map(|(row, column)| value(row, column))
                    .collect(),
            });
        }
    }
    let drawing = slices("Slices through the volume", &all, largest, "\u{b5}m");
    figure(
        &drawing,
        "Length of the error as it is, one scale for all slices. A cell is a node; of large grids some are left out in the drawing. All nodes are in the file of --csv.",
        None,
    )
}

const AXES: [&str; 3] = ["X", "Y", "Z"];

fn sizes(study: &Study) -> Markup {
    let found = classes(study);
    let width = found.width_mm * 1e3;
    let rows: Vec<Vec<String>> = found
        .before
        .iter()
        .zip(&found.after)
        .enumerate()
        .map(|(k, (before, after))| {
            let end = |k: usize| number(width * k as f64);
            vec![end(k), end(k + 1), before.to_string(), after.to_string()]
        })
        .collect();
    let drawn =
        Histogram { largest: width * found.before.len() as f64, before: found.before, after: found.after };
    let limit = Some((study.within_mm * 1e3, "within"));
    let drawing = histogram(
        "Nodes by the size of their error",
        &drawn,
        limit,
        "length of the error, \u{b5}m",
        "\u{b5}m",
    );
    let header = ["from, \u{b5}m", "to, \u{b5}m", "before", "after"];
    figure(
        &drawing,
        "Before, and after the zero point is moved by the geometric median.",
        Some(table(&header, &[0, 1, 2, 3], &rows)),
    )
}

fn axes(study: &Study) -> Markup {
    let panels: Vec<Curves> = study
        .curves
        .iter()
        .map(|curve| Curves {
            label: format!("{}, mm, the other axes in the middle of the map", AXES[curve.axis]),
            at: curve.at_mm.clone(),
            values: (0..3).map(|c| curve.errors_mm.iter().map(|e| e[c] * 1e3).collect()).collect(),
        })
        .collect();
    let series = [("s0", "dx"), ("s1", "dy"), ("s2", "dz")];
    figure(
        &curves("Errors along the axes", &panels, &series, "\u{b5}m"),
        "Components of the error, \u{b5}m, while one axis moves. The numbers are in the JSON.",
        None,
    )
}

fn diagonals(study: &Study) -> Markup {
    let panels = [Curves {
        label: "distance along the diagonal, mm".to_owned(),
        at: study.diagonals[0].deviations_mm.iter().map(|row| row[0]).collect(),
        values: study
            .diagonals
            .iter()
            .map(|d| d.deviations_mm.iter().map(|row| row[1] * 1e3).collect())
            .collect(),
    }];
    let names: Vec<String> = study.diagonals.iter().map(|d| signs(d.signs)).collect();
    let series: Vec<(&str, &str)> =
        ["s0", "s1", "s2", "s3"].into_iter().zip(names.iter().map(String::as_str)).collect();
    let rows: Vec<Vec<String>> = study
        .diagonals
        .iter()
        .map(|d| {
            let figures = [d.systematic_mm, d.mean_mm, d.reversal_mm, d.length_error_mm].map(um);
            std::iter::once(signs(d.signs)).chain(figures).collect()
        })
        .collect();
    let header = ["diagonal", "systematic E", "mean M", "reversal B", "length error"];
    html! {
        (figure(&curves("Positioning along the body diagonals", &panels, &series, "\u{b5}m"),
            "Deviation forward along each diagonal, \u{b5}m, as an interferometer would read it (ISO 230-6); P and N: whether X, Y, Z run to plus or to minus. Spread between diagonals speaks of squareness, a common slope of scale.", None))
        (table(&header, &[1, 2, 3, 4], &rows))
    }
}

/// `PPN`: positive in X and Y, negative in Z.
fn signs(signs: [i8; 3]) -> String {
    signs.iter().map(|sign| if *sign > 0 { 'P' } else { 'N' }).collect()
}

fn zero_points(study: &Study) -> Markup {
    html! {
        p {
            "The offset to enter is minus the error: the machine goes too far by the error, so the zero point goes back by it. Do this or correct programs, not both."
        }
        @for part in &study.parts { (zero_points_of(study, part)) }
    }
}

fn zero_points_of(study: &Study, part: &Part) -> Markup {
    let figures = |f: &error_map::Statistics| {
        [um(f.rms_mm), um(f.p95_mm), um(f.magnitude_mm.high), percent2(f.share_within())]
    };
    let mut rows = vec![
        std::iter::once("as it is".to_owned())
            .chain([const { String::new() }; 3])
            .chain(figures(&part.figures))
            .collect::<Vec<_>>(),
    ];
    for zero in &part.zero_points {
        let add = zero.to_enter_mm(study);
        let shift = [add.x, add.y, add.z].map(|v| number_of_digits(v, study.decimals()));
        rows.push(
            std::iter::once(zero.kind.name().to_owned()).chain(shift).chain(figures(&zero.figures)).collect(),
        );
    }
    let within = format!("\u{2264} {} \u{b5}m", within(study));
    let header =
        ["answer", "add X, mm", "add Y, mm", "add Z, mm", "RMS, \u{b5}m", "95 %", "largest", &within];
    let chosen = part.zero_points.iter().find(|zero| zero.kind == super::study::Kind::Median);
    html! {
        h3 { (shown(&part.name)) }
        (table(&header, &[1, 2, 3, 4, 5, 6, 7], &rows))
        details {
            summary { "How good these answers are" }
            ul { @for zero in &part.zero_points { li { (proof(zero, part)) } } }
        }
        @if let Some(zero) = chosen.filter(|_| !study.work_offsets.is_empty()) {
            p { "To enter for the geometric median:" }
            dl {
                @for (name, offset) in &study.work_offsets {
                    @let to = Vector::from(*offset) + zero.to_enter_mm(study);
                    dt { (shown(name)) }
                    dd { "X " (number_of_digits(to.x, study.decimals())) " Y " (number_of_digits(to.y, study.decimals()))
                        " Z " (number_of_digits(to.z, study.decimals())) }
                }
            }
        }
    }
}

fn places(study: &Study) -> Markup {
    let rows: Vec<Vec<String>> = study
        .places
        .iter()
        .map(|(freedom, place)| {
            let mut row = vec![freedom_name(*freedom).to_owned()];
            row.extend(
                place
                    .box_mm
                    .iter()
                    .map(|r| format!("{} to {}", number_of_digits(r.low, 1), number_of_digits(r.high, 1))),
            );
            let fit = &place.fit;
            row.extend([fit.before.rms_mm, fit.after.rms_mm, fit.after.magnitude_mm.high].map(um));
            row.extend((-fit.shift_mm).iter().map(|v| number_of_digits(*v, study.decimals())));
            row.extend((-fit.rotation_rad).iter().map(|v| number_of_digits(v * 1e6, 0)));
            row
        })
        .collect();
    let header = [
        "the set-up can",
        "X, mm",
        "Y, mm",
        "Z, mm",
        "RMS before, \u{b5}m",
        "after",
        "largest",
        "add X, mm",
        "add Y",
        "add Z",
        "turn X, \u{b5}rad",
        "turn Y",
        "turn Z",
    ];
    html! {
        p { "Axis commands of the box in which least is left after the set-up did what it can; turns are about its centre." }
        (table(&header, &[4, 5, 6, 7, 8, 9, 10, 11, 12], &rows))
    }
}

fn provenance(study: &Study, facts: &Facts) -> Markup {
    let vector =
        |v: &Vector, d: usize| v.iter().map(|v| number_of_digits(*v, d)).collect::<Vec<_>>().join(" ");
    html! {
        dl {
            dt { "machine" } dd { (shown(&study.machine)) ", chain " (shown(&facts.chain)) }
            dt { "profile and its tables" } dd { (shown(&facts.profile)) " " span.muted { "BLAKE3 " (facts.profile_hash) } }
            dt { "model" } dd { (study.engine.name()) }
            dt { "grid" } dd {
                @for (axis, nodes) in AXES.iter().zip(study.map.grid().axes()) {
                    (axis) " " (number_of_digits(nodes.range_mm().low, 3)) " to " (number_of_digits(nodes.range_mm().high, 3)) " mm, "
                    (nodes.places_mm().len()) " nodes. "
                }
            }
            dt { "tool vector" } dd { (vector(&study.tool_mm, 3)) " mm" }
            dt { "rotary axes" } dd { (vector(&study.rotary_rad.map(f64::to_degrees), 3)) "\u{b0}" }
            @for (name, value) in &facts.options { dt { (name) } dd { (shown(value)) } }
            dt { "made by" } dd { "vpost " (env!("CARGO_PKG_VERSION")) ", vpost.map/1" }
        }
    }
}

fn um(mm: f64) -> String {
    number_of_digits(mm * 1e3, if mm.abs() < 0.0995 { 1 } else { 0 })
}

/// The tolerance as it was typed.
fn within(study: &Study) -> String {
    format!("{}", (study.within_mm * 1e6).round() * 1e-3)
}

/// A share as people compare them: small ones with a decimal.
fn percent2(share: f64) -> String {
    if share < 0.1 { format!("{} %", number_of_digits(100.0 * share, 1)) } else { percent(share) }
}
