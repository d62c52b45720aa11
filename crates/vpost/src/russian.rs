//! The command line in Russian: help, and what is wrong with arguments.
//!
//! clap's texts are doc comments and its own words; the Russian is put in their place where it is asked for.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, Command};

/// Parts of a page of help, with the words that clap would put in English.
const PAGE: &str = "{about-with-newline}\nЗапуск: {usage}\n\n{all-args}{after-help}";

/// The command and all below it, with help in Russian.
///
/// Built before, since the flags and commands that clap adds itself are there only then.
pub(crate) fn spoken(mut command: Command) -> Command {
    command.build();
    said(command)
}

fn said(command: Command) -> Command {
    let about = command.get_about().map(|text| russian(&text.to_string()));
    let after = command.get_after_help().map(|text| russian(&text.to_string()));
    let command = command
        .help_template(PAGE)
        .subcommand_help_heading("Команды")
        .mut_args(argument)
        .mut_subcommands(said);
    let command = match about {
        Some(about) => command.about(about),
        None => command,
    };
    match after {
        Some(after) => command.after_help(after),
        None => command,
    }
}

fn argument(argument: Arg) -> Arg {
    let help = argument.get_help().map(|text| russian(&text.to_string()) + &values(&argument));
    let heading = match argument.get_help_heading() {
        Some(heading) => russian(heading),
        None if argument.is_positional() => "Аргументы".to_owned(),
        None => "Ключи".to_owned(),
    };
    let heading = HEADINGS.into_iter().find(|known| *known == heading);
    let argument = argument.help_heading(heading).hide_possible_values(true).hide_default_value(true);
    match help {
        Some(help) => argument.help(help),
        None => argument,
    }
}

/// What clap says of values in English: the default, and all that there are.
fn values(argument: &Arg) -> String {
    if !argument.get_action().takes_values() {
        return String::new();
    }
    let mut said = String::new();
    let default: Vec<_> = argument.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
    if !default.is_empty() && !argument.is_hide_default_value_set() {
        said.push_str(&format!(" [по умолчанию {}]", default.join(" ")));
    }
    let possible: Vec<String> = argument
        .get_possible_values()
        .iter()
        .filter(|value| !value.is_hide_set())
        .map(|value| value.get_name().to_owned())
        .collect();
    if !possible.is_empty() && !argument.is_hide_possible_values_set() {
        said.push_str(&format!(" [одно из: {}]", possible.join(", ")));
    }
    said
}

const HEADINGS: [&str; 7] =
    ["Аргументы", "Ключи", "Перпендикулярность", "Таблицы", "Станок", "Программа", "Сообщения"];

/// A text of the help in Russian; as it is where it is not known.
fn russian(english: &str) -> String {
    let at = TEXTS.binary_search_by_key(&english, |(known, _)| known);
    at.map_or(english, |at| TEXTS[at].1).to_owned()
}

/// What is wrong with arguments.
pub(crate) fn error(error: &clap::Error) -> String {
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => text.clone(),
        Some(ContextValue::Strings(texts)) => texts.join(", "),
        Some(ContextValue::StyledStr(text)) => text.to_string(),
        Some(ContextValue::StyledStrs(texts)) => {
            texts.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
        }
        Some(ContextValue::Number(number)) => number.to_string(),
        _ => String::new(),
    };
    let (argument, value) = (text(ContextKind::InvalidArg), text(ContextKind::InvalidValue));
    let one_of = match text(ContextKind::ValidValue) {
        values if values.is_empty() => String::new(),
        values => format!("; есть {values}"),
    };
    let mut said = match error.kind() {
        ErrorKind::InvalidValue if value.is_empty() => format!("у `{argument}` нет значения{one_of}"),
        ErrorKind::InvalidValue => format!("`{argument}`: значения `{value}` нет{one_of}"),
        ErrorKind::UnknownArgument => format!("ключ `{argument}` незнаком"),
        ErrorKind::InvalidSubcommand => {
            format!("команды `{}` нет", text(ContextKind::InvalidSubcommand))
        }
        ErrorKind::MissingRequiredArgument => format!("не хватает: {argument}"),
        ErrorKind::MissingSubcommand => "не хватает команды".to_owned(),
        ErrorKind::ArgumentConflict => {
            let (own, prior) = (text(ContextKind::Custom), text(ContextKind::PriorArg));
            if !own.is_empty() {
                own
            } else if prior == argument {
                format!("`{argument}` дан дважды")
            } else {
                format!("`{argument}` и `{prior}` исключают друг друга")
            }
        }
        ErrorKind::NoEquals => format!("`{argument}`: значение пишется через `=`"),
        ErrorKind::TooManyValues => format!("`{argument}`: значение `{value}` лишнее"),
        ErrorKind::TooFewValues | ErrorKind::WrongNumberOfValues => {
            format!(
                "`{argument}`: значений {}, а нужно {}",
                text(ContextKind::ActualNumValues),
                text(ContextKind::MinValues) + &text(ContextKind::ExpectedNumValues)
            )
        }
        ErrorKind::ValueValidation => format!("`{argument}`: значение `{value}` непонятно"),
        ErrorKind::InvalidUtf8 => "аргумент не в UTF-8".to_owned(),
        _ => return error.render().to_string(),
    };
    said.insert_str(0, "ошибка: ");
    for kind in [ContextKind::SuggestedArg, ContextKind::SuggestedSubcommand, ContextKind::SuggestedValue] {
        let near = text(kind);
        if !near.is_empty() {
            said.push_str(&format!("\n\nимелось в виду `{near}`?"));
        }
    }
    let usage = text(ContextKind::Usage);
    if !usage.is_empty() {
        said.push_str(&format!("\n\n{}", usage.replace("Usage:", "Запуск:")));
    }
    said.push_str("\n\nПодробнее: `--help`");
    said
}

/// English and Russian, in the order of the English.
#[rustfmt::skip]
const TEXTS: &[(&str, &str)] = &[
    ("A file is whole if it stays so long as it is, s", "Файл цел, если столько не меняется, с"),
    ("A part of the volume to give figures and zero points for, mm (repeatable)", "Часть объёма, для которой дать числа и нули, мм (можно повторять)"),
    ("A point of a rotary axis' line, machine coordinates; one for each", "Точка на поворотной оси, координаты станка; по одной на каждую"),
    ("A point through which the axes of the table should go, machine coordinates, mm, where the base profile has no centre_mm", "Точка, через которую должны проходить оси стола, координаты станка, мм, если в исходном профиле нет centre_mm"),
    ("All options: vpost correct --help\n\nExit: 0 done; 1 refused, nothing is written; 2 usage; 75 try again; 130, 143 signal\nExample: vpost in.nc -m machine-profiles/stan_s500.toml -o out.nc", "Все ключи: `vpost correct --help`\n\nКод завершения: 0 сделано; 1 не принято, ничего не записано; 2 ошибка вызова;\n75 повторить позже; 130, 143 сигнал\nПример: vpost in.nc -m machine-profiles/stan_s500.toml -o out.nc"),
    ("Answer an editor: messages as you type (LSP)", "Отвечать редактору: сообщения при правке (LSP)"),
    ("As the instrument gave it, µrad", "Как её дал прибор, мкрад"),
    ("At which angles products of errors begin to matter", "При каких углах начинают сказываться произведения погрешностей"),
    ("Axes from workpiece to tool, b the bed; `[w X Y b Z t]` if not given", "Оси от детали к инструменту, станина — b; если не заданы, `[w X Y b Z t]`"),
    ("Axes of a new profile: \"[w X Y b Z t]\"", "Оси нового профиля: \"[w X Y b Z t]\""),
    ("Ball bar: location errors of a table's rotary axes, or squareness, scale mismatch and backlash of linear axes", "Телескопический измеритель: положение поворотных осей стола или перпендикулярность, масштаб и люфт линейных осей"),
    ("Ball deviations (CSV): run, one mounting of the ball; x_mm … z_mm, a_deg … c_deg commanded; dx_um dy_um dz_um, workpiece frame; tool_x_mm …, dir_a …, u_um or u_x_um …, repeat, temp_c where known", "Отклонения шара (CSV): run — одна установка шара; x_mm … z_mm, a_deg … c_deg заданные; dx_um dy_um dz_um в системе детали; tool_x_mm …, dir_a …, u_um или u_x_um …, repeat, temp_c, если известны"),
    ("Ball deviations at angles of A, B, C, by R-test or by probe and sphere: location errors and error functions of rotary axes", "Отклонения шара при углах A, B, C, R-тест или щуп и сфера: погрешности положения и функции погрешностей поворотных осей"),
    ("Begin a corrected program anew at one of its lines", "Начать исправленную программу заново с одной из её строк"),
    ("Begin at this line", "Начать с этой строки"),
    ("Between targets: linear, monotone", "Между целями: linear, monotone"),
    ("Beyond the volume: refuse, or clamp to its edge", "Вне объёма: refuse (отказать) или clamp (взять край)"),
    ("Column to pass over (repeatable)", "Столбец, который пропустить (можно повторять)"),
    ("Commanded points (CSV), or with --lathe the program; - for standard input", "Заданные точки (CSV), с --lathe — программа; - стандартный ввод"),
    ("Completions for a shell", "Автодополнение для оболочки"),
    ("Conditions: temp_c=24, time_s=600 … (repeatable)", "Условия: temp_c=24, time_s=600 … (можно повторять)"),
    ("Control points of a file instead (CSV, as for `vpost predict`); - for standard input", "Контрольные точки из файла (CSV, как для `vpost predict`); - стандартный ввод"),
    ("Control points: a ball on the rotary table, at a radius and a height from its centre, mm, which the linear axes follow through the angles of both rotary axes in steps of 30 degrees; the leading axis turns slowest", "Контрольные точки: шар на поворотном столе, радиус и высота от его центра, мм; линейные оси следуют за ним по углам обеих поворотных осей с шагом 30 градусов; ведущая ось поворачивается реже"),
    ("Control points: nodes of X, Y and Z, how many over the calibrated volume (22x22x21), or from:to:step in mm for each (40:880:40,30:450:20,5:505:25)", "Контрольные точки: узлы X, Y и Z, сколько их на объём (22x22x21) или от:до:шаг в мм для каждой (40:880:40,30:450:20,5:505:25)"),
    ("Correct a program that says it was corrected before", "Исправить программу, в которой сказано, что она исправлена"),
    ("Correct a program: the main job, which needs no name", "Исправить программу: главная команда, имя можно опустить"),
    ("Correct all again, and write over any file", "Исправить всё заново и писать поверх любых файлов"),
    ("Correct many programs, on all cores or on many machines", "Исправить много программ, на всех ядрах или на многих машинах"),
    ("Correct one share of a manifest's programs", "Исправить одну часть программ задания"),
    ("Correct whatever is saved into a folder", "Исправлять всё, что сохраняется в папку"),
    ("Correction engine; default: the profile's", "Метод исправления; иначе — из профиля"),
    ("Count errors from this zero of the profile, as it was touched", "Считать погрешности от этого нуля профиля, как его нашли"),
    ("Day of the measurement: year-month-day", "День измерения: год-месяц-день"),
    ("Deviations that stay as they are while the others are made smaller: EXX,EC0Y (repeatable)", "Отклонения, которые остаются, пока уменьшают другие: EXX,EC0Y (можно повторять)"),
    ("Dialect of the control, see `vpost grammar list`", "Диалект стойки, см. `vpost grammar list`"),
    ("Dialect of the control; default: the profile's", "Диалект стойки; иначе — из профиля"),
    ("Diameters of further parts that judge the profile; one that makes them worse is not written", "Диаметры других образцов, которые судят профиль; если он их ухудшает, он не записывается"),
    ("Distance of the lattice's points, mm", "Расстояние между точками решётки, мм"),
    ("Do two programs cut alike on this machine?", "Одинаково ли обрабатывают две программы на станке?"),
    ("Effect that this machine does not have, or the instrument (repeatable)", "Эффект, которого у станка или прибора нет (можно повторять)"),
    ("End when all that is there is corrected", "Закончить, когда исправлено всё, что есть"),
    ("Files with runs or tables. Where a file does not say what it holds: FILE=EXX:um", "Файлы с проходами или таблицами. Если файл не говорит, что в нём: FILE=EXX:um"),
    ("Find the place for a workpiece of this size, mm", "Найти место для детали такого габарита, мм"),
    ("Folder for the files", "Папка для файлов"),
    ("Folder of subprograms (repeatable)", "Папка подпрограмм (можно повторять)"),
    ("Folder of the corrected programs", "Папка исправленных программ"),
    ("Folder that programs are saved into", "Папка, в которую сохраняются программы"),
    ("From the gauge point to the moving optics, mm", "От базовой точки до подвижной оптики, мм"),
    ("Give positions in the measuring frame: apply the profile's `[setup]`", "Положения в измерительной системе: с разделом `[setup]` профиля"),
    ("Grammar files (TOML)", "Файлы таблиц диалектов (TOML)"),
    ("Has the machine changed since this profile?", "Изменился ли станок с этого профиля?"),
    ("ISG, axes under the part: line or carriage", "ISG, оси под деталью: line или carriage"),
    ("In folders, leave out such (repeatable)", "В папках исключить такие (можно повторять)"),
    ("In folders, take such files (repeatable)", "В папках брать такие файлы (можно повторять)"),
    ("Interval whose directions make G and r01, from 0", "Интервал, по направлениям которого составлены G и r01, с 0"),
    ("Its step l of model time; 0.1 if not given", "Его шаг l модельного времени; если не задан, 0.1"),
    ("K of the astatic law of `kmtpp-published`; 1.5 if not given", "K астатического закона `kmtpp-published`; если не задан, 1.5"),
    ("Largest deviation where that fails, um", "Наибольшее отклонение, где так не выходит, мкм"),
    ("Largest path deviation, um", "Наибольшее отклонение от траектории, мкм"),
    ("Leave out such (repeatable)", "Пропускать такие (можно повторять)"),
    ("Length of an H number, mm (repeatable)", "Длина по номеру H, мм (можно повторять)"),
    ("List or check dialect tables", "Перечислить или проверить таблицы диалектов"),
    ("Machine", "Станок"),
    ("Machine coordinates of a zero, mm (repeatable)", "Координаты нуля на станке, мм (можно повторять)"),
    ("Machine position on the measured lines, mm", "Точка станка на измеренных линиях, мм"),
    ("Machine profile (TOML)", "Профиль станка (TOML)"),
    ("Make a machine profile from an instrument's files", "Сделать профиль станка по файлам прибора"),
    ("Make, check, show or describe machine profiles", "Создать, проверить, показать или описать профиль станка"),
    ("Measured points (CSV): dx_um dy_um dz_um, xm_mm ym_mm zm_mm, or length_mm from a station bx_mm by_mm bz_mm", "Измеренные точки (CSV): dx_um dy_um dz_um, xm_mm ym_mm zm_mm или length_mm от стоянки bx_mm by_mm bz_mm"),
    ("Measured test pieces (CSV): part, z_mm, diameter_mm, d_um; feature, tool, time_s, u_um where known", "Измеренные образцы (CSV): part, z_mm, diameter_mm, d_um; feature, tool, time_s, u_um, если известны"),
    ("Measured test pieces of a lathe: taper, bow, squareness, sizes of the tools, growth and wear", "Измеренные образцы токарного станка: конус, прогиб, перпендикулярность, размеры резцов, рост и износ"),
    ("Measurements (CSV); - for standard input", "Измерения (CSV); - стандартный ввод"),
    ("Measurements that no fit may see: the predicted shrinkage is checked on them", "Измерения, которых подгонка не видит: по ним проверяется предсказанное уменьшение"),
    ("Messages", "Сообщения"),
    ("More about what is done", "Больше о том, что делается"),
    ("N of the shards that were run", "N — число частей, которые шли"),
    ("NC program; - for standard input", "Управляющая программа; - стандартный ввод"),
    ("NC programs, or folders with all programs in them", "Программы или папки, в которых лежат программы"),
    ("Name of the machine, for a new profile", "Имя станка, для нового профиля"),
    ("Name of the machine; at a terminal vpost asks for what is not given", "Имя станка; о том, что не задано, vpost спросит с терминала"),
    ("Nodes of the tables per axis", "Узлов таблиц на ось"),
    ("Nodes: how many (22x22x21), or from:to:step of each axis, mm", "Узлы: сколько (22x22x21) или от:до:шаг по каждой оси, мм"),
    ("Number of a message: VP0509, or 509", "Номер сообщения: VP0509 или 509"),
    ("Of a control: positions, errors, corrections", "Таблица стойки: positions, errors, corrections"),
    ("One point of so many is held out of a first fit and judges it, spread over the rows; 0: none", "Одна точка из стольких оставлена от первой подгонки и судит её, вразброс по строкам; 0 — ни одной"),
    ("Plus is right-handed or larger-than90", "Плюс — right-handed или larger-than90"),
    ("Plus turns a rotary axis right or left about its letter's direction; one for each", "Плюс поворачивает ось вправо (right) или влево (left) вокруг направления её буквы; для каждой свой"),
    ("Points anywhere in the volume, of a tracker or a tracking interferometer: all rigid-body terms", "Точки где угодно в объёме, от трекера или следящего интерферометра: все погрешности твёрдых тел"),
    ("Predict what a lathe turns by a program: radius along Z, roundness, cylindricity, roughness", "Предсказать, что токарный станок выточит по программе: радиус вдоль Z, круглость, цилиндричность, шероховатость"),
    ("Print all commands and options as JSON", "Вывести все команды и ключи как JSON"),
    ("Print only the shards that must run again, in the form that this engine takes", "Напечатать только части, которые надо запустить снова, в записи этого планировщика"),
    ("Print the JSON Schema of profiles", "Напечатать JSON Schema профилей"),
    ("Print this message or the help of the given subcommand(s)", "Напечатать эту справку или справку названных команд"),
    ("Print version", "Напечатать версию"),
    ("Print what to measure next instead of the summary: rows to fill in, or the NC program that goes there", "Напечатать, что измерить дальше: строки или управляющую программу"),
    ("Print what to measure on this machine, and nothing else: rows to fill in, or the NC program that goes there", "Напечатать, что измерить на станке: строки или управляющую программу"),
    ("Program", "Программа"),
    ("Programs at once; default: one a core", "Программ сразу; иначе — одна на ядро"),
    ("Put in blocks that stop where offsets differ", "Вставить кадры: стоп, если смещения другие"),
    ("Read a profile and everything it names; say what is wrong", "Прочесть профиль и всё, что он называет; сказать, что неверно"),
    ("Read grammar files; say what is wrong", "Прочесть таблицы диалектов; сказать, что неверно"),
    ("Readings (CSV): run, x_mm … z_mm of the moving ball, bx_mm … bz_mm of the other at angle 0, length_mm, and a_deg, b_deg, c_deg, spindle_deg or dir_x … dir_z", "Показания (CSV): run, x_mm … z_mm подвижного шара, bx_mm … bz_mm другого при угле 0, length_mm и a_deg, b_deg, c_deg, spindle_deg или dir_x … dir_z"),
    ("Refuse doubtful programs", "Не принимать сомнительных программ"),
    ("Report progress: linuxcnc", "Сообщать о ходе работы: linuxcnc"),
    ("Rewrites NC programs so that a measured machine goes where the program says", "Переписывает управляющие программы так, чтобы измеренный станок шёл туда, куда велит программа"),
    ("Rows that no fit sees judge the profile; one that makes them worse is not written", "Отложенные строки проверяют профиль; тот, с которым они хуже, не записывается"),
    ("Runs of an interferometer, or tables of a control: eighteen functions, squareness, ISO 230-2", "Проходы интерферометра или таблицы стойки: восемнадцать функций, перпендикулярность, ISO 230-2"),
    ("Say what a profile means", "Сказать, что значит профиль"),
    ("Say which programs of a manifest are not corrected yet", "Сказать, какие программы задания ещё не исправлены"),
    ("Seed of the random relabellings behind the p values of places", "Начальное число случайных перестановок для p мест"),
    ("Settings from this file; none: from no file", "Настройки из этого файла; none — без файла"),
    ("Show the cosines without their signs, as Tables 2.6 to 2.12 of Pimushkin 2023 print them. The profile keeps the signs", "Показать косинусы без знаков, как в таблицах 2.6–2.12 Пимушкина (2023). В профиле знаки остаются"),
    ("Slopes of the curves: remove or keep", "Наклоны кривых: remove (убрать) или keep"),
    ("Squareness", "Перпендикулярность"),
    ("Standard uncertainty of one reading, µm; default: from the repeats, or from the roughness of the lines", "Стандартная неопределённость одного показания, мкм; иначе — по повторам или по неровности линий"),
    ("Standard uncertainty of the instrument, µm/m; 0.5", "Стандартная неопределённость, мкм/м; 0.5"),
    ("Step of the coordinates that the control takes, mm", "Дискрета координат, которую принимает стойка, мм"),
    ("Table of an axis' errors, relative to the profile", "Таблица погрешностей оси, путь от профиля"),
    ("Tables", "Таблицы"),
    ("Take such files (repeatable)", "Брать такие файлы (можно повторять)"),
    ("Take the columns as named: no look for flipped signs, swapped columns", "Брать столбцы как названы: не искать обратных знаков и переставленных столбцов"),
    ("Target points (CSV); - for standard input", "Цели (CSV); - стандартный ввод"),
    ("Temperature of the machine, °C; else temp_c", "Температура станка, °C; иначе — temp_c"),
    ("The control's corners: keep, tolerance or exact", "Углы: как в программе, допуск или останов"),
    ("The corrected program", "Исправленная программа"),
    ("The dialects vpost knows, with their assumptions", "Диалекты, которые знает vpost, и что о них принято"),
    ("The error over the volume, and where to put the workpiece", "Погрешность по объёму и куда поставить деталь"),
    ("The form", "Форма"),
    ("The instrument's frame: turned until the lines lie along the axes, or aligned to the machine and taken as it is", "Система прибора: повёрнута так, что линии лежат вдоль осей, или выставлена по станку и взята как есть"),
    ("The manifest", "Задание"),
    ("The manifest to write (JSON Lines)", "Записать такое задание (JSON Lines)"),
    ("The manual pages (roff)", "Страницы руководства (roff)"),
    ("The profile; a file that is there is left alone", "Профиль; существующий файл не тронут"),
    ("The program as posted", "Программа, какой её выдал постпроцессор"),
    ("The program, as the machine has it; - for standard input", "Программа, какая она на станке; - стандартный ввод"),
    ("The program, or its folder; default: the current one", "Программа или её папка; иначе — текущая папка"),
    ("The result as JSON on standard output", "Результат как JSON в стандартный вывод"),
    ("The rows are places at which a touch probe was centred on a sphere fixed to the workpiece: no dx_um dy_um dz_um", "Строки — места, где щуп центрировали по сфере, закреплённой на детали: без dx_um dy_um dz_um"),
    ("The same for a layer of nodes, at a place of the third axis in mm, or for every layer (repeatable)", "То же для слоя узлов, в месте третьей оси в мм, или для каждого слоя (можно повторять)"),
    ("The same for a workpiece, where its axis commands lie, mm", "То же для детали, где лежат команды её осей, мм"),
    ("The same tests after a compensation: a table before and after", "Те же опыты после компенсации: таблица до и после"),
    ("The settings as JSON on standard output", "Настройки как JSON в стандартный вывод"),
    ("The shell", "Оболочка"),
    ("This help; everywhere: -q, --lang en|ru, --color WHEN", "Эта справка; везде: -q, --lang en|ru, --color WHEN"),
    ("Three axis traverses of a laser tracker: directions, squareness, positioning and straightness", "Три прохода по осям лазерным трекером: направления, перпендикулярность, позиционирование и прямолинейность"),
    ("Tolerance for the share of nodes within it, µm", "Допуск для доли узлов в нём, мкм"),
    ("Tool lengths: CSV, a dump of G10, or .tbl", "Длины инструмента: CSV, вывод G10 или .tbl"),
    ("Tool vector, gauge point to tip, mm: an H number of the profile or X,Y,Z; default: the profile's", "Вектор инструмента, от базовой точки к вершине, мм: номер H профиля или X,Y,Z; иначе — из профиля"),
    ("Travel of a linear axis, mm; one for each", "Ход линейной оси, мм; по одному на каждую"),
    ("Traverses of X, of Y and of Z (CSV), in this order", "Проходы X, Y и Z (CSV), в этом порядке"),
    ("Two directions: tables or mean", "Направления: tables или mean"),
    ("Use nodes this far apart only: longer chords know their directions better", "Брать только узлы на таком расстоянии: у длинных хорд направления известны лучше"),
    ("Variable that the program does not set", "Переменная, которую программа не задаёт"),
    ("Wanted M, largest error at the control points, µm: what to mend, and what each deviation may be", "Желаемая M, наибольшая погрешность в контрольных точках, мкм: что исправить и каким может быть каждое отклонение"),
    ("Ways of runs: alternating, up or down", "Направления проходов: alternating, up или down"),
    ("What Z10 is: increments or millimetres", "Z10 без точки: increments или millimetres"),
    ("What a message means and what to do: VP0509", "Что значит сообщение и что делать: VP0509"),
    ("What became of each program (JSON Lines)", "Что стало с каждой программой (JSON Lines)"),
    ("What each deviation of the machine costs", "Во что обходится каждое отклонение станка"),
    ("What is corrected on five axes: xyz or full", "Что исправлять на пяти осях: xyz или full"),
    ("What it was measured with", "Чем измерено"),
    ("What the control says of itself: LinuxCNC's INI, or an MTConnect `probe`", "Что стойка говорит о себе: INI-файл LinuxCNC или ответ MTConnect на `probe`"),
    ("What to command so that the tool reaches points", "Что задать, чтобы инструмент пришёл в точки"),
    ("What work offsets are: touched or true", "Нули: touched (касанием) или true"),
    ("Where a zero was touched, mm (repeatable)", "Где касались нуля, мм (можно повторять)"),
    ("Where the axes stand at the start, mm", "Где стоят оси в начале, мм"),
    ("Where the machine really goes for commanded points", "Куда станок на самом деле придёт по заданным точкам"),
    ("Where the rotary axes stand at the nodes of the grid, degrees; 0 if not given", "Где стоят поворотные оси в узлах сетки, градусы; 0, если не задано"),
    ("Where the rotary axes stand, degrees; 0 if not given", "Где стоят поворотные оси, градусы; 0, если не задано"),
    ("Whether the lattice holds what the machine does wrong or what the control adds", "Что в решётке: погрешности станка или то, что прибавляет стойка"),
    ("Which device of the `probe`, where it has several", "Которое устройство из ответа на `probe`, если их несколько"),
    ("Which settings of vpost.toml hold, and from where", "Какие настройки vpost.toml действуют и откуда они"),
    ("Which share: the I-th of N, I from 1; or `auto/N`: I from `HQ_TASK_ID`, `SLURM_ARRAY_TASK_ID` (both from 1) or `JOB_COMPLETION_INDEX` (from 0), the first that is set. Default: all", "Какая часть: I-я из N, I от 1; или `auto/N`: I из `HQ_TASK_ID`, `SLURM_ARRAY_TASK_ID` (оба от 1) или `JOB_COMPLETION_INDEX` (от 0), первая из заданных. Иначе — все"),
    ("Which unmodelled effect explains the measurements", "Какой неучтённый эффект объясняет измерения"),
    ("With --html: Z from the chuck of a cross section to draw, mm (repeatable)", "С --html: Z сечения от торца патрона, которое начертить, мм (можно несколько раз)"),
    ("With --lathe: distance of the places along Z, mm", "С --lathe: расстояние между местами вдоль Z, мм"),
    ("With --lathe: the result as JSON on standard output", "С --lathe: результат как JSON в стандартный вывод"),
    ("With --lathe: the tool cuts a bore, so that the largest radius counts", "С --lathe: резец растачивает, так что считается наибольший радиус"),
    ("With --lathe: what to add to the wear offsets of X, by tool and cylinder, for who may change offsets only", "С --lathe: что прибавить к износу X, по инструментам и цилиндрам, — для тех, кому можно менять только коррекции"),
    ("With --lathe: write a page with the outline, its roundness, and what a correction will bring", "С --lathe: записать страницу: контур, круглость и что даст исправление"),
    ("Write a page for a browser: drawings, numbers", "Записать страницу для браузера: рисунки, числа"),
    ("Write a page in which the error moves", "Записать страницу, на которой погрешность движется"),
    ("Write a profile to begin with, its sections explained", "Записать профиль для начала, с пояснениями разделов"),
    ("Write a summary (JSON)", "Записать сводку (JSON)"),
    ("Write all figures (JSON)", "Записать все числа (JSON)"),
    ("Write down the programs and how to correct them: the manifest", "Записать, какие программы исправлять и как: задание"),
    ("Write finer tables, with this step", "Записать более частые таблицы, с этим шагом"),
    ("Write the diagnosis as JSON", "Записать диагностику как JSON"),
    ("Write the diagnosis as one page for a browser", "Записать диагностику одной страницей для браузера"),
    ("Write the errors of all nodes (CSV)", "Записать погрешности всех узлов (CSV)"),
    ("Write the map as one page with drawings (HTML)", "Записать карту одной страницей с рисунками (HTML)"),
    ("Write the map for ParaView (VTK)", "Записать карту для ParaView (VTK)"),
    ("Write the model in a form that a control takes", "Записать модель в форме, которую принимает стойка"),
    ("Write the numbers of the drawings as CSV", "Записать числа рисунков как CSV"),
    ("Write the pages of all commands into this folder", "Записать страницы всех команд в эту папку"),
    ("Write the profile with the causes added as effects", "Записать профиль с причинами-эффектами"),
    ("Write the result as one page: the tool path coloured by its error, the worst blocks (HTML)", "Записать результат одной страницей: путь инструмента, раскрашенный погрешностью, худшие кадры (HTML)"),
    ("Write this profile; without: the report only", "Записать профиль; без ключа — только отчёт"),
    ("Write to this file, all or nothing", "Записать в этот файл, целиком или ничего"),
    ("Write what became of each program (JSON Lines, in the order of the outputs' names); `-` for standard output", "Записать, что стало с каждой программой (JSON Lines, по порядку имён выходных файлов); `-` — стандартный вывод"),
    ("Write what was found as JSON", "Записать найденное как JSON"),
    ("Write what was found, with covariance, as JSON", "Записать найденное с ковариацией как JSON"),
    ("Z of the way above the workpiece, mm", "Z пути над деталью, мм"),
    ("Zeros and lengths of a LinuxCNC machine", "Нули и длины станка с LinuxCNC"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_of_the_help_is_known_and_no_other() {
        fn collect(command: &Command, found: &mut Vec<String>) {
            found.extend(command.get_about().map(ToString::to_string));
            found.extend(command.get_after_help().map(ToString::to_string));
            for argument in command.get_arguments().filter(|argument| !argument.is_hide_set()) {
                found.extend(argument.get_help().map(ToString::to_string));
                found.extend(argument.get_help_heading().map(str::to_owned));
            }
            command.get_subcommands().for_each(|inner| collect(inner, found));
        }
        let mut command = crate::command_line::command();
        command.build();
        let mut found = Vec::new();
        collect(&command, &mut found);
        found.retain(|text| !text.is_empty());
        found.sort_unstable();
        found.dedup();
        let known: Vec<&str> = TEXTS.iter().map(|(english, _)| *english).collect();
        let missing: Vec<_> = found.iter().filter(|text| !known.contains(&text.as_str())).collect();
        let stale: Vec<_> = known.iter().filter(|text| !found.iter().any(|found| found == *text)).collect();
        assert!(missing.is_empty() && stale.is_empty(), "missing: {missing:#?}\nstale: {stale:#?}");
        assert!(TEXTS.is_sorted_by(|(a, _), (b, _)| a < b));
    }
}
