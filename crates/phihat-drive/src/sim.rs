//! phihat's own world at the other end: in lock-step, or by this machine's clock.

use phihat::{Released, Report};
use phihat_sim::{Acted, Ended, Sample, WorldSide};
use phihat_study::Study;

use crate::facts::{Adds, Clock, Facts, Stops, Tells};
use crate::finding::SystemError;
use crate::link::{Link, LinkFault, Wait};
use crate::system::HostClock;

/// A study's simulated arm. Its sensors, drives, delays, losses and faults act as in `phihat run`.
#[derive(Debug)]
pub struct SimLink {
    world: WorldSide,
    facts: Facts,
    clock: Option<HostClock>,
    /// The number of the message that came last.
    last: Option<u64>,
}

impl SimLink {
    /// In lock-step: each side waits for the other.
    pub fn lock_step(study: &Study, world: WorldSide) -> Self {
        let facts = Self::facts_of(study, Clock::LockStep);
        Self { world, facts, clock: None, last: None }
    }

    /// By this machine's clock: a sample is due every period, and how late the loop woke is measured.
    ///
    /// # Errors
    ///
    /// [`SystemError`]: this system has no such clock.
    pub fn real_time(study: &Study, world: WorldSide) -> Result<Self, SystemError> {
        let clock = HostClock::new(world.period_ns())?;
        let facts = Self::facts_of(study, Clock::Host);
        Ok(Self { world, facts, clock: Some(clock), last: None })
    }

    /// A simulated arm is what its study says.
    pub fn facts_of(study: &Study, clock: Clock) -> Facts {
        let profile = &study.interface.profile;
        let joints = study.robot.joint_names();
        Facts {
            name: "the simulated arm".to_owned(),
            clock,
            period_ns: study.control.period_ns,
            width: joints.len(),
            joints: Some(joints),
            adds: Adds { gravity: profile.adds_gravity, friction: Some(profile.adds_friction) },
            stops: Stops {
                torque_rate_max_nm_s: profile.torque_rate_max,
                first_torque_max_nm: profile.first_torque_max,
                losses_max: profile.losses_max,
            },
            tells: Tells { echo: true, losses: true, truth: true },
        }
    }
}

impl Link for SimLink {
    fn facts(&self) -> &Facts {
        &self.facts
    }

    fn start(&mut self) -> Result<(), LinkFault> {
        if let Some(clock) = &mut self.clock {
            clock.start();
        }
        Ok(())
    }

    fn wait(&mut self, sample: &mut Sample) -> Wait {
        if let Some(clock) = &mut self.clock {
            clock.wait();
        }
        if self.world.abort().is_some() {
            // Which rule it was is in how the world ended.
            return Wait::Fault(LinkFault::Stopped("its torque interface stopped"));
        }
        let Some(sensed) = self.world.sense() else { return Wait::Over };
        let t_ns = sensed.t_ns;
        sample.take(sensed.sample);
        let fresh = self.last != Some(sensed.sample.sequence);
        self.last = Some(sensed.sample.sequence);
        match (sensed.runs, fresh) {
            (false, _) => Wait::Skipped { t_ns },
            (true, true) => Wait::Fresh { t_ns },
            (true, false) => Wait::Lost { t_ns },
        }
    }

    fn supervised(&mut self, report: Option<&Report>) {
        self.world.brake(report);
    }

    fn send(&mut self, tau: Released<'_, f64>) {
        self.world.act(tau.tau());
    }

    fn acted(&self, joint: usize, inertia: f64) -> Option<Acted> {
        (joint < self.facts.width).then(|| self.world.acted(joint, inertia))
    }

    fn finish(&mut self, _: Released<'_, f64>) -> Result<(), LinkFault> {
        Ok(())
    }

    fn recover(&mut self) -> Result<(), LinkFault> {
        Err(LinkFault::NoRecovery)
    }

    fn now_ns(&self) -> Option<u64> {
        self.clock.as_ref().map(HostClock::now_ns)
    }

    fn late_ns(&self) -> Option<u64> {
        self.clock.as_ref().map(HostClock::late_ns)
    }

    fn into_ended(self) -> Option<Ended> {
        Some(self.world.end())
    }
}
