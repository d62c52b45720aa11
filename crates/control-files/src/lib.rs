//! What controls keep in files: tool lengths and work offsets, bytes in, millimetres out.
//!
//! For lengths three writers are known: LinuxCNC (its INI, which names a tool table and a file of parameters), controls whose offsets
//! come out as a program (G10 L10 and L11), and people with a spreadsheet. What the file leaves open (a unit, an offset
//! that vpost cannot follow) is refused: these numbers move axes.
//!
//! What a machine is begins in such files, too: LinuxCNC's INI, and the answer of an MTConnect agent to `probe`.
//!
//! No files are opened here; a [`Refusal`] knows its place and what to write instead.
//!
//! ```
//! use control_files::tool_lengths;
//!
//! let table = b"T1 P1 Z+4 D0.5 ;end mill\nT12 P3 X0.1 Z-2 ;probe\n";
//! let lengths = tool_lengths("tool.tbl", table, Some(25.4)).expect("a tool table");
//! assert_eq!(lengths, [(1, [0.0, 0.0, 101.6]), (12, [2.54, 0.0, -50.8])]);
//! let refusal = tool_lengths("tool.tbl", table, None).expect_err("inches or millimetres?");
//! assert!(refusal.diagnostic.message.english().contains("does not say in which unit"));
//! ```

mod ini;
mod machine;
mod mtconnect;
mod offset_dump;
mod parameters;
mod refusals;
mod tool_list;
mod tool_table;

pub use ini::Ini;
pub use machine::Machine;
pub use measurement_files::Refusal;
pub use parameters::work_offsets;
pub use tool_list::Length;

/// Tool lengths of a file, whoever wrote it, by ascending number.
///
/// * `name` – the file's, in messages
/// * `unit_mm` – of a LinuxCNC tool table, which does not say it: that of the machine
///
/// # Errors
/// It is none of the three; a line that cannot be read; a unit that nobody says; a number twice.
pub fn tool_lengths(name: &str, bytes: &[u8], unit_mm: Option<f64>) -> Result<Vec<Length>, Box<Refusal>> {
    let text = measurement_files::decoded(bytes);
    let mut lengths = if offset_dump::is_one(&text) {
        offset_dump::lengths(name, &text)?
    } else if tool_table::is_one(&text) {
        tool_table::lengths(name, &text, unit_mm)?
    } else {
        tool_list::lengths(name, bytes)?
    };
    lengths.sort_by_key(|(number, _)| *number);
    Ok(lengths)
}

impl Machine {
    /// Reads the INI file of a LinuxCNC machine, or what an MTConnect agent answers to `probe`.
    ///
    /// * `name` – the file's, in messages
    /// * `device` – which device of an MTConnect agent, where it has several
    ///
    /// # Errors
    /// It is neither; it is of a lathe or of a machine without X, Y, Z of its own; a limit is no number or two contradict
    /// each other; a device is not there, or which one nobody says.
    pub fn read(name: &str, bytes: &[u8], device: Option<&str>) -> Result<Self, Box<Refusal>> {
        let text = measurement_files::decoded(bytes);
        let file = (name, text.as_ref());
        if text.trim_start().starts_with('<') {
            mtconnect::machine(file, device)
        } else {
            machine::of_ini(file)
        }
    }
}
