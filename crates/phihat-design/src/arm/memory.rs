//! Cache of an arm's ranges of inertia: searches for gains request the same ranges again and again.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use phihat_certificate::ArmInertia;

/// Ranges that are kept at most.
const MOST: usize = 1000;

/// Shared by the clones of an arm. What it hands out is what would be found again, bit for bit: the keys are the bits.
#[derive(Debug, Clone)]
pub(super) struct Memory<Arm>(Arc<Mutex<RememberedArm<Arm>>>);

#[derive(Debug)]
struct RememberedArm<Arm> {
    ranges: BTreeMap<Vec<u64>, ArmInertia>,
    few: BTreeMap<(Vec<u64>, usize), Arm>,
}

impl<Arm> Default for Memory<Arm> {
    fn default() -> Self {
        Self(Arc::new(Mutex::new(RememberedArm { ranges: BTreeMap::new(), few: BTreeMap::new() })))
    }
}

fn bits(nominal: &[f64]) -> Vec<u64> {
    nominal.iter().map(|m| m.to_bits()).collect()
}

impl<Arm: Clone> Memory<Arm> {
    fn kept(&self) -> MutexGuard<'_, RememberedArm<Arm>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The range against these nominal inertias, if it was measured.
    pub(super) fn range(&self, nominal: &[f64]) -> Option<ArmInertia> {
        self.kept().ranges.get(&bits(nominal)).cloned()
    }

    pub(super) fn keep(&self, range: &ArmInertia) {
        let mut kept = self.kept();
        if kept.ranges.len() >= MOST {
            kept.ranges.clear();
        }
        kept.ranges.insert(bits(&range.nominal_kg_m2), range.clone());
    }

    /// The arm of so many extreme postures against these nominal inertias, if it was made.
    pub(super) fn few(&self, nominal: &[f64], count: usize) -> Option<Arm> {
        self.kept().few.get(&(bits(nominal), count)).cloned()
    }

    pub(super) fn keep_few(&self, nominal: &[f64], count: usize, few: &Arm) {
        let mut kept = self.kept();
        if kept.few.len() >= MOST {
            kept.few.clear();
        }
        kept.few.insert((bits(nominal), count), few.clone());
    }
}
