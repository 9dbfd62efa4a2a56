//! Stage: an arm under control, another law alongside where one was requested; or a run that was recorded.

use phihat_study::Study;
use serde_json::{Value, json};

use crate::begin::Begin;
use crate::beside::AlongsideLaw;
use crate::error::StudioError;
use crate::live::Live;
use crate::offer::Offer;
use crate::recorded::Recorded;
use crate::sampled::Sampled;

/// Samples that measurements may be late at most, as in a study.
const LATE_MAX: u32 = 8;

/// A live run or a record.
#[derive(Debug)]
pub(crate) enum Stage {
    Live(Box<Pair>),
    Record(Box<Recorded>),
}

/// An arm under phihat's law, and perhaps the same arm under another, in two worlds that are alike.
#[derive(Debug)]
pub(crate) struct Pair {
    begin: Begin,
    live: Box<Live>,
    rows: Vec<Sampled>,
    other: Option<OtherArm>,
    /// True once the delay of the measurements was set by hand.
    is_late: bool,
}

#[derive(Debug)]
struct OtherArm {
    law: AlongsideLaw,
    live: Box<Live>,
    rows: Vec<Sampled>,
    over: Option<String>,
}

/// A sample: of the arm, and of the arm under the other law.
pub(crate) type StageSamples<'a> = (&'a [Sampled], Option<&'a [Sampled]>);

impl Stage {
    pub(crate) fn live(begin: Begin) -> Result<Self, StudioError> {
        Ok(Self::Live(Box::new(Pair::new(begin)?)))
    }

    /// Mode of the supervisor; `None`: there is none, or it is a record.
    pub(crate) fn mode(&self) -> Option<&'static str> {
        match self {
            Self::Live(pair) => pair.live.mode(),
            Self::Record(_) => None,
        }
    }

    pub(crate) fn joints(&self) -> usize {
        match self {
            Self::Live(pair) => pair.live.joints(),
            Self::Record(record) => record.joints(),
        }
    }

    /// Time of the next sample \[s\].
    pub(crate) fn time(&self) -> f64 {
        match self {
            Self::Live(pair) => pair.live.time(),
            Self::Record(record) => record.time(),
        }
    }

    /// The arm under control; a record takes no order.
    pub(crate) fn pair(&mut self) -> Result<&mut Pair, StudioError> {
        match self {
            Self::Live(pair) => Ok(pair),
            Self::Record(_) => Err(StudioError::refused("what was recorded can only be looked at")),
        }
    }

    /// One sample; `None`: it is over.
    pub(crate) fn step(&mut self) -> Option<StageSamples<'_>> {
        match self {
            Self::Live(pair) => pair.step(),
            Self::Record(record) => Some((record.step()?, None)),
        }
    }

    /// Faults that came and still act: word, joint, size.
    pub(crate) fn acting(&self) -> Vec<(&'static str, Option<usize>, f64)> {
        let Self::Live(pair) = self else { return Vec::new() };
        pair.live.acting().map(|(kind, joint, size)| (kind.word(), joint, size)).collect()
    }

    /// Why the other law does not go on, where it does not.
    pub(crate) fn other_is_over(&self) -> Option<&str> {
        let Self::Live(pair) = self else { return None };
        pair.other.as_ref()?.over.as_deref()
    }

    /// From the start again; what came is gone.
    pub(crate) fn again(&mut self) -> Result<(), StudioError> {
        match self {
            Self::Live(pair) => pair.restart(pair.begin.clone(), false),
            Self::Record(record) => {
                record.seek(0.0);
                Ok(())
            }
        }
    }

    /// To a time of a record \[s\].
    pub(crate) fn seek(&mut self, t: f64) -> Result<(), StudioError> {
        match self {
            Self::Live(_) => Err(StudioError::refused("a live run goes forward only")),
            Self::Record(record) => {
                record.seek(t);
                Ok(())
            }
        }
    }

    /// Begins anew after the last sample: a motion that came to its end, with the faults that act, or a record.
    /// The error says why it does not.
    pub(crate) fn round(&mut self) -> Result<(), StudioError> {
        match self {
            Self::Live(pair) if pair.live.is_whole() => pair.restart(pair.begin.clone(), true),
            Self::Live(pair) => Err(StudioError::refused(pair.live.ending())),
            Self::Record(record) => {
                record.seek(0.0);
                Ok(())
            }
        }
    }
}

impl OtherArm {
    fn new(law: AlongsideLaw, begin: &Begin) -> Result<Self, StudioError> {
        let live = Box::new(Live::beside(begin, &law)?);
        let rows = vec![Sampled::default(); live.joints()];
        Ok(Self { law, live, rows, over: None })
    }

    fn step(&mut self) -> Option<&[Sampled]> {
        let Some((_, rows)) = self.live.step() else {
            self.over = Some(self.live.ending());
            return None;
        };
        self.rows.iter_mut().zip(rows).for_each(|(shown, row)| *shown = Sampled::of(row));
        Some(&self.rows)
    }
}

impl Pair {
    fn new(begin: Begin) -> Result<Self, StudioError> {
        let live = Box::new(Live::new(&begin)?);
        let rows = vec![Sampled::default(); live.joints()];
        Ok(Self { begin, live, rows, other: None, is_late: false })
    }

    fn step(&mut self) -> Option<StageSamples<'_>> {
        let (_, rows) = self.live.step()?;
        self.rows.iter_mut().zip(rows).for_each(|(shown, row)| *shown = Sampled::of(row));
        let other = self.other.as_mut().filter(|other| other.over.is_none());
        let other = other.and_then(OtherArm::step);
        Some((&self.rows, other))
    }

    /// Both from the start, with what acts where it is to stay. Nothing has changed if one cannot begin.
    fn restart(&mut self, begin: Begin, stays: bool) -> Result<(), StudioError> {
        let law = self.other.as_ref().map(|other| other.law.clone());
        self.stage(begin, law, stays)
    }

    fn stage(
        &mut self,
        begin: Begin,
        law: Option<AlongsideLaw>,
        stays: bool,
    ) -> Result<(), StudioError> {
        let mut live = Box::new(Live::new(&begin)?);
        let mut other = law.map(|law| OtherArm::new(law, &begin)).transpose()?;
        for (kind, joint, size) in self.live.acting().filter(|_| stays) {
            live.meet_named(kind.word(), joint, Some(size))?;
            if let Some(other) = &mut other {
                other.live.meet_named(kind.word(), joint, Some(size))?;
            }
        }
        (self.begin, self.live, self.other) = (begin, live, other);
        Ok(())
    }

    /// An offer acts from the next sample on, on both.
    pub(crate) fn meet(
        &mut self,
        offer: &Offer,
        joint: Option<usize>,
        size: Option<f64>,
    ) -> Result<Value, StudioError> {
        self.live.meet(offer, joint, size)?;
        if let Some(other) = self.other.as_mut().filter(|other| other.over.is_none()) {
            other.live.meet(offer, joint, size)?;
        }
        Ok(json!({ "t": self.live.time() }))
    }

    /// A safe stop of the supervisor.
    pub(crate) fn stop(&mut self) -> Result<Value, StudioError> {
        self.live.stop()?;
        Ok(json!({ "t": self.live.time() }))
    }

    /// Begins anew with the supervisor of a study around the law, and what acts.
    pub(crate) fn supervise(&mut self, study: &Study) -> Result<Value, StudioError> {
        let mut begin = self.begin.clone();
        begin.study.supervisor.clone_from(&study.supervisor);
        begin.study.world.held.clone_from(&study.world.held);
        self.restart(begin, true)?;
        Ok(json!({ "t": 0.0 }))
    }

    /// Gains of phihat's law, from the next sample on where they can.
    pub(crate) fn gains(&mut self, begin: Begin, runs: bool) -> Result<Value, StudioError> {
        let next = Begin { study: self.begin.study.clone(), gains: begin.gains };
        let now = runs && self.live.take_gains(&next)?;
        self.begin = next;
        Ok(json!({ "now": now }))
    }

    /// Another law beside it, or none. The same law with other scalars goes on; else both begin anew, with what acts.
    pub(crate) fn beside(&mut self, law: Option<AlongsideLaw>) -> Result<Value, StudioError> {
        match (&mut self.other, law) {
            (Some(other), Some(law))
                if other.law.title() == law.title() && other.over.is_none() =>
            {
                other.live.take_law(&self.begin, &law)?;
                other.law = law;
            }
            (other, None) => *other = None,
            (_, Some(law)) => self.stage(self.begin.clone(), Some(law), true)?,
        }
        Ok(json!({ "t": self.live.time() }))
    }

    /// Measurements come so many samples late, which the law is not told of: both begin anew, with what acts.
    pub(crate) fn late(&mut self, samples: u32) -> Result<Value, StudioError> {
        if samples > LATE_MAX {
            return Err(StudioError::refused(format!("0 to {LATE_MAX} samples late are taken")));
        }
        let mut begin = self.begin.clone();
        begin.study.sensor.delay_samples = samples;
        self.restart(begin, true)?;
        self.is_late = true;
        Ok(json!({ "t": 0.0 }))
    }

    /// Faults that came, for a study of this run.
    pub(crate) fn tell(&self) -> Value {
        let (sections, substeps) = self.live.sections();
        let late = self.is_late.then_some(self.begin.study.sensor.delay_samples);
        json!({ "sections": sections, "substeps": substeps, "t": self.live.time(), "late": late })
    }
}
