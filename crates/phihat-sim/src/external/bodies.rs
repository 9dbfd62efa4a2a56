//! The bodies that explain all torques since some time.

use phihat_study::PayloadSet;

use super::body_set::{BodyRow, BodySet, larger};
use super::record::PayloadEstimate;

/// Time for which a set of bodies waits before torques are held against it \[s\]: what a contact that begins slowly
/// cut from it is given back.
const WAITS_S: f64 = 0.1;

/// Time for which one body has to explain all torques after a contact began, to be another payload \[s\].
const CHANGED_S: f64 = 1.0;

/// Bodies that torques allow, and from when on.
#[derive(Debug)]
pub(super) struct KnownBodies {
    now: BodySet,
    /// Bodies of some time ago, and the ones that take their place next.
    settled: BodySet,
    waiting: BodySet,
    /// Time of the last change of these two \[s\].
    changed: f64,
    /// Time of the first sample and of the last one that they explain \[s\].
    pub(super) from: Option<f64>,
    pub(super) last: f64,
    known: Option<f64>,
    /// While a contact lasts: bodies that explain all torques since a time \[s\].
    other: (BodySet, f64),
}

impl KnownBodies {
    /// All bodies of a payload set.
    pub(super) fn of(payload: &PayloadSet) -> Self {
        let all = BodySet::of(payload);
        let (from, known) = (None, None);
        let (settled, waiting, other) = (all, all, (all, 0.0));
        Self { now: all, settled, waiting, changed: 0.0, from, last: 0.0, known, other }
    }

    /// All bodies again, from a time on \[s\].
    pub(super) fn begin(&mut self, t: f64, payload: &PayloadSet) {
        *self = Self { changed: t, ..Self::of(payload) };
    }

    /// A contact begins, or no body explained the torques since the last one: bodies are looked for from here on.
    pub(super) fn look_for_another(&mut self, t: f64, payload: &PayloadSet) {
        self.other = (BodySet::of(payload), t);
    }

    /// Holds a strip of a window that begins at `from` \[s\] against them; `false`: there is none.
    pub(super) fn cut_other(&mut self, a: &BodyRow, strip: (f64, f64), from: f64) -> bool {
        let (set, since) = &mut self.other;
        from < *since || set.cut(a, strip)
    }

    /// Takes them in place of those before the contact, if they explain all torques for long; true if so.
    pub(super) fn take_other(&mut self, t: f64, payload: &PayloadSet) -> bool {
        let (set, since) = self.other;
        let explains = t - since >= CHANGED_S;
        if explains {
            self.begin(t, payload);
            (self.now, self.settled, self.waiting) = (set, set, set);
            self.from = Some(since);
        }
        explains
    }

    /// Leaves those with `low ≤ a·p ≤ high`; `false`: there is none.
    pub(super) fn cut(&mut self, a: &BodyRow, strip: (f64, f64)) -> bool {
        self.now.cut(a, strip)
    }

    /// Range of a linear function over the bodies of some time ago.
    pub(super) fn range(&self, of: &BodyRow) -> (f64, f64) {
        self.settled.range(of)
    }

    /// The torques at a time \[s\] are explained.
    pub(super) fn explain(&mut self, t: f64) {
        self.from = self.from.or(Some(t));
        self.last = t;
        if self.known.is_none() && is_known(self.now.mass()) {
            self.known = Some(t);
        }
        if t - self.changed >= WAITS_S {
            (self.settled, self.waiting) = (self.waiting, self.now);
            self.changed = t;
        }
    }

    /// The payload until a time \[s\], without what the torques of the last tenths cut where a contact ends it.
    pub(super) fn estimate(
        &self,
        (to_s, contact): (f64, bool),
        payload: &PayloadSet,
    ) -> Option<PayloadEstimate> {
        let from_s = self.from?;
        let set = if contact { &self.settled } else { &self.now };
        Some(PayloadEstimate {
            frame: String::new(),
            from_s,
            to_s,
            mass_kg: set.mass(),
            com_m: core::array::from_fn(|axis| set.com(axis, payload.com[axis])),
            known_s: self.known.filter(|_| is_known(set.mass())),
        })
    }
}

/// Returns true if a mass is known to 5 % or 30 g.
fn is_known((low, high): (f64, f64)) -> bool {
    let half = 0.5 * (high - low);
    half <= larger(0.03, 0.05 * 0.5 * (low + high))
}
