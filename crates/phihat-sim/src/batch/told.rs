//! References of all arms, computed once for arms that share one, and the poses of the tip along them.

use phihat_model::{FrameId, Lanes, Model, Pose, Workspace};

use crate::motion::Motion;

/// Samples that are computed at once.
const AHEAD: u64 = 1 << 15;

/// The same for an arm whose motion is its own.
const OWN_AHEAD: u64 = 64;

/// Beyond it, a law may refuse a number.
const PLAUSIBLE: f64 = 4e9;

/// The tip of an arm.
#[derive(Debug, Clone)]
pub(super) struct TipLanes {
    model: Model,
    frame: FrameId,
    workspace: Workspace<Lanes>,
}

impl TipLanes {
    pub(super) fn new(model: &Model, frame: FrameId) -> Self {
        Self { workspace: Workspace::new(model), model: model.clone(), frame }
    }

    /// Pose of the tip at `q`.
    pub(super) fn pose(&mut self, q: &[Lanes]) -> Pose<Lanes> {
        self.model.forward_kinematics(&mut self.workspace, q);
        self.model.pose(&self.workspace, self.frame)
    }

    fn is(&self, other: &Self) -> bool {
        self.frame == other.frame && self.model == other.model
    }
}

/// References of all joints, and the tip's pose if there is one.
type ReferenceRow<'a> = (&'a [[f64; 3]], Option<&'a [f64; 12]>);

/// A motion of an arm, sample by sample, as far as it was worked out.
#[derive(Debug)]
pub(super) struct PreparedMotion {
    motion: Motion,
    joints: usize,
    period_ns: u64,
    tip: Option<TipLanes>,
    ahead: u64,
    /// The first sample that is here.
    from: u64,
    rows: Vec<[f64; 3]>,
    /// Origin and axes of the tip in every sample.
    poses: Vec<[f64; 12]>,
    plausible: bool,
}

impl PreparedMotion {
    /// The motion of `joints` joints at a period \[ns\], shared or one arm's own.
    pub(super) fn new(
        motion: &Motion,
        (joints, period_ns): (usize, u64),
        tip: Option<&TipLanes>,
        shared: bool,
    ) -> Self {
        Self {
            motion: motion.clone(),
            joints,
            period_ns,
            tip: tip.cloned(),
            ahead: if shared { AHEAD } else { OWN_AHEAD },
            from: 0,
            rows: Vec::new(),
            poses: Vec::new(),
            plausible: true,
        }
    }

    /// Returns true if these are the references of this motion.
    pub(super) fn is(&self, motion: &Motion, period_ns: u64, tip: Option<&TipLanes>) -> bool {
        let tips = match (&self.tip, tip) {
            (None, None) => true,
            (Some(own), Some(other)) => own.is(other),
            _ => false,
        };
        tips && self.period_ns == period_ns && self.motion == *motion
    }

    /// Sample `k` of a run of so many: `q_d`, `q̇_d`, `q̈_d` of every joint, and the tip's pose; `None`:
    /// numbers that no law accepts.
    pub(super) fn at(&mut self, k: u64, samples: u64) -> Option<ReferenceRow<'_>> {
        let here = self.rows.len() / self.joints.max(1);
        let mut at = k.checked_sub(self.from).and_then(|at| usize::try_from(at).ok());
        if at.is_none_or(|at| at >= here) {
            self.work_out(k, samples);
            at = Some(0);
        }
        let at = at.filter(|_| self.plausible)?;
        let row = self.rows.get(at * self.joints..(at + 1) * self.joints)?;
        Some((row, self.poses.get(at)))
    }

    fn work_out(&mut self, from: u64, samples: u64) {
        self.from = from;
        self.rows.clear();
        self.poses.clear();
        for k in from..samples.min(from.saturating_add(self.ahead)) {
            let t = (k * self.period_ns) as f64 * 1e-9;
            self.rows.extend((0..self.joints).map(|joint| self.motion.told(joint, t)));
        }
        let doubtful = |x: &f64| x.is_nan() || x.abs() >= PLAUSIBLE;
        self.plausible = !self.rows.iter().flatten().any(doubtful);
        let Some(tip) = &mut self.tip else { return };
        let (n, count) = (self.joints, self.rows.len() / self.joints.max(1));
        for first in (0..count).step_by(Lanes::COUNT) {
            let sample = |k: usize| (first + k).min(count - 1);
            let q =
                |i: usize| Lanes::from(core::array::from_fn(|k| self.rows[sample(k) * n + i][0]));
            let pose = tip.pose(&(0..n).map(q).collect::<Vec<_>>());
            let all = numbers(&pose).map(<[f64; Lanes::COUNT]>::from);
            let those = Lanes::COUNT.min(count - first);
            self.poses.extend((0..those).map(|k| all.map(|number| number[k])));
        }
    }
}

/// Origin, then axes row by row.
fn numbers(pose: &Pose<Lanes>) -> [Lanes; 12] {
    core::array::from_fn(|i| if i < 3 { pose.p[i] } else { pose.r[(i - 3) / 3][i % 3] })
}

/// The pose of these numbers.
pub(super) fn pose(numbers: &[Lanes; 12]) -> Pose<Lanes> {
    let [a, b, c, d, e, f, g, h, i, j, k, l] = *numbers;
    Pose { p: [a, b, c], r: [[d, e, f], [g, h, i], [j, k, l]] }
}
