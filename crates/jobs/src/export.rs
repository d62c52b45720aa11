//! The model in the forms that controls take.

use std::fmt::Write;

use clap::ValueEnum;
use diagnostic::{Text, both, notice};
use machine_model::{Axis, Command, EngineId, Interpolation, PathModel, Six, Vector};
use machine_profile::Profile;

use crate::figures::short;
use crate::message::{Failure, OPTION};

/// Forms that controls take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// LinuxCNC compensation files (COMP_FILE_TYPE = 0): nominal, forward, reverse.
    Linuxcnc,
    /// ISG CSV: tables of each axis and the angles between them, mm and rad.
    Isg,
    /// A lattice of vectors.
    Lattice,
    /// The product's own tables.
    Csv,
}

/// What a lattice holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Sign {
    /// Real minus commanded: dx_um dy_um dz_um.
    Errors,
    /// What the control adds, the negative of it: cx_um cy_um cz_um.
    Corrections,
}

/// What is asked for.
pub struct Asked {
    /// The form.
    pub format: Format,
    /// Distance of a lattice's points, mm.
    pub step_mm: f64,
    /// What a lattice holds.
    pub lattice: Sign,
}

/// What a form makes of a profile.
#[derive(Default)]
pub struct Exported {
    /// Names and texts of its files.
    pub files: Vec<(String, String)>,
    /// What of the profile it does not hold.
    pub lost: Vec<Text>,
}

/// A profile in a form.
///
/// # Errors
/// The form does not suit the machine, the step is none.
pub fn of(profile: &Profile, asked: &Asked) -> Result<Exported, Failure> {
    if profile.lathe.is_some() && asked.format == Format::Lattice {
        return Err(Failure::usage(notice!(OPTION;
            "a lathe's errors are those of a radius about the spindle: no lattice of vectors holds them",
            "погрешности токарного станка — погрешности радиуса вокруг шпинделя: решётка векторов их не вмещает";
            "write `--format linuxcnc`, `isg` or `csv`; the wear of X is in `vpost predict --lathe PROGRAM --wear`",
            "напишите `--format linuxcnc`, `isg` или `csv`; износ X даёт `vpost predict --lathe PROGRAM --wear`"
        )));
    }
    if !(asked.step_mm > 0.0 && asked.step_mm.is_finite()) {
        return Err(Failure::usage(notice!(OPTION;
            "a step is above zero", "шаг больше нуля";
            "write `--step 50`", "напишите `--step 50`"
        )));
    }
    if profile.correction.engine == EngineId::Field && asked.format != Format::Lattice {
        return Err(Failure::usage(notice!(OPTION;
            "the profile corrects by error vectors, which are no functions of axes",
            "профиль исправляет по векторам погрешности, а это не функции осей";
            "write them as a lattice: `--format lattice`", "выведите их решёткой: `--format lattice`"
        )));
    }
    let mut out = Exported::default();
    match asked.format {
        Format::Linuxcnc => linuxcnc(profile, &mut out),
        Format::Isg => isg(profile, &mut out),
        Format::Lattice => lattice(profile, asked, &mut out)?,
        Format::Csv => own(profile, &mut out),
    }
    out.lost.extend(curves_lost(profile, asked.format));
    out.lost.extend(rotary_lost(profile, asked.format));
    if profile.lathe.is_some() {
        out.lost.push(both!(
            "the spindle, head- and tailstock, the tool's height and what the workpiece gives way; X is a radius in it",
            "шпинделя, передней и задней бабок, высоты резца и отжима детали; X в ней — радиус"
        ));
    }
    if !profile.effects.is_empty() {
        out.lost.push(both!("the profile's [[effect]] entries", "разделов [[effect]] профиля"));
    }
    Ok(out)
}

/// Error functions of an axis at a place, for a direction (0: mean of both).
fn six(profile: &Profile, axis: usize, q: f64, direction: i8) -> Six {
    let data = &profile.description.linear[axis];
    let at = |tables: &Option<machine_model::AxisTables>| tables.as_ref().map(|t| t.at(q));
    let positive = at(&data.errors).unwrap_or_default();
    let mut values = match (at(&data.errors_negative), direction) {
        (Some(negative), -1) => negative,
        (Some(negative), 0) => std::array::from_fn(|k| 0.5 * (positive[k] + negative[k])),
        _ => positive,
    };
    // The whole reversal value: after coming from above the axis stands further.
    values[axis] -= 0.5 * data.backlash_mm * f64::from(direction);
    values
}

/// Places at which an axis' tables have nodes, those of both directions; the ends of an axis that has lost motion alone.
fn nodes(profile: &Profile, axis: usize) -> Vec<f64> {
    let data = &profile.description.linear[axis];
    let tables = || [&data.errors, &data.errors_negative].into_iter().flatten();
    let mut places: Vec<f64> = tables().flat_map(|t| t.nodes()).copied().collect();
    if places.is_empty() && data.backlash_mm != 0.0 {
        places = vec![data.travel_mm.low, data.travel_mm.high];
    }
    places.sort_by(f64::total_cmp);
    places.dedup();
    places.retain(|q| tables().all(|t| t.range().low <= *q && *q <= t.range().high));
    places
}

/// True where motion towards minus differs from motion towards plus.
fn has_two_directions(profile: &Profile, axis: usize) -> bool {
    let data = &profile.description.linear[axis];
    data.errors_negative.is_some() || data.backlash_mm != 0.0
}

/// Functions of an axis that say something.
fn given(profile: &Profile, axis: usize) -> Vec<usize> {
    let data = &profile.description.linear[axis];
    let columns = profile.rows[axis].as_ref().map_or([false; 6], |rows| rows.given);
    let negative = data.errors_negative.as_ref().map_or([0.0; 6], |tables| tables.largest(tables.range()));
    (0..6)
        .filter(|&k| columns[k] || negative[k] != 0.0 || (k == axis && has_two_directions(profile, axis)))
        .collect()
}

/// Where the axes were measured, for forms that hold functions along the measured lines and not where those ran.
fn lines_lost(profile: &Profile) -> Vec<Text> {
    let letters = (0..3).filter(|&axis| {
        let data = &profile.description.linear[axis];
        data.errors.is_some()
            && (data.measured_tool_mm != Vector::zeros() || data.measured_at_mm != Vector::zeros())
    });
    letters
        .map(|axis| {
            both!(
                "where {} was measured (measured_at_mm)",
                "места, где измерялась {} (measured_at_mm)",
                Axis::ALL[axis].letter()
            )
        })
        .collect()
}

/// What lies between the nodes, where that is no straight line.
fn curves_lost(profile: &Profile, format: Format) -> Option<Text> {
    (profile.interpolation == Interpolation::Monotone).then(|| {
        let back = match format {
            Format::Csv => both!(
                " (read it back with `--interpolation monotone`)",
                " (прочесть обратно: `--interpolation monotone`)"
            ),
            Format::Linuxcnc | Format::Isg | Format::Lattice => Text::EMPTY,
        };
        both!(
            "the profile's monotone interpolation: between its points it goes straight{back}",
            "монотонной интерполяции профиля: между её точками — прямые{back:#}"
        )
    })
}

/// What becomes of rotary axes that have errors: only a profile holds them.
fn rotary_lost(profile: &Profile, format: Format) -> Option<Text> {
    let machine = &profile.description;
    let axes = machine.chain.table().iter().chain(machine.chain.head());
    let crooked = axes.filter(|axis| !machine.rotary[axis.direction()].is_perfect());
    let names: Vec<String> = crooked.map(|axis| axis.letter().to_string()).collect();
    let names = names.join(", ");
    (!names.is_empty()).then(|| match format {
        Format::Lattice => both!(
            "the errors of {names} at any angle but 0, where the lattice has them",
            "погрешностей {names} при углах, кроме 0, при котором взята решётка"
        ),
        Format::Linuxcnc | Format::Isg | Format::Csv => {
            both!("the errors of {names}", "погрешностей {names}")
        }
    })
}

/// One file per axis. No comments: LinuxCNC stops reading at the first line that is not three numbers.
fn linuxcnc(profile: &Profile, out: &mut Exported) {
    out.lost.push(both!(
        "straightness, angles and squareness: a compensation file moves its own axis only",
        "прямолинейности, углов и перпендикулярности: файл компенсации двигает только свою ось"
    ));
    for axis in 0..3 {
        let places = nodes(profile, axis);
        if places.is_empty() {
            continue;
        }
        let letter = Axis::ALL[axis].letter();
        if places.len() > 256 {
            out.lost.push(both!(
                "all of the {} nodes of {letter}: LinuxCNC reads 256",
                "всех {} узлов {letter}: LinuxCNC читает 256",
                places.len()
            ));
        }
        let mut text = String::new();
        for q in places.iter().take(256) {
            let real = |direction: i8| short(q + six(profile, axis, *q, direction)[axis], 7);
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{} {} {}", short(*q, 6), real(1), real(-1));
        }
        out.files.push((format!("{}.comp", letter.to_ascii_lowercase()), text));
    }
}

/// One file with a block per axis and one of angles.
fn isg(profile: &Profile, out: &mut Exported) {
    let mut text = String::from("// Errors along the measured lines, mean of both directions; mm and rad.\n");
    for axis in 0..3 {
        let functions = given(profile, axis);
        if functions.is_empty() {
            continue;
        }
        let letter = Axis::ALL[axis].letter();
        if has_two_directions(profile, axis) {
            out.lost.push(both!("the direction of motion of {letter}", "направления движения {letter}"));
        }
        let names: Vec<String> = functions.iter().map(|k| format!("E{}{letter}", Axis::ALL[*k])).collect();
        let _ = writeln!(text, "{letter} {}", names.join(" "));
        for q in nodes(profile, axis) {
            let values = six(profile, axis, q, 0);
            let cells: Vec<String> = functions.iter().map(|k| short(values[*k], 12)).collect();
            let _ = writeln!(text, "{} {}", short(q, 6), cells.join(" "));
        }
        text.push_str("#\n");
    }
    let s = profile.description.squareness;
    let _ = writeln!(
        text,
        "C0Y B0Z A0Z\n{} {} {}",
        short(s.ec0y_rad, 12),
        short(s.eb0z_rad, 12),
        short(s.ea0z_rad, 12)
    );
    out.files.push(("errors.isg".to_owned(), text));
    out.lost.extend(lines_lost(profile));
}

/// Vectors on a lattice over the calibrated volume, its far faces included.
fn lattice(profile: &Profile, asked: &Asked, out: &mut Exported) -> Result<(), Failure> {
    const MOST_POINTS: f64 = 1e6;
    let field = profile.field.as_ref().filter(|_| profile.correction.engine == EngineId::Field);
    let model: &dyn PathModel = match field {
        Some(measured) => &measured.field,
        None => profile.rigid_body_without_effects(),
    };
    let volume = model.volume();
    let cells = volume.0.map(|range| ((range.high - range.low) / asked.step_mm - 1e-9).ceil().max(1.0));
    // Counted before there are any.
    let points: f64 = cells.iter().map(|cells| cells + 1.0).product();
    if points > MOST_POINTS {
        return Err(Failure::usage(notice!(OPTION;
            "a lattice of {points:.3e} points, more than {MOST_POINTS:e}",
            "решётка в {points:.3e} точек, больше {MOST_POINTS:e}";
            "use a larger `--step`", "возьмите `--step` больше"
        )));
    }
    let places: [Vec<f64>; 3] = [0, 1, 2].map(|i| {
        let range = volume.0[i];
        (0..=cells[i] as usize).map(|k| (range.low + k as f64 * asked.step_mm).min(range.high)).collect()
    });
    let tool_mm =
        field.map_or_else(|| Vector::from(profile.default_tool_mm), |measured| measured.field.tool_mm());
    let (sign, head) = match asked.lattice {
        Sign::Errors => (1.0, "run,x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm,dx_um,dy_um,dz_um\n"),
        Sign::Corrections => (-1.0, "run,x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm,cx_um,cy_um,cz_um\n"),
    };
    let mut text = String::from(head);
    for z in &places[2] {
        for y in &places[1] {
            for x in &places[0] {
                let at = Vector::new(*x, *y, *z);
                let command = Command { linear_mm: at, tool_mm, ..Command::default() };
                let error = model.error_mm(&command) * (1e3 * sign);
                let cells: Vec<String> = at
                    .iter()
                    .chain(tool_mm.iter())
                    .map(|v| short(*v, 6))
                    .chain(error.iter().map(|v| short(*v, 4)))
                    .collect();
                let _ = writeln!(text, "lattice,{}", cells.join(","));
            }
        }
    }
    out.files.push(("lattice.csv".to_owned(), text));
    if (0..3).any(|i| has_two_directions(profile, i)) {
        out.lost.push(both!("the direction of motion", "направления движения"));
    }
    out.lost.push(both!("other tools than the default one", "инструмента, кроме заданного по умолчанию"));
    let missed = (0..3).filter(|&axis| {
        let inside = |q: &f64| volume.0[axis].low < *q && *q < volume.0[axis].high;
        let on_plane = |q: f64| places[axis].iter().any(|place| (place - q).abs() < 1e-6);
        nodes(profile, axis).into_iter().filter(inside).any(|q| !on_plane(q))
    });
    let missed: Vec<String> = missed.map(|axis| Axis::ALL[axis].letter().to_string()).collect();
    if !missed.is_empty() {
        out.lost.push(both!(
            "what the tables of {} do between the lattice's points (their nodes lie elsewhere: `--step`)",
            "хода таблиц {} между точками решётки (их узлы лежат не там: `--step`)",
            missed.join(", ")
        ));
    }
    Ok(())
}

/// The tables as `vpost calibrate interferometer` reads them.
fn own(profile: &Profile, out: &mut Exported) {
    for axis in 0..3 {
        let functions = given(profile, axis);
        if functions.is_empty() {
            continue;
        }
        let letter = Axis::ALL[axis].letter();
        let unit = |k: usize| if k < 3 { "um" } else { "urad" };
        let names: Vec<String> =
            functions.iter().map(|k| format!("E{}{letter}_{}", Axis::ALL[*k], unit(*k))).collect();
        let mut text = format!("run,dir,position_mm,{}\n", names.join(","));
        let directions: &[i8] = if has_two_directions(profile, axis) { &[1, -1] } else { &[0] };
        for direction in directions {
            for q in nodes(profile, axis) {
                let values = six(profile, axis, q, *direction);
                let cells: Vec<String> =
                    functions.iter().map(|k| short(values[*k] * if *k < 3 { 1e3 } else { 1e6 }, 4)).collect();
                let _ = writeln!(text, "1,{direction},{},{}", short(q, 6), cells.join(","));
            }
        }
        out.files.push((format!("{}.csv", letter.to_ascii_lowercase()), text));
    }
    out.lost.push(both!(
        "squareness, tools and offsets: they stand in the profile",
        "перпендикулярности, инструмента и смещений: они стоят в профиле"
    ));
    out.lost.extend(lines_lost(profile));
}
