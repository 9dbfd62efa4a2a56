//! The way of commands to the drives of many arms, one arm per lane.

use phihat_model::Lanes;

use super::SimulatedWorld;

/// Samples that a command may be on its way, and one.
const ROOM: usize = phihat::DELAY_MAX + 1;

/// The ways of commands, one per lane: as `CommandPath` where nothing is lost and nothing refused.
#[derive(Debug)]
pub(crate) struct PathLanes {
    joints: Vec<PathOfJoint>,
    /// By how many samples each lane's commands are late, and all of them, if equally.
    late: [usize; Lanes::COUNT],
    all_late: Option<usize>,
    /// Index of the newest command.
    at: usize,
}

/// One joint of every arm.
#[derive(Debug)]
struct PathOfJoint {
    sent: [Lanes; ROOM],
    told: Lanes,
    told_max: Lanes,
    step_max: Lanes,
}

impl PathLanes {
    pub(crate) fn new(worlds: &[&SimulatedWorld]) -> Self {
        let world = |k: usize| worlds.get(k).or(worlds.last());
        let late = core::array::from_fn(|k| world(k).map_or(0, |world| world.path.late()));
        let all_late = late.iter().all(|own| *own == late[0]).then_some(late[0]);
        let joints = worlds.first().map_or(0, |world| world.path.told.len());
        let way = |i: usize| {
            let of = |of: &dyn Fn(&SimulatedWorld) -> f64| {
                Lanes::from(core::array::from_fn(|k| world(k).map_or(0.0, |world| of(world))))
            };
            let told = of(&|world| world.path.told[i]);
            let told_max = of(&|world| world.path.told_max[i]);
            PathOfJoint {
                sent: [told; ROOM],
                told,
                told_max,
                step_max: of(&|w| w.path.step_max[i]),
            }
        };
        Self { joints: (0..joints).map(way).collect(), late, all_late, at: 0 }
    }

    /// Torque last delivered to the drive of a joint \[N·m\].
    #[inline]
    pub(crate) fn told(&self, joint: usize) -> Lanes {
        self.joints[joint].told
    }

    /// The next sample begins.
    #[inline]
    pub(crate) fn advance(&mut self) {
        self.at = (self.at + 1) % ROOM;
    }

    /// Sends a joint's command \[N·m\] of this sample; what its drive is told now.
    #[inline]
    pub(crate) fn pass(&mut self, joint: usize, command: Lanes) -> Lanes {
        let way = &mut self.joints[joint];
        way.sent[self.at] = command;
        let sent = |late: usize| &way.sent[(self.at + ROOM - late) % ROOM];
        let told = match self.all_late {
            Some(late) => *sent(late),
            None => Lanes::from(core::array::from_fn(|k| {
                <[f64; Lanes::COUNT]>::from(*sent(self.late[k]))[k]
            })),
        };
        way.step_max = way.step_max.larger((told - way.told).abs());
        way.told_max = way.told_max.larger(told.abs());
        way.told = told;
        told
    }

    /// Largest torque that each drive of an arm was told, and largest step of it \[N·m\].
    pub(crate) fn most(&self, lane: usize) -> [Vec<f64>; 2] {
        let of = |of: fn(&PathOfJoint) -> Lanes| {
            self.joints.iter().map(|way| <[f64; Lanes::COUNT]>::from(of(way))[lane]).collect()
        };
        [of(|way| way.told_max), of(|way| way.step_max)]
    }
}
