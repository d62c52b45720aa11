//! Expressions: tree to value.
//!
//! LinuxCNC computes in double precision, so its results are these. What Fanuc's own number format makes of
//! values that differ by rounding only is told by no manual: there the work is refused
//! ([`Fault::TooClose`]) instead of decided.

use nc_syntax::dialect::{Flow, Macros};
use units::math;

use crate::expression::{Expression, Function, Operator};
use crate::value::{Value, Variable};

/// LinuxCNC: values nearer than this are EQ (its TOLERANCE_EQUAL), and an index may be off by as much.
pub(crate) const LINUXCNC_EQUAL: f64 = 1e-4;
/// Fanuc: relative difference below which two values cannot be told apart with certainty.
const FANUC_NEAR: f64 = 1e-7;

/// Why there is no value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Fault {
    /// The operation has no result.
    Arithmetic(String),
    /// The control's rounding decides.
    TooClose(f64, f64),
    /// A whole number was needed.
    NotWhole(&'static str, f64),
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
    const fn fanuc(self) -> bool {
        matches!(self.flow.macros, Macros::Fanuc)
    }

    /// The value of an expression.
    pub(crate) fn evaluate(
        self,
        expression: &Expression,
        variables: &impl Variables,
    ) -> Result<Value, Fault> {
        let value = match expression {
            Expression::Number(number) => return Ok(Value::Number(*number)),
            Expression::Variable(variable) => return variables.value(*variable),
            Expression::Indirect(index) => {
                return match self.evaluate(index, variables)? {
                    Value::Number(number) => variables.value(self.index(number)?),
                    Value::Null => variables.value(Variable::Numbered(0)),
                    unknown @ Value::Unknown(_) => Ok(unknown),
                };
            }
            Expression::Exists(variable) => {
                return Ok(match variables.exists(*variable) {
                    Some(exists) => Value::Number(f64::from(u8::from(exists))),
                    None => Value::Unknown(*variable),
                });
            }
            Expression::Negative(inside) => match self.evaluate(inside, variables)? {
                Value::Number(number) => -number,
                Value::Null => 0.0,
                unknown @ Value::Unknown(_) => return Ok(unknown),
            },
            Expression::Unary(function, inside) => match self.evaluate(inside, variables)? {
                Value::Number(number) => self.function(*function, number)?,
                Value::Null => self.function(*function, 0.0)?,
                unknown @ Value::Unknown(_) => return Ok(unknown),
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
                        truth((a == b) == (*operator == Operator::Equal))
                    }
                    (_, a, b) => self.binary(*operator, number(a), number(b))?,
                }
            }
        };
        if value.is_finite() {
            Ok(Value::Number(value))
        } else {
            Err(Fault::Arithmetic("the result is larger than any number".to_owned()))
        }
    }

    /// The variable that a computed number names.
    pub(crate) fn index(self, number: f64) -> Result<Variable, Fault> {
        let whole = number.round();
        let slack = if self.fanuc() { 1e-9 } else { LINUXCNC_EQUAL };
        if (number - whole).abs() > slack {
            return Err(Fault::NotWhole("the number of a variable", number));
        }
        if !(0.0..=1e9).contains(&whole) {
            return Err(Fault::NoVariable(number));
        }
        Ok(Variable::Numbered(whole as u32))
    }

    fn function(self, function: Function, v: f64) -> Result<f64, Fault> {
        let arithmetic = |message: String| Err(Fault::Arithmetic(message));
        Ok(match function {
            Function::Abs => v.abs(),
            Function::Sin => math::sin(v.to_radians()),
            Function::Cos => math::cos(v.to_radians()),
            Function::Tan => math::tan(v.to_radians()),
            Function::Atan => math::atan(v).to_degrees(),
            Function::Asin | Function::Acos if !(-1.0..=1.0).contains(&v) => {
                return arithmetic(format!("no angle has the sine or cosine {v}"));
            }
            Function::Asin => math::asin(v).to_degrees(),
            Function::Acos => math::acos(v).to_degrees(),
            Function::Exp => math::exp(v),
            Function::Ln if v <= 0.0 => return arithmetic(format!("the logarithm of {v}")),
            Function::Ln => math::ln(v),
            Function::Sqrt if v < 0.0 => return arithmetic(format!("the square root of {v}")),
            Function::Sqrt => v.sqrt(),
            Function::Fix | Function::Fup => {
                let whole = v.round();
                if self.fanuc() && whole != v && near(v, whole) {
                    return Err(Fault::TooClose(v, whole));
                }
                match (function, self.fanuc()) {
                    (Function::Fix, true) => v.trunc(),
                    (Function::Fix, false) => v.floor(),
                    (_, true) if v < 0.0 => v.floor(),
                    _ => v.ceil(),
                }
            }
            Function::Round => match self.round_decimals {
                Some(decimals) => {
                    let steps = f64::from(10_u32.pow(u32::from(decimals.min(9))));
                    self.half_away(v * steps)? / steps
                }
                None => self.half_away(v)?,
            },
            Function::Bcd | Function::Bin => {
                let whole = whole("BCD and BIN", v)?;
                if !(0..100_000_000).contains(&whole) {
                    return arithmetic(format!("BCD or BIN of {v}"));
                }
                let (from, to) = if function == Function::Bcd { (10, 16) } else { (16, 10) };
                let (mut left, mut place, mut sum) = (whole, 1, 0);
                while left > 0 {
                    if left % from > 9 {
                        return arithmetic(format!("{v} is no binary coded decimal"));
                    }
                    sum += left % from * place;
                    place *= to;
                    left /= from;
                }
                sum as f64
            }
        })
    }

    /// The nearest whole number, halves away from zero.
    fn half_away(self, v: f64) -> Result<f64, Fault> {
        let half = v.trunc() + 0.5 * v.signum();
        if self.fanuc() && v != half && near(v, half) {
            return Err(Fault::TooClose(v, half));
        }
        Ok(v.round())
    }

    fn binary(self, operator: Operator, a: f64, b: f64) -> Result<f64, Fault> {
        let arithmetic = |message: String| Err(Fault::Arithmetic(message));
        Ok(match operator {
            Operator::Add => a + b,
            Operator::Subtract => a - b,
            Operator::Multiply => a * b,
            Operator::Divide | Operator::Modulo if b == 0.0 => {
                return arithmetic(format!("{a} is divided by zero"));
            }
            Operator::Divide => a / b,
            Operator::Modulo if self.fanuc() => (whole("MOD", a)? % whole("MOD", b)?) as f64,
            Operator::Modulo => {
                let rest = a % b;
                if rest < 0.0 { rest + b.abs() } else { rest }
            }
            Operator::Power if a < 0.0 && b.fract() != 0.0 => {
                return arithmetic(format!("{a} to the power of {b}"));
            }
            Operator::Power => math::powf(a, b),
            Operator::Atan2 => {
                let degrees = math::atan2(a, b).to_degrees();
                if self.flow.full_circle_atan && degrees < 0.0 { degrees + 360.0 } else { degrees }
            }
            Operator::And | Operator::Or | Operator::Xor if self.fanuc() => {
                let (a, b) = (whole("AND, OR and XOR", a)?, whole("AND, OR and XOR", b)?);
                (match operator {
                    Operator::And => a & b,
                    Operator::Or => a | b,
                    _ => a ^ b,
                }) as f64
            }
            Operator::And => truth(a != 0.0 && b != 0.0),
            Operator::Or => truth(a != 0.0 || b != 0.0),
            Operator::Xor => truth((a != 0.0) != (b != 0.0)),
            comparison => {
                if self.fanuc() && a != b && near(a, b) {
                    return Err(Fault::TooClose(a, b));
                }
                let equal = if self.fanuc() { a == b } else { (a - b).abs() < LINUXCNC_EQUAL };
                truth(match comparison {
                    Operator::Equal => equal,
                    Operator::NotEqual => !equal,
                    Operator::Greater => a > b,
                    Operator::GreaterOrEqual => a >= b,
                    Operator::Less => a < b,
                    _ => a <= b,
                })
            }
        })
    }
}

fn truth(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}

/// An empty variable counts as 0.
pub(crate) fn number(value: Value) -> f64 {
    if let Value::Number(number) = value { number } else { 0.0 }
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= FANUC_NEAR * a.abs().max(b.abs()).max(1.0)
}

/// The value as an integer of 32 bits.
fn whole(what: &'static str, v: f64) -> Result<i64, Fault> {
    if v.fract() != 0.0 || v.abs() > 4_294_967_295.0 {
        return Err(Fault::NotWhole(what, v));
    }
    Ok(v as i64)
}
