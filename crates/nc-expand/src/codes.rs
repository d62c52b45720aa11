//! Numbers of this room's diagnostics, with cause and remedy; `docs/diagnostics.md` lists them.

use diagnostic::Code;

/// A statement of flow or an expression cannot be read in this dialect. Remedy: the spelling of the
/// control's manual.
pub const SYNTAX: Code = Code(120);
/// A value is known only on the machine: a system variable, or one that nothing has set.
/// Remedy: `--set "#500=12.5"`.
pub const UNKNOWN_VALUE: Code = Code(121);
/// The arithmetic has no result: division by zero, a root of a negative number.
pub const ARITHMETIC: Code = Code(122);
/// Two values are so near to each other that the control's own rounding decides.
/// Remedy: compare with a margin.
pub const TOO_CLOSE: Code = Code(123);
/// A number does not fit its place: a fraction for a code, a label or a count, or a word too large to be written.
pub const BAD_VALUE: Code = Code(124);
/// A GOTO leads to a block number that the program does not have, or has twice.
pub const LABEL: Code = Code(125);
/// A loop or a condition without its end, or an end without its beginning.
pub const STRUCTURE: Code = Code(126);
/// A subprogram is neither in the file nor in the folders given. Remedy: `--include DIR`.
pub const PROGRAM_MISSING: Code = Code(127);
/// The name of a subprogram leads out of the folder it is looked for in.
pub const PATH: Code = Code(128);
/// Subprograms call each other too deep. Cause: recursion without end.
pub const DEPTH: Code = Code(129);
/// The program runs in loops for longer than the limit of steps. Cause: a loop that never ends.
pub const STEPS: Code = Code(130);
/// The expanded program is longer than the limit. Cause: calls or loops that multiply.
pub const SIZE: Code = Code(131);
/// The program writes a variable of the control: an offset, a position, a timer.
pub const SYSTEM_WRITE: Code = Code(132);
/// The program stops itself with an alarm (`#3000`, `(ABORT, …)`).
pub const ALARM: Code = Code(133);
/// Flow, an assignment or a call behind block delete: two programs in one.
pub const BLOCK_DELETE: Code = Code(134);
/// A return without a call, or a subprogram that ends without a return.
pub const RETURN: Code = Code(135);
/// Words beside a call or a statement that may belong to either.
pub const COMBINATION: Code = Code(136);
/// Arguments of a macro call that cannot be told apart or scaled with certainty.
pub const ARGUMENT: Code = Code(137);
/// A subprogram's file cannot be read, or is not a part program.
pub const UNREADABLE_FILE: Code = Code(138);
/// Warning: variables that keep their value after the program are not written by the expanded one.
pub const LOST_ASSIGNMENT: Code = Code(139);
/// Warning: output to a printer or file is left out of the expanded program.
pub const LOST_OUTPUT: Code = Code(140);
/// The file defines subroutines and executes nothing: there is no path to correct.
/// Remedy: the program that calls them, with `--include`.
pub const NOTHING_EXECUTED: Code = Code(141);
/// A corner (`,R`, `,C`) or a polar word (G16) whose shape no manual makes certain. Remedy: points, arcs and lines.
pub const SHORTHAND: Code = Code(142);
/// A cycle of a lathe that cannot be written out with certainty. Remedy: the words it lacks, or its moves.
pub const TURNING_CYCLE: Code = Code(143);
/// The contour of a lathe's cycle, the blocks from P to Q, is missing, or is none that the cycle takes.
/// Remedy: N numbers of P and Q, and a contour that does not turn back.
pub const CONTOUR: Code = Code(144);
/// A parameter of the control decides how a cycle moves, and neither program nor profile says it.
/// Remedy: the key under `[program]` that the message names.
pub const CYCLE_PARAMETER: Code = Code(145);
/// A call of a cycle by its name, or a dimension by AC and IC, that cannot be written out with certainty.
/// Remedy: the words it lacks, or its moves.
pub const CALLED_CYCLE: Code = Code(146);
/// Doubt: a call of a program that only the control has is left as it is. Remedy: `[calls]` in the profile, or that
/// program with `--include`.
pub const LEFT_ALONE: Code = Code(147);
