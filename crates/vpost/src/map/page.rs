//! The map as one page.

mod tables;

use diagnostic::{Language, Text, both};
use error_map::Plane;
use machine_model::Vector;
use report::body::{Body, Fact, Table};
use report::chart::solid::{Displacement, Solid, Spot, displacements, spots};
use report::chart::{Amounts, Arrow, Slice, View, slices, views};
use report::numbers::{count, digits, number, prose};
use report::page::Page;
use report::scale::nice;
use report::text::opening;

use super::dominant;
use crate::origin::{MACHINE, MODEL, Origin, PROFILE};
use jobs::map::deformation;
use jobs::map::dominant::Dominant;
use jobs::map::study::Study;
use jobs::map::text::second_order_lines;
use tables::{AXES, axes, diagonals, percent2, places, sizes, um, within, within_said, zero_points};

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
    pub origin: Origin,
    /// Deviations, first the one that matters most.
    pub dominant: Vec<Dominant>,
    /// What is doubtful of the profile: signs, orders, units.
    pub doubts: Vec<Text>,
    /// What a corrected program keeps to, µm.
    pub tolerance_um: f64,
}

/// The page.
pub(super) fn html(study: &Study, facts: &Facts, json: &str, language: Language) -> String {
    let title = both!("Error map \u{2013} {}", "Карта погрешностей \u{2014} {}", study.machine);
    let mut page = Page::new(language, title, "map", "vpost.map/1");
    head(&mut page.head, study, facts);
    figures(page.section("figures", both!("How large the error is", "Величина погрешности")), study);
    let makes = both!("What makes it", "Из чего она складывается");
    dominant::section(page.section("deviations", makes), &facts.dominant);
    volume(page.section("volume", both!("The volume", "Рабочий объём")), study);
    vectors(page.section("vectors", both!("Error vectors", "Векторы погрешности")), study);
    slices_of(page.section("slices", both!("Slices", "Сечения")), study);
    let deformation = both!("Stretch, shear and rotation", "Растяжение, сдвиг и поворот");
    deformations(page.section("deformation", deformation), study);
    let many = both!("How many nodes have which error", "Распределение узлов по погрешности");
    sizes(page.section("histogram", many), study);
    axes(page.section("axes", both!("Along the axes", "Вдоль осей")), study);
    diagonals(page.section("diagonals", both!("Body diagonals", "Объёмные диагонали")), study);
    let zero_point = both!("Where to put the zero point", "Куда поставить нулевую точку");
    zero_points(page.section("zero-point", zero_point), study);
    places(page.section("clamp", both!("Where to clamp", "Где закрепить")), study);
    let second = page.section("second-order", both!("Second order of rotations", "Второй порядок поворотов"));
    for line in study.second_order.iter().flat_map(second_order_lines) {
        let line = opening(&prose(&line));
        second.p(&both!("{line}.", "{line:#}."));
    }
    page.provenance(provenance(study, facts));
    page.into_html(json)
}

fn head(out: &mut Body, study: &Study, facts: &Facts) {
    let (before, after) = (&study.parts[0].figures, &study.parts[0].median().figures);
    let [largest, largest_after] = [before, after].map(|f| um(f.magnitude_mm.high));
    let [rms, rms_after] = [before, after].map(|f| um(f.rms_mm));
    let [share, share_after] = [before, after].map(|f| percent2(f.share_within()));
    let (nodes, within) = (count(before.nodes), within(study));
    out.muted(&both!("Volumetric error map: {}", "Карта объёмных погрешностей: {}", study.machine));
    out.headline(&both!(
        "The tool is up to {largest} \u{b5}m from where it is told to be; with the zero point moved, up to {largest_after} \u{b5}m",
        "Инструмент отстоит от заданного места до {largest:#} мкм; со сдвинутой нулевой точкой — до {largest_after:#} мкм"
    ));
    out.p(&both!(
        "Of {nodes} nodes {share} are within {within} \u{b5}m as it is, {share_after} after the zero point is moved by the geometric median. Mean (RMS) error {rms} \u{b5}m before, {rms_after} \u{b5}m after.",
        "Узлов {nodes:#}: в пределах {within:#} мкм сейчас {share:#}, после сдвига нулевой точки на геометрическую медиану {share_after:#}. Среднее квадратическое значение (СКЗ) погрешности: {rms:#} мкм до, {rms_after:#} мкм после."
    ));
    if let Some(makes) = dominant::sentence(&facts.dominant) {
        out.p(&makes);
    }
    out.p(&next_step(study, facts));
    for doubt in &facts.doubts {
        out.warning(&both!("Doubtful: ", "Сомнительно: "), &prose(doubt));
    }
    out.muted(&facts.origin.said());
}

/// What to do, and what it will bring.
fn next_step(study: &Study, facts: &Facts) -> Text {
    let tolerance = number(facts.tolerance_um);
    if study.parts[0].figures.magnitude_mm.high <= study.asked.within_mm {
        return both!(
            "All of it is within what is asked: programs may stay as they are.",
            "Всё в пределах заданного: программы можно не исправлять."
        );
    }
    let [x, y, z] = <[f64; 3]>::from(study.parts[0].median().shift_mm).map(|mm| number(mm * 1e3));
    both!(
        "What to do: correct programs with this profile. Their paths then stay within {tolerance} \u{b5}m of what is programmed, as far as the model knows the machine. Without correction: the machine is off by X {x}, Y {y}, Z {z} \u{b5}m on the average, and a moved zero point takes that away.",
        "Что делать: исправлять программы по этому профилю. Траектория будет в пределах {tolerance:#} мкм от заданной — насколько модель знает станок. Без исправления: станок в среднем отходит на X {x:#}, Y {y:#}, Z {z:#} мкм, и сдвиг нулевой точки это снимает."
    )
}

fn figures(out: &mut Body, study: &Study) {
    out.p(&both!(
        "In \u{b5}m. Ranges per axis are those of ISO 230-1 for the volumetric accuracy of three linear axes; the others are of the length of the error.",
        "В мкм. Размах по каждой оси — тот, что в ISO 230-1 определяет объёмную точность трёх линейных осей; остальное относится к длине вектора погрешности."
    ));
    let mut table = Table::of(study.parts.iter().map(|part| (&part.name, &part.figures)))
        .words(both!("part", "часть"), |(name, _)| (*name).clone())
        .numbers(both!("nodes", "узлов"), |(_, f)| count(f.nodes));
    for (k, axis) in AXES.into_iter().enumerate() {
        let range = both!("range {axis}", "размах {axis}");
        table = table.numbers(range, |(_, f)| um(f.component_mm[k].high - f.component_mm[k].low));
    }
    let table = table
        .numbers(both!("RMS", "СКЗ"), |(_, f)| um(f.rms_mm))
        .numbers(Text::same("95 %"), |(_, f)| um(f.p95_mm))
        .numbers(both!("least", "наим."), |(_, f)| um(f.magnitude_mm.low))
        .numbers(both!("largest", "наиб."), |(_, f)| um(f.magnitude_mm.high))
        .numbers(within_said(study), |(_, f)| percent2(f.share_within()));
    out.table(&table);
}

/// What a field does to small boxes of commands.
fn deformations(out: &mut Body, study: &Study) {
    let Some(figures) = deformation::figures(&study.cells) else { return };
    let cells = count(study.cells.len());
    out.p(&both!(
        "The Jacobian of the field in the middle of each of {cells} cells of the grid. Shear: by how much the right angle between two axes is smaller there. Rotation is that of a small box of commands; how the tool turns, a field does not say. All cells are in the files of --csv and --vtk.",
        "Матрица Якоби поля в середине каждой ячейки сетки (ячеек {cells:#}). Сдвиг — на сколько там меньше прямой угол между двумя осями. Поворот — малого объёма заданных точек; как поворачивается инструмент, поле не говорит. Все ячейки есть в файлах --csv и --vtk."
    ));
    let table = Table::of(figures.iter().enumerate())
        .words(both!("of a cell", "в ячейке"), |(which, _)| deformation::WORDS[*which].clone())
        .words(both!("unit", "единица"), |(which, _)| prose(&deformation::unit(*which)))
        .numbers(both!("least", "наименьшее"), |(_, (range, _))| digits(range.low, 2))
        .numbers(both!("largest", "наибольшее"), |(_, (range, _))| digits(range.high, 2))
        .numbers(both!("RMS", "СКЗ"), |(_, (_, rms))| digits(*rms, 2));
    out.table(&table);
}

/// Colours by the tolerance: what is within it, and how far the rest goes.
fn amounts<'a>(study: &Study, within: &'a Text) -> Amounts<'a> {
    let largest = study.parts[0].figures.magnitude_mm.high * 1e3;
    Amounts { largest, within: Some((study.asked.within_mm * 1e3, within)) }
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

fn volume(out: &mut Body, study: &Study) {
    let nodes = spread(study, SPOTS);
    let within = within_said(study);
    let (drawn, all) = (count(nodes.len()), count(study.map.grid().len()));
    let drawings = [
        (
            both!("Error over the volume, as it is", "Погрешность в рабочем объёме, как есть"),
            Vector::zeros(),
            both!(
                "As it is: {drawn} of {all} nodes, coloured by the length of the error; green and hollow: {within}.",
                "Как есть: узлов {drawn:#} из {all:#}, цвет — длина вектора погрешности; зелёные пустые: {within:#}."
            ),
        ),
        (
            both!(
                "Error over the volume, zero point moved",
                "Погрешность в рабочем объёме, нулевая точка сдвинута"
            ),
            study.parts[0].median().shift_mm,
            both!(
                "The same with the zero point moved by the geometric median, in the same colours.",
                "То же со сдвигом нулевой точки на геометрическую медиану, в тех же цветах."
            ),
        ),
    ];
    for (title, shift, caption) in drawings {
        let spot = |index: &usize| Spot {
            at: study.map.grid().place_mm(*index).into(),
            value: (study.map.errors_mm()[*index] - shift).norm() * 1e3,
        };
        let all: Vec<Spot> = nodes.iter().map(spot).collect();
        out.figure(&spots(out.language(), &title, solid(study), &all, &amounts(study, &within)), &caption);
    }
}

fn vectors(out: &mut Body, study: &Study) {
    let shift = study.parts[0].median().shift_mm;
    let size = solid(study).ranges.map(|(low, high)| high - low).into_iter().fold(0.0, f64::max);
    let largest = study.parts[0].figures.magnitude_mm.high;
    // The longest arrow is an eighth of the volume; the magnification is a round number below that.
    let magnification = if largest > 0.0 { nice(0.6 * size / (8.0 * largest)) } else { 1.0 };
    let displacement = |index: usize| {
        let error = study.map.errors_mm()[index];
        Displacement {
            at: study.map.grid().place_mm(index).into(),
            before: (error * magnification).into(),
            after: ((error - shift) * magnification).into(),
        }
    };
    let all: Vec<Displacement> = spread(study, ARROWS).into_iter().map(displacement).collect();
    let title = both!("Error vectors", "Векторы погрешности");
    let times = number(magnification);
    out.figure(
        &displacements(out.language(), &title, solid(study), &all, magnification),
        &both!(
            "From where the tool is told to be (dots) to where it is, {times} times as long as in truth; before and after the zero point is moved by the geometric median.",
            "От заданного места инструмента (точки) к действительному, увеличение {times:#}\u{d7}; до и после сдвига нулевой точки на геометрическую медиану."
        ),
    );
    let title = both!(
        "Error vectors from above, from the front and from the side",
        "Векторы погрешности сверху, спереди и сбоку"
    );
    out.figure(
        &views(out.language(), &title, &views_of(study, &shift, magnification), magnification),
        &both!(
            "The same from above, from the front and from the side: nodes in the middle of the third axis.",
            "То же сверху, спереди и сбоку: узлы в середине третьей оси."
        ),
    );
}

/// From above, from the front, from the side.
fn views_of(study: &Study, shift: &Vector, magnification: f64) -> Vec<View> {
    let grid = study.map.grid();
    let ([nx, ny, _], ranges) = (grid.counts(), solid(study).ranges);
    let view = |[right, up, normal]: [usize; 3]| {
        let mut arrows = Vec::new();
        for row in thinned(grid.counts()[up], ARROWS) {
            for column in thinned(grid.counts()[right], ARROWS) {
                let mut at = [0; 3];
                (at[right], at[up], at[normal]) = (column, row, grid.counts()[normal] / 2);
                let index = at[0] + nx * (at[1] + ny * at[2]);
                let (place, error) = (grid.place_mm(index), study.map.errors_mm()[index]);
                let seen = |v: Vector| (v[right], v[up]);
                arrows.push(Arrow {
                    at: seen(place),
                    before: seen(error * magnification),
                    after: seen((error - shift) * magnification),
                });
            }
        }
        View { axes: [AXES[right], AXES[up]], ranges: [ranges[right], ranges[up]], arrows }
    };
    [[0, 1, 2], [0, 2, 1], [1, 2, 0]].map(view).to_vec()
}

fn slices_of(out: &mut Body, study: &Study) {
    let grid = study.map.grid();
    let [nx, ny, _] = grid.counts();
    let ranges = solid(study).ranges;
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
            let (axis, place) = (AXES[normal], digits(grid.axes()[normal].places_mm()[layer], 0));
            let own = |row: &usize| columns.iter().map(|column| value(*row, *column)).collect::<Vec<_>>();
            all.push(Slice {
                title: both!("{} at {axis} {place} mm", "{} при {axis} {place:#} мм", plane.name()),
                axes: [AXES[right], AXES[up]],
                ranges: [ranges[right], ranges[up]],
                cells: [columns.len(), rows.len()],
                values: rows.iter().flat_map(own).collect(),
            });
        }
    }
    let title = both!("Slices through the volume", "Сечения рабочего объёма");
    let within = within_said(study);
    out.figure(
        &slices(out.language(), &title, &all, &amounts(study, &within)),
        &both!(
            "Length of the error as it is, one scale for all slices; green: {within}. A cell is a node; of large grids some are left out in the drawing. All nodes are in the file of --csv.",
            "Длина вектора погрешности, как есть; шкала для всех сечений одна, зелёным — {within:#}. Клетка — узел; у крупных сеток часть узлов на рисунке пропущена. Все узлы есть в файле --csv."
        ),
    );
}

fn provenance(study: &Study, facts: &Facts) -> Vec<Fact> {
    let vector = |v: &Vector| Text::join(&v.iter().map(|v| digits(*v, 3)).collect::<Vec<_>>(), " ");
    let axis = |(axis, nodes): (&str, &error_map::Nodes)| {
        let [low, high] = [nodes.range_mm().low, nodes.range_mm().high].map(|v| digits(v, 3));
        let count = nodes.places_mm().len();
        both!(
            "{axis} {low} to {high} mm, {count} nodes. ",
            "{axis} от {low:#} до {high:#} мм, узлов {count}. "
        )
    };
    let grid: Vec<Text> = AXES.into_iter().zip(study.map.grid().axes()).map(axis).collect();
    let (machine, chain, tool) = (&study.machine, &facts.chain, vector(&study.asked.tool_mm));
    let angles = vector(&study.asked.rotary_rad.map(f64::to_degrees));
    let mut all = vec![
        Fact::new(MACHINE, &both!("{machine}, chain {chain}", "{machine}, цепь {chain}")),
        Fact::file(PROFILE, &facts.profile, Some(facts.profile_hash.clone())),
        Fact::same(MODEL, study.engine.name()),
        Fact::new(both!("grid", "сетка"), &Text::join(&grid, "")),
        Fact::new(both!("tool vector", "вектор инструмента"), &both!("{tool} mm", "{tool:#} мм")),
        Fact::new(both!("rotary axes", "поворотные оси"), &both!("{angles}\u{b0}", "{angles:#}\u{b0}")),
    ];
    all.extend(facts.options.iter().map(|(name, value)| Fact::same(Text::same(*name), value)));
    all.extend(facts.origin.facts());
    all
}
