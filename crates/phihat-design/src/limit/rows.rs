//! Rows of a linear programme about signals in time.

use microlp::{ComparisonOp, Problem, Solution, SolveOptions, Variable};

/// Tolerance of a row \[1\]: the smallest that the solver takes. A row's error is summed up twice over all
/// samples.
const MISS: f64 = 1e-10;

/// A signal, as variables and their factors.
#[derive(Debug, Clone)]
pub(super) struct LimitSignal(Vec<(Vec<Variable>, f64)>);

impl LimitSignal {
    /// Of any sign, between two ends; each sample with its cost.
    pub(super) fn between(
        problem: &mut Problem,
        ends: (f64, f64),
        costs: impl Iterator<Item = f64>,
    ) -> Self {
        Self(vec![(costs.map(|cost| problem.add_var(cost, ends)).collect(), 1.0)])
    }

    /// Of any sign, at no cost.
    pub(super) fn free(problem: &mut Problem, length: usize) -> Self {
        let costs = core::iter::repeat_n(0.0, length);
        Self::between(problem, (f64::NEG_INFINITY, f64::INFINITY), costs)
    }

    /// The same signal with more samples behind it.
    pub(super) fn then(mut self, problem: &mut Problem, ends: (f64, f64), costs: &[f64]) -> Self {
        if let Some((part, _)) = self.0.first_mut() {
            part.extend(costs.iter().map(|cost| problem.add_var(*cost, ends)));
        }
        self
    }

    /// `x = x⁺ − x⁻`, each at least 0, at a cost for `x⁺ + x⁻`: the least is `|x|`.
    pub(super) fn sized(problem: &mut Problem, length: usize, cost: f64) -> Self {
        let mut part =
            || (0..length).map(|_| problem.add_var(cost, (0.0, f64::INFINITY))).collect();
        let (plus, minus) = (part(), part());
        Self(vec![(plus, 1.0), (minus, -1.0)])
    }

    /// All variables, each once, with factor 1: the sum of sizes.
    pub(super) fn size(&self) -> Vec<(Variable, f64)> {
        self.0.iter().flat_map(|(part, _)| part.iter().map(|x| (*x, 1.0))).collect()
    }

    pub(super) fn values(&self, solution: &Solution) -> Vec<f64> {
        let length = self.0.first().map_or(0, |(part, _)| part.len());
        let value = |k: usize| {
            self.0.iter().map(|(part, factor)| factor * solution.var_value(part[k])).sum()
        };
        (0..length).map(value).collect()
    }
}

/// One row; what lies outside of a signal is 0 and left out.
#[derive(Debug, Default)]
pub(super) struct LimitRow(Vec<(Variable, f64)>);

impl LimitRow {
    /// Adds a signal, `back` samples before `k`, times a factor.
    pub(super) fn back(self, signal: &LimitSignal, k: usize, back: usize, factor: f64) -> Self {
        match k.checked_sub(back) {
            Some(k) => self.at(signal, k, factor),
            None => self,
        }
    }

    /// Adds a signal at `k` times a factor.
    pub(super) fn at(mut self, signal: &LimitSignal, k: usize, factor: f64) -> Self {
        let there = signal.0.iter().filter_map(|(part, own)| Some((*part.get(k)?, own * factor)));
        self.0.extend(there);
        self
    }

    pub(super) fn with(mut self, variable: Variable, factor: f64) -> Self {
        self.0.push((variable, factor));
        self
    }

    pub(super) fn is(self, problem: &mut Problem, how: ComparisonOp, value: f64) {
        if !self.0.is_empty() {
            problem.add_constraint(&self.0, how, value);
        }
    }
}

/// The solver's answer; `None` where it has none.
pub(super) fn solved(problem: &Problem) -> Option<Solution> {
    let mut options = SolveOptions::default();
    options.tolerances.feasibility = MISS;
    problem.solve_with(options).ok()?.into_solution().ok()
}
