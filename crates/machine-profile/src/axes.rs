//! Linear and rotary axes, squareness and traverses of a profile.

use std::ops::Bound::{Excluded, Included};

use diagnostic::{Diagnostic, Text, both};
use machine_model::{
    Axis, Chain, Interpolation, LinearAxis, Range, RotaryAxis, Squareness, Tilt, Traverse, Vector,
};
use units::{Angle, Length};

use crate::error::{CONFLICT, KEY, ProfileError, TILT, VALUE};
use crate::format::{self, Document};
use crate::loader::{Bounds, Loader, vector};
use crate::number::{Finite, Spanned, Triple};
use crate::tables::{ErrorRows, traverse};

/// No control of a machine whose errors are worth correcting has a coarser step, mm; a resolution in µm would be.
const COARSEST_MM: f64 = 0.1;
/// No rotary axis of a machine tool has so much play: a fifth of a degree, in µrad.
const MOST_BACKLASH_URAD: f64 = 3500.0;
const WRONG_UNIT: Text = Text::pair("wrong unit?", "не та единица?");
const MICRORADIANS: Text = Text::pair(
    "the unit is the microradian: 1 arc second is 4.848 urad",
    "единица — микрорадиан: 1 угловая секунда — 4.848 мкрад",
);

impl Loader<'_> {
    /// Refuses tables of one direction without those of the other, and play that is said twice.
    fn both_directions(
        &mut self,
        axis: Axis,
        errors: Option<&Spanned<String>>,
        negative: Option<&Spanned<String>>,
        backlash: Option<(&Spanned<Finite>, &str)>,
    ) {
        let Some(negative) = negative else { return };
        if errors.is_none() {
            let message = both!(
                "axis {axis} has errors_negative, but no errors",
                "у оси {axis} есть errors_negative, а errors нет"
            );
            let label = both!("the other direction is missing", "нет другого направления");
            let help = both!(
                "errors is the table of the positive direction; a table for both directions is errors alone",
                "errors — таблица движения в плюс; таблица для обоих направлений — одно errors"
            );
            self.refuse(negative, CONFLICT, message, label, help);
        }
        if let Some((backlash, key)) = backlash {
            let message = both!(
                "axis {axis} has both errors_negative and {key}",
                "у оси {axis} и errors_negative, и {key}"
            );
            let help = both!(
                "two tables already hold the reversal value: leave {key} out",
                "погрешность реверса уже есть в двух таблицах: уберите {key}"
            );
            self.refuse(backlash, CONFLICT, message, both!("counted twice", "учтено дважды"), help);
        }
    }

    /// Refuses an axis that stood somewhere while it was measured.
    fn measured_beside(&mut self, axis: Axis, place: Option<&Spanned<format::MeasuredAt>>) {
        if let Some(place) = place
            && [place.get_ref().X, place.get_ref().Y, place.get_ref().Z][axis.direction()].is_some()
        {
            let message = both!(
                "measured_at_mm of {axis} names {axis} itself",
                "в measured_at_mm оси {axis} названа сама {axis}"
            );
            let label = both!("{axis} moved along the whole line", "{axis} прошла всю линию");
            let help = both!(
                "it says where the other axes stood while this one was measured",
                "там сказано, где стояли остальные оси, пока измеряли эту"
            );
            self.refuse(place, CONFLICT, message, label, help);
        }
    }

    pub(crate) fn linear(
        &mut self,
        axis: Axis,
        written: Option<&Spanned<format::LinearAxis>>,
        interpolation: Interpolation,
        rows: &mut [Option<ErrorRows>; 3],
        resolution_mm: &mut [f64; 3],
    ) -> Option<LinearAxis> {
        let Some(spanned) = written else {
            let diagnostic = Diagnostic::error(
                KEY,
                both!("the profile lacks [axis.{axis}]", "в профиле нет [axis.{axis}]"),
            )
            .help(both!(
                "add [axis.{axis}] with travel_mm = [lowest, highest]",
                "добавьте [axis.{axis}] с travel_mm = [наименьшее, наибольшее]"
            ));
            self.errors.push(ProfileError::profile(diagnostic));
            return None;
        };
        let index = axis.direction();
        let data = spanned.get_ref();
        let bounds = Bounds {
            range: (Excluded(0.0), Included(COARSEST_MM)),
            label: both!(
                "expected a number above 0, at most {COARSEST_MM}",
                "ожидалось число больше 0 и не больше {COARSEST_MM}"
            ),
            help: both!(
                "write the smallest step the control takes, like 0.001",
                "напишите наименьшую дискрету стойки, например 0.001"
            ),
        };
        let name = both!("resolution_mm of {axis}", "resolution_mm оси {axis}");
        if let Some(step_mm) = self.number(data.resolution_mm.as_ref(), name, &bounds) {
            resolution_mm[index] = step_mm;
        }
        let before = self.errors.len();
        let own = self.table(data.errors.as_ref(), axis);
        let negative = self.table(data.errors_negative.as_ref(), axis);
        let travel = data
            .travel_mm
            .as_ref()
            .and_then(|travel| self.range(travel, &both!("travel_mm of {axis}", "travel_mm оси {axis}")));
        let backlash = data.backlash_um.as_ref().map(|value| (value, "backlash_um"));
        self.both_directions(axis, data.errors.as_ref(), data.errors_negative.as_ref(), backlash);
        self.measured_beside(axis, data.measured_at_mm.as_ref());
        if self.errors.len() > before {
            return None;
        }
        let errors = own.as_ref().and_then(|rows| rows.tables(interpolation));
        let errors_negative = negative.as_ref().and_then(|rows| rows.tables(interpolation));
        let Some(travel_mm) = travel.or_else(|| errors.as_ref().map(machine_model::AxisTables::range)) else {
            let message = both!(
                "axis {axis} has neither travel_mm nor errors",
                "у оси {axis} нет ни travel_mm, ни errors"
            );
            let label = both!("how far does this axis go?", "каков ход этой оси?");
            let help = both!(
                "add travel_mm = [lowest, highest], machine coordinates",
                "добавьте travel_mm = [наименьшее, наибольшее], координаты станка"
            );
            self.refuse(spanned, KEY, message, label, help);
            return None;
        };
        let place = data.measured_at_mm.as_ref().map(|place| *place.get_ref()).unwrap_or_default();
        rows[index] = own;
        Some(LinearAxis {
            travel_mm,
            errors,
            errors_negative,
            backlash_mm: data.backlash_um.as_ref().map_or(0.0, |b| Length::from_um(b.get_ref().0).mm()),
            measured_at_mm: Vector::from([place.X, place.Y, place.Z].map(|v| v.map_or(0.0, |Finite(v)| v))),
            measured_tool_mm: vector(place.tool),
        })
    }

    pub(crate) fn rotary(
        &mut self,
        document: &Document,
        chain: Option<&Chain>,
        interpolation: Interpolation,
        resolution_deg: &mut [f64; 3],
    ) -> [RotaryAxis; 3] {
        let written = &document.rotary;
        let parts = [
            written.A.as_ref().map(|axis| (axis.span(), axis.get_ref().parts())),
            written.B.as_ref().map(|axis| (axis.span(), axis.get_ref().parts())),
            written.C.as_ref().map(|axis| (axis.span(), axis.get_ref().parts())),
        ];
        let mut all: [RotaryAxis; 3] = std::array::from_fn(|_| RotaryAxis::perfect(Vector::zeros()));
        for ((axis, parts), result) in Axis::ALL[3..].iter().zip(parts).zip(&mut all) {
            let Some((place, parts)) = parts else { continue };
            let bounds = Bounds {
                range: (Included(1e-7), Included(1.0)),
                label: both!("expected 0.0000001 to 1", "ожидалось от 0.0000001 до 1"),
                help: both!(
                    "the step of its words in degrees, like 0.001",
                    "дискрета её слов в градусах, например 0.001"
                ),
            };
            let name = both!("resolution_deg of {axis}", "resolution_deg оси {axis}");
            if let Some(step_deg) = self.number(parts.resolution_deg, name, &bounds) {
                resolution_deg[axis.direction()] = step_deg;
            }
            if chain.is_some_and(|chain| !chain.axes().any(|known| known == *axis)) {
                let message = both!(
                    "[rotary.{axis}] is described, but the chain lacks {axis}",
                    "[rotary.{axis}] описана, а в цепи нет {axis}"
                );
                let label = both!("not in the chain", "её нет в цепи");
                let help = both!(
                    "add {axis} to the chain, or remove [rotary.{axis}]",
                    "добавьте {axis} в цепь или уберите [rotary.{axis}]"
                );
                self.refuse_at(&place, CONFLICT, message, label, help);
            }
            *result = self.rotary_axis(*axis, &place, &parts, interpolation);
        }
        all
    }

    fn rotary_axis(
        &mut self,
        axis: Axis,
        place: &std::ops::Range<usize>,
        parts: &format::RotaryAxis<'_>,
        interpolation: Interpolation,
    ) -> RotaryAxis {
        let mut result = RotaryAxis::perfect(vector(parts.centre_mm));
        result.tilt = match parts.tilt {
            Some(format::TiltName::Axis) => Tilt::Axis,
            Some(format::TiltName::Body) | None => Tilt::Body,
        };
        let leans = parts.tilt_urad.iter().any(|tilt| tilt.is_some_and(|Finite(urad)| urad != 0.0));
        if leans && parts.tilt.is_none() {
            let message = both!(
                "what the tilt of {axis} does to the workpiece or the tool is not said",
                "не сказано, что наклон оси {axis} делает с деталью или инструментом"
            );
            let label = both!("a tilt without `tilt`", "наклон без ключа `tilt`");
            let help = both!(
                "write tilt = \"body\" in [rotary.{axis}] where what the axis carries leans with it, as vpost calibrate \
                 measures it, or tilt = \"axis\" where it only turns about the leaning line",
                "напишите tilt = \"body\" в [rotary.{axis}], если то, что несёт ось, наклонено вместе с ней (так \
                 измеряет vpost calibrate), или tilt = \"axis\", если оно лишь вращается вокруг наклонной линии"
            );
            self.refuse_at(place, TILT, message, label, help);
        }
        result.direction = parts.direction.and_then(|direction| self.direction(axis, direction));
        result.shift_mm =
            Vector::from(parts.shift_um.map(|v| v.map_or(0.0, |Finite(v)| Length::from_um(v).mm())));
        result.tilt_rad =
            Vector::from(parts.tilt_urad.map(|v| v.map_or(0.0, |Finite(v)| Angle::from_urad(v).rad())));
        if let Some(travel) = parts.travel_deg
            && let Some(range) = self.range(travel, &both!("travel_deg of {axis}", "travel_deg оси {axis}"))
        {
            let rad = |deg: f64| Angle::from_deg(deg).rad();
            result.travel_rad = Range { low: rad(range.low), high: rad(range.high) };
        }
        result.errors = self.table(parts.errors, axis).and_then(|rows| rows.tables(interpolation));
        result.errors_negative =
            self.table(parts.errors_negative, axis).and_then(|rows| rows.tables(interpolation));
        let backlash = parts.backlash_urad.map(|value| (value, "backlash_urad"));
        self.both_directions(axis, parts.errors, parts.errors_negative, backlash);
        let bounds = Bounds {
            range: (Included(-MOST_BACKLASH_URAD), Included(MOST_BACKLASH_URAD)),
            label: WRONG_UNIT,
            help: MICRORADIANS,
        };
        let name = both!("backlash_urad of {axis}", "backlash_urad оси {axis}");
        if let Some(urad) = self.number(parts.backlash_urad, name, &bounds) {
            result.backlash_rad = Angle::from_urad(urad).rad();
        }
        result
    }

    /// Where an axis points, of length 1.
    fn direction(&mut self, axis: Axis, written: &Spanned<Triple>) -> Option<Vector> {
        let along = vector(Some(*written.get_ref()));
        let length = along.norm();
        if length > 1e-9 {
            return Some(along / length);
        }
        let message = both!("the direction of {axis} is no direction", "направление {axis} — не направление");
        let help = both!(
            "write three numbers, not all zero, like [0, 0.7071, 0.7071]",
            "напишите три числа, не все нули, например [0, 0.7071, 0.7071]"
        );
        self.refuse(written, VALUE, message, both!("a vector of length 0", "нулевой вектор"), help);
        None
    }

    pub(crate) fn squareness(&mut self, written: &format::Squareness) -> Squareness {
        let mut read = |value: &Option<Spanned<Finite>>, name: &str| {
            let Some(value) = value else { return 0.0 };
            let Finite(urad) = *value.get_ref();
            if urad.abs() > 1e5 {
                let message = both!(
                    "{name} of {urad} urad is more than 0.1 rad",
                    "{name} {urad} мкрад — больше 0.1 рад"
                );
                self.refuse(value, VALUE, message, WRONG_UNIT, MICRORADIANS);
            }
            Angle::from_urad(urad).rad()
        };
        Squareness {
            ec0y_rad: read(&written.EC0Y_urad, "EC0Y"),
            eb0z_rad: read(&written.EB0Z_urad, "EB0Z"),
            ea0z_rad: read(&written.EA0Z_urad, "EA0Z"),
        }
    }

    pub(crate) fn traverses(&mut self, tracker: &format::Tracker) -> Option<[Traverse; 3]> {
        let mut all = Vec::new();
        for (axis, name) in Axis::ALL.into_iter().zip([&tracker.x, &tracker.y, &tracker.z]) {
            let bytes = self.file(name);
            all.push(bytes.and_then(|bytes| self.keep(traverse(name.get_ref(), &bytes, axis))));
        }
        all.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok()
    }
}
