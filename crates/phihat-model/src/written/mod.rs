//! A number type that writes down what is done with it: exact counts of operations, and code written out for one arm.

mod counts;
mod kernels;

use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use crate::{Quad, Scalar};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum WrittenStep {
    /// Bits of a number.
    Constant(u64),
    Input(usize),
    Sine(usize),
    Cosine(usize),
    Minus(usize),
    Plus(usize, usize),
    Less(usize, usize),
    Times(usize, usize),
    Over(usize, usize),
}

#[derive(Debug, Default)]
struct WrittenTape {
    steps: Vec<WrittenStep>,
    known: HashMap<WrittenStep, usize>,
    performed: usize,
}

thread_local!(static TAPE: RefCell<WrittenTape> = RefCell::default());

/// A number that is written down; 0 is the constant zero on every tape.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Written(pub(crate) usize);

impl Written {
    pub(crate) fn put(step: WrittenStep) -> Self {
        TAPE.with_borrow_mut(|tape| {
            let next = tape.steps.len();
            let at = *tape.known.entry(step).or_insert(next);
            if at == next {
                tape.steps.push(step);
            }
            Self(at)
        })
    }

    fn step(self) -> WrittenStep {
        TAPE.with_borrow(|tape| tape.steps[self.0])
    }

    fn constant(self) -> Option<f64> {
        match self.step() {
            WrittenStep::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// The number that this is the negative of.
    fn negated(self) -> Option<Self> {
        match self.step() {
            WrittenStep::Minus(of) => Some(Self(of)),
            _ => None,
        }
    }

    fn sum(self, other: Self) -> Self {
        match (self.constant(), other.constant()) {
            (Some(a), Some(b)) => Self::splat(a + b),
            (Some(0.0), _) => other,
            (_, Some(0.0)) => self,
            _ => match (self.negated(), other.negated()) {
                (_, Some(b)) => self.difference(b),
                (Some(a), _) => other.difference(a),
                _ => Self::put(WrittenStep::Plus(self.0.min(other.0), self.0.max(other.0))),
            },
        }
    }

    fn difference(self, other: Self) -> Self {
        match (self.constant(), other.constant()) {
            (Some(a), Some(b)) => Self::splat(a - b),
            (_, Some(0.0)) => self,
            (Some(0.0), _) => -other,
            _ if self.0 == other.0 => Self::splat(0.0),
            _ => match other.negated() {
                Some(b) => self.sum(b),
                None => Self::put(WrittenStep::Less(self.0, other.0)),
            },
        }
    }

    fn product(self, other: Self) -> Self {
        if let Some(a) = self.negated() {
            return -a.product(other);
        }
        if let Some(b) = other.negated() {
            return -self.product(b);
        }
        match (self.constant(), other.constant()) {
            (Some(a), Some(b)) => Self::splat(a * b),
            (Some(0.0), _) | (_, Some(0.0)) => Self::splat(0.0),
            (Some(1.0), _) => other,
            (_, Some(1.0)) => self,
            (Some(-1.0), _) => -other,
            (_, Some(-1.0)) => -self,
            _ => Self::put(WrittenStep::Times(self.0.min(other.0), self.0.max(other.0))),
        }
    }
}

fn performed() {
    TAPE.with_borrow_mut(|tape| tape.performed += 1);
}

impl Add for Written {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        performed();
        self.sum(other)
    }
}

impl Sub for Written {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        performed();
        self.difference(other)
    }
}

impl Mul for Written {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        performed();
        self.product(other)
    }
}

impl Div for Written {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        performed();
        Self::put(WrittenStep::Over(self.0, other.0))
    }
}

impl Neg for Written {
    type Output = Self;
    fn neg(self) -> Self {
        match (self.constant(), self.negated()) {
            (Some(value), _) => Self::splat(-value),
            (_, Some(of)) => of,
            _ => Self::put(WrittenStep::Minus(self.0)),
        }
    }
}

impl AddAssign for Written {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Written {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl Scalar for Written {
    type Four = Quad<Self>;

    fn splat(value: f64) -> Self {
        // Of both zeros one: folding does not tell them apart.
        Self::put(WrittenStep::Constant((value + 0.0).to_bits()))
    }

    fn sin_cos(self) -> (Self, Self) {
        (Self::put(WrittenStep::Sine(self.0)), Self::put(WrittenStep::Cosine(self.0)))
    }
}

/// Recorded operations, and which of them the results need.
pub(crate) struct Program {
    pub(crate) steps: Vec<WrittenStep>,
    pub(crate) live: Vec<bool>,
    pub(crate) results: Vec<usize>,
    performed: usize,
}

impl Program {
    /// Writes down what `work` does with so many inputs.
    pub(crate) fn of(inputs: usize, work: impl FnOnce(&[Written]) -> Vec<Written>) -> Self {
        TAPE.with_borrow_mut(|tape| *tape = WrittenTape::default());
        let _ = Written::splat(0.0);
        let inputs: Vec<_> = (0..inputs).map(|k| Written::put(WrittenStep::Input(k))).collect();
        let results: Vec<usize> = work(&inputs).iter().map(|result| result.0).collect();
        let WrittenTape { steps, performed, .. } = TAPE.take();
        let mut live = vec![false; steps.len()];
        for k in &results {
            live[*k] = true;
        }
        for k in (0..steps.len()).rev() {
            if !live[k] {
                continue;
            }
            match steps[k] {
                WrittenStep::Constant(_) | WrittenStep::Input(_) => (),
                WrittenStep::Sine(a) | WrittenStep::Cosine(a) | WrittenStep::Minus(a) => {
                    live[a] = true;
                }
                WrittenStep::Plus(a, b)
                | WrittenStep::Less(a, b)
                | WrittenStep::Times(a, b)
                | WrittenStep::Over(a, b) => {
                    (live[a], live[b]) = (true, true);
                }
            }
        }
        Self { steps, live, results, performed }
    }

    /// Live steps, each behind what it needs, inputs just before their first use.
    fn order(&self) -> Vec<usize> {
        let mut order = Vec::new();
        let mut placed = vec![false; self.steps.len()];
        let mut put = |k: usize| {
            if !core::mem::replace(&mut placed[k], true) {
                order.push(k);
            }
        };
        for (k, step) in self.steps.iter().enumerate().filter(|(k, _)| self.live[*k]) {
            match *step {
                WrittenStep::Constant(_) | WrittenStep::Input(_) => continue,
                WrittenStep::Sine(a) | WrittenStep::Cosine(a) | WrittenStep::Minus(a) => put(a),
                WrittenStep::Plus(a, b)
                | WrittenStep::Less(a, b)
                | WrittenStep::Times(a, b)
                | WrittenStep::Over(a, b) => {
                    put(a);
                    put(b);
                }
            }
            put(k);
        }
        order
    }

    fn operations(&self) -> usize {
        let counted = |step: &WrittenStep| {
            matches!(
                step,
                WrittenStep::Plus(..)
                    | WrittenStep::Less(..)
                    | WrittenStep::Times(..)
                    | WrittenStep::Over(..)
            )
        };
        self.steps.iter().zip(&self.live).filter(|(step, live)| **live && counted(step)).count()
    }

    /// Does it again, one operation after the other.
    pub(crate) fn run(&self, inputs: &[f64]) -> Vec<f64> {
        let mut values: Vec<f64> = Vec::with_capacity(self.steps.len());
        for step in &self.steps {
            let value = match *step {
                WrittenStep::Constant(bits) => f64::from_bits(bits),
                WrittenStep::Input(k) => inputs[k],
                WrittenStep::Sine(a) => <f64 as Scalar>::sin_cos(values[a]).0,
                WrittenStep::Cosine(a) => <f64 as Scalar>::sin_cos(values[a]).1,
                WrittenStep::Minus(a) => -values[a],
                WrittenStep::Plus(a, b) => values[a] + values[b],
                WrittenStep::Less(a, b) => values[a] - values[b],
                WrittenStep::Times(a, b) => values[a] * values[b],
                WrittenStep::Over(a, b) => values[a] / values[b],
            };
            values.push(value);
        }
        self.results.iter().map(|k| values[*k]).collect()
    }
}

/// Numbers in ±2 that follow no pattern, other ones in every round.
fn scattered(round: u32, count: usize) -> Vec<f64> {
    let at = |k: usize| 2.0 * (78.233 * (k as f64 + 1.0) + 12.9898 * f64::from(round)).sin();
    (0..count).map(at).collect()
}
