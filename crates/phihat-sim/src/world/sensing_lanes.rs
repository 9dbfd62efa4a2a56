//! The sensors of many arms, one arm per lane, and the way of their messages.

use phihat_model::{FileChoice, Lanes, Scalar};

use super::SimulatedWorld;

/// Sensors, one arm per lane: as `Sensing` where nothing is lost, spoiled or wrapped.
#[derive(Debug)]
pub(crate) struct SensingLanes {
    sensors: Vec<SensorLanes>,
    /// Arms whose reported torque is the demanded one.
    told: FileChoice,
    period: Lanes,
    /// Messages on their way, a row of all joints each, the oldest at `at`.
    way: Vec<Vec<[Lanes; 3]>>,
    at: usize,
    /// The arms whose sensors err.
    erring: Vec<usize>,
}

/// The sensors of one joint.
#[derive(Debug)]
struct SensorLanes {
    quantum: Lanes,
    coded: FileChoice,
    differenced: FileChoice,
    filter: Lanes,
    filtered: FileChoice,
    any: [bool; 2],
    last: [Lanes; 2],
}

impl SensingLanes {
    /// `None`: some messages are later than others.
    pub(crate) fn new(worlds: &[&SimulatedWorld]) -> Option<Self> {
        let world = |k: usize| worlds.get(k).or(worlds.last());
        let late = worlds.first()?.sensing.late();
        if worlds.iter().any(|world| world.sensing.late() != late) {
            return None;
        }
        let joints = worlds.first()?.path.told.len();
        let sensor = |i: usize| {
            let all: [(Option<f64>, bool, f64); Lanes::COUNT] = core::array::from_fn(|k| {
                world(k).map_or((None, false, 1.0), |world| world.sensing.sensor(i).numbers())
            });
            SensorLanes {
                quantum: Lanes::from(all.map(|own| own.0.unwrap_or(1.0))),
                coded: FileChoice::from(all.map(|own| own.0.is_some())),
                differenced: FileChoice::from(all.map(|own| own.1)),
                filter: Lanes::from(all.map(|own| own.2)),
                filtered: FileChoice::from(all.map(|own| own.2 < 1.0)),
                any: [all.iter().any(|own| own.0.is_some()), all.iter().any(|own| own.1)],
                last: [Lanes::default(); 2],
            }
        };
        let demand = |k: usize| world(k).is_some_and(|world| world.sensing.tells_demand());
        let errs = |k: &usize| world(*k).is_some_and(|world| world.sensing.errs());
        Some(Self {
            sensors: (0..joints).map(sensor).collect(),
            told: FileChoice::from(core::array::from_fn(demand)),
            period: Lanes::splat(worlds.first()?.period),
            way: vec![vec![[Lanes::default(); 3]; joints]; late + 1],
            at: 0,
            erring: (0..Lanes::COUNT).filter(errs).collect(),
        })
    }

    /// Takes sample `k` of a joint from its true `[q, q̇, q̈]`, the mean torque that acted and the one it was told.
    #[inline]
    pub(crate) fn sense(
        &mut self,
        (worlds, k): (&[&SimulatedWorld], u64),
        i: usize,
        [q, dq, ddq]: [Lanes; 3],
        [mean, told]: [Lanes; 2],
    ) {
        let (mut q, mut dq, mut tau) = (q, dq, self.told.pick(told, mean));
        if !self.erring.is_empty() {
            let mut each = [q, dq, ddq, tau].map(<[f64; Lanes::COUNT]>::from);
            for lane in &self.erring {
                let Some(world) = worlds.get(*lane).or(worlds.last()) else { continue };
                let x = [each[0][*lane], each[1][*lane], each[2][*lane]];
                if let Some(told) = world.sensing.errors(i, k, x, each[3][*lane]) {
                    (each[0][*lane], each[1][*lane], each[3][*lane]) = told;
                }
            }
            [q, dq, _, tau] = each.map(Lanes::from);
        }
        let seen = self.sensors[i].sense(q, dq, (k == 0, self.period));
        self.way[self.at][i] = [seen[0], seen[1], tau];
        if k == 0 {
            // As if the driver had been running before the start.
            for message in &mut self.way {
                message[i] = [seen[0], seen[1], tau];
            }
        }
    }

    /// The message that arrives with this sample: position, velocity and torque of every joint.
    #[inline]
    pub(crate) fn arrived(&self) -> &[[Lanes; 3]] {
        &self.way[(self.at + 1) % self.way.len()]
    }

    /// The next sample begins.
    #[inline]
    pub(crate) fn advance(&mut self) {
        self.at = (self.at + 1) % self.way.len();
    }
}

impl SensorLanes {
    /// As `Sensor::sense`.
    #[inline]
    fn sense(&mut self, q: Lanes, dq: Lanes, (first, period): (bool, Lanes)) -> [Lanes; 2] {
        let [codes, differences] = self.any;
        let position =
            if codes { self.coded.pick(self.quantum * (q / self.quantum).round(), q) } else { q };
        if first {
            self.last = [position, dq];
            return self.last;
        }
        let [before, filtered] = self.last;
        let raw =
            if differences { self.differenced.pick((position - before) / period, dq) } else { dq };
        let smooth = filtered + self.filter * (raw - filtered);
        self.last = [position, self.filtered.pick(smooth, raw)];
        self.last
    }
}
