//! A joint's law as matrices, by playing the core: a unit in each entry of its state, and in each input.

use phihat::{JointGains, JointState, Measurement, Reference, STATE_ENTRIES, StateEntry};

use crate::{JointRecord, LoopModel};

/// Inputs of a sample: `q`, `q̇`, torque that acted, acceleration that is fed forward.
pub(crate) const INPUTS: usize = 4;

/// Inputs that are measured, the first ones.
const MEASURED: usize = 3;

/// One sample of a law: `x⁺ = A x + B u`, `τ = C x + D u`.
#[derive(Debug, Clone)]
pub(crate) struct LawMatrices {
    /// Meaning of each entry of `x`: estimates, states of a filter, a velocity, torques, in this order. They are the
    /// entries of the core's state that a measurement reaches and that reach the torque; of several that are always
    /// equal one.
    pub(crate) entries: Vec<StateEntry>,
    /// Place of each entry in the core's state.
    pub(crate) places: Vec<usize>,
    /// `A` and `B`.
    rows: Vec<Row>,
    /// `C` and `D`.
    torque: Row,
    /// `x` of a law that has commanded 1 N·m for long, at rest on its reference.
    pub(crate) bearing: Vec<f64>,
    /// `x` of a law that goes on from no torque, with a reading 1 rad off its reference.
    pub(crate) begun: Vec<f64>,
}

/// A row of the matrices: its entries that are not zero, by their column, and what the inputs weigh.
#[derive(Debug, Clone, Default)]
struct Row {
    state: Vec<(usize, f64)>,
    input: [f64; INPUTS],
}

impl Row {
    #[inline]
    fn times(&self, x: &[f64], u: &[f64; INPUTS]) -> f64 {
        let own: f64 = self.state.iter().map(|(at, factor)| factor * x[*at]).sum();
        self.input.iter().zip(u).fold(own, |sum, (factor, u)| sum + factor * u)
    }
}

/// Next state and torque of a sample in which all is zero but one number.
struct Answer {
    next: [f64; STATE_ENTRIES],
    tau: f64,
}

impl LawMatrices {
    /// The matrices of gains; `None`: the core refuses a unit.
    pub(crate) fn of(gains: &JointGains<f64>) -> Option<Self> {
        let unit = |at: usize| core::array::from_fn(|i| f64::from(u8::from(i == at)));
        let (still, nothing) = (Measurement::default(), Reference::default());
        let states: Vec<Answer> = (0..STATE_ENTRIES)
            .map(|at| answer(gains, &unit(at), &still, &nothing))
            .collect::<Option<_>>()?;
        let inputs: Vec<Answer> = [
            (Measurement { q: 1.0, ..still }, nothing),
            (Measurement { dq: 1.0, ..still }, nothing),
            (Measurement { tau_applied: 1.0, ..still }, nothing),
            (still, Reference { ddq: 1.0, ..nothing }),
        ]
        .iter()
        .map(|(m, reference)| answer(gains, &[0.0; STATE_ENTRIES], m, reference))
        .collect::<Option<_>>()?;
        let meaning = JointState::<f64>::meaning(gains.form());
        let mut places = reached(&states, &inputs[..MEASURED]);
        places.sort_by_key(|at| (rank(meaning[*at]), *at));
        let twins = twins(&places, &states, &inputs);
        places.retain(|at| twins[*at] == *at);
        let row = |of: &dyn Fn(&Answer) -> f64| Row {
            state: places
                .iter()
                .map(|column| {
                    let all = (0..STATE_ENTRIES).filter(|at| twins[*at] == *column);
                    all.map(|at| of(&states[at])).sum::<f64>()
                })
                .enumerate()
                .filter(|(_, factor)| factor.abs() > 0.0)
                .collect(),
            input: core::array::from_fn(|i| of(&inputs[i])),
        };
        let resumed = |measurement: &Measurement<f64>, tau: f64| {
            let mut state = JointState::new();
            gains.resume(&mut state, measurement, &nothing, tau).then(|| state.entries())
        };
        let held = resumed(&Measurement { tau_applied: 1.0, ..still }, 1.0)?;
        let begun = resumed(&Measurement { q: 1.0, ..still }, 0.0)?;
        Some(Self {
            entries: places.iter().map(|at| meaning[*at]).collect(),
            rows: places.iter().map(|at| row(&|answer| answer.next[*at])).collect(),
            torque: row(&|answer| answer.tau),
            bearing: places.iter().map(|at| held[*at]).collect(),
            begun: places.iter().map(|at| begun[*at]).collect(),
            places: places.clone(),
        })
    }

    /// Those of a record's law per unit of `M̄`; of one that the core does not run, a torque that is no number, so that
    /// nothing holds of it.
    pub(crate) fn unit(record: &JointRecord, model: &LoopModel) -> Self {
        let unit = JointRecord { inertia_kg_m2: 1.0, ..record.clone() };
        let own = unit.core_gains_in(model).ok().and_then(|gains| Self::of(&gains));
        own.unwrap_or_else(|| Self {
            entries: Vec::new(),
            places: Vec::new(),
            rows: Vec::new(),
            torque: Row { state: Vec::new(), input: [f64::NAN; INPUTS] },
            bearing: Vec::new(),
            begun: Vec::new(),
        })
    }

    /// Number of entries.
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }

    /// One sample: the torque.
    #[inline]
    pub(crate) fn step(&self, x: &mut [f64], u: &[f64; INPUTS]) -> f64 {
        let mut before = [0.0; STATE_ENTRIES];
        let before = &mut before[..x.len().min(STATE_ENTRIES)];
        before.copy_from_slice(x);
        for (x, row) in x.iter_mut().zip(&self.rows) {
            *x = row.times(before, u);
        }
        self.torque.times(before, u)
    }

    /// Returns true if this input is in the torque, in some sample.
    fn uses(&self, input: usize) -> bool {
        self.rows.iter().chain([&self.torque]).any(|row| row.input[input].abs() > 0.0)
    }

    /// Returns true if the measured velocity is in its torque.
    pub(crate) fn uses_velocity(&self) -> bool {
        self.uses(1)
    }

    /// Returns true if the torque that acted is in its torque.
    pub(crate) fn uses_torque(&self) -> bool {
        self.uses(2)
    }

    /// Entry that is the velocity of the sample before.
    pub(crate) fn register(&self) -> Option<usize> {
        self.entries.iter().position(|entry| *entry == StateEntry::Velocity)
    }

    /// Factors of measured inputs in each entry and in the torque, and of the entries themselves, row by row.
    pub(crate) fn whole(&self) -> (Vec<Vec<f64>>, Vec<[f64; MEASURED]>) {
        let rows = || self.rows.iter().chain([&self.torque]);
        let dense = |row: &Row| {
            let mut all = vec![0.0; self.len()];
            row.state.iter().for_each(|(at, factor)| all[*at] = *factor);
            all
        };
        let input = |row: &Row| core::array::from_fn(|i| row.input[i]);
        (rows().map(dense).collect(), rows().map(input).collect())
    }
}

fn answer(
    gains: &JointGains<f64>,
    entries: &[f64; STATE_ENTRIES],
    measurement: &Measurement<f64>,
    reference: &Reference<f64>,
) -> Option<Answer> {
    let mut state = JointState::of_entries(entries);
    let command = gains.update(&mut state, measurement, reference);
    (!command.status.refused).then(|| Answer { next: state.entries(), tau: command.tau })
}

/// Order of the entries: by meaning, estimates from the least derivative or integral on.
fn rank(entry: StateEntry) -> (u8, u8) {
    match entry {
        StateEntry::Estimate { power } => (0, power.unsigned_abs()),
        StateEntry::Filter => (1, 0),
        StateEntry::Velocity => (2, 0),
        StateEntry::Torque => (3, 0),
        _ => (4, 0),
    }
}

/// Entries that a measurement reaches and that reach the torque, in some samples.
fn reached(states: &[Answer], inputs: &[Answer]) -> Vec<usize> {
    let there = |value: f64| value.abs() > 0.0;
    let leads = |from: usize, to: usize| there(states[from].next[to]);
    let all = 0..STATE_ENTRIES;
    let reached = all.clone().filter(|i| inputs.iter().any(|of| there(of.next[*i])));
    let reached = closed(reached.collect(), leads);
    let reaching = all.filter(|i| there(states[*i].tau));
    let reaching = closed(reaching.collect(), |from, to| leads(to, from));
    (0..STATE_ENTRIES).filter(|i| reached.contains(i) && reaching.contains(i)).collect()
}

/// A set of entries with all that these lead to.
fn closed(mut set: Vec<usize>, leads: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let mut at = 0;
    while let Some(from) = set.get(at).copied() {
        at += 1;
        let more = (0..STATE_ENTRIES).filter(|to| leads(from, *to));
        let new: Vec<usize> = more.filter(|to| !set.contains(to)).collect();
        set.extend(new);
    }
    set
}

/// The first of the places whose entry becomes what each entry becomes, whatever is measured; else its own place.
fn twins(places: &[usize], states: &[Answer], inputs: &[Answer]) -> [usize; STATE_ENTRIES] {
    let mut twins = core::array::from_fn(|at| at);
    let same = |a: usize, b: usize| {
        let alike = |answer: &Answer| (answer.next[a] - answer.next[b]).abs() <= 0.0;
        places.iter().all(|at| alike(&states[*at])) && inputs[..MEASURED].iter().all(alike)
    };
    for (k, at) in places.iter().enumerate() {
        if let Some(first) = places[..k].iter().find(|first| same(**first, *at)) {
            twins[*at] = *first;
        }
    }
    twins
}
