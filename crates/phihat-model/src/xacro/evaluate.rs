//! Value of an expression, by Python's rules.

use super::expression::Expression;
use super::functions;
use super::value::{ENTRIES_MAX, TEXT_MAX, Value};

pub(super) type Result<T> = core::result::Result<T, String>;

/// Names and functions that only the file on its way can tell.
pub(super) trait Names {
    /// Value of a property.
    ///
    /// # Errors
    ///
    /// Its own text does not evaluate.
    fn value(&mut self, name: &str) -> Result<Option<Value>>;

    /// Value of an argument of the file.
    fn argument(&mut self, name: &str) -> Option<String>;

    /// Content of a YAML file.
    ///
    /// # Errors
    ///
    /// It cannot be read.
    fn yaml(&mut self, file: &str) -> Result<Value>;

    /// Counts a step.
    ///
    /// # Errors
    ///
    /// There were too many.
    fn step(&mut self) -> Result<()>;
}

/// Evaluates an expression.
///
/// # Errors
///
/// Words that say what cannot be evaluated.
pub(super) fn evaluate(expression: &Expression, names: &mut dyn Names) -> Result<Value> {
    names.step()?;
    match expression {
        Expression::Value(value) => Ok(value.clone()),
        Expression::Name(name) => match names.value(name)? {
            Some(value) => Ok(value),
            None => functions::constant(name).ok_or_else(|| format!("`{name}` is not defined")),
        },
        Expression::List(list) => {
            list.iter().map(|entry| evaluate(entry, names)).collect::<Result<_>>().map(Value::List)
        }
        Expression::Table(table) => {
            let mut all = Vec::new();
            for (key, value) in table {
                all.push((evaluate(key, names)?, evaluate(value, names)?));
            }
            Ok(Value::Table(all))
        }
        Expression::Unary(mark, inner) => unary(mark, &evaluate(inner, names)?),
        Expression::Binary(mark @ ("and" | "or"), left, right) => {
            let left = evaluate(left, names)?;
            if left.truth() == (*mark == "or") { Ok(left) } else { evaluate(right, names) }
        }
        Expression::Binary(mark, left, right) => {
            let (left, right) = (evaluate(left, names)?, evaluate(right, names)?);
            binary(mark, left, right)
        }
        Expression::Chain(first, others) => chain(first, others, names),
        Expression::Choice { condition, yes, no } => {
            let chosen = if evaluate(condition, names)?.truth() { yes } else { no };
            evaluate(chosen, names)
        }
        Expression::Entry(whole, index) => {
            let (whole, index) = (evaluate(whole, names)?, evaluate(index, names)?);
            entry(&whole, &index)
        }
        Expression::Member(whole, name) => member(whole, name, names),
        Expression::Call(function, given, named) if named.is_empty() => {
            call(function, given, names)
        }
        Expression::Call(function, given, named) => {
            if **function != Expression::Name("dict".to_owned()) || !given.is_empty() {
                return Err("named arguments are read of dict alone".to_owned());
            }
            let one = |(name, value): &(String, Expression)| {
                Ok((Value::Text(name.clone()), evaluate(value, names)?))
            };
            named.iter().map(one).collect::<Result<_>>().map(Value::Table)
        }
    }
}

fn unary(mark: &str, value: &Value) -> Result<Value> {
    if mark == "not" {
        return Ok(Value::Bool(!value.truth()));
    }
    let sign = if mark == "-" { -1 } else { 1 };
    if let Some(whole) = value.whole().and_then(|whole| whole.checked_mul(sign)) {
        return Ok(Value::Int(whole));
    }
    let number = value.number().ok_or_else(|| format!("{mark} of {}", value.kind()))?;
    Ok(Value::Float(sign as f64 * number))
}

fn binary(mark: &str, left: Value, right: Value) -> Result<Value> {
    match (mark, left, right) {
        ("+", Value::Text(a), Value::Text(b)) => text(a + &b),
        ("+", Value::List(mut a), Value::List(b)) => {
            a.extend(b);
            if a.len() > ENTRIES_MAX { Err(too_long()) } else { Ok(Value::List(a)) }
        }
        ("*", Value::Text(one), times) | ("*", times, Value::Text(one)) => {
            let times = times.whole().ok_or("text times what is no whole number")?;
            let times = usize::try_from(times.max(0)).map_err(|_| too_long())?;
            if one.len().saturating_mul(times) > TEXT_MAX {
                return Err(too_long());
            }
            Ok(Value::Text(one.repeat(times)))
        }
        (mark, left, right) => numbers(mark, &left, &right),
    }
}

fn too_long() -> String {
    "a text or list longer than is read".to_owned()
}

fn text(text: String) -> Result<Value> {
    if text.len() > TEXT_MAX { Err(too_long()) } else { Ok(Value::Text(text)) }
}

fn numbers(mark: &str, left: &Value, right: &Value) -> Result<Value> {
    let (Some(a), Some(b)) = (left.number(), right.number()) else {
        return Err(format!("{} {mark} {}", left.kind(), right.kind()));
    };
    if matches!(mark, "/" | "//" | "%") && b.abs() <= 0.0 {
        return Err("division by zero".to_owned());
    }
    // Whole numbers stay whole where Python has them so, and they fit.
    if let (Some(a), Some(b)) = (left.whole(), right.whole()) {
        let quotient = |a: i64, b: i64| {
            let (whole, rest) = (a.checked_div(b)?, a.checked_rem(b)?);
            Some(if rest != 0 && (rest < 0) != (b < 0) { whole - 1 } else { whole })
        };
        let whole = match mark {
            "+" => a.checked_add(b),
            "-" => a.checked_sub(b),
            "*" => a.checked_mul(b),
            "//" => quotient(a, b),
            "%" => quotient(a, b).and_then(|whole| a.checked_sub(whole.checked_mul(b)?)),
            "**" => u32::try_from(b).ok().and_then(|b| a.checked_pow(b)),
            _ => None,
        };
        if let Some(whole) = whole {
            return Ok(Value::Int(whole));
        }
    }
    Ok(Value::Float(match mark {
        "+" => a + b,
        "-" => a - b,
        "*" => a * b,
        "/" => a / b,
        "//" => divided(a, b).0,
        "%" => divided(a, b).1,
        "**" => libm::pow(a, b),
        other => return Err(format!("`{other}` is not read")),
    }))
}

/// Quotient, rounded down, and remainder, of the sign of the divisor, as Python has them: from an exact remainder.
fn divided(a: f64, b: f64) -> (f64, f64) {
    let mut rest = libm::fmod(a, b);
    let mut whole = (a - rest) / b;
    if rest.abs() > 0.0 && (rest < 0.0) != (b < 0.0) {
        rest += b;
        whole -= 1.0;
    }
    (whole.round(), rest)
}

fn chain(
    first: &Expression,
    others: &[(&'static str, Expression)],
    names: &mut dyn Names,
) -> Result<Value> {
    let mut left = evaluate(first, names)?;
    for (mark, right) in others {
        let right = evaluate(right, names)?;
        if !compared(mark, &left, &right)? {
            return Ok(Value::Bool(false));
        }
        left = right;
    }
    Ok(Value::Bool(true))
}

fn compared(mark: &str, left: &Value, right: &Value) -> Result<bool> {
    let order = || match (left, right) {
        (Value::Text(a), Value::Text(b)) => Some(a.cmp(b)),
        _ => left.number()?.partial_cmp(&right.number()?),
    };
    let ordered = |wanted: fn(core::cmp::Ordering) -> bool| {
        let order = order().ok_or_else(|| format!("{} {mark} {}", left.kind(), right.kind()))?;
        Ok(wanted(order))
    };
    match mark {
        "==" => Ok(left.equals(right)),
        "!=" => Ok(!left.equals(right)),
        "<" => ordered(core::cmp::Ordering::is_lt),
        "<=" => ordered(core::cmp::Ordering::is_le),
        ">" => ordered(core::cmp::Ordering::is_gt),
        ">=" => ordered(core::cmp::Ordering::is_ge),
        _ => Ok(contains(right, left)? == (mark == "in")),
    }
}

fn contains(whole: &Value, part: &Value) -> Result<bool> {
    match (whole, part) {
        (Value::Text(whole), Value::Text(part)) => Ok(whole.contains(part.as_str())),
        (Value::List(list), part) => Ok(list.iter().any(|own| own.equals(part))),
        (Value::Table(table), part) => Ok(table.iter().any(|(key, _)| key.equals(part))),
        _ => Err(format!("{} in {}", part.kind(), whole.kind())),
    }
}

fn entry(whole: &Value, index: &Value) -> Result<Value> {
    let at = |length: usize| {
        let index = index.whole().ok_or_else(|| format!("[{index}] of {}", whole.kind()))?;
        let length = i64::try_from(length).map_err(|_| too_long())?;
        let from_start = if index < 0 { index.saturating_add(length) } else { index };
        usize::try_from(from_start).map_err(|_| format!("[{index}] is outside of {length} entries"))
    };
    let outside = || format!("[{index}] is not in {}", whole.kind());
    match whole {
        Value::List(list) => list.get(at(list.len())?).cloned().ok_or_else(outside),
        Value::Text(text) => {
            let one = text.chars().nth(at(text.chars().count())?);
            one.map(|c| Value::Text(c.to_string())).ok_or_else(outside)
        }
        Value::Table(table) => {
            let own = table.iter().find(|(key, _)| key.equals(index));
            own.map(|(_, value)| value.clone()).ok_or_else(outside)
        }
        _ => Err(format!("[{index}] of {}", whole.kind())),
    }
}

/// Namespaces of functions and constants.
const SPACES: [&str; 3] = ["math", "xacro", "python"];

/// The namespace that an expression names, where no property has that name.
fn space(expression: &Expression, names: &mut dyn Names) -> Result<Option<&'static str>> {
    let Expression::Name(name) = expression else { return Ok(None) };
    let space = SPACES.iter().copied().find(|space| space == name);
    Ok(if space.is_some() && names.value(name)?.is_none() { space } else { None })
}

fn member(whole: &Expression, name: &str, names: &mut dyn Names) -> Result<Value> {
    if let Some(space) = space(whole, names)? {
        let value = functions::constant(name).filter(|_| space == "math");
        return value.ok_or_else(|| format!("`{space}.{name}` is not read"));
    }
    // A property of a namespace of a file that was included.
    if let Expression::Name(before) = whole
        && let Some(value) = names.value(&format!("{before}.{name}"))?
    {
        return Ok(value);
    }
    let whole = evaluate(whole, names)?;
    entry(&whole, &Value::Text(name.to_owned()))
        .map_err(|_| format!("{} has no `{name}`", whole.kind()))
}

fn call(function: &Expression, given: &[Expression], names: &mut dyn Names) -> Result<Value> {
    let values = given.iter().map(|one| evaluate(one, names)).collect::<Result<Vec<_>>>();
    match function {
        Expression::Name(name) => of_file(name, &values?, names),
        Expression::Member(whole, name) => {
            if space(whole, names)?.is_some() {
                return of_file(name, &values?, names);
            }
            let whole = evaluate(whole, names)?;
            functions::method(&whole, name, &values?)
        }
        _ => Err("only a name can be called".to_owned()),
    }
}

/// Functions that need the file, and those that need nothing.
fn of_file(name: &str, values: &[Value], names: &mut dyn Names) -> Result<Value> {
    let joined = || values.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    match (name, values) {
        ("load_yaml", [Value::Text(file)]) => names.yaml(file),
        ("arg", [Value::Text(argument)]) => {
            let value = names.argument(argument);
            value.map(Value::Text).ok_or_else(|| format!("there is no argument `{argument}`"))
        }
        ("dotify", [value]) => Ok(value.clone()),
        ("fatal" | "error", _) => Err(format!("the file refuses: {}", joined())),
        ("message" | "warning" | "print_location", _) => Ok(Value::Text(String::new())),
        _ => functions::call(name, values),
    }
}
