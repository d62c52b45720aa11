//! What a machine is, as far as its control says so.

use diagnostic::both;
use measurement_files::Refusal;

use crate::ini::{entries, unit_mm};
use crate::refusals::{BEYOND, File, UNREADABLE, refuse, refuse_whole};

/// What a machine is; what the file leaves open stays open.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Machine {
    /// What people call it.
    pub name: Option<String>,
    /// The dialect of its programs.
    pub control: Option<&'static str>,
    /// Where X, Y and Z end, machine coordinates, mm.
    pub travels_mm: [Option<[f64; 2]>; 3],
    /// Axes that turn to a position; which of them carry the workpiece no such file says.
    pub rotary: Vec<char>,
}

/// The machine of an INI file of LinuxCNC.
pub(crate) fn of_ini(file: File<'_>) -> Result<Machine, Box<Refusal>> {
    let entries = entries(file)?;
    let first =
        |section: &str, key: &str| entries.iter().find(|entry| entry.is(section, key)).map(|e| e.value);
    let unit_mm = unit_mm(file, first("TRAJ", "LINEAR_UNITS"))?;
    let kinematics = first("KINS", "KINEMATICS");
    if let Some(lathe) = first("DISPLAY", "LATHE").filter(|value| value.text != "0") {
        let label = both!("its profile has no Y, and a spindle", "в его профиле нет Y и есть шпиндель");
        let help = both!(
            "begin with a copy of machine-profiles/generic_lathe.toml",
            "начните с копии machine-profiles/generic_lathe.toml"
        );
        return Err(refuse(
            file,
            lathe,
            BEYOND,
            both!("this is a lathe", "это токарный станок"),
            label,
            help,
        ));
    }
    let coordinates =
        first("TRAJ", "COORDINATES").map_or_else(String::new, |value| value.text.to_ascii_uppercase());
    let mut machine = Machine {
        name: first("EMC", "MACHINE").map(|value| value.text.to_owned()),
        control: Some("linuxcnc"),
        rotary: ['A', 'B', 'C'].into_iter().filter(|letter| coordinates.contains(*letter)).collect(),
        ..Machine::default()
    };
    // Joints of such a machine are no axes, and their limits bound no box.
    let is_known = |value: &str| {
        let module = value.split_whitespace().next().unwrap_or_default().to_ascii_lowercase();
        module.starts_with("trivkins") || module.ends_with("-trt-kins") || module == "5axiskins"
    };
    if let Some(value) = kinematics.filter(|value| !is_known(value.text)) {
        let message = both!(
            "this machine has no axes X, Y and Z of its own",
            "у этого станка нет собственных осей X, Y и Z"
        );
        let label = both!("its joints move other than straight", "его приводы движутся иначе");
        let help = both!(
            "vpost models machines with straight axes and turning ones in series",
            "vpost описывает станки из последовательных линейных и поворотных осей"
        );
        return Err(refuse(file, value, BEYOND, message, label, help));
    }
    for (number, (travel, letter)) in machine.travels_mm.iter_mut().zip(['X', 'Y', 'Z']).enumerate() {
        // Up to LinuxCNC 2.7 axes were numbered, 0 for X, also where one was left out.
        let sections = [format!("AXIS_{letter}"), format!("AXIS_{number}")];
        let limit = |key: &str| {
            let Some(value) = sections.iter().find_map(|section| first(section, key)) else {
                return Ok(None);
            };
            let number = value.before(&['#', ';']).trimmed();
            number.number().map(|number| Some(number * unit_mm)).ok_or_else(|| {
                let help = both!("write a number there", "напишите там число");
                let message =
                    both!("`{}` is no limit of {letter}", "`{}` — не предел оси {letter}", value.text);
                refuse(file, value, UNREADABLE, message, both!("expected a number", "ожидалось число"), help)
            })
        };
        let (low, high) = (limit("MIN_LIMIT")?, limit("MAX_LIMIT")?);
        *travel = low.zip(high).map(|(low, high)| [low, high]);
    }
    if machine.travels_mm.iter().all(Option::is_none) {
        let message =
            both!("no axis of this INI file has limits", "ни у одной оси этого INI-файла нет пределов");
        let help = both!(
            "[AXIS_X] MIN_LIMIT and MAX_LIMIT, or leave `--from` out and give `--travel`",
            "[AXIS_X] MIN_LIMIT и MAX_LIMIT; или без `--from`, с `--travel`"
        );
        return Err(refuse_whole(file, UNREADABLE, message, help));
    }
    Ok(machine)
}
