//! What a profile to begin with must know: given, said by the control's own files, or asked for.

use std::path::PathBuf;

use control_files::Machine;
use diagnostic::{Speaks, Text, both, notice};
use machine_model::{Axis, Chain, Range, Vector};
use machine_profile::plus_turns;

use crate::message::{Failure, Messages, OPTION};
use crate::profile_new::arguments::New;
use crate::questions::Questions;
use crate::settings::load_dialect;
use crate::values::{Centre, Given, Sense, Travel};

/// The chain of a machine nobody describes otherwise.
const USUAL: &str = "[w X Y b Z t]";
/// What most machines are, in the order of the question.
const COMMON: [&str; 3] = [USUAL, "[w b X Y Z t]", "[w X b Y Z t]"];

/// All that is needed.
pub(super) struct Answers {
    pub(super) name: String,
    pub(super) control: String,
    pub(super) chain: Chain,
    /// X, Y, Z.
    pub(super) travels_mm: [Range; 3],
    /// A point of the line of each rotary axis of the chain, mm, and the direction about which plus turns it right-handed.
    pub(super) rotary: Vec<(Axis, [f64; 3], Vector)>,
    pub(super) output: Option<PathBuf>,
}

/// What is given, else what the control's files say, else what somebody at a terminal answers.
///
/// Questions begin where name, control or a travel is missing; then the chain is asked for as well.
pub(super) fn complete(arguments: &New, said: Machine, messages: &Messages) -> Result<Answers, Failure> {
    let name = arguments.name.clone().or(said.name);
    let control = arguments.control.clone().or(said.control.map(str::to_owned));
    let travels_mm = travels_mm(arguments, said.travels_mm)?;
    let is_whole = name.is_some() && control.is_some() && travels_mm.iter().all(Option::is_some);
    let questions = if is_whole { None } else { Questions::at_a_terminal(messages) };
    let ask = questions.as_ref();

    let name = match name {
        Some(name) => name,
        None => asked(ask, &both!("1. What is the machine called?", "1. Как называется станок?"), not_empty)?
            .ok_or_else(|| {
                Failure::usage(notice!(OPTION;
                    "--name is not given", "--name не задан";
                    "`--name NAME`, as people call the machine", "`--name ИМЯ`, как зовут станок в цехе"
                ))
            })?,
    };
    let control = match control {
        Some(control) => control,
        None => {
            let names = nc_dialect::builtin_names().join(", ");
            let question = both!("2. Which control? {names}", "2. Какая стойка? {names}");
            let known = |text: &str| match load_dialect(text) {
                Ok(_) => Ok(text.to_owned()),
                Err(_) => Err(both!("one of these: {names}", "одно из: {names}")),
            };
            asked(ask, &question, known)?.ok_or_else(|| {
                Failure::usage(notice!(OPTION;
                    "--control is not given", "--control не задан";
                    "`--control fanuc`; one of: {names}", "`--control fanuc`; одно из: {names}"
                ))
            })?
        }
    };
    load_dialect(&control)?;
    let chain = chain(arguments, &said.rotary, ask)?;
    let mut ranges = [Range { low: 0.0, high: 0.0 }; 3];
    for ((range, travel_mm), axis) in ranges.iter_mut().zip(travels_mm).zip([Axis::X, Axis::Y, Axis::Z]) {
        let letter = axis.letter();
        let question = both!(
            "4. From where to where does {letter} travel? Machine coordinates, mm: 0..500",
            "4. Откуда и докуда ходит {letter}? Координаты станка, мм: 0..500"
        );
        let read = |text: &str| {
            let given: Result<Given<Travel>, _> = format!("{letter}={text}").parse();
            given.map(|travel| travel.range_mm).map_err(|_| {
                both!(
                    "two numbers, the lesser first: 0..500 or -420..0",
                    "два числа, меньшее первым: 0..500 или -420..0"
                )
            })
        };
        *range = match travel_mm {
            Some(range_mm) => range_mm,
            None => asked(ask, &question, read)?.ok_or_else(|| not_once(axis))?,
        };
    }
    let along = |(axis, point_mm)| Ok((axis, point_mm, sense(arguments, &chain, axis, ask)?));
    let rotary = centres(arguments, &chain, ask)?.into_iter().map(along).collect::<Result<_, Failure>>()?;
    let output = match (&arguments.output, ask) {
        (Some(path), _) => Some(path.clone()),
        (None, None) => None,
        (None, Some(ask)) => {
            let usual = usual_file(&name);
            let question = both!("5. To which file? Enter: {usual}", "5. В какой файл? Enter: {usual}");
            let read = |text: &str| Ok(PathBuf::from(if text.is_empty() { usual.as_str() } else { text }));
            Some(ask.ask(&question, read)?)
        }
    };
    Ok(Answers { name, control, chain, travels_mm: ranges, rotary, output })
}

/// The travels that options give, else those of the control's files.
fn travels_mm(arguments: &New, said: [Option<[f64; 2]>; 3]) -> Result<[Option<Range>; 3], Failure> {
    let range = |[low, high]: [f64; 2]| Some(Range { low, high }).filter(|range| range.low < range.high);
    let mut travels_mm = said.map(|ends| ends.and_then(range));
    for (travel_mm, axis) in travels_mm.iter_mut().zip([Axis::X, Axis::Y, Axis::Z]) {
        let mut given = arguments.travel.iter().filter(|travel| travel.axis == axis);
        if let Some(travel) = given.next() {
            *travel_mm = Some(travel.range_mm);
        }
        if given.next().is_some() {
            return Err(not_once(axis));
        }
    }
    Ok(travels_mm)
}

/// The answer of whoever is there; `None` where nobody is.
fn asked<T>(
    ask: Option<&Questions<'_>>,
    question: &Text,
    read: impl Fn(&str) -> Result<T, Text>,
) -> Result<Option<T>, Failure> {
    ask.map(|ask| ask.ask(question, read)).transpose()
}

fn not_empty(text: &str) -> Result<String, Text> {
    if text.is_empty() {
        Err(both!("a word, please", "хотя бы слово"))
    } else {
        Ok(text.to_owned())
    }
}

fn not_once(axis: Axis) -> Failure {
    let letter = axis.letter();
    Failure::usage(notice!(OPTION;
        "--travel of {letter} is not given once", "--travel для {letter} задан не один раз";
        "`--travel {letter}=0..500` with the ends of its travel in machine coordinates",
        "`--travel {letter}=0..500` — концы её хода в координатах станка"
    ))
}

/// The axes from workpiece to tool; `rotary`: those that the control's files name.
fn chain(arguments: &New, rotary: &[char], ask: Option<&Questions<'_>>) -> Result<Chain, Failure> {
    let parsed = |text: &str| {
        Chain::parse(text).map_err(|error| {
            let help = both!(
                "like `--chain '[w X Y b Z t]'`; of a lathe begin with machine-profiles/generic_lathe.toml",
                "например `--chain '[w X Y b Z t]'`; для токарного станка начните с machine-profiles/generic_lathe.toml"
            );
            let error = error.text();
            Failure::usage(notice!(OPTION; "--chain: {error}", "--chain: {error:#}"; help))
        })
    };
    if let Some(text) = &arguments.chain {
        return parsed(text);
    }
    let letters = rotary.iter().map(char::to_string).collect::<Vec<_>>().join(", ");
    let turning = if rotary.is_empty() {
        Text::EMPTY
    } else {
        both!(" It turns {letters}, too.", " Есть и поворотные: {letters}.")
    };
    let [first, second, third] = COMMON;
    let question = both!(
        "3. Which axes carry the workpiece?{turning} 1: a table moves in X and Y, {first}; 2: it stands, {second}; \
         3: it moves in X alone, {third}; or the axes from workpiece to tool, b the bed",
        "3. Какие оси несут заготовку?{turning:#} 1: стол ходит по X и Y, {first}; 2: стоит, {second}; \
         3: ходит только по X, {third}; или оси от заготовки к инструменту, b — станина"
    );
    let read = |text: &str| {
        let number = text.parse::<usize>().ok().and_then(|number| COMMON.get(number.checked_sub(1)?));
        let chosen = Chain::parse(number.copied().unwrap_or(text)).map_err(|error| {
            let error = error.text();
            both!("{error}; like {first}", "{error:#}; например {first}")
        })?;
        let lacks = rotary.iter().find(|letter| !chosen.to_string().contains(**letter));
        match lacks {
            Some(letter) => Err(both!(
                "{letter} is missing: like [w C A X Y b Z t]",
                "нет {letter}: например [w C A X Y b Z t]"
            )),
            None => Ok(chosen),
        }
    };
    if let Some(chain) = asked(ask, &question, read)? {
        return Ok(chain);
    }
    if !rotary.is_empty() {
        return Err(Failure::usage(notice!(OPTION;
            "the machine turns {letters}, and which of them carry the workpiece no file says",
            "у станка есть поворотные оси {letters}, а какие из них несут заготовку, файл не говорит";
            "`--chain '[w C A X Y b Z t]'`, the axes from workpiece to tool; without them where they are not used",
            "`--chain '[w C A X Y b Z t]'` — оси от заготовки к инструменту; без поворотных, если ими не работают"
        )));
    }
    parsed(USUAL)
}

/// A point of the line of each rotary axis.
fn centres(
    arguments: &New,
    chain: &Chain,
    ask: Option<&Questions<'_>>,
) -> Result<Vec<(Axis, [f64; 3])>, Failure> {
    let rotary = || chain.table().iter().chain(chain.head()).copied();
    if let Some(centre) = arguments.centre.iter().find(|centre| rotary().all(|axis| axis != centre.axis)) {
        return Err(Failure::usage(notice!(OPTION;
            "--centre {centre} is of no axis of {chain}",
            "--centre {centre} не относится ни к одной оси цепи {chain}";
            "put {} into `--chain`, or leave the option out",
            "впишите {} в `--chain` или уберите ключ", centre.axis.letter()
        )));
    }
    let centre = |axis: Axis| {
        let letter = axis.letter();
        let mut given = arguments.centre.iter().filter(|centre| centre.axis == axis);
        let first = given.next();
        let not_once = || {
            Failure::usage(notice!(OPTION;
                "--centre of {letter} is not given once", "--centre для {letter} задан не один раз";
                "`--centre {letter}=X,Y,Z` with the machine coordinates of a point of its line",
                "`--centre {letter}=X,Y,Z` — координаты станка одной точки её оси"
            ))
        };
        if given.next().is_some() {
            return Err(not_once());
        }
        let question = both!(
            "Where is a point of the line that {letter} turns about? Machine coordinates, mm: X,Y,Z",
            "Где точка прямой, вокруг которой поворачивается {letter}? Координаты станка, мм: X,Y,Z"
        );
        let read = |text: &str| {
            let given: Result<Given<Centre>, _> = format!("{letter}={text}").parse();
            given
                .map(|centre| centre.point_mm)
                .map_err(|_| both!("three numbers: 250,200,0", "три числа: 250,200,0"))
        };
        let point_mm = match first {
            Some(centre) => Some(centre.point_mm),
            None => asked(ask, &question, read)?,
        };
        point_mm.map(|point_mm| (axis, point_mm)).ok_or_else(not_once)
    };
    rotary().map(centre).collect()
}

/// The direction about which plus turns an axis right-handed.
fn sense(arguments: &New, chain: &Chain, axis: Axis, ask: Option<&Questions<'_>>) -> Result<Vector, Failure> {
    let letter = axis.letter();
    let along = |sign: f64| Vector::ith(axis.direction(), sign);
    let [right, left] = [1.0, -1.0].map(|sign| plus_turns(chain, axis, along(sign)));
    // ISO 841 has plus right-handed where the tool turns; a table turns against that.
    let standard = if chain.table().contains(&axis) { "left" } else { "right" };
    let mut given = arguments.sense.iter().filter(|sense| sense.axis == axis);
    let sign = match (given.next(), given.next()) {
        (Some(sense), None) => Some(sense.sign),
        (Some(_), Some(_)) => None,
        (None, _) => {
            let question = both!(
                "Which way does {letter} count? right: {right}; left: {left} ({standard} by ISO 841)",
                "В какую сторону считает {letter}? right: {right:#}; left: {left:#} (по ISO 841 {standard})"
            );
            let read = |text: &str| Sense::sign(text).ok_or_else(|| both!("right or left", "right или left"));
            asked(ask, &question, read)?
        }
    };
    sign.map(along).ok_or_else(|| {
        Failure::usage(notice!(OPTION;
            "--sense of {letter} is not given once", "--sense для {letter} задан не один раз";
            "turn it by a little and look: `--sense {letter}=right`: {right}; `--sense {letter}=left`: {left} ({standard} by ISO 841)",
            "поверните её немного и посмотрите: `--sense {letter}=right`: {right:#}; `--sense {letter}=left`: {left:#} (по ISO 841 {standard})"
        ))
    })
}

/// A file named after a machine.
fn usual_file(name: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() { c.to_lowercase().next().unwrap_or(c) } else { '_' };
    format!("{}.toml", name.chars().map(plain).collect::<String>())
}
