//! `--viewer FILE`: what the pages of `check`, `map` and `diagnose` in which the error moves have in common.

use std::collections::BTreeMap;
use std::path::Path;

use diagnostic::{Code, Text, notice};
use jobs::causes::Causes;
use report::viewer::scene::{BEFORE, CAUSES, Cause, Displacement, Place, Scene};
use report::viewer::thinning::TooLarge;

use crate::file;
use crate::message::Failure;

/// Even thinned the path is too large for a page.
const TOO_LARGE: Code = Code(1201);
/// Nothing is fed: there is no path.
const NO_PATH: Code = Code(1202);

/// The texts of all lines may be so long together, bytes, and each no longer than that.
const MOST_TEXT: usize = 1_000_000;
const LONGEST: usize = 160;

/// What is refused where a path cannot be drawn truly.
pub(crate) fn too_large(name: &str, refused: &TooLarge) -> Failure {
    Failure::usage(notice!(TOO_LARGE;
        "{name}: the path is too large for `--viewer`: left out what lies within {:.0} um, {} of its places remain, and a page holds {}",
        "{name}: траектория слишком велика для `--viewer`: если пропустить всё, что ближе {:.0} мкм, точек остаётся {}, а страница вмещает {}",
        refused.path_bound_um, refused.left, refused.most;
        "draw a part of the program: cut it where it positions, or leave `--viewer` out",
        "покажите часть программы, разделив её на позиционировании, или обойдитесь без `--viewer`"
    ))
}

/// What is refused where there is nothing to draw.
pub(crate) fn no_path(name: &str, what: &Text, help: Text) -> Failure {
    Failure::usage(notice!(NO_PATH;
        "{name}: {what}: there is nothing for `--viewer` to draw",
        "{name}: {what:#}: для `--viewer` рисовать нечего";
        help
    ))
}

/// Causes as the page knows them.
pub(crate) fn causes(causes: Option<&Causes>) -> Vec<Cause> {
    let all = causes.map_or(&[][..], Causes::causes);
    all.iter().map(|cause| Cause { kind: cause.kind, symbol: cause.symbol.clone(), russian: None }).collect()
}

/// Displacements of a place, µm: the whole, what is left after, and by each cause what is missing without it.
///
/// * `without_mm` – the displacement on the machine without each cause
pub(crate) fn displacements(
    whole_mm: [f64; 3],
    after_mm: [f64; 3],
    without_mm: &[[f64; 3]],
) -> Vec<Displacement> {
    let um = |mm: [f64; 3]| mm.map(|mm| (mm * 1e3) as f32);
    let by = |without: &[f64; 3]| um([0, 1, 2].map(|axis| whole_mm[axis] - without[axis]));
    [um(whole_mm), um(after_mm)].into_iter().chain(without_mm.iter().map(by)).collect()
}

/// By how much the causes of a place do not add up to the whole, µm.
pub(crate) fn remainder_um(place: &Place) -> f64 {
    let square: f32 = (0..3)
        .map(|axis| {
            let sum: f32 = place.displaced_um[CAUSES..].iter().map(|by| by[axis]).sum();
            (place.displaced_um[BEFORE][axis] - sum).powi(2)
        })
        .sum();
    f64::from(square.sqrt())
}

/// The lines that a scene shows, each cut to what there is room for.
pub(crate) fn blocks<'t>(scene: &Scene, text_of: impl Fn(u64) -> Option<&'t str>) -> BTreeMap<u64, String> {
    let mut lines: Vec<u64> = scene.places.iter().map(|place| place.line).collect();
    lines.sort_unstable();
    lines.dedup();
    let room = (MOST_TEXT / lines.len().max(1)).min(LONGEST);
    let text = |line| {
        let text = report::text::short(text_of(line)?.trim_end(), LONGEST);
        let end = (0..=room.min(text.len())).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
        let cut = if end < text.len() { "\u{2026}" } else { "" };
        Some((line, format!("{}{cut}", &text[..end])))
    };
    lines.into_iter().filter_map(text).collect()
}

/// Writes the page.
pub(crate) fn write(path: &Path, viewer: report::viewer::Viewer<'_>) -> Result<(), Failure> {
    file::write(path, viewer.into_html().as_bytes())
}
