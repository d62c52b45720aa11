//! Lists what stands in each block of a program, and gives the program back.
//!
//! ```console
//! $ cargo run -q -p nc-syntax --example words
//! 1: Percent `%`
//! 2: O `O7`, Comment `(BRACKET)`
//! 3: N `N10`, G `G1`, X `X-12.5`, F `F300`
//! 4: Skip `/`, Y `Y[#1+2.]`
//! 5: Invalid(Number) `X1.2.3`
//! 6: Percent `%`
//! 54 bytes came out as they went in
//! ```

use nc_syntax::{Block, ItemKind, Marks, Reader};

const PROGRAM: &[u8] = b"%\nO7 (BRACKET)\nN10 G1 X-12.5 F300\n/ Y[#1+2.]\nX1.2.3\n%\n";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let marks = Marks::default();
    let (mut reader, mut block) = (Reader::new(PROGRAM, &marks), Block::default());
    let mut again = Vec::new();
    let mut text = String::new();
    while reader.next(&mut block) {
        let items = block.items.iter().map(|item| {
            let name = match item.kind {
                ItemKind::Word { letter, .. } => char::from(letter).to_string(),
                other => format!("{other:?}"),
            };
            format!("{name} `{}`", String::from_utf8_lossy(block.text(item.span)))
        });
        text += &format!("{}: {}\n", block.line, items.collect::<Vec<_>>().join(", "));
        again.extend_from_slice(block.bytes);
    }
    assert_eq!(again, PROGRAM);
    text += &format!("{} bytes came out as they went in\n", again.len());
    std::io::Write::write_all(&mut std::io::stdout(), text.as_bytes())?;
    Ok(())
}
