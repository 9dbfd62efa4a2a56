//! Gains while a person drags: numbers at once, then what they promise; what is overtaken is dropped.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Instant;

use phihat_design::tube::{Desired, tube};
use phihat_design::{Arm, Gains, Outcome, search};
use phihat_sim::{Demand, Motion};
use phihat_study::Study;
use phihat_synthesis::{arm_along, phi_along};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::begin::Begin;
use crate::error::StudioError;
use crate::numbers::{Factors, GainNumbers};

/// Requested change of gains.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Wish {
    /// The error that is allowed, over that of the study.
    pub(crate) error: f64,
    /// By which factors their bandwidths and the nominal inertia are changed.
    outer: f64,
    estimator: f64,
    inertia: f64,
}

impl Wish {
    fn factors(&self) -> Factors {
        Factors { outer: self.outer, estimator: self.estimator, inertia: self.inertia }
    }
}

/// Worker that computes the claims of gains. Of requests that wait, the last one counts.
#[derive(Debug)]
pub(crate) struct Proof {
    wish: Mutex<Option<(u64, Wish)>>,
    more: Condvar,
    newest: AtomicU64,
    proving: AtomicBool,
    told: Mutex<String>,
    begin: Mutex<Begin>,
    taken: Mutex<Option<Gains>>,
    /// The arm of the study, once it was looked at.
    arm: Mutex<Option<Arm>>,
}

/// Action on gains that are armed.
type TakeProof = Box<dyn Fn(Begin) -> bool + Send>;

#[expect(clippy::disallowed_methods, reason = "how long a search took is told")]
fn now() -> Instant {
    Instant::now()
}

impl Proof {
    pub(crate) fn new(begin: Begin) -> Arc<Self> {
        Arc::new(Self {
            wish: Mutex::new(None),
            more: Condvar::new(),
            newest: AtomicU64::new(0),
            proving: AtomicBool::new(false),
            told: Mutex::new("{}".to_owned()),
            begin: Mutex::new(begin),
            taken: Mutex::new(None),
            arm: Mutex::new(None),
        })
    }

    /// Result of the last request, as a document.
    pub(crate) fn told(&self) -> String {
        self.told.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The gains that run now, where they are not those that the run was begun with.
    pub(crate) fn taken(&self) -> Option<Gains> {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Another study from here on.
    pub(crate) fn turn_to(&self, begin: Begin) {
        *self.begin.lock().unwrap_or_else(PoisonError::into_inner) = begin;
        *self.taken.lock().unwrap_or_else(PoisonError::into_inner) = None;
        *self.arm.lock().unwrap_or_else(PoisonError::into_inner) = None;
        self.newest.fetch_add(1, Ordering::SeqCst);
    }

    /// Takes a wish in place of one that waits; its number.
    pub(crate) fn ask(&self, wish: Wish) -> Result<u64, StudioError> {
        if !(0.05..=20.0).contains(&wish.error) {
            return Err(StudioError::refused("an error is 0.05 to 20 times that of the study"));
        }
        wish.factors().check()?;
        let number = self.newest.fetch_add(1, Ordering::SeqCst) + 1;
        *self.wish.lock().unwrap_or_else(PoisonError::into_inner) = Some((number, wish));
        self.more.notify_one();
        Ok(number)
    }

    /// Begins the thread that answers wishes.
    pub(crate) fn work(self: &Arc<Self>, take: TakeProof) -> Result<(), StudioError> {
        let own = Arc::clone(self);
        let thread = std::thread::Builder::new().name("phihat-numbers".to_owned());
        let begun = thread.spawn(move || {
            own.look_ahead();
            loop {
                let (number, wish) = own.next();
                own.answer(number, wish, &take);
            }
        });
        begun.map(drop).map_err(|why| StudioError::refused(why.to_string()))
    }

    fn next(&self) -> (u64, Wish) {
        let mut waits = self.wish.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if let Some(asked) = waits.take() {
                return asked;
            }
            waits = self.more.wait(waits).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn answer(self: &Arc<Self>, number: u64, wish: Wish, take: &TakeProof) {
        let began = now();
        let begin = self.begin.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let mut document = json!({ "ask": number, "error": wish.error, "factors": wish.factors() });
        match self.arm_of(&begin.study).and_then(|arm| looked(&begin, &arm, wish)) {
            Err(why) => document["refused"] = why.to_string().into(),
            Ok((next, numbers)) => {
                document["numbers"] = json!(numbers);
                let newest = self.newest.load(Ordering::SeqCst) == number;
                if numbers.armed && newest {
                    document["now"] = take(next.clone()).into();
                    *self.taken.lock().unwrap_or_else(PoisonError::into_inner) =
                        Some(next.gains.clone());
                    document["tube"] = self.prove(number, next, document.clone()).into();
                }
            }
        }
        document["seconds"] = began.elapsed().as_secs_f64().into();
        self.tell(number, &document);
    }

    /// The arm of a study, whose postures take long to search: once per study.
    fn arm_of(&self, study: &Study) -> Result<Arm, StudioError> {
        let mut known = self.arm.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(arm) = &*known {
            return Ok(arm.clone());
        }
        let arm = arm_along(study).map_err(|why| StudioError::refused(why.to_string()))?;
        Ok(known.insert(arm).clone())
    }

    /// Looks at the arm before anybody asks.
    fn look_ahead(&self) {
        let begin = self.begin.lock().unwrap_or_else(PoisonError::into_inner).clone();
        // Whoever asks is told what is wrong with it.
        let _ = self.arm_of(&begin.study);
    }

    fn tell(&self, number: u64, document: &Value) {
        if self.newest.load(Ordering::SeqCst) == number {
            *self.told.lock().unwrap_or_else(PoisonError::into_inner) = document.to_string();
        }
    }

    /// Begins to prove the tube, where none is being proved; one that was overtaken cannot be stopped, only dropped.
    fn prove(self: &Arc<Self>, number: u64, begin: Begin, mut document: Value) -> &'static str {
        if self.proving.swap(true, Ordering::SeqCst) {
            return "waits: the one before is still being proved";
        }
        let own = Arc::clone(self);
        let thread = std::thread::Builder::new().name("phihat-tube".to_owned());
        let begun = thread.spawn(move || {
            let began = now();
            let found = proved(&begin);
            own.proving.store(false, Ordering::SeqCst);
            document["tube"] = match found {
                Ok(_) => "proved".into(),
                Err(ref why) => format!("none: {why}").into(),
            };
            if let Ok(errors) = found {
                document["tube_error"] = errors.into();
            }
            document["tube_seconds"] = began.elapsed().as_secs_f64().into();
            own.tell(number, &document);
        });
        if begun.is_ok() { "being proved" } else { "none: no thread for it" }
    }
}

/// The gains of a wish with their numbers.
fn looked(begin: &Begin, arm: &Arm, wish: Wish) -> Result<(Begin, GainNumbers), StudioError> {
    let study = &begin.study;
    let base = if (wish.error - 1.0).abs() < 1e-9 {
        begin.gains.clone()
    } else {
        found(study, arm, wish.error)?
    };
    let gains = wish.factors().of(study, &base)?;
    let numbers = GainNumbers::of(study, arm, &gains);
    Ok((Begin { study: study.clone(), gains }, numbers))
}

/// Gains for an error that is so many times the study's, by bounds of joint after joint.
fn found(study: &Study, arm: &Arm, times: f64) -> Result<Gains, StudioError> {
    let mut asked = study.clone();
    let Some(bounds) = &mut asked.spec.error_bound else {
        return Err(StudioError::refused("the study states no spec.error_bound_rad"));
    };
    for bound in bounds {
        *bound *= times;
    }
    let demand = Demand::along(&asked)?;
    let phi = |joint: usize, inertia: f64| phi_along(&demand, joint, inertia);
    match search(&asked, arm, &phi) {
        Ok(Outcome::Designed(gains)) => Ok(*gains),
        Ok(Outcome::Infeasible(_)) => {
            Err(StudioError::refused("no gains keep this error: `phihat design` says why"))
        }
        Err(why) => Err(StudioError::refused(why.to_string())),
    }
}

/// Largest error of each joint \[rad\] by the tube.
fn proved(begin: &Begin) -> Result<Vec<f64>, StudioError> {
    let study = &begin.study;
    let motion = Motion::of(study)?;
    let desired = Desired::of(study, |joint, t| motion.told(joint, t));
    let tube =
        tube(study, &begin.gains, &desired).map_err(|why| StudioError::refused(why.to_string()))?;
    Ok(tube.joints.iter().map(|joint| joint.error_bound_rad).collect())
}
