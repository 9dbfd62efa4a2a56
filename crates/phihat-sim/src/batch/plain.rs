//! Closed loops that are in lanes from the sensor to the figure.

use phihat_model::{Lanes, Scalar};
use phihat_study::Study;

use super::figures::{ActedLanes, BatchFigures};
use super::law::{CommandLanes, LawLanes};
use super::told::{PreparedMotion, TipLanes, pose};
use crate::metrics::{Measured, Metrics};
use crate::simulation::{DIVERGED, Ended, Simulation};
use crate::world::{DriveLanes, PathLanes, PlantLanes, SensingLanes, SimulatedWorld};

/// Beyond it, a law may refuse a number.
const PLAUSIBLE: f64 = 4e9;

/// Arms of one structure whose samples bring nothing but what every sample brings.
///
/// # Method
///
/// As `Simulation::record` into `Measured`, operation by operation, but in lockstep and without a record. The
/// simulations are not changed: where an arm leaves the plain case (it diverges, its law refuses a sample),
/// the whole group is run again by the general method.
pub(super) struct Plain<'a> {
    worlds: Vec<&'a SimulatedWorld>,
    studies: Vec<&'a Study>,
    law: LawLanes,
    sensing: SensingLanes,
    path: PathLanes,
    plant: PlantLanes,
    drives: Vec<DriveLanes>,
    figures: BatchFigures,
    tip: Option<TipLanes>,
    answers: Vec<CommandLanes>,
    /// Torque at the start of a sample and mean torque over the last one, joint by joint.
    start: Vec<Lanes>,
    mean: Vec<Lanes>,
    wanted: Vec<[Lanes; 3]>,
    /// The tip's pose that is wanted.
    wanted_pose: Option<[Lanes; 12]>,
    samples: u64,
    period_ns: u64,
}

impl<'a> Plain<'a> {
    /// `None`: these are for the way that is for all.
    pub(super) fn of(group: &'a [(usize, Simulation)], studies: &[&'a Study]) -> Option<Self> {
        let (_, first) = group.first()?;
        let own: Vec<&Study> =
            group.iter().map(|(arm, _)| studies.get(*arm).copied()).collect::<Option<_>>()?;
        let alike = |((_, simulation), study): (&(usize, Simulation), &&Study)| {
            simulation.samples() == first.samples()
                && simulation.period_ns == first.period_ns
                && study.control.period_ns == first.period_ns
                && study.spec.settle.to_bits() == own[0].spec.settle.to_bits()
                && study.robot.tip == own[0].robot.tip
                && study.robot.model == own[0].robot.model
                && simulation.world.uneventful()
        };
        if !group.iter().zip(&own).all(alike) {
            return None;
        }
        let worlds: Vec<&SimulatedWorld> =
            group.iter().map(|(_, simulation)| &*simulation.world).collect();
        let laws = group.iter().map(|(_, simulation)| simulation.control.law_alone());
        let law = LawLanes::new(&laws.collect::<Option<Vec<_>>>()?)?;
        let mut plant = PlantLanes::new(&worlds).ok()?;
        plant.take_over(&worlds);
        let n = first.names.len();
        let lane = |of: &dyn Fn(&Simulation) -> f64| {
            let at = |k: usize| group.get(k).or(group.last());
            Lanes::from(core::array::from_fn(|k| at(k).map_or(0.0, |(_, s)| of(s))))
        };
        let inertia: Vec<Lanes> = (0..n).map(|i| lane(&|s| s.control.inertia(i))).collect();
        Some(Self {
            law,
            sensing: SensingLanes::new(&worlds)?,
            path: PathLanes::new(&worlds),
            plant,
            drives: (0..n).map(|i| DriveLanes::of(&worlds, i)).collect(),
            figures: BatchFigures::new(&inertia, first.period_ns as f64 * 1e-9),
            tip: tip_of(own[0]),
            answers: vec![CommandLanes::default(); n],
            start: vec![Lanes::default(); n],
            mean: (0..n).map(|i| lane(&|s| s.world.plant.tau_mean[i])).collect(),
            wanted: vec![[Lanes::default(); 3]; n],
            wanted_pose: None,
            samples: first.samples(),
            period_ns: first.period_ns,
            studies: own,
            worlds,
        })
    }

    /// Runs all to their ends. `None`: some arm left the plain case. Motions that arms share are stored for
    /// others in `kept`.
    pub(super) fn run(
        mut self,
        group: &[(usize, Simulation)],
        kept: &mut Vec<PreparedMotion>,
    ) -> Option<Vec<(Metrics, Ended)>> {
        let n = self.wanted.len();
        let motions = || group.iter().map(|(_, simulation)| simulation.control.motion());
        let first = motions().next()?;
        let mut own = Vec::new();
        let told = if motions().all(|motion| motion == first) {
            let is = |told: &PreparedMotion| told.is(first, self.period_ns, self.tip.as_ref());
            let at = kept.iter().position(is).unwrap_or_else(|| {
                kept.push(PreparedMotion::new(first, (n, self.period_ns), self.tip.as_ref(), true));
                kept.len() - 1
            });
            kept.get_mut(at..=at)?
        } else {
            let tip = self.tip.as_ref();
            own.extend(motions().map(|m| PreparedMotion::new(m, (n, self.period_ns), tip, false)));
            &mut own[..]
        };
        let settle_ns = self.studies[0].spec.settle * 1e9;
        for k in 0..self.samples {
            let t_ns = k * self.period_ns;
            let before = (t_ns as f64) < settle_ns;
            self.sample(k, t_ns as f64 * 1e-9, !before, told)?;
        }
        let arm = |(lane, study): (usize, &&Study)| {
            let [told_max, told_step_max] = self.path.most(lane);
            let ended = Ended { told_max, told_step_max, ..Ended::default() };
            (self.figures.of(lane, Measured::new(study)), ended)
        };
        Some(self.studies.iter().enumerate().map(arm).collect())
    }

    /// Sample `k`, time `t` \[s\].
    fn sample(&mut self, k: u64, t: f64, steady: bool, told: &mut [PreparedMotion]) -> Option<()> {
        self.refer(k, told)?;
        let [q, dq, ddq] = self.plant.state();
        for i in 0..self.wanted.len() {
            let torques = [self.mean[i], self.path.told(i)];
            self.sensing.sense((&self.worlds, k), i, [q[i], dq[i], ddq[i]], torques);
        }
        let seen = self.sensing.arrived();
        let plausible = seen.iter().flatten().all(|x| x.all_below(PLAUSIBLE));
        if !plausible || !self.law.answer(k == 0, (seen, &self.wanted), &mut self.answers) {
            return None;
        }
        self.figures.begin(steady, [q, dq], &self.wanted);
        if let (Some(tip), Some(wanted)) = (&mut self.tip, self.wanted_pose) {
            self.figures.tip(steady, &tip.pose(q), &pose(&wanted));
        }
        for (i, answer) in self.answers.iter().enumerate() {
            let told = self.path.pass(i, answer.tau);
            self.start[i] = self.plant.shaped(i, self.drives[i].begin(told), t);
            self.plant.demand(i, &self.drives[i]);
        }
        self.plant.go(t, self.worlds[0].steps());
        if !self.plant.within(DIVERGED) {
            return None;
        }
        let [_, _, ddq] = self.plant.state();
        for (i, answer) in self.answers.iter().enumerate() {
            self.mean[i] = self.drives[i].finish();
            if let Some(excess) = self.plant.excess(i, self.worlds[0].substeps()) {
                self.mean[i] += excess;
            }
            let acted = ActedLanes { ddq: ddq[i], start: self.start[i], mean: self.mean[i] };
            self.figures.end(steady, i, answer, acted);
        }
        self.sensing.advance();
        self.path.advance();
        Some(())
    }

    /// Writes the references of sample `k` into `wanted` and `wanted_pose`.
    fn refer(&mut self, k: u64, told: &mut [PreparedMotion]) -> Option<()> {
        if let [shared] = told {
            let (row, tip) = shared.at(k, self.samples)?;
            for (wanted, row) in self.wanted.iter_mut().zip(row) {
                *wanted = row.map(Lanes::splat);
            }
            self.wanted_pose = tip.map(|numbers| numbers.map(Lanes::splat));
            return Some(());
        }
        let mut numbers = [[0.0; Lanes::COUNT]; 12];
        let mut rows = vec![[[0.0; Lanes::COUNT]; 3]; self.wanted.len()];
        let last = told.len() - 1;
        for lane in 0..Lanes::COUNT {
            let (row, tip) = told[lane.min(last)].at(k, self.samples)?;
            for (rows, row) in rows.iter_mut().zip(row) {
                for (lanes, number) in rows.iter_mut().zip(row) {
                    lanes[lane] = *number;
                }
            }
            for (lanes, number) in numbers.iter_mut().zip(tip.into_iter().flatten()) {
                lanes[lane] = *number;
            }
        }
        for (wanted, rows) in self.wanted.iter_mut().zip(rows) {
            *wanted = rows.map(Lanes::from);
        }
        self.wanted_pose = self.tip.is_some().then(|| numbers.map(Lanes::from));
        Some(())
    }
}

/// The tip of an arm, if its description has one.
fn tip_of(study: &Study) -> Option<TipLanes> {
    let robot = &study.robot;
    robot.model.frame(&robot.tip).map(|frame| TipLanes::new(&robot.model, frame))
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use phihat::{Form, JointDesign, JointGains, PositionDesign};
    use phihat_study::Study;

    use super::Plain;
    use crate::Batch;
    use crate::metrics::{Measured, Metrics};
    use crate::simulation::{Ended, Simulation};

    /// Studies of eight arms, whose worlds differ in all that may differ.
    fn studies(more: impl Fn(usize) -> String) -> Vec<Study> {
        let one = |arm: usize| {
            let text = format!(
                r#"
                duration_s = 0.3
                seed = {arm}
                [robot]
                name = "panda"
                [spec]
                settle_s = 0.1
                error_bound_rad = 1e-3
                [gains]
                order = 2
                bandwidth_rad_s = 20.0
                damping = 1.0
                estimator_bandwidth_rad_s = {}.0
                estimator_damping = 1.0
                inertia_kg_m2 = [1.78, 2.22, 1.02, 1.28, 0.247, 0.259, 0.212]
                {}
                "#,
                60 + arm,
                more(arm)
            );
            let mut study = Study::from_text(&text, "plain.toml", "".as_ref()).unwrap();
            crate::derive_substeps(&mut study);
            study
        };
        (0..7).map(one).collect()
    }

    /// Orders 1 and 2, or from positions.
    fn gains(study: &Study, arm: usize, positions: bool) -> Vec<JointGains<f64>> {
        let one = |(i, inertia): (usize, &f64)| {
            let (kp, kd, period) = (400.0, 40.0 + arm as f64, 1e-3);
            if positions {
                let correction: &[f64] = &[0.3, 30.0, -1500.0];
                return JointGains::from_positions(&PositionDesign {
                    inertia: *inertia,
                    kp,
                    kd,
                    correction,
                    velocity_correction: &[],
                    share: 0.9,
                    delay: 1,
                    period,
                })
                .unwrap();
            }
            let a: &[f64] = if (i + arm).is_multiple_of(2) { &[70.0] } else { &[4900.0, 140.0] };
            JointGains::new(&JointDesign {
                inertia: *inertia,
                kp,
                kd,
                a,
                period,
                form: Form::Observer,
            })
            .unwrap()
        };
        study.gains.as_ref().unwrap().inertia.iter().enumerate().map(one).collect()
    }

    /// Each arm's figures from the lanes, `None` where the way for all is needed; held against those of its own run.
    fn compared(studies: &[Study], positions: bool) -> Option<()> {
        let simulation = |(arm, study): (usize, &Study)| {
            Simulation::new(study, &gains(study, arm, positions)).unwrap()
        };
        let batch = Batch::new(studies.iter().enumerate().map(simulation).collect());
        let all: Vec<&Study> = studies.iter().collect();
        let [group] = &batch.groups[..] else { return None };
        let found = Plain::of(group, &all)?.run(group, &mut Vec::new())?;
        assert_eq!(found.len(), studies.len());
        for (arm, (study, found)) in studies.iter().zip(found).enumerate() {
            let mut measured = Measured::new(study);
            let Ok(ended) = simulation((arm, study)).record(&mut measured, |_| ());
            let own: (Metrics, Ended) = (measured.metrics(), ended);
            assert!(own.0.joints.iter().all(|joint| joint.error_peak_rad > 0.0));
            assert_eq!(format!("{found:?}"), format!("{own:?}"), "arm {arm}");
        }
        Some(())
    }

    fn sines(amplitude: f64) -> String {
        format!(
            "[reference]\nkind = \"sines\"\ncenter = \"ready\"\nfade_in_s = 0.1\n[[reference.sine]]\n\
             amplitude_rad = {amplitude}\nfrequency_hz = 0.9\nphase_rad = 0.4\n"
        )
    }

    #[test]
    fn what_is_plain_is_in_lanes_from_sensor_to_figure_with_the_bits_of_each_run() {
        let world = |arm: usize, shared: bool| {
            let mut text = format!(
                "[loop]\ndelay_samples = {}\ntorque_rate_max_nm_s = {}\ntorque_max_nm = {}\n",
                arm % 3,
                [900.0, 300.0, 2000.0][arm % 3],
                [87.0, 20.0][arm % 2],
            );
            let sensor = [
                "encoder_bits = 18\nvelocity = \"differenced\"\nvelocity_filter_hz = 45.0\n",
                "encoder_bits = \"none\"\n",
                "encoder_bits = 14\nposition_noise_rad = 1e-5\nsample_jitter_s = 2e-4\n",
                "encoder_bits = 19\nvelocity = \"differenced\"\nvelocity_noise_rad_s = 0.0\n",
            ][arm % 4];
            write!(text, "[sensor]\nsample_delay_samples = 1\n{sensor}").unwrap();
            let drive = ["", "drive_bandwidth_hz = 200.0\n"][arm % 2];
            let payload = format!(
                "{{ frame = \"panda_link8\", mass_kg = 0.{}, com_m = [0.0, 0.01, 0.05] }}",
                arm + 1
            );
            write!(text, "[world]\nsubsteps = 4\n{drive}friction = \"robot\"\ncoulomb_extra_nm = 0.{arm}\npayload = \
                {payload}\n").unwrap();
            text += [
                "",
                "[world.drive]\ngain = 0.95\nripple = 0.01\nripple_per_turn = 7\n",
                "[world.drive]\ntorque_max_nm = 30.0\nno_load_speed_rad_s = 2.0\n",
            ][arm % 3];
            text + &sines(if shared { 0.1 } else { 0.04 + 0.01 * arm as f64 })
        };
        for shared in [true, false] {
            for positions in [false, true] {
                let studies = studies(|arm| world(arm, shared));
                assert!(compared(&studies, positions).is_some(), "in lanes {shared} {positions}");
            }
        }
    }

    #[test]
    fn a_law_that_takes_over_goes_arm_by_arm() {
        let studies = studies(|_| format!("[start]\ntorque_nm = \"gravity\"\n{}", sines(0.1)));
        assert!(compared(&studies, false).is_some());
    }

    #[test]
    fn what_is_not_plain_goes_the_way_for_all() {
        let cases = [
            "[supervisor]\nerror_stop_rad = 0.05\n",
            "[world.network]\nsample_loss = 0.1\n",
            "[[fault]]\nkind = \"sensor_nan\"\nstart_s = 0.02\nduration_s = 0.015\n",
        ];
        for case in cases {
            let studies =
                studies(|arm| format!("{}{}", if arm == 5 { case } else { "" }, sines(0.1)));
            assert!(compared(&studies, false).is_none(), "{case}");
        }
    }
}
