//! Where a program's zeros were touched, and what the machine's error there makes of its places. Equation (121).

use machine_model::{Command, Models, PathModel, Placement, Vector, Way};
use nc_dialect::Dialect;
use nc_program::{Context, WorkOffset, work_offset_name};
use toolpath::Motion;

/// Where one coordinate of a zero was touched, with correction off.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Touch {
    /// Axis commands, mm: one place, or the two between which the coordinate lies (a bore). Empty: the program's zero.
    pub at_mm: Vec<[f64; 3]>,
    /// The tool that touched; `None`: [`Datums::tool`].
    pub tool: Option<TouchTool>,
    /// Where the rotary axes stood, degrees.
    pub rotary_deg: [f64; 3],
    /// From which side the axis came: -1, 1, or 0 where nobody knows.
    pub direction: i8,
}

/// A tool that touches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TouchTool {
    /// From the gauge point to its tip, mm.
    pub vector_mm: [f64; 3],
    /// What its length adds to axis commands, mm.
    pub length_mm: [f64; 3],
}

/// Where a zero was touched: X, Y and Z.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Touches {
    /// Each coordinate.
    pub axes: [Touch; 3],
    /// The way that the workpiece was dialled parallel to; `None`: it lies as the measuring frame does.
    pub aligned: Option<Way>,
}

/// How a work offset came to be.
#[derive(Clone, Debug, PartialEq)]
pub enum Zero {
    /// Found through a compensation, or by an outside instrument: a place in the measuring frame.
    True,
    /// Touched on this machine, with correction off.
    Touched(Box<Touches>),
}

/// What is known of a machine's zeros.
#[derive(Clone, Debug, PartialEq)]
pub struct Datums {
    /// By the name of the work offset.
    pub named: Vec<(String, Zero)>,
    /// All others.
    pub others: Zero,
    /// The tool that touched where nothing else is said.
    pub tool: TouchTool,
    /// Axis commands of the surface on which tool lengths were touched off, mm, the length not added; `None`: they are true.
    pub lengths_at_mm: Option<[f64; 3]>,
}

impl Default for Datums {
    /// All are true.
    fn default() -> Self {
        Self { named: Vec::new(), others: Zero::True, tool: TouchTool::default(), lengths_at_mm: None }
    }
}

/// A zero that a program used.
#[derive(Clone, Debug, PartialEq)]
pub struct Datum {
    /// `G54`.
    pub name: String,
    /// Its machine coordinate, mm.
    pub zero_mm: [f64; 3],
    /// The machine's error where it was touched, mm, frame of the workpiece: how far the zero lies from where it is said to.
    pub error_mm: [f64; 3],
    /// [`Command::datum`] of what is cut from it.
    pub placement: Placement,
    /// How much of that, mm, is the guess that it was touched without a tool length, where the tool in force has one.
    pub unsure_mm: f64,
    /// A place where it was touched lies outside the calibrated volume; the error is that of the nearest point.
    pub is_outside: bool,
}

impl Datum {
    /// The same zero, whichever tool was in force.
    pub(crate) fn is(&self, other: &Self) -> bool {
        (&self.name, self.zero_mm, self.placement) == (&other.name, other.zero_mm, other.placement)
    }
}

impl Touch {
    /// What the machine's error makes of one coordinate that is touched there, mm, frame of the workpiece, but for what the
    /// turn of the workpiece has made of it already.
    fn error(
        &self,
        model: &dyn PathModel,
        axis: usize,
        tool: &TouchTool,
        places: &[[f64; 3]],
        turned: &Placement,
    ) -> Vector {
        let of = |(k, place): (usize, &[f64; 3])| {
            let mut direction = [0; 3];
            // On the other side of a bore the axis came the other way.
            direction[axis] = if k == 0 { self.direction } else { -self.direction };
            let at = Command { direction, ..touched_at(&Vector::from(*place), tool, self.rotary_deg) };
            let error_mm = model.error_mm(&at) - turned.turn * (at.linear_mm + at.tool_mm);
            in_workpiece(model, &at, axis) * (error_mm[axis] / places.len() as f64)
        };
        places.iter().enumerate().map(of).sum()
    }
}

/// How the workpiece lies that was dialled along a way with a tool, its zero at the command `zero_mm`.
fn dialled(way: &Way, model: &dyn PathModel, tool: &TouchTool, zero_mm: [f64; 3]) -> Placement {
    let [from, to] = way.ends_mm.map(|end| {
        let place = Vector::from_fn(|axis, _| end[axis].unwrap_or(zero_mm[axis]));
        (place, model.error_mm(&touched_at(&place, tool, [0.0; 3])))
    });
    let (nominal, aside) = (to.0 - from.0, to.1 - from.1);
    // Across a face that nothing was dialled on the workpiece lies as its support does.
    let seen = Vector::from_fn(|axis, _| if way.faces[axis] { aside[axis] } else { 0.0 });
    Placement::turned(&nominal, &(nominal + seen))
}

impl Datums {
    /// All were touched at the program's zero.
    #[must_use]
    pub fn touched(tool: TouchTool) -> Self {
        Self { others: Zero::Touched(Box::default()), tool, ..Self::default() }
    }

    /// [`Command::datum`] of what is done in this context.
    #[must_use]
    pub fn placement(&self, model: &dyn PathModel, dialect: &Dialect, context: &Context) -> Placement {
        self.of(model, dialect, context).map_or_else(Placement::default, |datum| datum.placement)
    }

    /// True where no zero was touched: errors count from the measuring frame.
    #[must_use]
    pub fn are_true(&self) -> bool {
        self.others == Zero::True && self.named.iter().all(|(_, zero)| *zero == Zero::True)
    }

    /// The datum of the work offset in force; `None` where it is true.
    fn of(&self, model: &dyn PathModel, dialect: &Dialect, context: &Context) -> Option<Datum> {
        let zero_mm = context.work_offset.zero_mm?;
        let name = work_offset_name(dialect, &context.work_offset).unwrap_or_default();
        let own = TouchTool { vector_mm: context.tool_mm, length_mm: context.length_mm };
        self.of_zero(model, name, zero_mm, &own)
    }

    /// That of a work offset by its name and its machine coordinate, a tool being in force.
    #[must_use]
    pub fn of_zero(
        &self,
        model: &dyn PathModel,
        name: String,
        zero_mm: [f64; 3],
        own: &TouchTool,
    ) -> Option<Datum> {
        let zero = self.named.iter().find(|(known, _)| *known == name).map_or(&self.others, |(_, zero)| zero);
        let Zero::Touched(touches) = zero else { return None };
        let at_zero = |tool: &TouchTool| (Vector::from(zero_mm) + Vector::from(tool.length_mm)).into();
        let turned = touches.aligned.map_or_else(Placement::default, |way| {
            let face = way.faces.iter().position(|seen| *seen).unwrap_or(0);
            let tool = touches.axes[face].tool.unwrap_or(self.tool);
            dialled(&way, model, &tool, at_zero(&tool))
        });
        let [mut shift_mm, mut guessed_mm] = [Vector::zeros(); 2];
        let mut is_outside = false;
        for (axis, touch) in touches.axes.iter().enumerate() {
            let tool = touch.tool.unwrap_or(self.tool);
            let here = [at_zero(&tool)];
            let places = if touch.at_mm.is_empty() { &here[..] } else { &touch.at_mm[..] };
            shift_mm += touch.error(model, axis, &tool, places, &turned);
            is_outside |= places.iter().any(|place| !model.volume().contains(&Vector::from(*place)));
            if touch.at_mm.is_empty() && touch.tool.is_none() {
                guessed_mm += touch.error(model, axis, own, &[at_zero(own)], &turned)
                    - touch.error(model, axis, &tool, places, &turned);
            }
        }
        let unsure_mm = guessed_mm.norm();
        if let Some(surface_mm) = self.lengths_at_mm {
            shift_mm += self.length_error(model, surface_mm, &touches.axes, own);
        }
        let placement = turned.shifted(shift_mm);
        let zero =
            Vector::from(zero_mm) + Vector::from(self.tool.length_mm) + Vector::from(self.tool.vector_mm);
        let error_mm = (shift_mm + turned.turn * zero).into();
        Some(Datum { name, zero_mm, error_mm, placement, unsure_mm, is_outside })
    }

    /// What the length of the tool in force is off beside that of the tool that touched Z, both touched off on one surface.
    fn length_error(
        &self,
        model: &dyn PathModel,
        surface_mm: [f64; 3],
        touches: &[Touch; 3],
        own: &TouchTool,
    ) -> Vector {
        const Z: usize = 2;
        let first = touches[Z].tool.unwrap_or(self.tool);
        let [at_first, at_own] = [first, *own].map(|tool| {
            let place = Vector::from(surface_mm) + Vector::from(tool.length_mm);
            touched_at(&place, &tool, [0.0; 3])
        });
        in_workpiece(model, &at_own, Z) * (model.error_mm(&at_own)[Z] - model.error_mm(&at_first)[Z])
    }
}

fn touched_at(place: &Vector, tool: &TouchTool, rotary_deg: [f64; 3]) -> Command {
    Command {
        linear_mm: *place,
        rotary_rad: rotary_deg.map(f64::to_radians).into(),
        tool_mm: tool.vector_mm.into(),
        ..Command::default()
    }
}

/// The direction of a linear axis in the frame of the workpiece.
fn in_workpiece(model: &dyn PathModel, at: &Command, axis: usize) -> Vector {
    Vector::from_fn(|row, _| model.along_axes(&Vector::ith(row, 1.0), at)[axis])
}

/// A motion that goes on from where another datum was in force: it begins where that one's place is, seen from its own.
///
/// * `last` – [`Command::datum`] of the motion before, which becomes that of this one; `None` where the axes stand at a place
///   that no datum knows
pub(crate) fn going_on(
    models: &Models<'_>,
    motion: &Motion,
    context: &Context,
    own: Placement,
    last: &mut Option<Placement>,
) -> Motion {
    let mut motion = *motion;
    let next = Some(own).filter(|_| !matches!(motion, Motion::Uncorrected { .. }));
    let before = std::mem::replace(last, next).unwrap_or(own);
    if let (Motion::Feed(feed), true) = (&mut motion, before != own) {
        let model = models.of(context.kinematics).unwrap_or(models.axes);
        let tool = TouchTool { vector_mm: context.tool_mm, length_mm: context.length_mm };
        let at = touched_at(&Vector::from(feed.start.linear_mm), &tool, feed.start.rotary_deg);
        let tip_mm = at.linear_mm + at.tool_mm;
        let aside = if before.is_turned() || own.is_turned() {
            own.meant(&before.place(&tip_mm)) - tip_mm
        } else {
            before.shift_mm - own.shift_mm
        };
        feed.start.linear_mm = (at.linear_mm + model.along_axes(&aside, &at)).into();
    }
    motion
}

/// All that a datum depends on.
type Key = (WorkOffset, [f64; 3], [f64; 3]);

/// The datum that was asked for last: it is the same for thousands of blocks.
#[derive(Clone, Debug, Default)]
pub(crate) struct LastDatum {
    last: Option<(Key, Option<Datum>)>,
    noted: bool,
}

impl LastDatum {
    /// [`Command::datum`] of a block.
    pub(crate) fn placement(
        &mut self,
        datums: &Datums,
        (model, dialect): (&dyn PathModel, &Dialect),
        context: &Context,
    ) -> Placement {
        if datums.are_true() {
            return Placement::default();
        }
        let key = (context.work_offset, context.tool_mm, context.length_mm);
        if self.last.as_ref().is_none_or(|(known, _)| *known != key) {
            *self = Self { last: Some((key, datums.of(model, dialect, context))), noted: false };
        }
        self.last
            .as_ref()
            .and_then(|(_, datum)| datum.as_ref())
            .map_or_else(Placement::default, |datum| datum.placement)
    }

    /// That of the block that asked last, where something is cut from it for the first time.
    #[inline]
    pub(crate) fn newly_used(&mut self) -> Option<&Datum> {
        if std::mem::replace(&mut self.noted, true) {
            return None;
        }
        self.last.as_ref().and_then(|(_, datum)| datum.as_ref())
    }
}
