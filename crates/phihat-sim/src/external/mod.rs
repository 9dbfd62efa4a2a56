//! Torques from outside: contact, and the payload, from what the certificate's model leaves of φ.

mod allowance;
mod bodies;
mod body_set;
mod force;
mod known_arm;
mod record;
mod refusal;
mod room;
mod scope;
mod window;

use phihat::Reference;
use phihat_study::{AfterContact, PayloadSet, Study};

use allowance::{Allowance, WindowErrors};
use bodies::KnownBodies;
use body_set::{larger, smaller};
use force::TipForces;
use known_arm::WatchedArm;
pub use record::{ContactEvent, ContactReach, ContactRecord, PayloadEstimate};
pub use refusal::ContactRefusal;
use room::WatchRoom;
use scope::ReadingErrors;
pub use scope::VelocityErrorBounds;
use window::{LastSamples, count};

use crate::sample::Sample;

/// Half lengths of the windows \[s\]: a short one sees a large force sooner, a long one a small one.
const HALVES_S: [f64; 3] = [0.012, 0.025, 0.05];

/// The window whose length the reach is about.
const REACH: usize = 1;

/// Least samples in half a window.
const LEAST: usize = 3;

/// Time between two comparisons \[s\].
const BETWEEN_S: f64 = 0.004;

/// Time from which on forces are counted that a window cannot miss: until then the payload is hardly known \[s\].
const LEARNS_S: f64 = 1.0;

/// Time without a torque beyond the model after which a contact is over \[s\].
const QUIET_S: f64 = 0.25;

/// Contacts that are recorded.
const EVENTS: usize = 64;

/// Torque for rounding and for the means of smooth torques by sums \[N·m\], and its share of a torque.
const ROUNDING: (f64, f64) = (1e-4, 1e-6);

/// Watch over the torques of an arm from outside: contact, and the payload.
///
/// # Method
///
/// Over a window of `2N` samples the mean of φ, which φ̂ estimates, follows from readings and torques without any lag,
/// see docs/theory/contact.md. What the model explains of it is an interval per joint: every payload of the set that
/// all torques before allow, every level of dry friction of its interval, every error of reading and velocity that the
/// certificate allows. A mean outside of it is a contact. As long as the model holds, there is none: no threshold is
/// tuned.
///
/// # Real time
///
/// Neither allocates, locks nor asks for the time in a sample.
///
/// # Not claimed
///
/// A force that is smaller than the interval, or that a payload of the set would explain as well, is not noticed as a
/// contact; [`ContactReach`] says which forces are. After a contact nothing is claimed until the law starts again, but
/// further contacts and payloads are recorded.
#[derive(Debug)]
pub struct ContactWatch {
    then: AfterContact,
    names: Vec<String>,
    payload: PayloadSet,
    period: f64,
    halves: [usize; 3],
    stride: usize,
    arm: WatchedArm,
    velocity: VelocityErrorBounds,
    readings: ReadingErrors,
    allowance: Allowance,
    tip: Option<TipForces>,
    last: LastSamples,
    bodies: KnownBodies,
    /// Sequence number of the last sample.
    sequence: Option<u64>,
    since: usize,
    looks: usize,
    /// Contact that goes on: its number, and the time from which a whole window is about it \[s\].
    open: Option<(usize, f64)>,
    /// Without names, which would be allocated.
    record: ContactRecord,
    /// Joint of each contact.
    joints: Vec<usize>,
    room: WatchRoom,
}

impl ContactWatch {
    /// Over an arm whose certificate has these bounds on the velocity error.
    ///
    /// # Errors
    ///
    /// [`ContactRefusal`]: the study has an effect without a bound, or the bounds are not one per joint.
    pub fn new(study: &Study, velocity: VelocityErrorBounds) -> Result<Self, ContactRefusal> {
        scope::bounded(study)?;
        let arm = WatchedArm::of(study)?;
        let n = arm.joints();
        if velocity.joints() != n {
            return Err(ContactRefusal::Bounds(velocity.joints(), n));
        }
        let payload = study.design.payload.clone();
        let period = study.control.period_ns as f64 * 1e-9;
        let halves = HALVES_S.map(|half| count(half / period).max(LEAST));
        Ok(Self {
            then: study.contact.map_or(AfterContact::Report, |contact| contact.then),
            names: study.robot.joint_names(),
            period,
            halves,
            stride: count(BETWEEN_S / period).max(1),
            allowance: Allowance::of(&arm.model, &payload)?,
            tip: TipForces::of(study, &arm.model),
            readings: ReadingErrors::of(study),
            last: LastSamples::new(n, 2 * halves[2] + 2),
            bodies: KnownBodies::of(&payload),
            sequence: None,
            since: 0,
            looks: 0,
            open: None,
            record: ContactRecord {
                events: Vec::with_capacity(EVENTS),
                payloads: Vec::with_capacity(EVENTS),
                ..ContactRecord::default()
            },
            joints: Vec::with_capacity(EVENTS),
            room: WatchRoom::of(n),
            payload,
            arm,
            velocity,
        })
    }

    /// Consequence of a contact.
    pub fn then(&self) -> AfterContact {
        self.then
    }

    /// Takes a sample at time `t` \[s\] with the references of its time; `tracks`: the certificate is about it;
    /// `limited`: a limit acts. Returns true where a contact begins.
    pub(crate) fn sample(
        &mut self,
        t: f64,
        sample: &Sample,
        references: &[Reference<f64>],
        (tracks, limited): (bool, bool),
    ) -> bool {
        let fresh = self.sequence != Some(sample.sequence);
        self.sequence = Some(sample.sequence);
        if self.record.ended.is_some() {
            return false;
        }
        if limited && tracks && self.open.is_none() && !self.velocity.limits_silent() {
            // The bounds on the error are those of a law that no limit touches.
            self.record.ended = Some((t, String::new()));
            return false;
        }
        if !fresh || !tracks {
            self.last.forget();
            return false;
        }
        self.keep(t, sample, references);
        self.since += 1;
        if self.since < self.stride {
            return false;
        }
        self.since = 0;
        self.compare(t)
    }

    /// Keeps a sample with what the model says of it.
    fn keep(&mut self, t: f64, sample: &Sample, references: &[Reference<f64>]) {
        let Self { arm, velocity, last, room, .. } = self;
        for (i, (measured, wanted)) in sample.joints.iter().zip(references).enumerate() {
            (room.q[i], room.dq[i], room.ddq[i]) = (measured.q, wanted.dq, wanted.ddq);
            room.off[i] = velocity.at(i, t);
        }
        arm.torque((&room.q, &room.dq, &room.ddq), &room.off, &mut room.known);
        let samples = last.push();
        for (i, own) in samples.iter_mut().enumerate() {
            let (measured, wanted) = (&sample.joints[i], &references[i]);
            // What the robot added over the interval that ends here is gravity of the sample before.
            let added = if arm.adds_gravity { room.gravity[i] } else { 0.0 };
            (own.q, own.e) = (measured.q, measured.q - wanted.q);
            (own.dq, own.ddq) = (wanted.dq, wanted.ddq);
            own.tau = measured.tau_applied + added;
            own.takes(&room.known, i);
        }
        if arm.adds_gravity {
            arm.gravity(&room.q, &mut room.gravity);
        }
    }

    /// Holds the torques of every window against the model; true where a contact begins.
    fn compare(&mut self, t: f64) -> bool {
        let room = &self.room;
        self.allowance.look(&room.q, &room.dq, &room.ddq);
        self.looks += 1;
        if self.looks < self.allowance.loads() {
            return false;
        }
        let mut beyond: Option<(usize, f64)> = None;
        for (place, half) in self.halves.into_iter().enumerate() {
            if self.last.count <= 2 * half {
                break;
            }
            self.outside(t, half);
            if let Some(found) = self.farthest()
                && beyond.is_none_or(|(_, size)| found.1.abs() > size.abs())
            {
                beyond = Some(found);
            }
            self.record.watched_samples += 1;
            if self.open.is_some() && place > 0 {
                self.look_for_another(t, 2.0 * half as f64 * self.period);
            } else if beyond.is_none() && place > 0 {
                let Self { bodies, room, .. } = self;
                for (row, strip) in room.rows.iter().zip(&room.strips) {
                    if !bodies.cut(row, *strip) {
                        beyond = beyond.or(Some((0, 0.0)));
                    }
                }
            }
            if place == REACH {
                self.about_the_tip(t);
            }
        }
        self.settle(t, beyond)
    }

    /// While a contact lasts, bodies that explain the torques since: another payload, if they do so for long.
    fn look_for_another(&mut self, t: f64, length: f64) {
        let Self { bodies, room, payload, .. } = self;
        let mut strips = room.rows.iter().zip(&room.strips);
        if !strips.all(|(row, strip)| bodies.cut_other(row, *strip, t - length)) {
            bodies.look_for_another(t, payload);
        }
    }

    /// Interval of the torque from outside over the last window of two halves, joint by joint, by (CW4).
    fn outside(&mut self, t: f64, half: usize) {
        let Self { arm, velocity, readings, allowance, last, bodies, room, period, .. } = self;
        let n = room.q.len();
        last.means(half, *period, &mut room.means);
        for (mass, back) in room.mass.iter_mut().zip([0, half, 2 * half]) {
            last.back(back).iter().zip(&mut room.q).for_each(|(one, q)| *q = one.q);
            arm.model.mass_matrix(&mut arm.workspace, &room.q, mass);
        }
        for k in 0..n * n {
            let (a, b, c) = (room.mass[0][k], room.mass[1][k], room.mass[2][k]);
            (room.turned[k], room.bent[k]) = (a - c, (a - b) - (b - c));
        }
        let half_s = half as f64 * *period;
        for (i, middle) in last.back(half).iter().enumerate() {
            (room.q[i], room.dq[i]) = (middle.q, middle.dq);
            room.ddq[i] = room.means[i].ddq;
            room.off[i] = velocity.at_most(i, (t - 2.0 * half_s, t));
            let speed = middle.dq.abs() + half_s * middle.ddq.abs() + room.off[i];
            (room.reading[i], room.posture[i]) = readings.at(i, speed);
        }
        room.rows.iter_mut().zip(&room.means).for_each(|(row, mean)| *row = mean.body);
        arm.accelerated(&room.q, &room.ddq, &mut room.rows);
        let errors = WindowErrors {
            half_s,
            reading: &room.reading,
            posture: &room.posture,
            dq: &room.dq,
            off: &room.off,
            turned: &room.turned,
            bent: &room.bent,
        };
        allowance.torque(&errors, &mut room.allowed);
        for i in 0..n {
            let mean = &room.means[i];
            let mut left = mean.tau - mean.bare;
            for j in 0..n {
                let k = i * n + j;
                left -= room.mass[1][k] * room.means[j].ddq;
                left -= room.turned[k] / (2.0 * half_s) * room.means[j].turning;
            }
            let (low, high) = arm.rotors[i];
            let (a, b) = (low * mean.whole, high * mean.whole);
            let rotor = (smaller(smaller(a, b), 0.0), larger(larger(a, b), 0.0));
            let more =
                room.allowed[i] + ROUNDING.0 + ROUNDING.1 * (mean.tau.abs() + mean.bare.abs());
            let strip = (left - mean.more.1 - rotor.1 - more, left - mean.more.0 - rotor.0 + more);
            let body = bodies.range(&room.rows[i]);
            room.strips[i] = strip;
            room.outside[i] = (body.0 - strip.1, body.1 - strip.0);
        }
    }

    /// The joint whose torque is farthest beyond the model, by its distance over the width of the interval.
    fn farthest(&self) -> Option<(usize, f64)> {
        let beyond = |(low, high): (f64, f64)| larger(low, 0.0) + smaller(high, 0.0);
        let all = self.room.outside.iter().map(|own| (beyond(*own), own.1 - own.0)).enumerate();
        let beyond = all.filter(|(_, (size, _))| size.abs() > 0.0);
        let most = beyond.max_by(|a, b| (a.1.0 / a.1.1).abs().total_cmp(&(b.1.0 / b.1.1).abs()));
        most.map(|(i, (size, _))| (i, size))
    }

    /// Takes what was found at time `t` to contacts and payload; true where a contact begins.
    fn settle(&mut self, t: f64, beyond: Option<(usize, f64)>) -> bool {
        let window = 2.0 * self.halves[REACH] as f64 * self.period;
        match (beyond, self.open) {
            (Some((joint, size)), None) => {
                let estimate = self.bodies.estimate((t, true), &self.payload);
                if self.record.payloads.len() < EVENTS {
                    self.record.payloads.extend(estimate);
                }
                let place = self.record.events.len();
                if place < EVENTS {
                    self.joints.push(joint);
                    self.record.events.push(ContactEvent {
                        t_s: t,
                        until_s: t,
                        joint: String::new(),
                        beyond_nm: size,
                        force_n: None,
                    });
                }
                self.bodies.look_for_another(t, &self.payload);
                self.open = Some((place, t + window));
                true
            }
            (Some(_), Some((place, _))) => {
                if let Some(event) = self.record.events.get_mut(place) {
                    event.until_s = t;
                }
                if self.bodies.take_other(t, &self.payload) {
                    self.open = None;
                }
                false
            }
            (None, Some((place, _))) => {
                let until = self.record.events.get(place).map_or(t, |event| event.until_s);
                if t - until >= QUIET_S {
                    self.open = None;
                    self.bodies.begin(t, &self.payload);
                }
                false
            }
            (None, None) => {
                self.bodies.explain(t);
                false
            }
        }
    }

    /// Force at the tip of a contact, or reach without one.
    fn about_the_tip(&mut self, t: f64) {
        let Some(tip) = &mut self.tip else { return };
        tip.look(&self.arm.model, &mut self.arm.workspace, &self.room.q);
        let learnt = self.bodies.from.map_or(f64::INFINITY, |from| from + LEARNS_S);
        match self.open {
            None if t >= learnt && t >= self.velocity.steady_from() => {
                tip.reach(&self.room.outside);
            }
            Some((place, from)) if t >= from => {
                if let Some(event) = self.record.events.get_mut(place)
                    && event.force_n.is_none()
                {
                    event.force_n = tip.force(&self.room.outside);
                }
            }
            _ => {}
        }
    }

    /// The record so far.
    pub fn record(&self) -> ContactRecord {
        let mut record = self.record.clone();
        for (event, joint) in record.events.iter_mut().zip(&self.joints) {
            event.joint.clone_from(&self.names[*joint]);
        }
        if let Some((_, why)) = &mut record.ended {
            "a limit acted, and the certificate does not exclude it".clone_into(why);
        }
        if self.open.is_none() {
            record.payloads.extend(self.bodies.estimate((self.bodies.last, false), &self.payload));
        }
        record.payloads.retain(|_| self.payload.mass.1 > 0.0);
        for payload in &mut record.payloads {
            payload.frame.clone_from(&self.payload.frame);
        }
        let within = 2.0 * self.halves[REACH] as f64 * self.period;
        record.reach = self.tip.as_ref().and_then(|tip| tip.reached(within));
        record
    }
}
