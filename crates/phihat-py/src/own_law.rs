//! A law written in Python, among the rivals of a comparison.

use std::sync::{Arc, Mutex, PoisonError};

use phihat_rivals::{
    All, Card, Entry, Grade, Needs, RivalRefusal, Running, Scalar, Supply, Tuning,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::sample::Sample;

/// Name, unit, meaning; default value, least, largest.
type DeclaredScalar = (String, String, String, [f64; 3]);

/// A law as its author declares it: see `phihat.compare`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Declared {
    id: String,
    title: String,
    source: String,
    law: String,
    scalars: Vec<DeclaredScalar>,
    /// True if the law gets the desired acceleration of the interval in which its torque acts.
    preview: bool,
    edition: String,
    make: Py<PyAny>,
}

/// First exception that the law raised.
pub(crate) type Raised = Arc<Mutex<Option<PyErr>>>;

/// Stores the first exception.
pub(crate) fn kept(raised: &Raised, why: PyErr) {
    raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(why);
}

/// An entry lives as long as the process: what stands in the list of rivals does too, and a comparison hands it on.
pub(crate) fn entry(declared: Declared, raised: &Raised) -> &'static Entry {
    let leaked = |text: String| -> &'static str { text.leak() };
    let card = Card {
        id: leaked(declared.id),
        title: leaked(declared.title),
        reference: "",
        source: leaked(declared.source),
        grade: Grade::A,
        caveat: "a law of the user's, written in Python: what it needs is what it says",
        law: leaked(declared.law),
        printed: None,
    };
    let scalar = |(name, unit, meaning, [default, low, high]): DeclaredScalar| Scalar {
        name: leaked(name),
        unit: leaked(unit),
        meaning: leaked(meaning),
        default,
        low,
        high,
    };
    let scalars: &'static [Scalar] =
        declared.scalars.into_iter().map(scalar).collect::<Vec<_>>().leak();
    let needs = Needs {
        velocity: true,
        torque: true,
        derivatives: 2,
        preview: declared.preview,
        delay: true,
        inertia: true,
        limits: true,
        ..Needs::NONE
    };
    let (make, raised, preview) = (declared.make, Arc::clone(raised), declared.preview);
    let build = move |tuning: &Tuning, supply: &Supply| -> Result<Box<dyn Running>, RivalRefusal> {
        if raised.lock().unwrap_or_else(PoisonError::into_inner).is_some() {
            return Err(RivalRefusal::NotApplicable("it raised an exception before".to_owned()));
        }
        let made = Python::attach(|py| law(py, &make, scalars, tuning, supply));
        match made {
            Ok(law) => {
                let (raised, period) = (Arc::clone(&raised), tuning.period());
                Ok(Box::new(OwnLaw { law, raised, preview, period, samples: 0 }))
            }
            Err(why) => {
                let refusal = RivalRefusal::NotApplicable(why.to_string());
                kept(&raised, why);
                Err(refusal)
            }
        }
    };
    let entry = Entry::own(
        Box::leak(Box::new(card)),
        needs,
        scalars,
        leaked(declared.edition),
        Box::leak(Box::new(build)),
    );
    Box::leak(Box::new(entry))
}

/// A law for one arm and one choice of its scalars: `make(scalars, arm)`.
fn law(
    py: Python<'_>,
    make: &Py<PyAny>,
    scalars: &[Scalar],
    tuning: &Tuning,
    supply: &Supply,
) -> PyResult<Py<PyAny>> {
    let values = PyDict::new(py);
    for (scalar, value) in scalars.iter().zip(tuning.all()) {
        values.set_item(scalar.name, value)?;
    }
    let arm = PyDict::new(py);
    arm.set_item("inertia", supply.inertia.clone())?;
    arm.set_item("torque_max", supply.torque_max.clone())?;
    arm.set_item("torque_rate_max", supply.torque_rate_max.clone())?;
    arm.set_item("delay_samples", supply.delay_samples)?;
    arm.set_item("period", tuning.period())?;
    make.call1(py, (values, arm))
}

/// A law at work.
#[derive(Debug)]
struct OwnLaw {
    law: Py<PyAny>,
    raised: Raised,
    preview: bool,
    period: f64,
    samples: u64,
}

impl Running for OwnLaw {
    fn update(&mut self, all: &All<'_>, tau: &mut [f64]) {
        let t = self.samples as f64 * self.period;
        self.samples += 1;
        let ddq = if self.preview { all.ddq_d_acting } else { all.ddq_d };
        let told = Python::attach(|py| -> PyResult<()> {
            let columns: [&mut dyn Iterator<Item = f64>; 6] = [
                &mut all.q.iter().copied(),
                &mut all.dq.iter().copied(),
                &mut all.tau.iter().copied(),
                &mut all.q_d.iter().copied(),
                &mut all.dq_d.iter().copied(),
                &mut ddq.iter().copied(),
            ];
            let sample = Sample::new(py, t, columns)?;
            let answer: Vec<f64> = self.law.call1(py, (sample,))?.extract(py)?;
            if answer.len() != tau.len() {
                let why = format!("{} torques for {} joints", answer.len(), tau.len());
                return Err(pyo3::exceptions::PyValueError::new_err(why));
            }
            tau.copy_from_slice(&answer);
            Ok(())
        });
        if let Err(why) = told {
            kept(&self.raised, why);
            // The run counts as one whose torque was no number; the comparison ends with what was raised.
            tau.fill(f64::NAN);
        }
    }

    fn states(&self) -> usize {
        0
    }
}
