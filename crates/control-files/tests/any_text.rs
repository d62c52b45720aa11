//! Any file is read or refused, and what is refused has a place in its text.

use control_files::{Ini, Refusal, tool_lengths, work_offsets};
use proptest::prelude::*;

const FILES: [&str; 5] = [
    "T1 P1 Z+0.511 D0.125 ;1/8 end mill\nt2 p2 x1 z-3.5\n",
    "G21\n%\nO1 (OFFSETS)\nN1 G90 G10 L10 P1 R120.5\nG10L11P1R-.02\nG10 L12 P1 R5.\n",
    "tool;length_mm;note\nH1;120,5;a\n2;95,25;\n",
    "5161\t0.0\n5220 1\n5221 1.5\n5222 2\n5223 -3\n5230 0\n5241 1\n",
    "[EMC]\nMACHINE = m\n[TRAJ]\n LINEAR_UNITS =  inch\n[EMCIO]\nTOOL_TABLE = a.tbl\n[RS274NGC]\nPARAMETER_FILE=m.var\n",
];

fn placed(refusal: &Refusal) -> Result<(), TestCaseError> {
    if let Some((_, text)) = &refusal.source
        && let Some(span) = &refusal.diagnostic.span
    {
        prop_assert!(text.is_char_boundary((span.start as usize).min(text.len())));
        prop_assert!(span.end as usize <= text.len() + 1);
    }
    prop_assert!(refusal.diagnostic.help.is_some(), "{refusal:?}");
    Ok(())
}

proptest! {
    #[test]
    fn changed_files(which in 0usize..FILES.len(), at: prop::sample::Index, length in 0usize..12, what in "[-a-zA-Z0-9 .,;=()%+#\n\\[\\]ТХé]{0,8}") {
        let mut text: Vec<char> = FILES[which].chars().collect();
        let from = at.index(text.len());
        let to = (from + length).min(text.len());
        text.splice(from..to, what.chars());
        let bytes = text.into_iter().collect::<String>().into_bytes();
        for unit_mm in [None, Some(25.4)] {
            match tool_lengths("a", &bytes, unit_mm) {
                Ok(lengths) => prop_assert!(lengths.windows(2).all(|pair| pair[0].0 < pair[1].0)),
                Err(refusal) => placed(&refusal)?,
            }
        }
        if let Err(refusal) = work_offsets("a", &bytes, 1.0, [true; 3]) {
            placed(&refusal)?;
        }
        if let Err(refusal) = Ini::read("a", &bytes) {
            placed(&refusal)?;
        }
    }

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = (tool_lengths("a", &bytes, Some(1.0)), work_offsets("a", &bytes, 1.0, [false; 3]), Ini::read("a", &bytes));
    }
}
