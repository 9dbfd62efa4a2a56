//! The claims themselves: bound on the error, φ, reference.

use phihat_certificate::extremes::Extremes as _;
use phihat_design::{RecordedJoint, Smoothed};
use phihat_sim::Motion;
use phihat_study::ReferenceRequest;

use super::Audited;
use super::row::{Assumption, AuditRow, largest_beyond};

/// Width of the boxes that positions are differenced over \[s\].
pub(super) const WIDTH: f64 = 0.01;

/// Share by which a figure may exceed the assumed one: both are rounded.
const SLACK: f64 = 1e-6;

/// A reference that is nearer than this to the study's is the study's \[rad\].
const SAME: f64 = 1e-6;

impl Audited<'_> {
    /// First sample from which a steady bound is claimed.
    fn settled(&self) -> usize {
        let spec = self.study.spec.settle;
        let own = self.gains.and_then(|gains| gains.certificate.as_ref());
        let settle = own.and_then(|own| own.settle.as_ref()).map_or(spec, |own| own.settle_s);
        let after = self.time(self.tracked.start) + settle;
        self.trace.index_at(after).clamp(self.tracked.start, self.tracked.end)
    }

    pub(super) fn error_rows(&self) -> Vec<AuditRow> {
        let certificate = self.gains.and_then(|gains| gains.certificate.as_ref());
        let bound = |i: usize| certificate.and_then(|own| own.error_bound(i));
        let from = self.settled();
        let rows = self.names().filter_map(|(i, name)| {
            let bound = bound(i)?.error_bound_rad;
            let e = self.trace.joints[i].e.get(from..self.tracked.end)?;
            let values = e.iter().enumerate().map(|(k, e)| (self.time(from + k), *e));
            let (most, time) = largest_beyond(values, bound * (1.0 + SLACK));
            let row = AuditRow::at_most(Assumption::ErrorBound, (most, bound, "rad"), time);
            Some(
                row.on(name)
                    .with_change(|| format!("[spec]\nerror_bound_rad = {:.2e}", 1.05 * most)),
            )
        });
        let rows: Vec<AuditRow> = rows.collect();
        if rows.is_empty() {
            let why = "the gains bound no error";
            return vec![AuditRow::not_told(Assumption::ErrorBound, why)];
        }
        rows
    }

    /// Positions and torques of some samples.
    pub(super) fn recorded_joints(&self, from: usize) -> Vec<RecordedJoint> {
        let part = |x: &[f64]| x.get(from..self.tracked.end).unwrap_or_default().to_vec();
        let joint = |joint: &phihat_sim::JointTrace| RecordedJoint {
            name: joint.name.clone(),
            q: part(&joint.q_measured),
            tau: part(&joint.tau_applied),
        };
        self.trace.joints.iter().map(joint).collect()
    }

    pub(super) fn phi_rows(&self) -> Vec<AuditRow> {
        let none = |why| {
            [Assumption::PhiSize, Assumption::PhiChange].map(|one| AuditRow::not_told(one, why))
        };
        let certificate = self.gains.and_then(|gains| gains.certificate.as_ref());
        let (Some(gains), Some(certificate)) = (self.gains, certificate) else {
            return none("the gains carry no certificate").into();
        };
        let from = self.settled();
        let record = Smoothed::new(&self.recorded_joints(from), self.trace.period_ns, WIDTH);
        let Some(record) = record else { return none("the record is too short").into() };
        let mut rows = Vec::new();
        for (((i, name), signals), own) in
            self.names().zip(record.signals()).zip(&certificate.joints)
        {
            let Some(phi) = &own.phi else { continue };
            let inertia = gains.joints[i].inertia_kg_m2;
            let pairs = signals.tau.iter().zip(signals.ddq);
            let course: Vec<f64> = pairs.map(|(tau, ddq)| tau - inertia * ddq).collect();
            let middle = samples(2.0 * WIDTH, self.period);
            let at = |k: usize| self.time(from + k + middle);
            if let Some(size) = phi.size_nm {
                let values = course.iter().enumerate().map(|(k, phi)| (at(k), *phi));
                let (most, time) = largest_beyond(values, size * (1.0 + SLACK));
                rows.push(
                    AuditRow::at_most(Assumption::PhiSize, (most, size, "N·m"), time).on(name),
                );
            }
            rows.push(
                change_row((&course, self.period), (phi.rate_nm_s, phi.jump_nm), &at).on(name),
            );
        }
        if rows.is_empty() {
            return none("the certificate states no φ: its bounds are those of a tube or a class")
                .into();
        }
        rows
    }

    pub(super) fn reference_rows(&self) -> Vec<AuditRow> {
        if let ReferenceRequest::Any { class, .. } = &self.study.reference {
            return self.class_rows(class);
        }
        let Ok(motion) = Motion::of(self.study) else {
            return vec![AuditRow::not_told(
                Assumption::Reference,
                "the study's motion cannot be followed",
            )];
        };
        let off = |i: usize, first: usize, k: usize| {
            let t = (k - first) as f64 * self.period;
            self.trace.joints[i].q_desired[k] - motion.told(i, t)[0]
        };
        // A supervisor begins the motion when it tracks, and comes to it from where the arm stands.
        let blend = if self.trace.supervision.is_some() {
            self.trace.index_at(self.time(self.tracked.start) + 1.0)
        } else {
            0
        };
        let part = self.tracked.start.max(blend).min(self.tracked.end)..self.tracked.end;
        let most = |i: usize, first: usize| part.clone().map(|k| off(i, first, k).abs()).largest();
        let first = [0, self.tracked.start].into_iter().min_by(|a, b| {
            let sum = |first: usize| self.names().map(|(i, _)| most(i, first)).largest();
            sum(*a).total_cmp(&sum(*b))
        });
        let first = first.unwrap_or(0);
        let row = |(i, name): (usize, &str)| {
            let values = part.clone().map(|k| (self.time(k), off(i, first, k)));
            let (most, time) = largest_beyond(values, SAME);
            AuditRow::at_most(Assumption::Reference, (most, 0.0, "rad"), time).on(name).with_change(
                || "[reference]: the motion that was driven (`kind = \"samples\"`), or its class (`kind = \
                    \"any\"`)".to_owned(),
            )
        };
        self.names().map(row).collect()
    }

    fn class_rows(&self, class: &phihat_study::MotionClass) -> Vec<AuditRow> {
        let mut rows = Vec::new();
        for (i, name) in self.names() {
            let joint = &self.trace.joints[i];
            let part = self.tracked.clone();
            let course = |x: &dyn Fn(usize) -> f64, most: f64| {
                largest_beyond(
                    part.clone().map(|k| (self.time(k), x(k))),
                    most * (1.0 + 1e-3) + 1e-9,
                )
            };
            let (low, high) = (class.low[i], class.high[i]);
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
            let jerk = |k: usize| {
                let next = joint.ddq_desired.get(k + 1).unwrap_or(&joint.ddq_desired[k]);
                (next - joint.ddq_desired[k]) / self.period
            };
            for (figure, assumed, unit) in [
                (
                    course(&|k| joint.q_desired[k] - middle, half),
                    half,
                    "rad from the middle of its box",
                ),
                (course(&|k| joint.dq_desired[k], class.speed[i]), class.speed[i], "rad/s"),
                (
                    course(&|k| joint.ddq_desired[k], class.acceleration[i]),
                    class.acceleration[i],
                    "rad/s²",
                ),
                (course(&jerk, class.jerk[i]), class.jerk[i], "rad/s³"),
            ] {
                let (most, time) = figure;
                rows.push(
                    AuditRow::at_most(Assumption::Reference, (most, assumed, unit), time).on(name),
                );
            }
        }
        rows
    }
}

/// Samples in so long a time \[s\], 1 at least.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
pub(super) fn samples(time: f64, period: f64) -> usize {
    (time / period).round().clamp(1.0, 1e9) as usize
}

/// Rate and jump of φ: no two samples may differ by more than the rate times their distance and twice the jump, each
/// way of the smooth part and both sides of the jump.
fn change_row(
    (course, period): (&[f64], f64),
    (rate, jump): (f64, f64),
    at: &impl Fn(usize) -> f64,
) -> AuditRow {
    let (mut steepest, mut time) = (0.0_f64, None);
    let mut reach = samples(4.0 * WIDTH, period);
    while reach < course.len() {
        let span = reach as f64 * period;
        for (k, pair) in course.windows(reach + 1).enumerate() {
            let beyond = (pair[reach] - pair[0]).abs() - 2.0 * jump;
            if beyond / span > steepest {
                steepest = beyond / span;
                if time.is_none() && beyond > rate * span * (1.0 + SLACK) {
                    time = Some(at(k));
                }
            }
        }
        reach *= 2;
    }
    AuditRow::at_most(Assumption::PhiChange, (steepest, rate, "N·m/s beside its jump"), time)
        .with_change(|| format!("[design]\nphi_rate_max_nm_s = {:.3}", 1.05 * steepest))
}
