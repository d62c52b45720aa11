//! Expressions: tree to value.
//!
//! LinuxCNC computes in double precision, so its sums and products are these; its sines differ in the last
//! digits from processor to processor (`COS[90]` is -2.5e-20 on one and 6.1e-17 on another). What Fanuc's own
//! number format makes of values that differ by rounding only is told by no manual. Where such a difference
//! would decide, the work is refused ([`Fault::TooClose`]).

use diagnostic::{Text, both};
use nc_dialect::Flow;
use nc_syntax::Macros;
use units::math;

use crate::expression::{Expression, Function, Operator};
use crate::value::{Digits, Value, Variable};

/// LinuxCNC: values nearer than this are EQ (its TOLERANCE_EQUAL), and an index may be off by as much.
pub(crate) const LINUXCNC_EQUAL: f64 = 1e-4;
/// Fanuc: relative difference below which two values cannot be told apart with certainty.
const FANUC_NEAR: f64 = 1e-7;

/// LinuxCNC: the same, for results of its mathematics library.
const LINUXCNC_NEAR: f64 = 1e-12;

/// Why there is no value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Fault {
    /// The operation has no result.
    Arithmetic(Text),
    /// The control's rounding decides.
    TooClose(f64, f64),
    /// A whole number was needed.
    NotWhole(Text, f64),
    /// The variable does not exist in the control.
    NoVariable(f64),
}

/// Where the values of variables come from.
pub(crate) trait Variables {
    /// The variable's value.
    fn value(&self, variable: Variable) -> Result<Value, Fault>;
    /// Whether a name is set; `None`: known on the machine only.
    fn exists(&self, variable: Variable) -> Option<bool>;
}

/// How a dialect computes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rules {
    pub(crate) flow: Flow,
    /// Fanuc: ROUND in an address rounds to this many decimals; `None` in a statement.
    pub(crate) round_decimals: Option<u8>,
}

impl Rules {
    /// Whole numbers are taken bit by bit and equal is equal; Siemens' arithmetic is taken as Fanuc's.
    const fn fanuc(self) -> bool {
        matches!(self.flow.macros, Macros::Fanuc | Macros::Siemens | Macros::Okuma)
    }

    /// The value of an expression.
    pub(crate) fn evaluate(
        self,
        expression: &Expression,
        variables: &impl Variables,
    ) -> Result<Value, Fault> {
        let (value, digits) = match expression {
            Expression::Number(number) => return Ok(Value::Number(*number)),
            Expression::Variable(variable) => return variables.value(*variable),
            Expression::Indirect(index) => {
                return match self.evaluate(index, variables)? {
                    Value::Null => variables.value(Variable::Numbered(0)),
                    unknown @ Value::Unknown(_) => Ok(unknown),
                    value => variables.value(self.index(number(value))?),
                };
            }
            Expression::Exists(variable) => {
                return Ok(match variables.exists(*variable) {
                    Some(exists) => Value::Number(f64::from(exists)),
                    None => Value::Unknown(*variable),
                });
            }
            Expression::Negative(inside) => match self.evaluate(inside, variables)? {
                unknown @ Value::Unknown(_) => return Ok(unknown),
                value => (0.0 - number(value), value.digits()),
            },
            Expression::Unary(function, inside) => match self.evaluate(inside, variables)? {
                unknown @ Value::Unknown(_) => return Ok(unknown),
                value => self.function(*function, number(value), value.digits())?,
            },
            Expression::Binary(operator, left, right) => {
                let left = self.evaluate(left, variables)?;
                let right = self.evaluate(right, variables)?;
                match (operator, left, right) {
                    (_, unknown @ Value::Unknown(_), _) | (_, _, unknown @ Value::Unknown(_)) => {
                        return Ok(unknown);
                    }
                    // An empty variable is not the number 0 where equality is asked for.
                    (Operator::Equal | Operator::NotEqual, a, b) if a == Value::Null || b == Value::Null => {
                        (f64::from((a == b) == (*operator == Operator::Equal)), Digits::Exact)
                    }
                    (_, a, b) => self.binary(*operator, number(a), number(b), a.digits().max(b.digits()))?,
                }
            }
        };
        if !value.is_finite() {
            return Err(Fault::Arithmetic(both!(
                "the result is larger than any number",
                "результат больше любого числа"
            )));
        }
        Ok(digits.of(value))
    }

    /// Whether a condition holds.
    ///
    /// # Errors
    /// A value that is zero but for rounding.
    pub(crate) fn truth(self, value: Value) -> Result<bool, Fault> {
        let number = number(value);
        if number != 0.0 && self.undecided(number, 0.0, value.digits()) {
            return Err(Fault::TooClose(number, 0.0));
        }
        Ok(number != 0.0)
    }

    /// Two values that another control may see in another order: any that are near on Fanuc, on LinuxCNC those
    /// that its mathematics library has rounded (its sines are computed in the processor's longest format).
    fn undecided(self, a: f64, b: f64, digits: Digits) -> bool {
        match (self.fanuc(), digits) {
            (true, Digits::Rounded) => near(a, b, FANUC_NEAR),
            (true, Digits::Exact) => a != b && near(a, b, FANUC_NEAR),
            (false, Digits::Rounded) => near(a, b, LINUXCNC_NEAR),
            (false, Digits::Exact) => false,
        }
    }

    /// The variable that a computed number names.
    pub(crate) fn index(self, number: f64) -> Result<Variable, Fault> {
        let whole = number.round();
        let slack = if self.fanuc() { 1e-9 } else { LINUXCNC_EQUAL };
        if (number - whole).abs() > slack {
            return Err(Fault::NotWhole(Text::pair("the number of a variable", "номер переменной"), number));
        }
        if !(0.0..=1e9).contains(&whole) {
            return Err(Fault::NoVariable(number));
        }
        Ok(Variable::Numbered(whole as u32))
    }

    /// A function's value, and whether its last digits are in doubt.
    fn function(self, function: Function, v: f64, digits: Digits) -> Result<(f64, Digits), Fault> {
        let arithmetic = |message: Text| Err(Fault::Arithmetic(message));
        Ok(match function {
            Function::Abs => (v.abs(), digits),
            Function::Sin => (math::sin(v.to_radians()), Digits::Rounded),
            Function::Cos => (math::cos(v.to_radians()), Digits::Rounded),
            Function::Tan => (math::tan(v.to_radians()), Digits::Rounded),
            Function::Atan => (math::atan(v).to_degrees(), Digits::Rounded),
            Function::Asin | Function::Acos if !(-1.0..=1.0).contains(&v) => {
                return arithmetic(both!(
                    "no angle has the sine or cosine {v}",
                    "угла с синусом или косинусом {v} нет"
                ));
            }
            Function::Asin => (math::asin(v).to_degrees(), Digits::Rounded),
            Function::Acos => (math::acos(v).to_degrees(), Digits::Rounded),
            Function::Exp => (math::exp(v), Digits::Rounded),
            Function::Ln if v <= 0.0 => return arithmetic(both!("the logarithm of {v}", "логарифм {v}")),
            Function::Ln => (math::ln(v), Digits::Rounded),
            Function::Sqrt if v < 0.0 => {
                return arithmetic(both!("the square root of {v}", "квадратный корень из {v}"));
            }
            Function::Sqrt => (v.sqrt(), digits),
            Function::Fix | Function::Fup => {
                if self.undecided(v, v.round(), digits) {
                    return Err(Fault::TooClose(v, v.round()));
                }
                let whole = match (function, self.fanuc()) {
                    (Function::Fix, true) => v.trunc(),
                    (Function::Fix, false) => v.floor(),
                    (_, true) if v < 0.0 => v.floor(),
                    _ => v.ceil(),
                };
                (whole, Digits::Exact)
            }
            Function::Round => match self.round_decimals {
                Some(decimals) => {
                    let steps = f64::from(10_u32.pow(u32::from(decimals.min(9))));
                    (self.half_away(v * steps, digits)? / steps, Digits::Exact)
                }
                None => (self.half_away(v, digits)?, Digits::Exact),
            },
            Function::Bcd | Function::Bin => {
                let whole = whole(&Text::pair("BCD and BIN", "BCD и BIN"), v)?;
                if !(0..100_000_000).contains(&whole) {
                    return arithmetic(both!("BCD or BIN of {v}", "BCD или BIN от {v}"));
                }
                let (from, to) = if function == Function::Bcd { (10, 16) } else { (16, 10) };
                let (mut left, mut place, mut sum) = (whole, 1, 0);
                while left > 0 {
                    if left % from > 9 {
                        return arithmetic(both!(
                            "{v} is no binary coded decimal",
                            "{v} — не двоично-десятичное число"
                        ));
                    }
                    sum += left % from * place;
                    place *= to;
                    left /= from;
                }
                (sum as f64, Digits::Exact)
            }
        })
    }

    /// The nearest whole number, halves away from zero.
    fn half_away(self, v: f64, digits: Digits) -> Result<f64, Fault> {
        let half = v.trunc() + 0.5 * v.signum();
        if self.undecided(v, half, digits) {
            return Err(Fault::TooClose(v, half));
        }
        Ok(v.round())
    }

    /// An operator's value, and whether its last digits are in doubt.
    fn binary(self, operator: Operator, a: f64, b: f64, digits: Digits) -> Result<(f64, Digits), Fault> {
        let arithmetic = |message: Text| Err(Fault::Arithmetic(message));
        let value = match operator {
            Operator::Add => a + b,
            Operator::Subtract => a - b,
            Operator::Multiply => a * b,
            Operator::Divide | Operator::Modulo if b == 0.0 => {
                return arithmetic(both!("{a} is divided by zero", "{a} делится на ноль"));
            }
            Operator::Divide => a / b,
            Operator::Modulo if self.fanuc() => {
                (whole(&Text::pair("MOD", "MOD"), a)? % whole(&Text::pair("MOD", "MOD"), b)?) as f64
            }
            Operator::Modulo => {
                if self.undecided(a / b, (a / b).round(), digits) {
                    return Err(Fault::TooClose(a, (a / b).round() * b));
                }
                let rest = a % b;
                if rest < 0.0 { rest + b.abs() } else { rest }
            }
            Operator::Power if a < 0.0 && b.fract() != 0.0 => {
                return arithmetic(both!("{a} to the power of {b}", "{a} в степени {b}"));
            }
            Operator::Power => return Ok((math::powf(a, b), Digits::Rounded)),
            Operator::Atan2 if self.flow.one_value_atan => {
                return arithmetic(both!(
                    "ATAN of two values: this control would divide the angle of the first",
                    "ATAN от двух значений: эта стойка разделила бы угол первого"
                ));
            }
            Operator::Atan2 => {
                // Where the angle jumps by a turn, the sign of a zero decides.
                let jumps = a != 0.0 || digits == Digits::Rounded;
                let cut = if self.flow.full_circle_atan { b >= 0.0 } else { b <= 0.0 };
                if cut && jumps && near(a, 0.0, if self.fanuc() { FANUC_NEAR } else { LINUXCNC_NEAR }) {
                    return Err(Fault::TooClose(a, 0.0));
                }
                let degrees = math::atan2(a, b).to_degrees();
                let turned = self.flow.full_circle_atan && degrees < 0.0;
                return Ok((if turned { degrees + 360.0 } else { degrees }, Digits::Rounded));
            }
            logic @ (Operator::And | Operator::Or | Operator::Xor) => {
                return Ok((self.logic(logic, a, b, digits)?, Digits::Exact));
            }
            comparison => return Ok((self.compare(comparison, a, b, digits)?, Digits::Exact)),
        };
        Ok((value, digits))
    }

    /// Fanuc: bit by bit. LinuxCNC: everything but 0 is true.
    fn logic(self, operator: Operator, a: f64, b: f64, digits: Digits) -> Result<f64, Fault> {
        if self.fanuc() {
            let (a, b) = (
                whole(&Text::pair("AND, OR and XOR", "AND, OR и XOR"), a)?,
                whole(&Text::pair("AND, OR and XOR", "AND, OR и XOR"), b)?,
            );
            return Ok(match operator {
                Operator::And => a & b,
                Operator::Or => a | b,
                _ => a ^ b,
            } as f64);
        }
        let holds = |v| self.truth(digits.of(v));
        let (a, b) = (holds(a)?, holds(b)?);
        Ok(f64::from(match operator {
            Operator::And => a && b,
            Operator::Or => a || b,
            _ => a != b,
        }))
    }

    fn compare(self, operator: Operator, a: f64, b: f64, digits: Digits) -> Result<f64, Fault> {
        let equality = matches!(operator, Operator::Equal | Operator::NotEqual);
        // LinuxCNC's EQ has a tolerance of its own that rounding does not reach.
        if (self.fanuc() || !equality) && self.undecided(a, b, digits) {
            return Err(Fault::TooClose(a, b));
        }
        let equal = if self.fanuc() { a == b } else { (a - b).abs() < LINUXCNC_EQUAL };
        Ok(f64::from(match operator {
            Operator::Equal => equal,
            Operator::NotEqual => !equal,
            Operator::Greater => a > b,
            Operator::GreaterOrEqual => a >= b,
            Operator::Less => a < b,
            _ => a <= b,
        }))
    }
}

/// An empty variable counts as 0.
pub(crate) fn number(value: Value) -> f64 {
    if let Value::Number(number) | Value::Rounded(number) = value { number } else { 0.0 }
}

fn near(a: f64, b: f64, share: f64) -> bool {
    (a - b).abs() <= share * a.abs().max(b.abs()).max(1.0)
}

/// The value as an integer of 32 bits.
fn whole(what: &Text, v: f64) -> Result<i64, Fault> {
    if v.fract() != 0.0 || v.abs() > 4_294_967_295.0 {
        return Err(Fault::NotWhole(what.clone(), v));
    }
    Ok(v as i64)
}
