//! Extent of a comparison.

/// Extent of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparisonExtent {
    /// Ids of rivals; empty: all.
    pub only: Vec<String>,
    /// Names of worlds; empty: all.
    pub worlds: Vec<String>,
    /// Motions that are scored: the study's own, and drawn ones.
    pub seeds: u64,
    /// Evaluations of every tuning.
    pub tuning_runs: usize,
    /// Largest number of times that ranges are widened where tuned values lie at their ends, and the tuning
    /// is repeated.
    pub widenings: usize,
    /// Motions of an evaluation, each in every world that is trained in.
    pub training_motions: u64,
    /// Their length \[s\].
    pub training_s: f64,
    /// Time from which they are scored \[s\].
    pub training_settle_s: f64,
    /// Draws of gains.
    pub draws: usize,
    /// Most seconds after `settle_s` that are scored.
    pub scored_max_s: f64,
}

impl ComparisonExtent {
    /// For a first look: some minutes.
    pub fn quick() -> Self {
        Self {
            only: Vec::new(),
            worlds: Vec::new(),
            seeds: 1,
            tuning_runs: 60,
            widenings: 1,
            training_motions: 1,
            training_s: 3.0,
            training_settle_s: 1.5,
            draws: 24,
            scored_max_s: 3.0,
        }
    }

    /// For the record: most of an hour.
    pub fn full() -> Self {
        Self {
            seeds: 3,
            tuning_runs: 300,
            widenings: 3,
            training_motions: 2,
            training_s: 4.0,
            draws: 100,
            scored_max_s: f64::INFINITY,
            ..Self::quick()
        }
    }
}
