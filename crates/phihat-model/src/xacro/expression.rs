//! Expressions of xacro, a part of Python's: from text to a tree.

use super::reason::{Reasoned, reason};
use super::value::XacroValue;

/// Deepest nesting of an expression, and its longest text \[bytes\].
const DEPTH_MAX: usize = 48;
const LENGTH_MAX: usize = 16_384;

/// Tree of an expression.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Expression {
    Value(XacroValue),
    Name(String),
    List(Vec<Expression>),
    Table(Vec<(Expression, Expression)>),
    /// `-x`, `+x`, `not x`.
    Unary(&'static str, Box<Expression>),
    /// `x + y` and the like, `and` and `or` among them.
    Binary(&'static str, Box<Expression>, Box<Expression>),
    /// `a < b <= c`.
    Chain(Box<Expression>, Vec<(&'static str, Expression)>),
    /// `yes if condition else no`.
    Choice {
        condition: Box<Expression>,
        yes: Box<Expression>,
        no: Box<Expression>,
    },
    /// `x[i]`.
    Entry(Box<Expression>, Box<Expression>),
    /// `x.name`.
    Member(Box<Expression>, String),
    /// `f(x, …)`; of `f(name=x)` the second list.
    Call(Box<Expression>, Vec<Expression>, Vec<(String, Expression)>),
}

/// A word of an expression.
#[derive(Debug, Clone, PartialEq)]
enum Token {
    Value(XacroValue),
    Name(String),
    Mark(&'static str),
}

/// Reads an expression.
///
/// # Errors
///
/// Words that say what is not read.
pub(super) fn parse(text: &str) -> Reasoned<Expression> {
    if text.len() > LENGTH_MAX {
        return Err(reason!("an expression longer than {LENGTH_MAX} bytes"));
    }
    let mut parser = Parser { tokens: tokens(text)?, at: 0, depth: 0 };
    let expression = parser.choice()?;
    match parser.peek() {
        None => Ok(expression),
        Some(token) => Err(reason!("{} is not expected there", shown(token))),
    }
}

const MARKS: [&str; 23] = [
    "**", "//", "==", "!=", "<=", ">=", "+", "-", "*", "/", "%", "<", ">", "(", ")", "[", "]", "{",
    "}", ",", ":", ".", "=",
];
const WORDS: [&str; 7] = ["not", "and", "or", "in", "if", "else", "is"];

fn tokens(text: &str) -> Reasoned<Vec<Token>> {
    let mut all = Vec::new();
    let mut rest = text.trim();
    while let Some(first) = rest.chars().next() {
        let (token, length) = if first.is_ascii_digit() || starts_fraction(rest) {
            number(rest)?
        } else if first == '\'' || first == '"' {
            quoted(rest, first)?
        } else if first.is_alphabetic() || first == '_' {
            word(rest)
        } else {
            let mark = MARKS.iter().find(|mark| rest.starts_with(**mark));
            let mark = mark.ok_or_else(|| reason!("`{first}` is not read"))?;
            (Token::Mark(mark), mark.len())
        };
        all.push(token);
        rest = rest[length..].trim_start();
    }
    Ok(all)
}

fn starts_fraction(text: &str) -> bool {
    text.strip_prefix('.').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
}

fn number(text: &str) -> Reasoned<(Token, usize)> {
    if let Some(digits) = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        let length = digits.find(|c: char| !c.is_ascii_hexdigit()).unwrap_or(digits.len());
        let whole = i64::from_str_radix(&digits[..length], 16);
        let whole = whole.map_err(|why| reason!("0x{}: {why}", &digits[..length]))?;
        return Ok((Token::Value(XacroValue::Int(whole)), length + 2));
    }
    let mut length = 0;
    let mut before = ' ';
    for c in text.chars() {
        let sign = matches!(c, '+' | '-') && matches!(before, 'e' | 'E');
        if !(c.is_ascii_digit() || matches!(c, '.' | 'e' | 'E' | '_') || sign) {
            break;
        }
        (before, length) = (c, length + 1);
    }
    let plain = text[..length].replace('_', "");
    let value = match plain.parse() {
        Ok(whole) => XacroValue::Int(whole),
        Err(_) => {
            XacroValue::Float(plain.parse().map_err(|_| reason!("`{plain}` is not a number"))?)
        }
    };
    Ok((Token::Value(value), length))
}

fn quoted(text: &str, quote: char) -> Reasoned<(Token, usize)> {
    let mut inside = String::new();
    let mut rest = text.char_indices().skip(1);
    while let Some((at, c)) = rest.next() {
        match c {
            '\\' => match rest.next().map(|(_, c)| c) {
                Some('n') => inside.push('\n'),
                Some('t') => inside.push('\t'),
                Some(c) => inside.push(c),
                None => break,
            },
            c if c == quote => return Ok((Token::Value(XacroValue::Text(inside)), at + 1)),
            c => inside.push(c),
        }
    }
    Err(reason!("a text that {quote} begins and nothing ends"))
}

fn word(text: &str) -> (Token, usize) {
    let inside = |c: char| c.is_alphanumeric() || c == '_';
    let length = text.find(|c| !inside(c)).unwrap_or(text.len());
    let name = &text[..length];
    let token = match name {
        "True" => Token::Value(XacroValue::Bool(true)),
        "False" => Token::Value(XacroValue::Bool(false)),
        "None" => Token::Value(XacroValue::None),
        _ => match WORDS.iter().find(|word| **word == name) {
            Some(word) => Token::Mark(word),
            None => Token::Name(name.to_owned()),
        },
    };
    (token, length)
}

fn shown(token: &Token) -> String {
    match token {
        Token::Value(value) => format!("`{value}`"),
        Token::Name(name) => format!("`{name}`"),
        Token::Mark(mark) => format!("`{mark}`"),
    }
}

/// Operators of a level that group from the left, the loosest level first.
const LEVELS: [&[&str]; 2] = [&["+", "-"], &["*", "/", "//", "%"]];

struct Parser {
    tokens: Vec<Token>,
    at: usize,
    depth: usize,
}

impl Parser {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at)
    }

    /// The next mark, if it is one of these; it is consumed.
    fn mark(&mut self, of: &[&'static str]) -> Option<&'static str> {
        let Some(Token::Mark(mark)) = self.peek() else { return None };
        let mark = of.iter().copied().find(|own| own == mark)?;
        self.at += 1;
        Some(mark)
    }

    fn expect(&mut self, mark: &'static str) -> Reasoned<()> {
        if self.mark(&[mark]).is_some() {
            return Ok(());
        }
        let there = self.peek().map_or_else(|| "the end".to_owned(), shown);
        Err(reason!("`{mark}` is missing before {there}"))
    }

    fn choice(&mut self) -> Reasoned<Expression> {
        self.depth += 1;
        if self.depth > DEPTH_MAX {
            return Err(reason!("more than {DEPTH_MAX} levels inside each other"));
        }
        let yes = self.or()?;
        let whole = if self.mark(&["if"]).is_some() {
            let condition = Box::new(self.or()?);
            self.expect("else")?;
            let no = Box::new(self.choice()?);
            Expression::Choice { condition, yes: Box::new(yes), no }
        } else {
            yes
        };
        self.depth -= 1;
        Ok(whole)
    }

    fn or(&mut self) -> Reasoned<Expression> {
        let mut left = self.and()?;
        while self.mark(&["or"]).is_some() {
            left = Expression::Binary("or", Box::new(left), Box::new(self.and()?));
        }
        Ok(left)
    }

    fn and(&mut self) -> Reasoned<Expression> {
        let mut left = self.not()?;
        while self.mark(&["and"]).is_some() {
            left = Expression::Binary("and", Box::new(left), Box::new(self.not()?));
        }
        Ok(left)
    }

    fn not(&mut self) -> Reasoned<Expression> {
        let mut turned = 0;
        while self.mark(&["not"]).is_some() {
            turned += 1;
        }
        let mut inner = self.comparison()?;
        // Two of them make a bool of what is inside, and more of them nothing else.
        let times = if turned == 0 { 0 } else { 2 - turned % 2 };
        for _ in 0..times {
            inner = Expression::Unary("not", Box::new(inner));
        }
        Ok(inner)
    }

    fn comparison(&mut self) -> Reasoned<Expression> {
        let first = self.level(0)?;
        let mut others = Vec::new();
        loop {
            let mark = match self.mark(&["==", "!=", "<=", ">=", "<", ">", "in", "is", "not"]) {
                None => break,
                Some("not") => {
                    self.expect("in")?;
                    "not in"
                }
                Some("is") if self.mark(&["not"]).is_some() => "!=",
                Some("is") => "==",
                Some(mark) => mark,
            };
            others.push((mark, self.level(0)?));
        }
        if others.is_empty() {
            return Ok(first);
        }
        Ok(Expression::Chain(Box::new(first), others))
    }

    fn level(&mut self, at: usize) -> Reasoned<Expression> {
        let Some(marks) = LEVELS.get(at) else { return self.signed() };
        let mut left = self.level(at + 1)?;
        while let Some(mark) = self.mark(marks) {
            left = Expression::Binary(mark, Box::new(left), Box::new(self.level(at + 1)?));
        }
        Ok(left)
    }

    fn signed(&mut self) -> Reasoned<Expression> {
        let Some(mark) = self.mark(&["-", "+"]) else { return self.power() };
        self.depth += 1;
        if self.depth > DEPTH_MAX {
            return Err(reason!("more than {DEPTH_MAX} levels inside each other"));
        }
        let inner = self.signed()?;
        self.depth -= 1;
        Ok(Expression::Unary(mark, Box::new(inner)))
    }

    fn power(&mut self) -> Reasoned<Expression> {
        let base = self.postfix()?;
        if self.mark(&["**"]).is_none() {
            return Ok(base);
        }
        // It groups from the right, and binds looser than a sign in its exponent.
        Ok(Expression::Binary("**", Box::new(base), Box::new(self.signed()?)))
    }

    fn postfix(&mut self) -> Reasoned<Expression> {
        let mut whole = self.atom()?;
        for _ in 0..DEPTH_MAX {
            match self.mark(&["[", "(", "."]) {
                Some("[") => {
                    let index = Box::new(self.choice()?);
                    self.expect("]")?;
                    whole = Expression::Entry(Box::new(whole), index);
                }
                Some("(") => {
                    let (given, named) = self.given()?;
                    whole = Expression::Call(Box::new(whole), given, named);
                }
                Some(_) => {
                    let Some(Token::Name(name)) = self.peek().cloned() else {
                        return Err("a name is missing after `.`".into());
                    };
                    self.at += 1;
                    whole = Expression::Member(Box::new(whole), name);
                }
                None => return Ok(whole),
            }
        }
        Err(reason!("more than {DEPTH_MAX} brackets and points in a row"))
    }

    fn atom(&mut self) -> Reasoned<Expression> {
        let Some(token) = self.peek().cloned() else {
            return Err("a value is missing at the end".into());
        };
        self.at += 1;
        match token {
            Token::Value(XacroValue::Text(mut text)) => {
                // Texts in a row are one.
                while let Some(Token::Value(XacroValue::Text(more))) = self.peek() {
                    text.push_str(more);
                    self.at += 1;
                }
                Ok(Expression::Value(XacroValue::Text(text)))
            }
            Token::Value(value) => Ok(Expression::Value(value)),
            Token::Name(name) => Ok(Expression::Name(name)),
            Token::Mark("(") => {
                let mut inside = self.until(")")?;
                let comma = matches!(self.tokens.get(self.at - 2), Some(Token::Mark(",")));
                match inside.pop() {
                    Some(one) if inside.is_empty() && !comma => Ok(one),
                    last => {
                        inside.extend(last);
                        Ok(Expression::List(inside))
                    }
                }
            }
            Token::Mark("[") => Ok(Expression::List(self.until("]")?)),
            Token::Mark("{") => self.table(),
            mark @ Token::Mark(_) => Err(reason!("{} is not expected there", shown(&mark))),
        }
    }

    /// Values that a function is given, to the end of its bracket.
    #[expect(clippy::type_complexity, reason = "two lists")]
    fn given(&mut self) -> Reasoned<(Vec<Expression>, Vec<(String, Expression)>)> {
        let (mut given, mut named) = (Vec::new(), Vec::new());
        while self.mark(&[")"]).is_none() {
            let name = match (self.peek(), self.tokens.get(self.at + 1)) {
                (Some(Token::Name(name)), Some(Token::Mark("="))) => Some(name.clone()),
                _ => None,
            };
            match name {
                Some(name) => {
                    self.at += 2;
                    named.push((name, self.choice()?));
                }
                None => given.push(self.choice()?),
            }
            if self.mark(&[","]).is_none() {
                self.expect(")")?;
                break;
            }
        }
        Ok((given, named))
    }

    fn until(&mut self, end: &'static str) -> Reasoned<Vec<Expression>> {
        let mut all = Vec::new();
        while self.mark(&[end]).is_none() {
            all.push(self.choice()?);
            if self.mark(&[","]).is_none() {
                self.expect(end)?;
                break;
            }
        }
        Ok(all)
    }

    fn table(&mut self) -> Reasoned<Expression> {
        let mut all = Vec::new();
        while self.mark(&["}"]).is_none() {
            let key = self.choice()?;
            self.expect(":")?;
            all.push((key, self.choice()?));
            if self.mark(&[","]).is_none() {
                self.expect("}")?;
                break;
            }
        }
        Ok(Expression::Table(all))
    }
}
