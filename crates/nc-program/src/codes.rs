//! Numbers of this room's diagnostics, with cause and remedy; `docs/diagnostics.md` lists them.

use diagnostic::Code;

/// A variable, an expression or program flow stands where a number is needed. Cause: a macro program.
/// Remedy: post the program with plain numbers.
pub const NOT_STATIC: Code = Code(202);
/// The R of an arc is smaller than half the chord from start to end, by more than the dialect's
/// tolerance. Remedy: I/J/K, or a larger R.
pub const RADIUS_TOO_SMALL: Code = Code(203);
/// An arc has neither centre words nor R. Cause: a post processor that drops unchanged I and J (FreeCAD's
/// fanuc posts). Remedy: post again with the centre on each arc block.
pub const ARC_WITHOUT_CENTRE: Code = Code(204);
/// Start and end of an arc lie at different distances from its centre, by more than the dialect's
/// tolerance. Remedy: correct the end or the centre; look for the wrong G90.1/G91.1 mode.
pub const RADII_DIFFER: Code = Code(205);
/// The words of an arc contradict each other: R and a centre, a centre word of another plane, a full
/// circle by R, a start on the centre, several turns by P, half a centre under G90.1.
pub const ARC_WORDS: Code = Code(206);
/// The dialect's table has no such G code, and it may move an axis. Remedy: a row in a copy of the
/// grammar, given with `--dialect`.
pub const UNKNOWN_CODE: Code = Code(207);
/// The dialect's table refuses this G or M code, and says why.
pub const REFUSED_CODE: Code = Code(208);
/// Two codes of one modal group stand in one block. Remedy: two blocks.
pub const SAME_GROUP: Code = Code(209);
/// A letter stands twice in one block. Remedy: remove one of the two words.
pub const LETTER_TWICE: Code = Code(210);
/// A word has no number, or not the whole number it needs.
pub const BAD_NUMBER: Code = Code(211);
/// Axis words without a motion code in force. Remedy: G0, G1, G2 or G3 in the block.
pub const NO_MOTION_CODE: Code = Code(212);
/// A motion needs the position of an axis that nobody knows here: at the start of the program, after a
/// reference return, a tool change, a change of tool length without a word of its axis, a probe move or a
/// skipped block. Remedy: a rapid that names the axis in absolute coordinates.
pub const POSITION_UNKNOWN: Code = Code(213);
/// The work offset in force is given by no profile, file or option.
/// Remedy: `--work-offset G54=X,Y,Z`.
pub const WORK_OFFSET: Code = Code(214);
/// The tool length in force is given by no profile, file or option, or G43 does not say
/// which one. Remedy: `--tool H1=120`, or an H word.
pub const TOOL_LENGTH: Code = Code(215);
/// A drilling cycle has no depth Z or no level R. Remedy: both on the block that starts the cycle.
pub const CYCLE_INCOMPLETE: Code = Code(216);
/// Words of a drilling cycle that cannot be honoured as they stand.
pub const CYCLE_WORDS: Code = Code(217);
/// Under G93 a feed motion has no F of its own, or not a positive one.
pub const INVERSE_TIME: Code = Code(218);
/// A rotary axis is programmed that the profile's chain does not have.
pub const NO_SUCH_AXIS: Code = Code(219);
/// Rotary axes turn at feed rate where no path can be corrected: along an arc, or under cutter compensation.
pub const SIMULTANEOUS: Code = Code(220);
/// U, V or W: increments on some controls, axes on others.
pub const SECONDARY_AXIS: Code = Code(221);
/// After a block with block delete the program may be in two states that cannot both be served.
/// Remedy: repeat the setting in a block of its own that is always executed.
pub const BLOCK_DELETE: Code = Code(222);
/// The words of a block may belong to more than one of its codes. Remedy: two blocks.
pub const WORDS_OF_TWO: Code = Code(223);
/// A command by name (`(UAO,1)`, `TRANS`) that the dialect's table refuses or does not have: it may move
/// the frame.
pub const COMMAND: Code = Code(224);
/// I, J, K or R in a block that is no arc and no cycle, or `,R` and `,C`: corner roundings and chamfers.
/// Remedy: post them as arcs and lines.
pub const STRAY_ARC_WORD: Code = Code(225);
/// A rapid cannot be combined with what its block also does (tool change with motion, G53 in a cycle).
pub const COMBINATION: Code = Code(226);
/// A code that moves the frame (G10, G52, G92, G68, G51, G51.1…) cannot be honoured as it stands, or what
/// comes after it depends on the control.
pub const FRAME: Code = Code(227);
/// Motion stands behind the end of the program: a second program in the same file, say. Remedy: a file for each.
pub const AFTER_END: Code = Code(228);
/// A direction as a vector where none can stand: without tool centre point control, beside rotary words, in an arc. Remedy: in
/// the message.
pub const DIRECTION_WORDS: Code = Code(260);
/// What the control does between two directions is not said, or is a great circle. Remedy: `vectors` under `[kinematics]`.
pub const DIRECTION_BETWEEN: Code = Code(261);
/// A direction of no length. Remedy: a vector.
pub const NO_DIRECTION: Code = Code(262);
/// Where a direction turns the rotary axes is not certain. Remedy: in the message.
pub const DIRECTION_ANGLES: Code = Code(263);
/// The program was made for a lathe. Remedy: none yet, vpost corrects mills.
pub const LATHE: Code = Code(240);
/// Tool centre point control whose centres nobody said, or what does not go together with it. Remedy: `[kinematics]` in the
/// profile, or in the message.
pub const TIP_CONTROL: Code = Code(230);
/// A tilted working plane whose words, or what stands beside it, cannot be honoured as they stand, or of which the profile
/// says too little. Remedy: in the message.
pub const TILTED_PLANE: Code = Code(231);
/// The rotary axes do not stand upright on a tilted plane, or where the control turns them is not certain. Remedy: in the
/// message.
pub const PLANE_ANGLES: Code = Code(232);
/// A curve by control points whose words, or what it stands under, cannot be honoured as they stand. Remedy: in the message.
pub const CURVE: Code = Code(233);
/// A curve of several blocks is not whole where something else follows. Remedy: G5.3, or the knots that lack.
pub const CURVE_OPEN: Code = Code(234);
/// Lengths with and without a decimal point, where a parameter of the control decides what the latter are. Remedy:
/// `--decimal`.
pub const MIXED_LENGTHS: Code = Code(241);
/// Doubt: lengths without a decimal point are read as increments. Remedy: `--decimal`.
pub const BARE_LENGTHS: Code = Code(242);
/// Doubt: M codes that no table knows pass. Remedy: `[m_codes] harmless` in the profile.
pub const UNKNOWN_M_CODE: Code = Code(243);
/// Doubt: the program states no unit, and the control keeps that of the program before. Remedy: G21.
pub const UNIT_UNSTATED: Code = Code(244);
/// Doubt: the program may have been cut off. Remedy: the whole one.
pub const CUT_OFF: Code = Code(245);
/// The program looks written for another control than its dialect's. Remedy: `--dialect`.
pub const LOOKS_LIKE: Code = Code(246);
/// Whether X words of a lathe's program are diameters or radii is not said. Remedy: `[program] x` in the profile, or G7
/// and G8.
pub const X_UNSTATED: Code = Code(250);
/// An axis that a lathe does not have, a plane that it does not turn in, or an increment where none can stand. Remedy: in the
/// message.
pub const NO_TURNING: Code = Code(251);
/// A feed along Z, or an arc, at negative X. Remedy: X above zero.
pub const BELOW_THE_AXIS: Code = Code(252);
/// G96 without a limit of the spindle's speed. Remedy: G50 S, G92 S, D beside G96.
pub const UNLIMITED_SPEED: Code = Code(253);
