//! The map as one page.

use diagnostic::{Language, Text, say};
use error_map::Plane;
use machine_model::Vector;
use maud::{Markup, html};
use report::chart::solid::{Displacement, Solid, Spot, displacements, spots};
use report::chart::{Amounts, Arrow, Curves, Histogram, Slice, View, curves, histogram, slices, views};
use report::page::{Page, Section, figure, table};
use report::scale::nice;
use report::text::{MICROMETRES, Numbers, number_of_digits, opening, shown};

use super::deformation;
use super::dominant::{self, Dominant};
use super::drawn::{classes, median};
use super::study::{Part, Study};
use super::text::{freedom_name, proof};
use crate::origin::Origin;

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
    pub doubts: Vec<String>,
    /// What a corrected program keeps to, µm.
    pub tolerance_um: f64,
}

/// The page.
pub(super) fn html(study: &Study, facts: &Facts, json: &str, language: Language) -> String {
    let mut sections = vec![
        Section {
            id: "figures",
            title: Text::pair("How large the error is", "Величина погрешности"),
            body: figures(study, language),
        },
        Section {
            id: "volume",
            title: Text::pair("The volume", "Рабочий объём"),
            body: volume(study, language),
        },
        Section {
            id: "vectors",
            title: Text::pair("Error vectors", "Векторы погрешности"),
            body: vectors(study, language),
        },
        Section {
            id: "slices", title: Text::pair("Slices", "Сечения"), body: slices_of(study, language)
        },
        Section {
            id: "histogram",
            title: Text::pair("How many nodes have which error", "Распределение узлов по погрешности"),
            body: sizes(study, language),
        },
        Section {
            id: "axes",
            title: Text::pair("Along the axes", "Вдоль осей"),
            body: axes(study, language),
        },
        Section {
            id: "diagonals",
            title: Text::pair("Body diagonals", "Объёмные диагонали"),
            body: diagonals(study, language),
        },
        Section {
            id: "zero-point",
            title: Text::pair("Where to put the zero point", "Куда поставить нулевую точку"),
            body: zero_points(study, language),
        },
    ];
    if !facts.dominant.is_empty() {
        sections.insert(
            1,
            Section {
                id: "deviations",
                title: Text::pair("What makes it", "Из чего она складывается"),
                body: dominant::section(&facts.dominant, language),
            },
        );
    }
    let slices = sections.iter().position(|section| section.id == "slices").map_or(0, |at| at + 1);
    if let Some(body) = deformations(study, language) {
        sections.insert(
            slices,
            Section {
                id: "deformation",
                title: Text::pair("Stretch, shear and rotation", "Растяжение, сдвиг и поворот"),
                body,
            },
        );
    }
    if !study.places.is_empty() {
        sections.push(Section {
            id: "clamp",
            title: Text::pair("Where to clamp", "Где закрепить"),
            body: places(study, language),
        });
    }
    if let Some(found) = &study.second_order {
        let body = html! { @for line in super::text::second_order_lines(found, language) { p { (opening(&language.of_terminal(&line))) "." } } };
        sections.push(Section {
            id: "second-order",
            title: Text::pair("Second order of rotations", "Второй порядок поворотов"),
            body,
        });
    }
    sections.push(Section {
        id: "provenance",
        title: Text::pair("Where this comes from", "Откуда эти данные"),
        body: provenance(study, facts, language),
    });
    Page {
        language,
        title: &say!(language, "Error map \u{2013} {}", "Карта погрешностей \u{2014} {}", study.machine),
        head: head(study, facts, language),
        sections,
        json,
        command: "map",
        schema: "vpost.map/1",
    }
    .into_html()
}

fn head(study: &Study, facts: &Facts, language: Language) -> Markup {
    let (before, after) = (&study.parts[0].figures, &median(study).figures);
    let [largest, largest_after] = [before, after].map(|f| um(f.magnitude_mm.high, language));
    let [rms, rms_after] = [before, after].map(|f| um(f.rms_mm, language));
    let [share, share_after] = [before, after].map(|f| percent2(f.share_within(), language));
    let (nodes, within) = (language.count(before.nodes), within(study, language));
    html! {
        p.muted { (say!(language, "Volumetric error map: ", "Карта объёмных погрешностей: ")) (shown(&study.machine)) }
        h1 {
            (say!(
                language,
                "The tool is up to {largest} \u{b5}m from where it is told to be; with the zero point moved, up to {largest_after} \u{b5}m",
                "Инструмент отстоит от заданного места до {largest} мкм; со сдвинутой нулевой точкой — до {largest_after} мкм"
            ))
        }
        p {
            (say!(
                language,
                "Of {nodes} nodes {share} are within {within} \u{b5}m as it is, {share_after} after the zero point is moved by the geometric median. Mean (RMS) error {rms} \u{b5}m before, {rms_after} \u{b5}m after.",
                "Узлов {nodes}: в пределах {within} мкм сейчас {share}, после сдвига нулевой точки на геометрическую медиану {share_after}. Среднее квадратическое значение (СКЗ) погрешности: {rms} мкм до, {rms_after} мкм после."
            ))
        }
        @if let Some(makes) = dominant::sentence(&facts.dominant, language) { p { (shown(&makes)) } }
        p { (next_step(study, facts, language)) }
        @for doubt in &facts.doubts { p { strong { (say!(language, "Doubtful: ", "Сомнительно: ")) } (shown(doubt)) } }
        (facts.origin.line(language))
    }
}

/// What to do, and what it will bring.
fn next_step(study: &Study, facts: &Facts, language: Language) -> String {
    let tolerance = language.number(facts.tolerance_um);
    if study.parts[0].figures.magnitude_mm.high <= study.within_mm {
        return say!(
            language,
            "All of it is within what is asked: programs may stay as they are.",
            "Всё в пределах заданного: программы можно не исправлять."
        );
    }
    let [x, y, z] = median(study).shift_mm.map(|mm| language.number(mm * 1e3)).into();
    say!(
        language,
        "What to do: correct programs with this profile. Their paths then stay within {tolerance} \u{b5}m of what is programmed, as far as the model knows the machine. Without correction: the machine is off by X {x}, Y {y}, Z {z} \u{b5}m on the average, and a moved zero point takes that away.",
        "Что делать: исправлять программы по этому профилю. Траектория будет в пределах {tolerance} мкм от заданной — насколько модель знает станок. Без исправления: станок в среднем отходит на X {x}, Y {y}, Z {z} мкм, и сдвиг нулевой точки это снимает."
    )
}

fn figures(study: &Study, language: Language) -> Markup {
    let rows: Vec<Vec<String>> = study
        .parts
        .iter()
        .map(|part| {
            let f = &part.figures;
            let mut row = vec![part.name.in_language(language).to_owned(), language.count(f.nodes)];
            row.extend(f.component_mm.iter().map(|r| um(r.high - r.low, language)));
            row.extend(
                [f.rms_mm, f.p95_mm, f.magnitude_mm.low, f.magnitude_mm.high].map(|mm| um(mm, language)),
            );
            row.push(percent2(f.share_within(), language));
            row
        })
        .collect();
    let within = within_said(study, language);
    let header = match language {
        Language::English => {
            ["part", "nodes", "range X", "range Y", "range Z", "RMS", "95 %", "least", "largest", &within]
        }
        Language::Russian => {
            ["часть", "узлов", "размах X", "размах Y", "размах Z", "СКЗ", "95 %", "наим.", "наиб.", &within]
        }
    };
    html! {
        p {
            (say!(
                language,
                "In \u{b5}m. Ranges per axis are those of ISO 230-1 for the volumetric accuracy of three linear axes; the others are of the length of the error.",
                "В мкм. Размах по каждой оси — тот, что в ISO 230-1 определяет объёмную точность трёх линейных осей; остальное относится к длине вектора погрешности."
            ))
        }
        (table(language, &header, &[1, 2, 3, 4, 5, 6, 7, 8, 9], &rows))
    }
}

/// What a field does to small boxes of commands.
fn deformations(study: &Study, language: Language) -> Option<Markup> {
    let figures = deformation::figures(&study.cells)?;
    let rows: Vec<Vec<String>> = figures
        .iter()
        .enumerate()
        .map(|(which, (range, rms))| {
            let unit = deformation::unit(which, language).replace('u', "\u{b5}");
            let numbers = [range.low, range.high, *rms].map(|v| language.digits(v, 2));
            let words = deformation::WORDS[which].in_language(language).to_owned();
            [words, unit].into_iter().chain(numbers).collect()
        })
        .collect();
    let cells = language.count(study.cells.len());
    let header = match language {
        Language::English => ["of a cell", "unit", "least", "largest", "RMS"],
        Language::Russian => ["в ячейке", "единица", "наименьшее", "наибольшее", "СКЗ"],
    };
    Some(html! {
        p {
            (say!(
                language,
                "The Jacobian of the field in the middle of each of {cells} cells of the grid. Shear: by how much the right angle between two axes is smaller there. Rotation is that of a small box of commands; how the tool turns, a field does not say. All cells are in the files of --csv and --vtk.",
                "Матрица Якоби поля в середине каждой ячейки сетки (ячеек {cells}). Сдвиг — на сколько там меньше прямой угол между двумя осями. Поворот — малого объёма заданных точек; как поворачивается инструмент, поле не говорит. Все ячейки есть в файлах --csv и --vtk."
            ))
        }
        (table(language, &header, &[2, 3, 4], &rows))
    })
}

/// Colours by the tolerance: what is within it, and how far the rest goes.
fn amounts<'a>(study: &Study, within: &'a str, language: Language) -> Amounts<'a> {
    Amounts {
        largest: study.parts[0].figures.magnitude_mm.high * 1e3,
        within: Some((study.within_mm * 1e3, within)),
        unit: MICROMETRES.in_language(language),
    }
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

fn volume(study: &Study, language: Language) -> Markup {
    let shift = median(study).shift_mm;
    let nodes = spread(study, SPOTS);
    let within = within_said(study, language);
    let amounts = amounts(study, &within, language);
    let drawing = |title: &str, shift: &Vector| {
        let all: Vec<Spot> = nodes
            .iter()
            .map(|index| Spot {
                at: study.map.grid().place_mm(*index).into(),
                value: (study.map.errors_mm()[*index] - shift).norm() * 1e3,
            })
            .collect();
        spots(language, title, solid(study), &all, &amounts)
    };
    let as_it_is =
        say!(language, "Error over the volume, as it is", "Погрешность в рабочем объёме, как есть");
    let moved = say!(
        language,
        "Error over the volume, zero point moved",
        "Погрешность в рабочем объёме, нулевая точка сдвинута"
    );
    let (drawn, all) = (language.count(nodes.len()), language.count(study.map.grid().len()));
    let caption = say!(
        language,
        "As it is: {drawn} of {all} nodes, coloured by the length of the error; green and hollow: {within}.",
        "Как есть: узлов {drawn} из {all}, цвет — длина вектора погрешности; зелёные пустые: {within}."
    );
    let caption_moved = say!(
        language,
        "The same with the zero point moved by the geometric median, in the same colours.",
        "То же со сдвигом нулевой точки на геометрическую медиану, в тех же цветах."
    );
    html! {
        (figure(language, &drawing(&as_it_is, &Vector::zeros()), &caption, None))
        (figure(language, &drawing(&moved, &shift), &caption_moved, None))
    }
}

fn vectors(study: &Study, language: Language) -> Markup {
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
    let title = say!(language, "Error vectors", "Векторы погрешности");
    let drawing = displacements(language, &title, solid(study), &all, magnification);
    let times = language.number(magnification);
    let caption = say!(
        language,
        "From where the tool is told to be (dots) to where it is, {times} times as long as in truth; before and after the zero point is moved by the geometric median.",
        "От заданного места инструмента (точки) к действительному, увеличение {times}\u{d7}; до и после сдвига нулевой точки на геометрическую медиану."
    );
    let along = say!(
        language,
        "Error vectors from above, from the front and from the side",
        "Векторы погрешности сверху, спереди и сбоку"
    );
    let along_caption = say!(
        language,
        "The same from above, from the front and from the side: nodes in the middle of the third axis.",
        "То же сверху, спереди и сбоку: узлы в середине третьей оси."
    );
    let three = views(language, &along, &views_of(study, &shift, magnification), magnification);
    html! {
        (figure(language, &drawing, &caption, None))
        (figure(language, &three, &along_caption, None))
    }
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

fn slices_of(study: &Study, language: Language) -> Markup {
    let grid = study.map.grid();
    let [nx, ny, _] = grid.counts();
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
                title: say!(
                    language,
                    "{} at {} {} mm",
                    "{} при {} {} мм",
                    plane.name(),
                    AXES[normal],
                    language.digits(place, 0)
                ),
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
    let title = say!(language, "Slices through the volume", "Сечения рабочего объёма");
    let within = within_said(study, language);
    let drawing = slices(language, &title, &all, &amounts(study, &within, language));
    figure(
        language,
        &drawing,
        &say!(
            language,
            "Length of the error as it is, one scale for all slices; green: {within}. A cell is a node; of large grids some are left out in the drawing. All nodes are in the file of --csv.",
            "Длина вектора погрешности, как есть; шкала для всех сечений одна, зелёным — {within}. Клетка — узел; у крупных сеток часть узлов на рисунке пропущена. Все узлы есть в файле --csv."
        ),
        None,
    )
}

const AXES: [&str; 3] = ["X", "Y", "Z"];

fn sizes(study: &Study, language: Language) -> Markup {
    let found = classes(study);
    let width = found.width_mm * 1e3;
    let rows: Vec<Vec<String>> = found
        .before
        .iter()
        .zip(&found.after)
        .enumerate()
        .map(|(k, (before, after))| {
            let end = |k: usize| language.number(width * k as f64);
            vec![end(k), end(k + 1), language.count(*before), language.count(*after)]
        })
        .collect();
    let drawn =
        Histogram { largest: width * found.before.len() as f64, before: found.before, after: found.after };
    let within = say!(language, "within", "в пределах");
    let drawing = histogram(
        language,
        &say!(language, "Nodes by the size of their error", "Узлы по величине погрешности"),
        &drawn,
        Some((study.within_mm * 1e3, &within)),
        [
            &say!(language, "length of the error, \u{b5}m", "длина вектора погрешности, мкм"),
            &say!(language, "nodes", "узлов"),
        ],
        MICROMETRES.in_language(language),
    );
    let header = match language {
        Language::English => ["from, \u{b5}m", "to, \u{b5}m", "before", "after"],
        Language::Russian => ["от, мкм", "до, мкм", "до сдвига", "после сдвига"],
    };
    figure(
        language,
        &drawing,
        &say!(
            language,
            "Before, and after the zero point is moved by the geometric median.",
            "До и после сдвига нулевой точки на геометрическую медиану."
        ),
        Some(table(language, &header, &[0, 1, 2, 3], &rows)),
    )
}

fn axes(study: &Study, language: Language) -> Markup {
    let panels: Vec<Curves> = study
        .curves
        .iter()
        .map(|curve| Curves {
            label: say!(
                language,
                "{}, mm, the other axes in the middle of the map",
                "{}, мм, остальные оси в середине карты",
                AXES[curve.axis]
            ),
            at: curve.at_mm.clone(),
            values: (0..3).map(|c| curve.errors_mm.iter().map(|e| e[c] * 1e3).collect()).collect(),
        })
        .collect();
    let series = [("s0", "dx"), ("s1", "dy"), ("s2", "dz")];
    let title = say!(language, "Errors along the axes", "Погрешности вдоль осей");
    figure(
        language,
        &curves(language, &title, &panels, &series, MICROMETRES.in_language(language)),
        &say!(
            language,
            "Components of the error, \u{b5}m, while one axis moves. The numbers are in the JSON.",
            "Составляющие погрешности, мкм, когда движется одна ось. Числа есть в JSON."
        ),
        None,
    )
}

fn diagonals(study: &Study, language: Language) -> Markup {
    let panels = [Curves {
        label: say!(language, "distance along the diagonal, mm", "путь по диагонали, мм"),
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
            let figures =
                [d.systematic_mm, d.mean_mm, d.reversal_mm, d.length_error_mm].map(|mm| um(mm, language));
            std::iter::once(signs(d.signs)).chain(figures).collect()
        })
        .collect();
    let header = match language {
        Language::English => ["diagonal", "systematic E", "mean M", "reversal B", "length error"],
        Language::Russian => {
            ["диагональ", "систематическое E", "среднее M", "зона нечувствительности B", "погрешность длины"]
        }
    };
    let title =
        say!(language, "Positioning along the body diagonals", "Позиционирование по объёмным диагоналям");
    let caption = say!(
        language,
        "Deviation forward along each diagonal, \u{b5}m, as an interferometer would read it (ISO 230-6); P and N: whether X, Y, Z run to plus or to minus. Spread between diagonals speaks of squareness, a common slope of scale.",
        "Отклонение на прямом ходе по каждой диагонали, мкм, как его показал бы интерферометр (ISO 230-6); P и N — в плюс или в минус идут X, Y, Z. Расхождение диагоналей говорит об отклонении от перпендикулярности, общий наклон — о масштабе."
    );
    html! {
        (figure(language, &curves(language, &title, &panels, &series, MICROMETRES.in_language(language)), &caption, None))
        (table(language, &header, &[1, 2, 3, 4], &rows))
    }
}

/// `PPN`: positive in X and Y, negative in Z.
fn signs(signs: [i8; 3]) -> String {
    signs.iter().map(|sign| if *sign > 0 { 'P' } else { 'N' }).collect()
}

fn zero_points(study: &Study, language: Language) -> Markup {
    html! {
        p {
            (say!(
                language,
                "The offset to enter is minus the error: the machine goes too far by the error, so the zero point goes back by it. Do this or correct programs, not both; what is to be added holds for a zero that an outside instrument found: one that was touched off on this machine has its error at that place in it already, and what is to be entered for it reckons with that.",
                "Вводится погрешность с обратным знаком: станок уходит на погрешность дальше, поэтому нулевая точка отводится на неё назад. Либо так, либо исправлять программы, но не то и другое вместе; прибавлять нужно к нулю, найденному внешним прибором: в нуле, найденном касанием на этом станке, его погрешность в этом месте уже есть, и вводимые для него числа её учитывают."
            ))
        }
        @for part in &study.parts { (zero_points_of(study, part, language)) }
    }
}

fn zero_points_of(study: &Study, part: &Part, language: Language) -> Markup {
    let figures = |f: &error_map::Statistics| {
        let [rms, p95, largest] = [f.rms_mm, f.p95_mm, f.magnitude_mm.high].map(|mm| um(mm, language));
        [rms, p95, largest, percent2(f.share_within(), language)]
    };
    let mut rows = vec![
        std::iter::once(say!(language, "as it is", "как есть"))
            .chain([const { String::new() }; 3])
            .chain(figures(&part.figures))
            .collect::<Vec<_>>(),
    ];
    for zero in &part.zero_points {
        let add = zero.to_enter_mm(study);
        let shift = [add.x, add.y, add.z].map(|v| language.digits(v, study.decimals()));
        rows.push(
            std::iter::once(zero.kind.name().in_language(language).to_owned())
                .chain(shift)
                .chain(figures(&zero.figures))
                .collect(),
        );
    }
    let within = within_said(study, language);
    let header = match language {
        Language::English => {
            ["answer", "add X, mm", "add Y, mm", "add Z, mm", "RMS, \u{b5}m", "95 %", "largest", &within]
        }
        Language::Russian => ["ответ", "к X, мм", "к Y, мм", "к Z, мм", "СКЗ, мкм", "95 %", "наиб.", &within],
    };
    let chosen = part.zero_points.iter().find(|zero| zero.kind == super::study::Kind::Median);
    html! {
        h3 { (shown(part.name.in_language(language))) }
        (table(language, &header, &[1, 2, 3, 4, 5, 6, 7], &rows))
        details {
            summary { (say!(language, "How good these answers are", "Насколько хороши эти ответы")) }
            ul { @for zero in &part.zero_points { li { (language.of_terminal(&proof(zero, part, language))) } } }
        }
        @if let Some(zero) = chosen.filter(|_| !study.work_offsets.is_empty()) {
            p { (say!(language, "To enter for the geometric median:", "Ввести для геометрической медианы:")) }
            dl {
                @for offset in &study.work_offsets {
                    @let to = offset.to_enter_mm(zero, study);
                    dt { (shown(&offset.name)) " (" (offset.how().in_language(language)) ")" }
                    // A control takes a point in every language.
                    @let [x, y, z] = [to.x, to.y, to.z].map(|v| number_of_digits(v, study.decimals()));
                    dd { "X " (x) " Y " (y) " Z " (z) }
                }
            }
        }
    }
}

fn places(study: &Study, language: Language) -> Markup {
    let rows: Vec<Vec<String>> = study
        .places
        .iter()
        .map(|(freedom, place)| {
            let mut row = vec![freedom_name(*freedom).in_language(language).to_owned()];
            row.extend(
                place
                    .box_mm
                    .iter()
                    .map(|r| range_said(&language.digits(r.low, 1), &language.digits(r.high, 1), language)),
            );
            let fit = &place.fit;
            row.extend(
                [fit.before.rms_mm, fit.after.rms_mm, fit.after.magnitude_mm.high].map(|mm| um(mm, language)),
            );
            row.extend((-fit.shift_mm).iter().map(|v| language.digits(*v, study.decimals())));
            row.extend((-fit.rotation_rad).iter().map(|v| language.digits(v * 1e6, 0)));
            row
        })
        .collect();
    #[rustfmt::skip]
    let header = match language {
        Language::English => [
            "the set-up can", "X, mm", "Y, mm", "Z, mm", "RMS before, \u{b5}m", "after", "largest",
            "add X, mm", "add Y", "add Z", "turn X, \u{b5}rad", "turn Y", "turn Z",
        ],
        Language::Russian => [
            "при наладке можно", "X, мм", "Y, мм", "Z, мм", "СКЗ до, мкм", "после", "наиб.",
            "к X, мм", "к Y", "к Z", "вокруг X, мкрад", "вокруг Y", "вокруг Z",
        ],
    };
    html! {
        p {
            (say!(
                language,
                "Axis commands of the box in which least is left after the set-up did what it can; turns are about its centre.",
                "Координаты осей для габарита, в котором после наладки остаётся наименьшая погрешность; повороты — вокруг его центра."
            ))
        }
        (table(language, &header, &[4, 5, 6, 7, 8, 9, 10, 11, 12], &rows))
    }
}

fn provenance(study: &Study, facts: &Facts, language: Language) -> Markup {
    let vector =
        |v: &Vector, d: usize| v.iter().map(|v| language.digits(*v, d)).collect::<Vec<_>>().join(" ");
    html! {
        dl {
            dt { (say!(language, "machine", "станок")) }
            dd { (shown(&study.machine)) (say!(language, ", chain ", ", цепь ")) (shown(&facts.chain)) }
            dt { (say!(language, "profile and its tables", "профиль и его таблицы")) } dd { (shown(&facts.profile)) " " span.muted { "BLAKE3 " (facts.profile_hash) } }
            dt { (say!(language, "model", "модель")) } dd { (study.engine.name()) }
            dt { (say!(language, "grid", "сетка")) } dd {
                @for (axis, nodes) in AXES.iter().zip(study.map.grid().axes()) {
                    @let [low, high] = [nodes.range_mm().low, nodes.range_mm().high].map(|v| language.digits(v, 3));
                    @let count = nodes.places_mm().len();
                    (say!(
                        language,
                        "{axis} {low} to {high} mm, {count} nodes. ",
                        "{axis} от {low} до {high} мм, узлов {count}. "
                    ))
                }
            }
            dt { (say!(language, "tool vector", "вектор инструмента")) }
            dd { (vector(&study.tool_mm, 3)) (say!(language, " mm", " мм")) }
            dt { (say!(language, "rotary axes", "поворотные оси")) } dd { (vector(&study.rotary_rad.map(f64::to_degrees), 3)) "\u{b0}" }
            @for (name, value) in &facts.options { dt { (name) } dd { (shown(value)) } }
            (facts.origin.rows(language))
            dt { (say!(language, "made by", "создано")) } dd { "vpost " (env!("CARGO_PKG_VERSION")) ", vpost.map/1" }
        }
    }
}

fn range_said(low: &str, high: &str, language: Language) -> String {
    // Two lines where there is no room for one.
    say!(language, "{low} to\u{a0}{high}", "от\u{a0}{low} до\u{a0}{high}")
}

fn um(mm: f64, language: Language) -> String {
    language.digits(mm * 1e3, if mm.abs() < 0.0995 { 1 } else { 0 })
}

/// The tolerance as it was typed.
fn within(study: &Study, language: Language) -> String {
    language.figures(format!("{}", (study.within_mm * 1e6).round() * 1e-3))
}

fn within_said(study: &Study, language: Language) -> String {
    format!("\u{2264} {} {}", within(study, language), MICROMETRES.in_language(language))
}

/// A share as people compare them: small ones with a decimal.
fn percent2(share: f64, language: Language) -> String {
    if share < 0.1 { format!("{} %", language.digits(100.0 * share, 1)) } else { language.percent(share) }
}
