//! Plants of one structure that move in lockstep, one per lane.

use phihat_model::{Lanes, Lockstep, LockstepError, Model, Scalar};

use super::SimulatedWorld;
use super::drive_lanes::DriveLanes;
use super::forces::STAGES;
use super::friction_lanes::FrictionLanes;
use super::plant::Plant;
use super::shape_lanes::ShapeLanes;

/// A lane whose state adds up to more than this after an interval goes through it alone.
const TAME: f64 = 1e6;

/// The moving parts of up to [`Lanes::COUNT`] worlds.
///
/// # Method
///
/// The state is taken from the worlds at the start of an interval and given back at its end; in between are
/// the steps of `Rk4`, operation by operation. A lane that leaves every plausible state in an interval is not
/// given back: its world goes through it by itself, so infinities and their consequences are those of the
/// single run.
#[derive(Debug)]
pub(crate) struct PlantLanes {
    arms: Lockstep,
    /// Index of the model in force of each taken lane.
    stages: Vec<usize>,
    joints: Vec<JointLanes>,
    /// True if any drive has a lag.
    drives_lag: bool,
    /// True if friction or the shape of a drive's torque changes from interval to interval.
    varies: bool,
    /// Shape of the drives' torques, joint by joint; `None`: all are perfect.
    shapes: Option<Vec<ShapeLanes>>,
    /// Torque of the drives beyond the demanded one, summed over the interval with the integrator's weights
    /// \[N·m\].
    excess: Vec<Lanes>,
    /// State at the start, then at the end of an interval, and `q̈` at its start.
    q: Vec<Lanes>,
    dq: Vec<Lanes>,
    first: Vec<Lanes>,
    stage: IntegratorStage,
    pushes: Vec<(f64, f64, usize, Lanes)>,
}

/// One joint of every arm.
#[derive(Debug)]
struct JointLanes {
    friction: FrictionLanes,
    /// `−ω` of the drives; 0 where torque acts at once.
    falling: Lanes,
    demand: Lanes,
    gap: Lanes,
}

/// The stage of the integrator.
#[derive(Debug)]
struct IntegratorStage {
    q: Vec<Lanes>,
    dq: Vec<Lanes>,
    tau: Vec<Lanes>,
    ddq: Vec<Lanes>,
    velocity: Vec<Lanes>,
    acceleration: Vec<Lanes>,
}

impl PlantLanes {
    /// Why this world moves alone; `None`: it goes in lanes.
    pub(crate) fn alone(world: &SimulatedWorld) -> Option<&'static str> {
        let forces = &world.plant.forces;
        match () {
            () if forces.transmissions.is_some() => Some("elastic transmissions"),
            () if forces.bristles.is_some() => Some("stiction"),
            () if forces.contacts.is_some() => Some("contacts"),
            () if forces.stops.is_some() => Some("end stops"),
            () => None,
        }
    }

    /// Returns true if two worlds can share lanes.
    pub(crate) fn alike(a: &SimulatedWorld, b: &SimulatedWorld) -> bool {
        let models = [a, b].map(|world| world.plant.forces.carried.stage().1);
        a.substeps == b.substeps
            && a.period.to_bits() == b.period.to_bits()
            && Lockstep::new(&models).is_ok()
    }

    /// Lanes for these worlds, in their order.
    ///
    /// # Errors
    ///
    /// The arms are not of one structure, none, or too many.
    pub(crate) fn new(worlds: &[&SimulatedWorld]) -> Result<Self, LockstepError> {
        let plants: Vec<&Plant> = worlds.iter().map(|world| &world.plant).collect();
        let models: Vec<&Model> = plants.iter().map(|p| p.forces.carried.stage().1).collect();
        let arms = Lockstep::new(&models)?;
        let n = arms.joint_count();
        let zero = || vec![Lanes::splat(0.0); n];
        let drives = |i: usize| {
            let rate = |k: usize| {
                let plant = plants.get(k).or(plants.last());
                let drive = plant.and_then(|plant| plant.forces.drives.get(i));
                -drive.and_then(|drive| drive.held_over().0).unwrap_or(0.0)
            };
            Lanes::from(core::array::from_fn(rate))
        };
        let joint = |i: usize| JointLanes {
            friction: friction(&plants, i),
            falling: drives(i),
            demand: Lanes::default(),
            gap: Lanes::default(),
        };
        let lags = |plant: &&Plant| plant.forces.drives.iter().any(|d| d.held_over().0.is_some());
        let varies = |plant: &&Plant| !plant.faults.is_empty() || plant.warm_up.is_some();
        Ok(Self {
            stages: plants.iter().map(|plant| plant.forces.carried.stage().0).collect(),
            joints: (0..n).map(joint).collect(),
            drives_lag: plants.iter().any(lags),
            varies: plants.iter().any(varies),
            shapes: shapes(&core::array::from_fn(|k| plants.get(k).or(plants.last()).copied())),
            excess: zero(),
            q: zero(),
            dq: zero(),
            first: zero(),
            stage: IntegratorStage {
                q: zero(),
                dq: zero(),
                tau: zero(),
                ddq: zero(),
                velocity: zero(),
                acceleration: zero(),
            },
            pushes: pushes(&plants),
            arms,
        })
    }

    /// Moves all worlds through the interval that begins at `t` \[s\]; `world` hands out the one of a lane.
    pub(crate) fn integrate<T>(
        &mut self,
        t: f64,
        holders: &mut [T],
        world: impl Fn(&mut T) -> &mut SimulatedWorld,
    ) {
        let mut timing = None;
        let mut worlds = holders.iter_mut().map(&world);
        let mut lanes: [Option<&mut SimulatedWorld>; Lanes::COUNT] =
            core::array::from_fn(|_| worlds.next());
        if let Some(first) = lanes[0].as_deref() {
            timing = Some((first.period, first.substeps));
        }
        let Some((period, substeps)) = timing else { return };
        let plants: [Option<&Plant>; Lanes::COUNT] =
            core::array::from_fn(|k| lanes[k].as_deref().map(|world| &world.plant));
        self.take(&plants);
        self.go(t, (period, substeps));
        let [q, dq, first, excess] = [&self.q, &self.dq, &self.first, &self.excess];
        let sizes = <[f64; Lanes::COUNT]>::from(self.size());
        for (k, world) in lanes.iter_mut().enumerate() {
            let Some(world) = world else { continue };
            let tame = sizes[k] < TAME;
            if !tame {
                world.integrate(t);
                continue;
            }
            let plant = &mut world.plant;
            give(q, k, &mut plant.q);
            give(dq, k, &mut plant.dq);
            give(first, k, &mut plant.ddq);
            if plant.forces.shapes.is_some() {
                give(excess, k, &mut plant.forces.excess);
            }
        }
    }

    /// Through the interval that begins at `t` \[s\], of so long a period in so many steps.
    pub(crate) fn go(&mut self, t: f64, (period, substeps): (f64, u32)) {
        let h = period / f64::from(substeps);
        self.excess.fill(Lanes::default());
        for step in 0..substeps {
            self.step(t, (t + f64::from(step) * h, h), step == 0);
        }
    }

    /// Sum of `|q| + |q̇|` of each lane: an infinity or NaN on the way to the state has left one here.
    fn size(&self) -> Lanes {
        let sizes = self.q.iter().zip(&self.dq).map(|(q, dq)| q.abs() + dq.abs());
        sizes.fold(Lanes::splat(0.0), |sum, size| sum + size)
    }

    /// Returns true if every position and velocity is less than `bound`; NaN is not.
    pub(crate) fn within(&self, bound: f64) -> bool {
        self.q.iter().chain(&self.dq).all(|x| x.all_below(bound))
    }

    /// Takes over the state of worlds, for good: from here on it is kept here.
    pub(crate) fn take_over(&mut self, worlds: &[&SimulatedWorld]) {
        let plant = |k: usize| worlds.get(k).or(worlds.last()).map(|world| &world.plant);
        let lane = |of: &dyn Fn(&Plant) -> f64| {
            Lanes::from(core::array::from_fn(|k| plant(k).map_or(0.0, of)))
        };
        for i in 0..self.joints.len() {
            self.q[i] = lane(&|plant| plant.q[i]);
            self.dq[i] = lane(&|plant| plant.dq[i]);
            self.first[i] = lane(&|plant| plant.ddq[i]);
        }
    }

    /// Sets the torque demanded of a joint's drive, and its remaining gap, at the start of an interval.
    pub(crate) fn demand(&mut self, joint: usize, drive: &DriveLanes) {
        let own = &mut self.joints[joint];
        (own.demand, own.gap) = (drive.demand, drive.gap);
    }

    /// Torque of a joint's drive for a demanded torque \[N·m\], at the start of the interval that begins at
    /// `t` \[s\].
    pub(crate) fn shaped(&self, joint: usize, torque: Lanes, t: f64) -> Lanes {
        let Some(shapes) = &self.shapes else { return torque };
        shapes[joint].torque(torque, t, self.q[joint], self.dq[joint])
    }

    /// Mean torque of a joint's drive beyond the demanded one over the last interval \[N·m\].
    pub(crate) fn excess(&self, joint: usize, substeps: u32) -> Option<Lanes> {
        self.shapes.as_ref()?;
        Some(self.excess[joint] / Lanes::splat(f64::from(substeps)))
    }

    /// Positions, velocities, and accelerations at the start of the last interval.
    pub(crate) fn state(&self) -> [&[Lanes]; 3] {
        [&self.q, &self.dq, &self.first]
    }

    /// Takes over state and demands at the start of an interval.
    fn take(&mut self, plants: &[Option<&Plant>; Lanes::COUNT]) {
        // Lanes that are free do what the last one does.
        let last = self.stages.len().saturating_sub(1);
        let Some(filler) = plants[last.min(Lanes::COUNT - 1)] else { return };
        let plants = plants.map(|plant| plant.unwrap_or(filler));
        let stage = |k: usize| plants[k].forces.carried.stage();
        if (0..=last).any(|k| stage(k).0 != self.stages[k]) {
            let models: Vec<&Model> = (0..=last).map(|k| stage(k).1).collect();
            // Loads do not change what is structure.
            if let Ok(arms) = Lockstep::new(&models) {
                self.arms = arms;
            }
            (0..=last).for_each(|k| self.stages[k] = stage(k).0);
        }
        if self.varies {
            for (i, shape) in self.shapes.iter_mut().flatten().enumerate() {
                *shape = ShapeLanes::of(&plants.map(|plant| plant.forces.shapes.as_ref()?.get(i)));
            }
        }
        for (i, joint) in self.joints.iter_mut().enumerate() {
            self.q[i] = Lanes::from(plants.map(|plant| plant.q[i]));
            self.dq[i] = Lanes::from(plants.map(|plant| plant.dq[i]));
            joint.demand = Lanes::from(plants.map(|plant| plant.forces.drives[i].held_over().1));
            if self.drives_lag {
                joint.gap = Lanes::from(plants.map(|plant| plant.forces.drives[i].held_over().2));
            }
            if self.varies {
                joint.friction = FrictionLanes::of(&plants.map(|plant| plant.forces.friction[i]));
            }
        }
    }

    /// One step of the integrator, as `Rk4::step`.
    fn step(&mut self, interval: f64, (start, h): (f64, f64), is_first: bool) {
        let n = self.joints.len();
        self.stage.q.copy_from_slice(&self.q);
        self.stage.dq.copy_from_slice(&self.dq);
        self.accelerate([start, start, interval], STAGES[0]);
        if is_first {
            self.first.copy_from_slice(&self.stage.ddq);
        }
        self.stage.velocity.copy_from_slice(&self.dq);
        self.stage.acceleration.copy_from_slice(&self.stage.ddq);
        let stages = [(0.5, 2.0), (0.5, 2.0), (1.0, 1.0)];
        for ((node, weight), share) in stages.into_iter().zip(&STAGES[1..]) {
            let (step, weight) = (node * h, Lanes::splat(weight));
            let length = Lanes::splat(step);
            let IntegratorStage { q, dq, ddq, .. } = &mut self.stage;
            for i in 0..n {
                q[i] = self.q[i] + length * dq[i];
                dq[i] = self.dq[i] + length * ddq[i];
            }
            self.accelerate([start + step, start, interval], *share);
            let IntegratorStage { dq, ddq, velocity, acceleration, .. } = &mut self.stage;
            for i in 0..n {
                velocity[i] += weight * dq[i];
                acceleration[i] += weight * ddq[i];
            }
        }
        let sixth = Lanes::splat(h / 6.0);
        for i in 0..n {
            self.q[i] += sixth * self.stage.velocity[i];
            self.dq[i] += sixth * self.stage.acceleration[i];
        }
    }

    /// `q̈` of the stage at a time, in the step and the interval that began at the others \[s\]; `share` is
    /// the stage's in the interval.
    fn accelerate(&mut self, [t, begin, interval]: [f64; 3], share: f64) {
        let IntegratorStage { q, dq, tau, ddq, .. } = &mut self.stage;
        for (i, joint) in self.joints.iter().enumerate() {
            let mut given = joint.demand;
            if self.drives_lag {
                given += joint.gap * (joint.falling * Lanes::splat(t - interval)).exp();
            }
            if let Some(shapes) = &self.shapes {
                let meant = given;
                given = shapes[i].torque(meant, t, q[i], dq[i]);
                self.excess[i] += Lanes::splat(share) * (given - meant);
            }
            tau[i] = given - joint.friction.torque(dq[i]);
        }
        for (start, end, joint, torque) in &self.pushes {
            if *start <= begin && begin < *end {
                tau[*joint] += *torque;
            }
        }
        self.arms.forward_dynamics(q, dq, tau, ddq);
    }
}

/// Lane `k`, joint by joint.
fn give(lanes: &[Lanes], k: usize, out: &mut [f64]) {
    for (out, lanes) in out.iter_mut().zip(lanes) {
        *out = <[f64; Lanes::COUNT]>::from(*lanes)[k];
    }
}

/// Shape of the drives' torques of all joints; `None`: all are perfect.
fn shapes(plants: &[Option<&Plant>; Lanes::COUNT]) -> Option<Vec<ShapeLanes>> {
    let own = plants.map(|plant| plant.and_then(|plant| plant.forces.shapes.as_deref()));
    let joints = own.iter().flatten().map(|shapes| shapes.len()).next()?;
    Some((0..joints).map(|i| ShapeLanes::of(&own.map(|own| own?.get(i)))).collect())
}

/// The frictions of joint `i`; free lanes have the last one's.
fn friction(plants: &[&Plant], i: usize) -> FrictionLanes {
    let of = |k: usize| {
        let plant = plants.get(k).or(plants.last());
        plant.and_then(|plant| plant.forces.friction.get(i)).copied().unwrap_or_default()
    };
    FrictionLanes::of(&core::array::from_fn(of))
}

/// Every push of every plant, in its own lane, in each plant's order.
fn pushes(plants: &[&Plant]) -> Vec<(f64, f64, usize, Lanes)> {
    let mut all = Vec::new();
    for (lane, plant) in plants.iter().enumerate() {
        for push in &plant.forces.pushes {
            let torque = core::array::from_fn(|k| if k == lane { push.torque } else { 0.0 });
            all.push((push.start, push.end, push.joint, Lanes::from(torque)));
        }
    }
    all
}
