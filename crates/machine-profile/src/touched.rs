//! Reads what a profile says of its zeros.

use std::collections::BTreeMap;

use diagnostic::{Text, both};
use machine_model::Way;
use toolpath::AXIS_NAMES;

use crate::error::{CONFLICT, KEY};
use crate::loader::Loader;
use crate::number::{Finite, Length, Spanned};
use crate::zeros::{
    AlignedTo, End, Found, FoundOffset, OnePlace, Places, ToolThatTouched, TouchPlace, TouchedAt, TouchedBy,
    WorkOffset, ZeroFound,
};

/// Of each work offset.
type ByName<T> = Vec<(String, T)>;

impl Loader<'_> {
    /// Places of the zeros, and how each was found.
    pub(crate) fn work_offsets(
        &mut self,
        written: &BTreeMap<String, Spanned<WorkOffset>>,
        has_rotary: [bool; 3],
    ) -> (ByName<[f64; 3]>, ByName<ZeroFound>) {
        let (mut offsets, mut found) = (Vec::new(), Vec::new());
        for (name, offset) in written {
            if !name.strip_prefix('G').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit())) {
                let message = both!("`{name}` is no work offset", "`{name}` — не смещение нуля");
                let help = both!(
                    "write the word that selects it, like G54 or \"G54.1 P2\"",
                    "напишите слово, которым его выбирают, например G54 или \"G54.1 P2\""
                );
                self.refuse(offset, KEY, message, both!("of this entry", "в этой записи"), help);
            }
            let place = match offset.get_ref() {
                WorkOffset::Place(place) => place,
                WorkOffset::Found(found_offset) => {
                    let FoundOffset { at, zero, touched_at, aligned } = &**found_offset;
                    let places =
                        touched_at.as_ref().map(|places| self.touched_at(offset, places, has_rotary));
                    let aligned = aligned.as_ref().and_then(|way| self.aligned(offset, way, has_rotary));
                    let touched = places.is_some() || aligned.is_some();
                    if let (Some(Found::True), true) = (zero, touched) {
                        self.contradicts(
                            offset,
                            both!("`{name}` is both true and touched", "`{name}` и точное, и найдено касанием"),
                            both!(
                                "remove `touched_at` and `aligned` where it was found through a compensation or by an instrument, else write zero = \"touched\"",
                                "уберите `touched_at` и `aligned`, если нуль найден через компенсацию или прибором, иначе напишите zero = \"touched\""
                            ),
                        );
                    }
                    let found_so = zero.or(touched.then_some(Found::Touched));
                    found.push((name.clone(), ZeroFound { found: found_so, touched_at: places, aligned }));
                    at
                }
            };
            offsets.push((name.clone(), place.map(|Finite(v)| v)));
        }
        (offsets, found)
    }

    fn contradicts(&mut self, at: &Spanned<WorkOffset>, message: Text, help: Text) {
        self.refuse(at, CONFLICT, message, both!("of this entry", "в этой записи"), help);
    }

    fn aligned(
        &mut self,
        entry: &Spanned<WorkOffset>,
        written: &AlignedTo,
        has_rotary: [bool; 3],
    ) -> Option<Way> {
        const WHICH: Text = Text::pair(
            "write along = \"X\", \"Y\" or \"Z\", and faces by the axes across them, like \"Y\"",
            "напишите along = \"X\", \"Y\" или \"Z\", а faces — осями поперёк граней, например \"Y\"",
        );
        let AlignedTo { along, from, to, faces } = written;
        if has_rotary != [false; 3] {
            let message = both!(
                "a workpiece is aligned on a machine with rotary axes",
                "деталь выверена, а у станка есть поворотные оси"
            );
            let help = both!(
                "what turns with a table is not followed: set it straight by the rotary axis or by `G68`, and remove `aligned`",
                "поворот вместе со столом не учитывается: выставьте деталь поворотной осью или `G68` и уберите `aligned`"
            );
            self.contradicts(entry, message, help);
            return None;
        }
        let Some(axis) = "XYZ".find(along.as_str()).filter(|_| along.len() == 1) else {
            let message = both!(
                "aligned along `{along}`, which is no linear axis",
                "выверено вдоль `{along}`, а это не линейная ось"
            );
            self.contradicts(entry, message, WHICH);
            return None;
        };
        let faces = faces.as_deref().unwrap_or(["Y", "X", "XY"][axis]);
        let across = ["X", "Y", "Z"].map(|letter| faces.contains(letter));
        if faces.is_empty() || across[axis] || faces.chars().any(|face| !"XYZ".contains(face)) {
            let message = both!(
                "the dial ran on `{faces}` along {along}: no faces that lie along it",
                "индикатор шёл по `{faces}` вдоль {along}: вдоль неё таких граней нет"
            );
            self.contradicts(entry, message, WHICH);
            return None;
        }
        let ends_mm = [from, to].map(|end| match end {
            End::Axes(place) => place.map(|Finite(v)| Some(v)),
            End::Axis(Finite(command)) => [0, 1, 2].map(|other| (other == axis).then_some(*command)),
        });
        if (0..3).any(|other| (ends_mm[0][other] == ends_mm[1][other]) == (other == axis)) {
            let message = both!(
                "aligned along {along} between places that {along} does not join",
                "выверено вдоль {along} между местами, которые {along} не соединяет"
            );
            let help = both!(
                "`from` and `to` are two commands of {along}, all else alike",
                "`from` и `to` — две команды оси {along}, остальное одинаково"
            );
            self.contradicts(entry, message, help);
            return None;
        }
        Some(Way { along: axis, ends_mm, faces: across })
    }

    fn touched_at(
        &mut self,
        entry: &Spanned<WorkOffset>,
        written: &TouchedAt,
        has_rotary: [bool; 3],
    ) -> [TouchPlace; 3] {
        let (all, own) = written.parts();
        [0, 1, 2].map(|axis| {
            let letter = AXIS_NAMES[axis];
            let twice = own[axis].is_some_and(|own| own.at.is_some()) && all.at.is_some();
            if twice {
                let message = both!("{letter} was touched at two places", "{letter} касались в двух местах");
                let help = both!(
                    "keep `at` for all axes, or X, Y and Z with places of their own",
                    "оставьте `at` для всех осей или X, Y и Z со своими местами"
                );
                self.contradicts(entry, message, help);
            }
            self.touch_place(entry, own[axis].unwrap_or(&all), &all, has_rotary)
        })
    }

    /// A place of an axis; what it leaves out is as for all.
    fn touch_place(
        &mut self,
        entry: &Spanned<WorkOffset>,
        own: &OnePlace,
        all: &OnePlace,
        has_rotary: [bool; 3],
    ) -> TouchPlace {
        let mut rotary_deg = [0.0; 3];
        for (letter, Finite(degrees)) in all.rotary_deg.iter().chain(&own.rotary_deg) {
            match "ABC".find(letter.as_str()).filter(|axis| letter.len() == 1 && has_rotary[*axis]) {
                Some(axis) => rotary_deg[axis] = *degrees,
                None => self.contradicts(
                    entry,
                    both!(
                        "touched with {letter} at an angle, and the machine has no such axis",
                        "касание при повороте {letter}, а такой оси у станка нет"
                    ),
                    both!("name rotary axes of `chain`", "называйте поворотные оси из `chain`"),
                ),
            }
        }
        let direction = own.direction.or(all.direction).unwrap_or(0);
        if !(-1..=1).contains(&direction) {
            let message =
                both!("the direction of touching is {direction}", "направление касания — {direction}");
            let help = both!(
                "write 1 where the axis came upwards, -1 where downwards",
                "напишите 1, если ось шла в плюс, -1 — если в минус"
            );
            self.contradicts(entry, message, help);
        }
        let tool =
            own.tool.as_ref().or(all.tool.as_ref()).and_then(|tool| self.tool_that_touched(entry, tool));
        let at_mm = match own.at.or(all.at) {
            None => Vec::new(),
            Some(Places::One(place)) => vec![place],
            Some(Places::Two(places)) => places.to_vec(),
        };
        let at_mm = at_mm.into_iter().map(|place| place.map(|Finite(v)| v)).collect();
        TouchPlace { at_mm, tool, rotary_deg, direction }
    }

    fn tool_that_touched(
        &mut self,
        entry: &Spanned<WorkOffset>,
        written: &ToolThatTouched,
    ) -> Option<TouchedBy> {
        match written {
            ToolThatTouched::Length(Length::Number(Finite(mm))) => Some(TouchedBy::Vector([0.0, 0.0, -mm])),
            ToolThatTouched::Length(Length::Vector(vector)) => {
                Some(TouchedBy::Vector(vector.map(|Finite(v)| v)))
            }
            ToolThatTouched::Name(name) => {
                let number = name.strip_prefix('H').and_then(|digits| digits.parse().ok());
                if number.is_none() {
                    self.contradicts(
                        entry,
                        both!("touched with `{name}`, which is no H number", "касание инструментом `{name}`, а это не номер H"),
                        both!("write tool = \"H1\", a length in mm, or a vector [x, y, z] from the gauge point to the tip", "напишите tool = \"H1\", длину в мм или вектор [x, y, z] от базовой точки до вершины"),
                    );
                }
                number.map(TouchedBy::Length)
            }
        }
    }
}
