//! Bounds that follow in a bin from its inputs: payload's parameters, dry friction, and sums over all else.

use phihat_certificate::extremes::larger;

use super::dry::{DryInputs, DryRuns};
use super::guess::Guess;
use super::stretch::SweepStretch;
use crate::tube::products::times;
use crate::tube::shapes::LinearRun;

/// Bounds in one bin.
#[derive(Debug, Clone, Default)]
pub(in crate::tube) struct Bin {
    /// Deviation of position and velocity from the nominal run, `(low, high)` per sample and joint.
    pub(in crate::tube) e: Vec<(f64, f64)>,
    pub(in crate::tube) v: Vec<(f64, f64)>,
    /// Deviation of command and of its change per sample, likewise; without the bin's last end.
    pub(in crate::tube) command: Vec<(f64, f64)>,
    pub(in crate::tube) change: Vec<(f64, f64)>,
}

/// Data of a bin's outputs.
pub(super) struct SweepOutputs<'a> {
    pub(super) at: &'a SweepStretch<'a>,
    /// Boxes on the inputs of this bin and the one before.
    pub(super) boxes: &'a [f64],
    /// Sums per row of the outputs.
    pub(super) summed: &'a [f64],
    pub(super) friction: &'a DryInputs,
    pub(super) runs: &'a DryRuns,
}

impl SweepOutputs<'_> {
    /// The bounds, and the guess that they would be.
    pub(super) fn bounds(&self) -> (Bin, Guess) {
        let SweepStretch { n, from, to, inputs, .. } = *self.at;
        let (momentum, payload) = self.momentum();
        let direct = self.at.direct(momentum, payload);
        let wide: Vec<f64> = (0..n).map(|i| self.summed[n + i] + direct[i]).collect();
        let mut bin = Bin::default();
        let mut found = Guess {
            v: Vec::with_capacity((to - from + 1) * n),
            e: vec![0.0; n],
            summed: [self.summed[..n].to_vec(), wide],
            twist: vec![0.0; inputs.twist],
        };
        for k in from..=to {
            self.states(k, &mut bin, &mut found);
            self.twist(k, &mut found.twist);
            if k < to {
                self.commands(k, &mut bin);
            }
        }
        self.summed_twist(&mut found.twist);
        (bin, found)
    }

    /// Boxes on momentum, of the arm and of the payload.
    fn momentum(&self) -> (&[f64], &[f64]) {
        let SweepStretch { n, inputs, .. } = *self.at;
        let (arm, payload) = (inputs.momentum(), inputs.payload());
        (&self.boxes[arm..arm + n], &self.boxes[payload..payload + inputs.twist])
    }

    /// Ends of what the payload's parameters do, from what each of them does.
    fn hull(&self, unit: impl Fn(&LinearRun) -> f64) -> (f64, f64) {
        let along = self.at.along;
        along.slice.map_or((0.0, 0.0), |slice| {
            slice.hull(&core::array::from_fn(|d| along.shapes[d].as_ref().map_or(0.0, &unit)))
        })
    }

    /// Position and velocity at sample `k`.
    fn states(&self, k: usize, bin: &mut Bin, found: &mut Guess) {
        let (n, row) = (self.at.n, k - self.at.from);
        for i in 0..n {
            let at = k * n + i;
            let parts = (self.hull(|s| s.e[at]), self.friction.ends(&self.runs.e, row, i));
            let e = bounds(parts, found.summed[0][i]);
            found.e[i] = larger(found.e[i], larger(e.1, -e.0));
            bin.e.push(e);
            let parts = (self.hull(|s| s.v[at]), self.friction.ends(&self.runs.v, row, i));
            let v = bounds(parts, found.summed[1][i]);
            found.v.push(v);
            bin.v.push(v);
        }
    }

    /// Twist of the payload at sample `k`, without what the sums add.
    fn twist(&self, k: usize, twist: &mut [f64]) {
        let (n, along) = (self.at.n, self.at.along);
        let Some(slice) = along.slice else { return };
        let rows = along.course.jacobian(k).chunks_exact(n);
        for (twist, row) in twist.iter_mut().zip(rows) {
            let along_row = |v: &[f64]| -> f64 { row.iter().zip(v).map(|(j, v)| j * v).sum() };
            let unit = |shape: &LinearRun| along_row(&shape.v[k * n..(k + 1) * n]);
            let shapes = &along.shapes;
            let unit = core::array::from_fn(|d| shapes[d].as_ref().map_or(0.0, unit));
            let mut size = slice.size(&unit);
            self.friction.enlarge(&mut size, &self.runs.v, k - self.at.from, along_row);
            *twist = larger(*twist, size);
        }
    }

    /// Adds the sums to the twist, the momentum's immediate part included.
    fn summed_twist(&self, twist: &mut [f64]) {
        let (n, (momentum, payload)) = (self.at.n, self.momentum());
        if self.at.along.slice.is_none() {
            return;
        }
        let lag = times(&self.at.group.moved_jacobian, &self.summed[n..2 * n]);
        let direct = self.at.twist_direct(momentum, payload);
        for (c, twist) in twist.iter_mut().enumerate() {
            *twist += self.summed[2 * n + c] + lag[c] + direct[c];
        }
    }

    /// Command of sample `k`, and its change from the one before.
    fn commands(&self, k: usize, bin: &mut Bin) {
        let (n, row, at) = (self.at.n, k - self.at.from, self.at.inputs.command_row());
        for i in 0..n {
            let now = k * n + i;
            let hull = self.hull(|shape| shape.command[now]);
            let parts = (hull, self.friction.ends(&self.runs.command, row, i));
            bin.command.push(bounds(parts, self.summed[at + i]));
            let hull = self.hull(|shape| {
                let before = if k > 0 { shape.command[now - n] } else { 0.0 };
                shape.command[now] - before
            });
            let parts = (hull, self.friction.ends(&self.runs.change, row, i));
            bin.change.push(bounds(parts, self.summed[at + n + i]));
        }
    }
}

/// Payload's part, friction's part, and sums either way.
fn bounds((payload, friction): ((f64, f64), (f64, f64)), sum: f64) -> (f64, f64) {
    (payload.0 + friction.0 - sum, payload.1 + friction.1 + sum)
}
