//! Conditions on polynomials that hold on all of `[0, 1]`, by Bernstein coefficients over cells.

use num_bigint::{BigInt, Sign};

use crate::{Number, Polynomial};

/// Cells after which a proof is given up.
const MOST: usize = 200_000;

/// Halvings after which a proof is given up.
const DEEPEST: u32 = 400;

/// Halvings up to which doubles tell the ends of a cell exactly.
const DEEPEST_EXACT: u32 = 50;

/// Bernstein coefficients of several polynomials over one cell, in one common unit: all of one length.
///
/// Between the ends of the cell each polynomial is a mean of its coefficients, with weights that are positive and the
/// same for all; at the ends it is its first and its last one.
pub(crate) type Forms = Vec<Vec<BigInt>>;

/// One cell of `[0, 1]`, or a single `t`, with what the polynomials are there.
pub(crate) struct BernsteinCell {
    /// Forms, group by group.
    pub(crate) groups: Vec<Forms>,
    /// Its start, exact while it was halved no more than 52 times.
    pub(crate) from: f64,
    width: f64,
    /// Number of halvings.
    pub(crate) depth: u32,
}

/// Place `t` at which a condition does not hold, or was not shown to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fails(pub(crate) f64);

/// Proves that a condition holds of all values that the polynomials take together at any `t` of `[0, 1]`.
///
/// # Method
///
/// `holds` may say yes of a cell only if the condition holds of all means of its Bernstein coefficients (with the same
/// weights for all polynomials). Where it says no, the cell is halved; where it says no of a single `t`, the proof
/// ends. Polynomials of a group share degree and unit.
pub(crate) fn everywhere(
    groups: &[Vec<Polynomial>],
    holds: impl Fn(&BernsteinCell) -> bool,
) -> Result<(), Fails> {
    let groups = groups.iter().map(|group| bernstein(group)).collect();
    let mut cells = vec![BernsteinCell { groups, from: 0.0, width: 1.0, depth: 0 }];
    let mut count = 0;
    while let Some(cell) = cells.pop() {
        count += 1;
        if holds(&cell) {
            continue;
        }
        let (left, right) = cell.halves();
        let bad = [left.start(), right.start(), right.end()].into_iter().find(|at| !holds(at));
        if let Some(at) = bad {
            return Err(Fails(at.from));
        }
        if cell.depth >= DEEPEST || count >= MOST {
            return Err(Fails(right.from));
        }
        cells.extend([right, left]);
    }
    Ok(())
}

/// Returns true if every coefficient is above zero.
pub(crate) fn positive(form: &[BigInt]) -> bool {
    form.iter().all(|c| c.sign() == Sign::Plus)
}

/// Returns true if every coefficient is below zero.
pub(crate) fn negative(form: &[BigInt]) -> bool {
    form.iter().all(|c| c.sign() == Sign::Minus)
}

/// Returns true if no coefficient is below zero.
pub(crate) fn not_negative(form: &[BigInt]) -> bool {
    form.iter().all(|c| c.sign() != Sign::Minus)
}

/// Returns true if no coefficient is above zero.
pub(crate) fn not_positive(form: &[BigInt]) -> bool {
    form.iter().all(|c| c.sign() != Sign::Plus)
}

/// The form, one degree higher, of its product with the line from `start` to `end` over the cell, times that degree.
pub(crate) fn times_line(form: &[BigInt], start: &BigInt, end: &BigInt) -> Vec<BigInt> {
    let degree = form.len();
    let entry = |i: usize| {
        let from = form.get(i).map(|b| b * start * (degree - i)).unwrap_or_default();
        let to =
            i.checked_sub(1).and_then(|k| form.get(k)).map(|b| b * end * i).unwrap_or_default();
        from + to
    };
    (0..=degree).map(entry).collect()
}

/// Bernstein coefficients over `[0, 1]` of a group, times `n!` and a power of two.
///
/// Of degree `n`, `b_i = Σ_k C(i,k)/C(n,k) c_k`, and `n! C(i,k)/C(n,k) = i!/(i−k)! · (n−k)!`.
fn bernstein(group: &[Polynomial]) -> Forms {
    let n = group.iter().map(Polynomial::degree).max().unwrap_or(0);
    let all = group.iter().flat_map(Polynomial::coefficients);
    let unit = all.filter_map(Number::exponent).min().unwrap_or(0);
    let mut factorial = vec![BigInt::from(1)];
    for k in 1..=n {
        factorial.push(&factorial[k - 1] * k);
    }
    let of = |p: &Polynomial| -> Vec<BigInt> {
        let c: Vec<BigInt> = p.coefficients().iter().map(|c| c.in_units(unit)).collect();
        let term =
            |i: usize, k: usize| &c[k] * &factorial[i] / &factorial[i - k] * &factorial[n - k];
        (0..=n).map(|i| (0..c.len().min(i + 1)).map(|k| term(i, k)).sum()).collect()
    };
    group.iter().map(of).collect()
}

impl BernsteinCell {
    /// Its end, exact as its start is.
    pub(crate) fn to(&self) -> f64 {
        self.from + self.width
    }

    /// Both ends, exactly; `None`: too narrow a cell to tell them.
    pub(crate) fn ends(&self) -> Option<(Number, Number)> {
        if self.depth > DEEPEST_EXACT {
            None
        } else {
            Number::of(self.from).zip(Number::of(self.to()))
        }
    }

    /// The single `t` at its start.
    fn start(&self) -> Self {
        self.at(self.from, <[BigInt]>::first)
    }

    /// The single `t` at its end.
    fn end(&self) -> Self {
        self.at(self.to(), <[BigInt]>::last)
    }

    fn at(&self, from: f64, value: impl Fn(&[BigInt]) -> Option<&BigInt>) -> Self {
        let one = |forms: &Forms| -> Forms {
            forms.iter().map(|form| value(form).into_iter().cloned().collect()).collect()
        };
        Self { groups: self.groups.iter().map(one).collect(), from, width: 0.0, depth: self.depth }
    }

    /// Both halves, by de Casteljau's means: sums in place of means, so all grow by `2^n`; common powers of two go.
    fn halves(&self) -> (Self, Self) {
        let half = |groups: Vec<Forms>, from: f64| Self {
            groups,
            from,
            width: 0.5 * self.width,
            depth: self.depth + 1,
        };
        let (left, right) = self.groups.iter().map(halved).unzip();
        (half(left, self.from), half(right, self.from + 0.5 * self.width))
    }
}

fn halved(forms: &Forms) -> (Forms, Forms) {
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for form in forms {
        let n = form.len().saturating_sub(1);
        let mut work = form.clone();
        let (mut low, mut high) = (Vec::new(), Vec::new());
        for level in 0..=n {
            low.push(&work[0] << (n - level));
            high.push(&work[n - level] << (n - level));
            for i in 0..n - level {
                let next = &work[i] + &work[i + 1];
                work[i] = next;
            }
        }
        high.reverse();
        left.push(low);
        right.push(high);
    }
    (reduced(left), reduced(right))
}

/// The same values in the largest unit that is a power of two.
fn reduced(mut forms: Forms) -> Forms {
    let even = forms.iter().flatten().filter_map(BigInt::trailing_zeros).min().unwrap_or(0);
    if even > 0 {
        forms.iter_mut().flatten().for_each(|c| *c >>= even);
    }
    forms
}
