//! Error vectors measured in the volume, from their CSV file.

use diagnostic::{Speaks, Text, both};
use machine_model::engines::{ErrorVector, Field, FieldError};
use machine_model::{Range, Vector};
use measurement_files::{Codes, Kind, Refusal, Row, Sheet, numbered};
use units::Length;

use crate::error::{CELL, COLUMN, CONFLICT, FIELD, FILE, ProfileError, ROWS, VALUE};
use crate::format;
use crate::loader::Loader;
use crate::number::Spanned;

/// Vectors beyond this are a mistake in the unit, or positions, mm.
const LARGEST_MM: f64 = 20.0;
/// Commands that span less were given in metres, mm.
const SMALLEST_SPAN_MM: f64 = 2.0;
/// Noise beyond this is no instrument's, µm.
const MOST_NOISE_UM: f64 = 1e4;
/// Tool vectors that differ by more are those of two tools, mm.
const SAME_TOOL_MM: f64 = 1e-3;
/// A command beyond the travel by no more is at its end, mm.
const ROUNDING_MM: f64 = 1e-6;

const PLACE: [&str; 3] = ["x_mm", "y_mm", "z_mm"];
const DEVIATION: [&str; 3] = ["dx_um", "dy_um", "dz_um"];
const POSITION: [&str; 3] = ["xm_mm", "ym_mm", "zm_mm"];
const TOOL: [&str; 3] = ["tool_x_mm", "tool_y_mm", "tool_z_mm"];
const UNCERTAINTY: [&str; 3] = ["u_x_um", "u_y_um", "u_z_um"];

/// The columns of a measurement.
const KIND: Kind<'_> = Kind {
    columns: "run x_mm y_mm z_mm a_deg b_deg c_deg dx_um dy_um dz_um xm_mm ym_mm zm_mm d_um length_mm bx_mm by_mm bz_mm \
              dir_x dir_y dir_z feed_mm_min tool_x_mm tool_y_mm tool_z_mm load_kg time_s temp_c temp_x_c temp_y_c \
              temp_z_c repeat u_um u_x_um u_y_um u_z_um instrument artefact station note",
    expected: Text::pair(
        "expected: x_mm,y_mm,z_mm,dx_um,dy_um,dz_um and one row per measured vector",
        "ожидалось: x_mm,y_mm,z_mm,dx_um,dy_um,dz_um и по строке на измеренный вектор",
    ),
    passes_over: None,
    may_be_empty: false,
    codes: Codes { unreadable: FILE, column: COLUMN, cell: CELL, unit: ROWS },
};

/// Error vectors of the volume, and the model that they make.
#[derive(Clone, Debug)]
pub struct MeasuredField {
    /// The file, as the profile names it.
    pub file: String,
    /// How many vectors it holds.
    pub vectors: usize,
    /// Smallest and largest standard uncertainty of a component, µm.
    pub uncertainty_um: [f64; 2],
    /// The mean vector, mm, and the rotation of all of them about their middle, rad: of the machine, or of how the
    /// instrument was set up. Equation (95).
    pub frame: [Vector; 2],
    /// The model.
    pub field: Field,
}

/// What the rest of the profile says of a file of vectors.
pub(crate) struct Around {
    pub(crate) travel_mm: [Range; 3],
    pub(crate) default_tool_mm: [f64; 3],
    /// Of the profile, where it says one, µm.
    pub(crate) noise_um: Option<f64>,
}

/// Vectors with what messages about them point to.
struct Read {
    vectors: Vec<ErrorVector>,
    runs: Vec<String>,
    tool_mm: Vector,
}

impl Loader<'_> {
    /// `[field]`
    pub(crate) fn field(
        &mut self,
        written: &Spanned<format::Field>,
        refuses: Option<Text>,
        mut around: Around,
    ) -> Option<MeasuredField> {
        let section = written.get_ref();
        if let Some(axes) = refuses {
            let message =
                both!("[field] on a machine with {axes}", "[field] на станке, у которого есть {axes:#}");
            let label = both!("of three linear axes only", "только для трёх линейных осей");
            let help = both!(
                "error vectors say nothing of how they change while a rotary axis or a spindle turns: describe this machine by [axis] tables",
                "векторы погрешности не говорят, как они меняются при повороте оси или шпинделя: опишите этот станок таблицами [axis]"
            );
            self.refuse(written, CONFLICT, message, label, help);
            return None;
        }
        if let Some(noise) = &section.noise_um {
            let um = noise.get_ref().0;
            if !(0.0..=MOST_NOISE_UM).contains(&um) {
                let label = both!("expected 0 to {MOST_NOISE_UM}", "ожидалось от 0 до {MOST_NOISE_UM}");
                let help = both!(
                    "give the standard uncertainty of one component in micrometres; 0 meets the vectors of a lattice exactly",
                    "задайте стандартную неопределённость одной составляющей в микрометрах; 0 — векторы решётки точны"
                );
                self.refuse(noise, VALUE, both!("noise_um is {um}", "noise_um равно {um}"), label, help);
                return None;
            }
            around.noise_um = Some(um);
        }
        let bytes = self.file(&section.file)?;
        let name = section.file.get_ref();
        let made =
            measured(name, &bytes, &around).map_err(|refusal| ProfileError::table(name, refusal.diagnostic));
        self.keep(made)
    }
}

fn measured(name: &str, bytes: &[u8], around: &Around) -> Result<MeasuredField, Box<Refusal>> {
    let sheet = Sheet::read(name, bytes, &KIND, None)?;
    of_vectors(&sheet)?;
    let Read { vectors, runs, tool_mm } = read(&sheet, around)?;
    let field = Field::new(&vectors, tool_mm).map_err(|error| refusal(&sheet, &runs, &vectors, &error))?;
    let um =
        || vectors.iter().flat_map(|vector| vector.uncertainty_mm.iter().map(|u| Length::from_mm(*u).um()));
    Ok(MeasuredField {
        file: name.to_owned(),
        vectors: vectors.len(),
        uncertainty_um: [um().fold(f64::INFINITY, f64::min), um().fold(0.0, f64::max)],
        frame: frame(&vectors),
        field,
    })
}

/// The columns are those of vectors.
fn of_vectors(sheet: &Sheet) -> Result<(), Box<Refusal>> {
    let any = |columns: &[&str]| columns.iter().any(|column| sheet.has(column));
    let has = any(&DEVIATION) || any(&POSITION);
    for (column, what) in
        [("d_um", both!("a magnitude", "модуль")), ("length_mm", both!("a length", "длина"))]
    {
        if sheet.has(column) && !has {
            let message = both!(
                "`{}` is {what} and has no direction: a field is made of vectors",
                "`{}` — {what:#}, направления здесь нет: поле состоит из векторов",
                sheet.header(column)
            );
            let help = both!("give dx_um, dy_um and dz_um", "задайте dx_um, dy_um и dz_um");
            return Err(sheet.refuse_column(COLUMN, column, message, help));
        }
        if sheet.has(column) {
            let message = both!(
                "`{}` stands beside vectors: two kinds of reading",
                "`{}` стоит рядом с векторами: показания двух видов",
                sheet.header(column)
            );
            let help = both!("keep dx_um, dy_um and dz_um", "оставьте dx_um, dy_um и dz_um");
            return Err(sheet.refuse_column(COLUMN, column, message, help));
        }
    }
    if any(&DEVIATION) && any(&POSITION) {
        let message = both!(
            "two kinds of reading: dx_um, dy_um, dz_um and xm_mm, ym_mm, zm_mm",
            "показания двух видов: dx_um, dy_um, dz_um и xm_mm, ym_mm, zm_mm"
        );
        return Err(sheet.refuse_header(COLUMN, message, both!("keep one of them", "оставьте одни из них")));
    }
    let places = both!(
        "the commanded position of all three axes is needed, machine coordinates",
        "нужно заданное положение всех трёх осей, в координатах станка"
    );
    sheet.need(&PLACE, places)?;
    let readings = if any(&POSITION) { &POSITION } else { &DEVIATION };
    let components = both!(
        "a vector has three components, measured minus commanded tip",
        "у вектора три составляющие: измеренное минус заданное положение вершины"
    );
    sheet.need(readings, components)
}

fn read(sheet: &Sheet, around: &Around) -> Result<Read, Box<Refusal>> {
    let (mut vectors, mut runs) = (Vec::new(), Vec::new());
    let mut tool: Option<Vector> = None;
    for row in sheet.rows() {
        let command = row.command(around.default_tool_mm)?;
        for (axis, travel) in around.travel_mm.iter().enumerate() {
            let at = command.linear_mm[axis];
            if at < travel.low - ROUNDING_MM || at > travel.high + ROUNDING_MM {
                let message = both!(
                    "{} at {at} mm lies outside its travel, {} to {} mm",
                    "{} в {at} мм лежит вне хода оси, от {} до {} мм",
                    ['X', 'Y', 'Z'][axis],
                    travel.low,
                    travel.high
                );
                let help = both!(
                    "give machine coordinates in millimetres, or correct travel_mm",
                    "задайте координаты станка в миллиметрах или исправьте travel_mm"
                );
                return Err(row.refuse(ROWS, PLACE[axis], message, help));
            }
        }
        for (axis, key) in ["a_deg", "b_deg", "c_deg"].into_iter().enumerate() {
            if command.rotary_rad[axis] != 0.0 {
                let message = both!(
                    "a vector with axis {} turned",
                    "вектор при повёрнутой оси {}",
                    ['A', 'B', 'C'][axis]
                );
                let help = both!(
                    "a field is of three linear axes; leave out what was measured with a rotary axis turned",
                    "поле — для трёх линейных осей; исключите измеренное при повёрнутой оси"
                );
                return Err(row.refuse(ROWS, key, message, help));
            }
        }
        let known = *tool.get_or_insert(command.tool_mm);
        if (command.tool_mm - known).amax() > SAME_TOOL_MM {
            let [a, b] = [known, command.tool_mm].map(|v| format!("{} {} {}", v.x, v.y, v.z));
            let message = both!(
                "tool vector {b} mm behind {a} mm: vectors of two tools are two fields",
                "вектор инструмента {b} мм после {a} мм: векторы двух инструментов — это два поля"
            );
            let key = TOOL.into_iter().find(|key| sheet.has(key)).unwrap_or(PLACE[0]);
            let help = both!("keep the vectors of one tool", "оставьте векторы одного инструмента");
            return Err(row.refuse(ROWS, key, message, help));
        }
        let error_mm = error(sheet, row, &command.linear_mm)?;
        vectors.push(ErrorVector {
            place_mm: command.linear_mm,
            error_mm,
            uncertainty_mm: uncertainty(row, around.noise_um)?,
            run: numbered(&mut runs, &row.text("run")),
        });
    }
    let span = (0..3)
        .map(|axis| {
            let at = || vectors.iter().map(|vector: &ErrorVector| vector.place_mm[axis]);
            at().fold(f64::NEG_INFINITY, f64::max) - at().fold(f64::INFINITY, f64::min)
        })
        .fold(0.0, f64::max);
    if span > 0.0 && span < SMALLEST_SPAN_MM && vectors.len() > 3 {
        let message = both!(
            "the commands span {span} mm in all: are x_mm, y_mm, z_mm metres?",
            "заданные положения занимают всего {span} мм: x_mm, y_mm, z_mm в метрах?"
        );
        let help =
            both!("give the commanded positions in millimetres", "задайте положения осей в миллиметрах");
        return Err(sheet.refuse_column(ROWS, PLACE[0], message, help));
    }
    Ok(Read { vectors, runs, tool_mm: tool.unwrap_or_default() })
}

/// Measured minus commanded, mm.
fn error(sheet: &Sheet, row: Row<'_>, place_mm: &Vector) -> Result<Vector, Box<Refusal>> {
    let measured = sheet.has(POSITION[0]);
    let error_mm = if measured {
        Vector::from(row.three(POSITION)?) - place_mm
    } else {
        Vector::from(row.three(DEVIATION)?.map(|um| Length::from_um(um).mm()))
    };
    if error_mm.norm() <= LARGEST_MM {
        return Ok(error_mm);
    }
    let message = both!(
        "an error of {:.3} mm is larger than geometric errors get: wrong unit?",
        "погрешность {:.3} мм больше, чем бывают геометрические: не та единица?",
        error_mm.norm()
    );
    let (key, help) = if measured {
        (
            POSITION[0],
            both!(
                "give the measured position of the axes, or measured minus commanded as dx_um, dy_um, dz_um",
                "задайте измеренное положение осей или разность измеренного и заданного: dx_um, dy_um, dz_um"
            ),
        )
    } else {
        let help = both!(
            "name each column by its unit; up to 20 mm are read",
            "назовите столбцы по их единицам; читается до 20 мм"
        );
        (DEVIATION[0], help)
    };
    Err(row.refuse(ROWS, key, message, help))
}

/// Stated standard uncertainty of each component, mm: of the row, else of the profile.
fn uncertainty(row: Row<'_>, noise_um: Option<f64>) -> Result<Vector, Box<Refusal>> {
    let common = row.number("u_um")?;
    let own = row.any_of(UNCERTAINTY)?;
    for (key, value) in
        ["u_um", "u_x_um", "u_y_um", "u_z_um"].into_iter().zip([common].into_iter().chain(own))
    {
        if let Some(u) = value.filter(|u| *u <= 0.0) {
            let message =
                both!("an uncertainty of {u} um is not possible", "неопределённости {u} мкм не бывает");
            let help = both!(
                "give the standard uncertainty, above zero, or leave it empty; noise_um = 0 in the profile meets the vectors of a lattice exactly",
                "задайте стандартную неопределённость больше нуля или оставьте пустой; noise_um = 0 в профиле: векторы решётки точны"
            );
            return Err(row.refuse(CELL, key, message, help));
        }
    }
    let mut uncertainty_mm = Vector::zeros();
    for (component, own) in own.into_iter().enumerate() {
        let Some(um) = own.or(common).or(noise_um) else {
            let message = both!(
                "nothing says how certain this vector is",
                "нигде не сказано, насколько достоверен этот вектор"
            );
            let help = both!(
                "write noise_um under [field], the standard uncertainty of one component, or a column u_um",
                "напишите noise_um в разделе [field], стандартную неопределённость одной составляющей, или столбец u_um"
            );
            let label = both!("without an uncertainty", "без неопределённости");
            return Err(row.refuse_row(FIELD, message, label, help));
        };
        uncertainty_mm[component] = Length::from_um(um).mm();
    }
    Ok(uncertainty_mm)
}

/// What to say of vectors that make no field.
fn refusal(sheet: &Sheet, runs: &[String], vectors: &[ErrorVector], error: &FieldError) -> Box<Refusal> {
    let of_row = |vector: usize, message: Text, label: Text, help: Text| match sheet.row(vector) {
        Some(row) => row.refuse_row(FIELD, message, label, help),
        None => sheet.refuse_header(FIELD, message, help),
    };
    let help = match error {
        FieldError::Repeated { first, second, .. } => {
            let line = sheet.row(*first).map_or(0, |row| row.line());
            let directions =
                [*first, *second].map(|vector| sheet.row(vector).and_then(|row| row.directions().ok()));
            let help = if directions[0] == directions[1] {
                both!(
                    "leave the wrong one out, or state the noise that repeated readings show",
                    "исключите неверный или задайте шум, который показывают повторные отсчёты"
                )
            } else {
                both!(
                    "the two were come to from different sides: a field knows no direction, give the mean of both or one side",
                    "к точке подходили с разных сторон: направления поле не знает, задайте среднее или одну сторону"
                )
            };
            let said = error.text();
            let message =
                both!("{said}; the other stands on line {line}", "{said:#}; другой стоит в строке {line}");
            return of_row(*second, message, both!("the same place", "та же точка"), help);
        }
        FieldError::Exact { vector } => {
            let help = both!(
                "state an uncertainty of every vector, or of none",
                "задайте неопределённость каждого вектора или ни одного"
            );
            return of_row(*vector, error.text(), both!("this one", "этот"), help);
        }
        FieldError::Offset { vector, offset_mm } => {
            let um = offset_mm.map(|mm| Length::from_mm(mm).um());
            let run = &runs[vectors[*vector].run];
            let message = both!(
                "run `{run}` lies {:.2} {:.2} {:.2} um beside the others: runs of different set-ups are no field",
                "серия `{run}` лежит на {:.2} {:.2} {:.2} мкм в стороне от остальных: серии разных установок — не одно поле",
                um.x,
                um.y,
                um.z
            );
            let help = both!(
                "bring all runs into one frame before, by their common places, or keep the runs of one set-up and one direction",
                "сначала приведите все серии в одну систему по их общим точкам или оставьте серии одной установки и одного направления"
            );
            return of_row(*vector, message, both!("the first of this run", "первый этой серии"), help);
        }
        FieldError::TooFew { .. } => both!(
            "measure more places; a complete lattice, however small, is met exactly with noise_um = 0",
            "измерьте больше точек; полная решётка, хотя бы и малая, при noise_um = 0 воспроизводится точно"
        ),
        FieldError::Flat { .. } => {
            both!("measure at least two layers along each axis", "измерьте хотя бы два слоя вдоль каждой оси")
        }
        FieldError::Hole { .. } => both!(
            "measure the missing nodes, or state a noise_um above 0: then the vectors are smoothed, wherever they are",
            "измерьте недостающие узлы или задайте noise_um больше 0: тогда векторы сглаживаются, где бы они ни лежали"
        ),
        FieldError::Scattered { .. } => both!(
            "state the noise: noise_um, or a column u_um; only a complete lattice can be met exactly",
            "задайте шум: noise_um или столбец u_um; точно воспроизводится только полная решётка"
        ),
        FieldError::Noise(doubt) if doubt.scatter_mm > doubt.stated_mm => both!(
            "state the noise that repeated readings show, or find what else is in the vectors: an axis with play, drift, blunders",
            "задайте шум, который показывают повторные отсчёты, или найдите, что ещё есть в векторах: люфт оси, дрейф, промахи"
        ),
        FieldError::Noise(_) => both!(
            "state the noise that repeated readings show; are the vectors millimetres, or is the noise of another unit?",
            "задайте шум, который показывают повторные отсчёты; векторы не в миллиметрах ли, единица шума та ли?"
        ),
        FieldError::NotDetermined => both!(
            "measure places that are spread over the whole volume",
            "измерьте точки, разбросанные по всему объёму"
        ),
    };
    sheet.refuse_header(FIELD, error.text(), help)
}

/// Mean and rotation of all vectors: least squares of `e = m + ω × (q - q̄)`, equation (95).
fn frame(vectors: &[ErrorVector]) -> [Vector; 2] {
    let n = vectors.len() as f64;
    let centre = vectors.iter().map(|vector| vector.place_mm).sum::<Vector>() / n;
    let mean = vectors.iter().map(|vector| vector.error_mm).sum::<Vector>() / n;
    let mut inertia = machine_model::Matrix::zeros();
    let mut moment = Vector::zeros();
    for vector in vectors {
        let from = vector.place_mm - centre;
        inertia += machine_model::Matrix::identity() * from.norm_squared() - from * from.transpose();
        moment += from.cross(&(vector.error_mm - mean));
    }
    [mean, inertia.try_inverse().map_or(Vector::zeros(), |inverse| inverse * moment)]
}
