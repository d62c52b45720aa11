//! Prints the second half of `docs/dialects.md`: every shipped dialect, code by code.

use std::io::Write;

fn main() -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    for dialect in nc_dialect::builtin_names().into_iter().filter_map(nc_dialect::builtin) {
        writeln!(out, "{}", nc_dialect::describe(dialect))?;
    }
    Ok(())
}
