//! `vpost profile new`: a profile to begin with.

use std::fmt::Write;
use std::path::Path;

use control_files::Machine;
use diagnostic::{Language, both, notice, say};
use machine_model::Axis;
use machine_profile::plus_turns;

use crate::figures::short;
use crate::message::{Failure, Messages, OPTION};
use crate::{file, profile};

mod answers;
mod arguments;

use answers::Answers;
pub(crate) use arguments::New;

/// `vpost profile new`
pub(crate) fn run(arguments: &New, messages: &Messages) -> Result<(), Failure> {
    let said = match &arguments.from {
        None => Machine::default(),
        Some(path) => Machine::read(&file::name(path), &file::read(path)?, arguments.device.as_deref())?,
    };
    let machine = answers::complete(arguments, said, messages)?;
    let text = text(arguments, &machine, messages.language())?;
    // What is wrong is said of the lines as they would stand there.
    let path = machine.output.as_deref().unwrap_or(Path::new("profile.toml"));
    profile::loaded(path, text.as_bytes())?;
    let Some(path) = &machine.output else { return file::print(text.as_bytes()) };
    if path.exists() {
        return Err(Failure::usage(notice!(OPTION;
            "{} is there already", "{} уже есть", file::name(path);
            "give another name, or remove it", "дайте другое имя или уберите его"
        )));
    }
    file::write(path, text.as_bytes())?;
    messages.note(&both!(
        "{}: a profile of {}; fill in what is measured",
        "{}: профиль станка {}; впишите в него измеренное",
        file::name(path),
        machine.name
    ));
    Ok(())
}

/// The profile with an example for each section that it has not, and comments for who fills them in.
fn text(arguments: &New, machine: &Answers, language: Language) -> Result<String, Failure> {
    let chain = &machine.chain;
    let string = |value: &str| toml_edit::Value::from(value).to_string();
    let keys = say!(
        language,
        "Every key: docs/reference.md, or `vpost profile schema`. Check with `vpost profile check`.",
        "Все ключи: docs/reference.md или `vpost profile schema`. Проверить: `vpost profile check`."
    );
    let order = say!(
        language,
        "From workpiece to tool, b the bed: what stands before it carries the workpiece.",
        "От детали к инструменту, b — станина: что стоит до неё, несёт деталь."
    );
    let control = string(&machine.control);
    let corners = say!(
        language,
        "how far it leaves the path at corners, or mode = \"exact-stop\"",
        "насколько она сходит с траектории на углах, или mode = \"exact-stop\""
    );
    let mut text = format!(
        "# {keys}\n\
         format  = 1\n\
         name    = {}\n\
         control = {control}\n\
         # control = {{ dialect = {control}, blending = {{ mode = \"tolerance\", tolerance_mm = 0.005 }} }}   # {corners}\n\
         # {order}\n\
         chain   = {}\n\
         # calibrated = {{ date = \"2026-01-31\", temperature_c = 20.0, instrument = \"interferometer\" }}\n",
        string(&machine.name),
        string(&chain.to_string()),
    );
    for (axis, range_mm) in [Axis::X, Axis::Y, Axis::Z].into_iter().zip(machine.travels_mm) {
        let letter = axis.letter();
        let [low, high, step] = [range_mm.low, range_mm.high, arguments.resolution].map(|mm| short(mm, 6));
        let _ = writeln!(text, "\n[axis.{letter}]\ntravel_mm     = [{low}, {high}]\nresolution_mm = {step}");
        let any = say!(language, "and any of", "и любые из");
        let _ = match arguments.table.iter().filter(|table| table.axis == axis).collect::<Vec<_>>()[..] {
            [] => writeln!(
                text,
                "# errors      = \"errors_{}.csv\"  # position_mm {any} EX{letter}_um EY{letter}_um EZ{letter}_um EA{letter}_urad EB{letter}_urad EC{letter}_urad",
                letter.to_ascii_lowercase()
            ),
            [table] => writeln!(text, "errors        = {}", string(&table.path)),
            _ => {
                return Err(Failure::usage(notice!(OPTION;
                    "--table of {letter} is given twice", "--table для {letter} задан дважды";
                    "one `--table {letter}=FILE` with all six functions",
                    "один `--table {letter}=FILE` со всеми шестью функциями"
                )));
            }
        };
        text.push_str("# backlash_um = 0.0\n");
    }
    for (axis, point_mm, along) in &machine.rotary {
        let letter = axis.letter();
        let [x, y, z] = point_mm.map(|value| short(value, 6));
        let point = say!(
            language,
            "A point of its line, machine coordinates of the linear axes.",
            "Точка на её оси, координаты станка по линейным осям."
        );
        let plus = plus_turns(chain, *axis, *along);
        let plus = plus.in_language(language);
        let [u, v, w] = [along.x, along.y, along.z].map(|value| short(value, 6));
        let _ = writeln!(
            text,
            "\n[rotary.{letter}]\n# {point}\ncentre_mm = [{x}, {y}, {z}]\n# {plus}\ndirection = [{u}, {v}, {w}]"
        );
    }
    let signs = say!(
        language,
        "Signs of ISO 230-1: where the number is above zero, the angle between the axes is this.",
        "Знаки по ISO 230-1: если число больше нуля, угол между осями такой."
    );
    let (above, below) =
        (say!(language, "above 90°", "больше 90°"), say!(language, "below 90°", "меньше 90°"));
    let tip = say!(
        language,
        "From the point where the tables were measured to the tip, mm.",
        "От точки, в которой измерены таблицы, до вершины инструмента, мм."
    );
    let zero = say!(
        language,
        "Machine coordinates of the program's zero.",
        "Координаты станка, где нуль программы."
    );
    let touched = say!(
        language,
        "How it was found: touched off on this machine, with its error there; \"true\": by an outside instrument.",
        "Как он найден: касанием на этом станке, тогда в нём его погрешность; \"true\" — внешним прибором."
    );
    let _ = write!(
        text,
        "\n# {signs}\n\
         [squareness]\n\
         # EC0Y_urad = 0.0  # +X, +Y: {above}\n\
         # EB0Z_urad = 0.0  # +X, +Z: {below}\n\
         # EA0Z_urad = 0.0  # +Y, +Z: {above}\n\
         \n\
         [tool]\n\
         # {tip}\n\
         # default_mm = [0, 0, 0]\n\
         # lengths_mm = {{ H1 = 120.0 }}\n\
         \n\
         [program]\n\
         # {touched}\n\
         # zero = \"touched\"\n\
         \n\
         # {zero}\n\
         [work_offsets_mm]\n\
         # G54 = [0, 0, 0]\n\
         \n\
         [correction]\n\
         # tolerance_um = 1.0\n"
    );
    Ok(text)
}
