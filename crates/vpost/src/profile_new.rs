//! `vpost profile new`: a profile to begin with.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use diagnostic::{Speaks, both};
use machine_model::{Axis, Chain};

use crate::message::{Failure, Messages};
use crate::number::short;
use crate::settings::load_dialect;
use crate::values::{AxisTable, Centre, Given, Travel};
use crate::{file, profile};

/// `vpost profile new`
#[derive(Debug, Args)]
pub struct New {
    /// Name of the machine.
    #[arg(long)]
    pub name: String,
    /// Dialect of the control, see `vpost grammar list`.
    #[arg(long, value_name = "DIALECT")]
    pub control: String,
    /// Travel of a linear axis, mm; one for each.
    #[arg(long, value_name = "X=LOW..HIGH", required = true, allow_hyphen_values = true)]
    pub travel: Vec<Given<Travel>>,
    /// Axes from workpiece to tool, b the bed.
    #[arg(long, default_value = "[w X Y b Z t]")]
    pub chain: String,
    /// Step of the coordinates that the control takes, mm.
    #[arg(long, value_name = "MM", default_value_t = 0.001)]
    pub resolution: f64,
    /// Table of an axis' errors, relative to the profile.
    #[arg(long, value_name = "X=FILE")]
    pub table: Vec<Given<AxisTable>>,
    /// A point of a rotary axis' line, machine coordinates; one for each.
    #[arg(long, value_name = "C=X,Y,Z", allow_hyphen_values = true)]
    pub centre: Vec<Given<Centre>>,
    /// The profile; a file that is there is left alone.
    #[arg(short = 'o', long, value_name = "PROFILE.toml")]
    pub output: Option<PathBuf>,
}

/// `vpost profile new`
pub(crate) fn run(arguments: &New, messages: &Messages) -> Result<(), Failure> {
    load_dialect(&arguments.control)?;
    let chain = Chain::parse(&arguments.chain).map_err(|error| {
        let help =
            both!("like `--chain '[w X Y b Z t]'`; of a lathe begin with machine-profiles/generic_lathe.toml", "например `--chain '[w X Y b Z t]'`; для токарного станка начните с machine-profiles/generic_lathe.toml");
        let error = error.text();
        Failure::option(both!("--chain: {error}", "--chain: {error:#}"), help)
    })?;
    let text = text(arguments, &chain)?;
    // What is wrong is said of the lines as they would stand there.
    let path = arguments.output.as_deref().unwrap_or(Path::new("profile.toml"));
    profile::loaded(path, text.as_bytes())?;
    let Some(path) = &arguments.output else { return file::print(text.as_bytes()) };
    if path.exists() {
        return Err(Failure::option(
            both!("{} is there already", "{} уже есть", file::name(path)),
            both!("give another name, or remove it", "дайте другое имя или уберите его"),
        ));
    }
    file::write(path, text.as_bytes())?;
    messages.note(&both!(
        "{}: a profile of {}; fill in what is measured",
        "{}: профиль станка {}; впишите в него измеренное",
        file::name(path),
        arguments.name
    ));
    Ok(())
}

/// The profile with an example for each section that it has not.
fn text(arguments: &New, chain: &Chain) -> Result<String, Failure> {
    let string = |value: &str| toml_edit::Value::from(value).to_string();
    let mut text = format!(
        "# Every key: docs/reference.md, or `vpost profile schema`. Check with `vpost profile check`.\n\
         format  = 1\n\
         name    = {}\n\
         control = {}\n\
         # From workpiece to tool, b the bed: what stands before it carries the workpiece.\n\
         chain   = {}\n\
         # calibrated = {{ date = \"2026-01-31\", temperature_c = 20.0, instrument = \"interferometer\" }}\n",
        string(&arguments.name),
        string(&arguments.control),
        string(&chain.to_string()),
    );
    for axis in [Axis::X, Axis::Y, Axis::Z] {
        let letter = axis.letter();
        let Some(Travel { range_mm, .. }) = only(&arguments.travel, |travel| travel.axis == axis) else {
            return Err(Failure::option(
                both!("--travel of {letter} is not given once", "--travel для {letter} задан не один раз"),
                both!(
                    "`--travel {letter}=0..500` with the ends of its travel in machine coordinates",
                    "`--travel {letter}=0..500` — концы её хода в координатах станка"
                ),
            ));
        };
        let [low, high, step] = [range_mm.low, range_mm.high, arguments.resolution].map(|mm| short(mm, 6));
        let _ = writeln!(text, "\n[axis.{letter}]\ntravel_mm     = [{low}, {high}]\nresolution_mm = {step}");
        let _ = match arguments.table.iter().filter(|table| table.axis == axis).collect::<Vec<_>>()[..] {
            [] => writeln!(
                text,
                "# errors      = \"errors_{}.csv\"  # position_mm and any of EX{letter}_um EY{letter}_um EZ{letter}_um EA{letter}_urad EB{letter}_urad EC{letter}_urad",
                letter.to_ascii_lowercase()
            ),
            [table] => writeln!(text, "errors        = {}", string(&table.path)),
            _ => {
                let help = both!(
                    "one `--table {letter}=FILE` with all six functions",
                    "один `--table {letter}=FILE` со всеми шестью функциями"
                );
                return Err(Failure::option(
                    both!("--table of {letter} is given twice", "--table для {letter} задан дважды"),
                    help,
                ));
            }
        };
        text.push_str("# backlash_um = 0.0\n");
    }
    let rotary = || chain.table().iter().chain(chain.head());
    if let Some(centre) = arguments.centre.iter().find(|centre| rotary().all(|axis| *axis != centre.axis)) {
        let help = both!(
            "put {} into `--chain`, or leave the option out",
            "впишите {} в `--chain` или уберите ключ",
            centre.axis.letter()
        );
        return Err(Failure::option(
            both!(
                "--centre {centre} is of no axis of {chain}",
                "--centre {centre} не относится ни к одной оси цепи {chain}"
            ),
            help,
        ));
    }
    for axis in rotary() {
        let letter = axis.letter();
        let Some(Centre { point_mm, .. }) = only(&arguments.centre, |centre| centre.axis == *axis) else {
            return Err(Failure::option(
                both!("--centre of {letter} is not given once", "--centre для {letter} задан не один раз"),
                both!(
                    "`--centre {letter}=X,Y,Z` with the machine coordinates of a point of its line",
                    "`--centre {letter}=X,Y,Z` — координаты станка одной точки её оси"
                ),
            ));
        };
        let [x, y, z] = point_mm.map(|value| short(value, 6));
        let _ = writeln!(
            text,
            "\n[rotary.{letter}]\n# A point of its line, machine coordinates of the linear axes.\ncentre_mm = [{x}, {y}, {z}]"
        );
    }
    text.push_str(
        "\n# Signs of ISO 230-1, vpost profile show says what they mean.\n\
         [squareness]\n\
         # EC0Y_urad = 0.0  # Y against X\n\
         # EB0Z_urad = 0.0  # Z against X\n\
         # EA0Z_urad = 0.0  # Z against Y\n\
         \n\
         [tool]\n\
         # From the point where the tables were measured to the tip, mm.\n\
         # default_mm = [0, 0, 0]\n\
         # lengths_mm = { H1 = 120.0 }\n\
         \n\
         # Machine coordinates of the program's zero.\n\
         [work_offsets_mm]\n\
         # G54 = [0, 0, 0]\n\
         \n\
         [correction]\n\
         # tolerance_um = 1.0\n",
    );
    Ok(text)
}

/// The only one that is wanted; `None` where there is none or are several.
fn only<T>(given: &[Given<T>], is_wanted: impl Fn(&T) -> bool) -> Option<&T> {
    let mut found = given.iter().map(|one| &**one).filter(|one| is_wanted(one));
    found.next().filter(|_| found.next().is_none())
}
