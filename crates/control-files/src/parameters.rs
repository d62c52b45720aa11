//! LinuxCNC's file of parameters: work offsets, and what else holds when a program begins.
//!
//! Numbers: LinuxCNC's manual, "Numbered parameters". The file is written when a program ends, after each command by hand
//! (touching off is one) and when LinuxCNC ends; lengths are in the machine's unit.

use std::collections::BTreeMap;

use diagnostic::{Text, both};
use measurement_files::{Piece, Refusal, decoded};

use crate::refusals::{BEYOND, UNREADABLE, refuse, refuse_whole};

/// Nine systems: the code that selects each.
const SYSTEMS: [&str; 9] = ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"];
/// The first number of the first system: X, Y, Z, A, B, C, U, V, W, then the turn about Z.
const FIRST: u32 = 5221;
const BETWEEN: u32 = 20;
/// Which system is in force, from 1.
const SELECTED: u32 = 5220;
/// Not 0: G92 is in force.
const G92_HOLDS: u32 = 5210;

/// The work offsets in a file of parameters: code and machine coordinates of its zero, mm; X of a lathe is a radius.
///
/// * `unit_mm` – the machine's, of its INI file
/// * `has_rotary` – which of A, B, C the machine has: a zero of those must be 0
///
/// # Errors
/// It is none; G92, a turn about Z or a zero of a rotary axis holds; another system than G54 is in force.
pub fn work_offsets(
    name: &str,
    bytes: &[u8],
    unit_mm: f64,
    has_rotary: [bool; 3],
) -> Result<Vec<(String, [f64; 3])>, Box<Refusal>> {
    let text = decoded(bytes);
    let parameters = Parameters::read((name, text.as_ref()))?;
    parameters.begins_in_g54()?;
    let systems = (FIRST..).step_by(BETWEEN as usize).zip(SYSTEMS);
    let zero = |(first, code): (u32, &str)| {
        let zero = parameters.zero(first, code, has_rotary)?;
        Ok((code.to_owned(), zero.map(|units| units * unit_mm)))
    };
    systems.map(zero).collect()
}

/// Values by number, each with its line.
struct Parameters<'t> {
    /// Name and text.
    file: (&'t str, &'t str),
    kept: BTreeMap<u32, (f64, Piece<'t>)>,
}

impl<'t> Parameters<'t> {
    fn read(file: (&'t str, &'t str)) -> Result<Self, Box<Refusal>> {
        let mut kept = BTreeMap::new();
        for line in Piece::lines(file.1).map(Piece::trimmed).filter(|line| !line.text.is_empty()) {
            let mut words = line.words();
            let number = words.next().and_then(|word| word.text.parse::<u32>().ok());
            let value = words.next();
            let (Some(number), Some(value), None) = (number, value.and_then(Piece::number), words.next())
            else {
                let help = both!(
                    "give the file that the INI file names as PARAMETER_FILE, as LinuxCNC writes it",
                    "дайте файл, который INI-файл называет PARAMETER_FILE, таким, каким его пишет LinuxCNC"
                );
                let message =
                    both!("this line is no parameter of LinuxCNC", "эта строка — не параметр LinuxCNC");
                let label = both!("expected a number and its value", "ожидались номер и его значение");
                return Err(refuse(file, line, UNREADABLE, message, label, help));
            };
            kept.insert(number, (value, line));
        }
        if !kept.contains_key(&FIRST) {
            let help = both!(
                "LinuxCNC writes it when it has run once; give the file that the INI file names as PARAMETER_FILE",
                "LinuxCNC пишет его после первого запуска; дайте файл, который INI-файл называет PARAMETER_FILE"
            );
            let message = both!(
                "the file holds no work offset: #5221 is missing",
                "в файле нет смещений нуля: не хватает #5221"
            );
            return Err(refuse_whole(file, UNREADABLE, message, help));
        }
        Ok(Self { file, kept })
    }

    /// What a parameter is; 0 where it is not there.
    fn value(&self, number: u32) -> f64 {
        self.kept.get(&number).map_or(0.0, |(value, _)| *value)
    }

    /// What is refused of a parameter.
    fn refuse(&self, number: u32, message: Text, label: Text, help: Text) -> Box<Refusal> {
        match self.kept.get(&number) {
            Some((_, line)) => refuse(self.file, *line, BEYOND, message, label, help),
            None => refuse_whole(self.file, BEYOND, message, help),
        }
    }

    /// Refuses what shifts a program that names no system: G92, or another system than G54.
    fn begins_in_g54(&self) -> Result<(), Box<Refusal>> {
        if self.value(G92_HOLDS) != 0.0 && (5211..=5219).any(|number| self.value(number) != 0.0) {
            let message = both!(
                "a shift by G92 was in force when this file was written",
                "когда записывался этот файл, действовал сдвиг G92"
            );
            let label = both!("it would shift the program too", "он сдвинул бы и программу");
            let help = both!(
                "end it on the control (G92.1), and give the file anew",
                "отмените его на стойке (G92.1) и дайте файл заново"
            );
            return Err(self.refuse(G92_HOLDS, message, label, help));
        }
        let selected = self.value(SELECTED);
        if selected != 1.0 {
            let code = SYSTEMS.get((selected - 1.0) as usize).filter(|_| selected >= 1.0);
            let message = both!(
                "{} was in force when this file was written",
                "когда записывался этот файл, действовало: {:#}",
                code.map_or(
                    Text::pair("no work offset", "ни одного смещения нуля"),
                    |code| { Text::same(*code) }
                )
            );
            let label = both!(
                "a program that names none would begin in it",
                "программа, которая ничего не выбирает, началась бы с ним"
            );
            let help = both!(
                "select G54 on the control, and give the file anew",
                "выберите на стойке G54 и дайте файл заново"
            );
            return Err(self.refuse(SELECTED, message, label, help));
        }
        Ok(())
    }

    /// Machine coordinates of the zero of a system, in the unit of the file.
    fn zero(&self, first: u32, code: &str, has_rotary: [bool; 3]) -> Result<[f64; 3], Box<Refusal>> {
        if self.value(first + 9) != 0.0 {
            let message = both!(
                "{code} is turned by {} degrees about Z",
                "{code} повёрнуто вокруг Z на {} градусов",
                self.value(first + 9)
            );
            let label = both!("a zero that is turned is no shift", "повёрнутый нуль — не сдвиг");
            let help = both!(
                "end the turn on the control (G10 L2 P{} R0), and give the file anew",
                "отмените поворот на стойке (G10 L2 P{} R0) и дайте файл заново",
                (first - FIRST) / BETWEEN + 1
            );
            return Err(self.refuse(first + 9, message, label, help));
        }
        for (at, axis) in (3u32..).zip(["A", "B", "C"]) {
            if has_rotary[at as usize - 3] && self.value(first + at) != 0.0 {
                let message = both!(
                    "the zero of {axis} under {code} is {} degrees",
                    "нуль {axis} при {code} — {} градусов",
                    self.value(first + at)
                );
                let label =
                    both!("rotary axes have no work offset here", "смещения нуля поворотных осей здесь нет");
                let help = both!(
                    "set it to 0 on the control, and program the machine's own angles",
                    "обнулите его на стойке и программируйте собственные углы станка"
                );
                return Err(self.refuse(first + at, message, label, help));
            }
        }
        Ok([0, 1, 2].map(|at| self.value(first + at)))
    }
}
