//! Requests of others: checked, in the study's order, and the requested position at a time.

use thiserror::Error;

use super::messages::JointTrajectory;

/// Reason why a request is refused.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub(super) enum Refused {
    #[error("the joints are {0}: every joint of the study is wanted, and no other")]
    Joints(String),
    #[error("point {0} has not one position per joint")]
    Length(usize),
    #[error("point {0} is not after the one before it")]
    Time(usize),
    #[error("point {point} wants {joint} where it cannot go")]
    Range { point: usize, joint: String },
    #[error("there is no point in it")]
    Empty,
}

/// A joint: its name and its position limits \[rad, m\].
pub(super) type NamedJoint = (String, (f64, f64));

/// Positions at times since the start \[ns\].
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TimedPositions {
    points: Vec<(u64, Vec<f64>)>,
}

impl TimedPositions {
    /// To a position, at once: the supervisor's limits decide how fast.
    pub(super) fn to(joints: &[NamedJoint], q: Vec<f64>) -> Result<Self, Refused> {
        inside(joints, 0, &q)?;
        Ok(Self { points: vec![(0, q)] })
    }

    /// Along a trajectory.
    pub(super) fn along(joints: &[NamedJoint], told: &JointTrajectory) -> Result<Self, Refused> {
        let wrong = || Refused::Joints(told.joint_names.join(", "));
        let place = |(name, _): &NamedJoint| {
            told.joint_names.iter().position(|other| other == name).ok_or_else(wrong)
        };
        let places = joints.iter().map(place).collect::<Result<Vec<_>, _>>()?;
        if told.joint_names.len() != joints.len() {
            return Err(wrong());
        }
        let mut points: Vec<(u64, Vec<f64>)> = Vec::new();
        for (k, point) in told.points.iter().enumerate() {
            let at = point.time_from_start;
            let seconds = u64::try_from(at.sec).map_err(|_| Refused::Time(k))?;
            let t_ns = seconds * 1_000_000_000 + u64::from(at.nanosec);
            if points.last().is_some_and(|(before, _)| *before >= t_ns) {
                return Err(Refused::Time(k));
            }
            if point.positions.len() != joints.len() {
                return Err(Refused::Length(k));
            }
            let q: Vec<f64> =
                places.iter().filter_map(|at| point.positions.get(*at)).copied().collect();
            inside(joints, k, &q)?;
            points.push((t_ns, q));
        }
        if points.is_empty() { Err(Refused::Empty) } else { Ok(Self { points }) }
    }

    /// Requested positions at `t_ns` after the begin, which was at `from`; and true if the way has ended.
    pub(super) fn at(&self, t_ns: u64, from: &[f64]) -> (Vec<f64>, bool) {
        let next = self.points.partition_point(|(at, _)| *at <= t_ns);
        let before = next.checked_sub(1).and_then(|k| self.points.get(k));
        let (start, begin) = before.map_or((0, from), |(at, q)| (*at, &q[..]));
        let Some((end, to)) = self.points.get(next) else { return (begin.to_vec(), true) };
        let share = (t_ns - start) as f64 / (end - start).max(1) as f64;
        let line = |(a, b): (&f64, &f64)| a + share * (b - a);
        (begin.iter().zip(to).map(line).collect(), false)
    }
}

fn inside(joints: &[NamedJoint], point: usize, q: &[f64]) -> Result<(), Refused> {
    if q.len() != joints.len() {
        return Err(Refused::Length(point));
    }
    for ((name, (low, high)), q) in joints.iter().zip(q) {
        if !(q.is_finite() && low <= q && q <= high) {
            return Err(Refused::Range { point, joint: name.clone() });
        }
    }
    Ok(())
}
