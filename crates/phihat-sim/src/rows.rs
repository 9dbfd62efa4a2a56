//! A record that is made of rows as they come, whoever runs the loop.

use phihat::{Command, Measurement, Reference, Report};

use crate::trace::{Integral, Trace};

/// Motion and torque of a joint over one sample interval.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Acted {
    /// Position at the sample \[rad\].
    pub q: f64,
    /// Velocity at the sample \[rad/s\].
    pub dq: f64,
    /// Acceleration at the start of the interval \[rad/s²\].
    pub ddq: f64,
    /// Mean torque over the interval \[N·m\].
    pub tau: f64,
    /// `φ` \[N·m\].
    pub phi: f64,
}

/// One joint's part of a sample, of fixed size.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Row {
    /// Measurement of the joint.
    pub measurement: Measurement<f64>,
    /// Reference of the joint.
    pub reference: Reference<f64>,
    /// Torque command.
    pub command: Command<f64>,
    /// Resulting motion and torque.
    pub acted: Acted,
}

/// A [`Trace`] that grows by rows; the same rows make the same trace as a [`Simulation`](crate::Simulation),
/// bit for bit.
#[derive(Debug)]
pub struct Rows {
    trace: Trace,
    integrals: Vec<Integral>,
}

impl Rows {
    /// An empty record of these joints at this period \[ns\], with room for so many samples.
    pub fn new(names: &[String], period_ns: u64, samples: u64) -> Self {
        let integrals = vec![Integral::default(); names.len()];
        Self { trace: Trace::new(names, period_ns, samples), integrals }
    }

    /// The next sample: its time \[ns\], a row per joint in the robot's order, and what the supervisor did.
    pub fn push(&mut self, t_ns: u64, rows: &[Row], report: Option<&Report>) {
        self.trace.t_ns.push(t_ns);
        for (i, (row, integral)) in rows.iter().zip(&mut self.integrals).enumerate() {
            let Acted { q, dq, ddq, tau, phi } = row.acted;
            if let Some(joint) = self.trace.joints.get_mut(i) {
                joint.q.push(q);
                joint.dq.push(dq);
            }
            let told = (&row.reference, &row.command);
            self.trace.answer(i, integral, &row.measurement, told, (ddq, tau, phi));
        }
        if let Some(report) = report {
            self.trace.supervision.get_or_insert_default().push(report);
        }
    }

    /// Record of the rows pushed since the last [`clear`](Self::clear).
    pub fn trace(&mut self) -> &mut Trace {
        &mut self.trace
    }

    /// The samples go; room and `∫e` stay.
    pub fn clear(&mut self) {
        self.trace.clear();
    }
}
