//! Range of an arm's inertia, which a constant nominal inertia has to represent.

mod ascent;
mod error;
mod memory;
mod postures;
mod rates;

use nalgebra::DMatrix;
use phihat_certificate::extremes::{Extremes as _, larger, smaller};
use phihat_certificate::{ArmBasis, ArmInertia, Searched};
use phihat_model::Workspace;
use phihat_study::{InertiaSource, Study};

pub use error::ArmError;
pub use rates::InertiaRates;

use crate::trace::InertiaEstimate;
use ascent::{RangeEnd, STARTS, extreme};
use memory::Memory;
use postures::{PostureSet, scaled};

/// An eigenvalue is not told apart from 0 below this share of the largest.
const TOLD: f64 = 1e-13;

/// Inertia of an arm, independent of the nominal one: obtained once, measured often.
///
/// # Example
///
/// ```
/// use phihat_design::Arm;
///
/// # let text = r#"
/// #     duration_s = 2.0
/// #     [robot]
/// #     name = "planar3r"
/// #     [spec]
/// #     settle_s = 1.0
/// #     error_bound_rad = 0.02
/// #     [design]
/// #     orders = [1]
/// #     payload_max_kg = 0.2
/// #     [reference]
/// #     kind = "sines"
/// #     center = "ready"
/// #     fade_in_s = 1.0
/// #     [[reference.sine]]
/// #     amplitude_rad = 0.2
/// #     frequency_hz = 0.3
/// # "#;
/// # let study = phihat_study::Study::from_text(text, "demo.toml", "".as_ref())?;
/// let arm = Arm::of(&study)?; // over its postures and payloads
/// let range = arm.against(arm.nominal())?;
/// // The eigenvalues of M̄^{-1/2} M(q) M̄^{-1/2}, and the postures at which they are reached.
/// assert!(0.0 < range.low && range.low < range.high);
/// assert!(range.searched.is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Arm {
    basis: ArmBasis,
    source: String,
    knowledge: Knowledge,
    memory: Memory<Arm>,
}

#[derive(Debug, Clone)]
enum Knowledge {
    /// A robot's postures.
    Postures(Box<PostureSet>),
    /// `M(q)` at some of them.
    Matrices(Vec<DMatrix<f64>>),
    /// Low and high \[kg·m²\] per joint.
    Intervals(Vec<f64>, Vec<f64>),
}

impl Arm {
    /// A study's arm, from its robot's postures or the intervals it types.
    ///
    /// The postures of its reference belong to it too: [`Self::along`] adds them.
    ///
    /// # Errors
    ///
    /// [`ArmError`]; an estimate from a trace is made by [`Self::estimated`].
    pub fn of(study: &Study) -> Result<Self, ArmError> {
        match &study.design.inertia {
            InertiaSource::Robot => Self::sampled(study),
            InertiaSource::Typed { low, high } => Ok(Self {
                basis: ArmBasis::Typed,
                source: "an interval per joint typed in the study; coupling is not in it".into(),
                knowledge: Knowledge::Intervals(low.clone(), high.clone()),
                memory: Memory::default(),
            }),
            InertiaSource::Trace(_) => Err(ArmError::NoEstimate),
        }
    }

    /// An arm known by what a trace shows of it.
    pub fn estimated(estimates: &[InertiaEstimate]) -> Self {
        Self {
            basis: ArmBasis::Trace,
            source: "ESTIMATE from a recorded trace, not a proof: intervals that explain every sample of it; coupling \
                     is not in it"
                .into(),
            knowledge: Knowledge::Intervals(
                estimates.iter().map(|e| e.low_kg_m2).collect(),
                estimates.iter().map(|e| e.high_kg_m2).collect(),
            ),
            memory: Memory::default(),
        }
    }

    /// A study's arm in the given postures \[rad\] alone, by its description without payload, rotors
    /// included: for a motion that stays there.
    pub fn near(study: &Study, postures: &[Vec<f64>]) -> Self {
        let model = study.robot.plant_model();
        let (n, mut room) = (model.joint_count(), Workspace::new(&model));
        let matrix = |q: &Vec<f64>| {
            let mut mass = vec![0.0; n * n];
            model.mass_matrix(&mut room, q, &mut mass);
            DMatrix::from_row_slice(n, n, &mass)
        };
        Self {
            basis: ArmBasis::Postures,
            source: format!("{} postures of {}, rotors included", postures.len(), study.robot.name),
            knowledge: Knowledge::Matrices(postures.iter().map(matrix).collect()),
            memory: Memory::default(),
        }
    }

    fn sampled(study: &Study) -> Result<Self, ArmError> {
        let postures = PostureSet::of(study)?;
        let (set, name) = (&study.design.payload, &study.robot.name);
        Ok(Self {
            basis: ArmBasis::Postures,
            source: format!(
                "{} postures inside the joint limits of {name} and those of the reference, rotors included, \
                 payload {} to {} kg on {}; the ends sought from {STARTS} of them",
                postures.count(),
                set.mass.0,
                set.mass.1,
                set.frame
            ),
            knowledge: Knowledge::Postures(Box::new(postures)),
            memory: Memory::default(),
        })
    }

    /// This arm, known along a reference too, by positions and velocities at some of its points; no change where it
    /// is known by intervals.
    ///
    /// # Errors
    ///
    /// [`ArmError::NotFinite`].
    pub fn along(mut self, reference: &[(Vec<f64>, Vec<f64>)]) -> Result<Self, ArmError> {
        if let Knowledge::Postures(postures) = &mut self.knowledge {
            postures.along(reference)?;
            self.memory = Memory::default();
        }
        Ok(self)
    }

    /// The geometric mean of each joint's own range \[kg·m²\]: a good nominal inertia.
    pub fn nominal(&self) -> Vec<f64> {
        self.diagonal().into_iter().map(|(low, high)| (low * high).sqrt()).collect()
    }

    /// Least and largest inertia of each joint \[kg·m²\] while all others are held.
    pub(crate) fn diagonal(&self) -> Vec<(f64, f64)> {
        match &self.knowledge {
            Knowledge::Intervals(low, high) => {
                low.iter().copied().zip(high.iter().copied()).collect()
            }
            Knowledge::Matrices(matrices) => diagonals(matrices.iter()),
            Knowledge::Postures(p) => diagonals(p.light.iter().chain(&p.heavy).map(|t| &t.matrix)),
        }
    }

    /// The same arm known by fewer postures only: those with the smallest and the largest eigenvalues against
    /// some nominal inertias, and nothing sought between them.
    pub(crate) fn extremes(&self, nominal: &[f64], count: usize) -> Self {
        let Knowledge::Postures(postures) = &self.knowledge else { return self.clone() };
        if let Some(few) = self.memory.few(nominal, count) {
            return few;
        }
        let best = |end: RangeEnd| {
            let tried = if end == RangeEnd::Low { &postures.light } else { &postures.heavy };
            let score = |m: &DMatrix<f64>| {
                let all = scaled(m, nominal).symmetric_eigenvalues();
                let (low, high) = all.iter().copied().ends();
                if end == RangeEnd::Low { low } else { -high }
            };
            let mut all: Vec<_> = tried.iter().map(|t| (score(&t.matrix), &t.matrix)).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            all.into_iter().take(count).map(|(_, matrix)| matrix.clone())
        };
        let few = best(RangeEnd::Low).chain(best(RangeEnd::High)).collect();
        let (knowledge, memory) = (Knowledge::Matrices(few), Memory::default());
        let few = Self { knowledge, memory, ..self.clone() };
        self.memory.keep_few(nominal, count, &few);
        few
    }

    /// The inertia \[kg·m²\] that each joint shows along the reference: least where all others are free,
    /// `1/(M⁻¹)_ii`, most where they are fixed, `M_ii`. `None`: no reference is known.
    pub(crate) fn shown(&self) -> Option<Vec<(f64, f64)>> {
        let Knowledge::Postures(postures) = &self.knowledge else { return None };
        let passing = postures.of_reference() as usize;
        let light = postures.light.iter().rev().take(passing);
        let heavy = postures.heavy.iter().rev().take(passing * postures.heaviest);
        let mut shown = vec![(f64::INFINITY, 0.0_f64); postures.travel.len()];
        for tried in light.chain(heavy) {
            let inverse = tried.matrix.clone().cholesky()?.inverse();
            for (i, (low, high)) in shown.iter_mut().enumerate() {
                *low = smaller(*low, inverse[(i, i)].recip());
                *high = larger(*high, tried.matrix[(i, i)]);
            }
        }
        (passing > 0).then_some(shown)
    }

    /// The range of inertia, measured in given nominal inertias \[kg·m²\].
    ///
    /// # Errors
    ///
    /// [`ArmError::Range`].
    pub fn against(&self, nominal: Vec<f64>) -> Result<ArmInertia, ArmError> {
        if let Some(range) = self.memory.range(&nominal) {
            return Ok(range);
        }
        let found = self.measured(nominal)?;
        self.memory.keep(&found);
        Ok(found)
    }

    fn measured(&self, nominal: Vec<f64>) -> Result<ArmInertia, ArmError> {
        let mut searched = None;
        let (low, high) = match &self.knowledge {
            Knowledge::Intervals(low, high) => (
                low.iter().zip(&nominal).map(|(l, m)| l / m).least(),
                high.iter().zip(&nominal).map(|(h, m)| h / m).largest(),
            ),
            Knowledge::Matrices(matrices) => {
                let spectrum = |m| scaled(m, &nominal).symmetric_eigenvalues();
                matrices.iter().map(spectrum).flat_map(|all| all.as_slice().to_vec()).ends()
            }
            Knowledge::Postures(postures) => {
                searched = witnesses(postures, &nominal);
                searched.as_ref().map_or((f64::NAN, f64::NAN), |searched: &Searched| {
                    (searched.low.eigenvalue, searched.high.eigenvalue)
                })
            }
        };
        if !(low > 0.0 && low <= high && high < f64::INFINITY && low > TOLD * high) {
            return Err(ArmError::Range { low, high, nominal });
        }
        let (basis, source) = (self.basis, self.source.clone());
        Ok(ArmInertia { basis, source, nominal_kg_m2: nominal, low, high, searched })
    }
}

impl Arm {
    /// Rates of change of the inertia, measured in given nominal inertias \[kg·m²\].
    pub fn rates(&self, nominal: &[f64]) -> InertiaRates {
        match &self.knowledge {
            Knowledge::Postures(postures) => rates::rates(postures, nominal),
            _ => InertiaRates::default(),
        }
    }
}

/// Witnesses of the range: the postures at which both ends are reached.
fn witnesses(postures: &PostureSet, nominal: &[f64]) -> Option<Searched> {
    Some(Searched {
        postures: postures.count(),
        of_reference: postures.of_reference(),
        starts: STARTS,
        frame: postures.frame.clone(),
        low: extreme(postures, nominal, RangeEnd::Low)?,
        high: extreme(postures, nominal, RangeEnd::High)?,
        proved: None,
    })
}

/// The range of each entry of the diagonal.
fn diagonals<'a>(matrices: impl Iterator<Item = &'a DMatrix<f64>>) -> Vec<(f64, f64)> {
    let mut ends: Vec<(f64, f64)> = Vec::new();
    for matrix in matrices {
        ends.resize(matrix.nrows(), (f64::INFINITY, 0.0));
        for (i, (low, high)) in ends.iter_mut().enumerate() {
            *low = smaller(*low, matrix[(i, i)]);
            *high = larger(*high, matrix[(i, i)]);
        }
    }
    ends
}
