//! Wrong if an arm in a batch had another record, end or figure than its own simulation, in any bit but the
//! sign of a zero; or if an arm that is reported to run alone went in lanes.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::fmt::Write as _;

use phihat_sim::{Batch, Ended, Metrics, Simulation, Trace, derive_substeps};
use phihat_study::Study;

use crate::support::{columns, gains, read, run};

/// A splitmix64 generator.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next() >> 11) as f64) / (1_u64 << 53) as f64
    }

    fn odds(&mut self, one_in: u64) -> bool {
        self.next().is_multiple_of(one_in)
    }

    fn of(&mut self, texts: &[&str]) -> String {
        texts[usize::try_from(self.next() % texts.len() as u64).unwrap()].to_owned()
    }
}

pub(crate) const ARMS: [(&str, &str, &str); 4] = [
    ("planar3r", "tool", "[0.42, 0.18, 0.14]"),
    ("panda", "panda_link8", "[1.78, 2.22, 1.02, 1.28, 0.247, 0.259, 0.212]"),
    ("ur5", "tool0", "[2.0, 2.0, 1.0, 0.3, 0.3, 0.2]"),
    ("iiwa14", "lbr_iiwa_link_7", "[2.0, 3.0, 1.0, 1.5, 0.3, 0.3, 0.2]"),
];

/// Imperfections of a drive, drawn at random.
fn drive(random: &mut Random) -> String {
    random.of(&[
        "",
        "",
        "[world.drive]\ngain = 0.9\ngain_error = 0.1\n",
        "[world.drive]\nripple = 0.02\ncogging_nm = 0.1\nripple_per_turn = 9\ngain_drift_per_s = 0.5\n",
        "[world.drive]\ntorque_max_nm = 6.0\nno_load_speed_rad_s = 1.5\n",
    ])
}

/// A study of an arm, drawn: its world, loop and sensors, and what goes wrong.
pub(crate) fn drawn(random: &mut Random, (robot, tip, inertia): (&str, &str, &str)) -> String {
    let r = random;
    let mut text = format!(
        "duration_s = {:.3}\nseed = {}\n[robot]\nname = \"{robot}\"\n[spec]\nsettle_s = 0.02\nerror_bound_rad = 1e-3\n\
         [gains]\norder = 2\nbandwidth_rad_s = 20.0\ndamping = 1.0\nestimator_bandwidth_rad_s = 70.0\n\
         estimator_damping = 1.0\ninertia_kg_m2 = {inertia}\n",
        r.within(0.05, 0.11),
        r.next() % 1000,
    );
    writeln!(
        text,
        "[loop]\ndelay_samples = {}\nform = \"{}\"",
        r.next() % 4,
        r.of(&["observer", "literal"])
    )
    .unwrap();
    text += &r.of(&["", "torque_rate_max_nm_s = 900.0\n", "torque_max_nm = 9.0\n"]);
    writeln!(text, "[sensor]\nencoder_bits = {}", r.of(&["18", "14", "\"none\""])).unwrap();
    text += &r.of(&["", "velocity = \"differenced\"\nvelocity_filter_hz = 45.0\n"]);
    text += &r.of(&[
        "",
        "",
        "position_noise_rad = 1e-5\nsample_jitter_s = 2e-4\n",
        "sample_delay_samples = 2\n",
    ]);
    writeln!(text, "[world]\nfriction = \"{}\"", r.of(&["robot", "robot", "none"])).unwrap();
    writeln!(text, "coulomb_extra_nm = {}", r.of(&["0.0", "0.3", "0.1"])).unwrap();
    text += &r.of(&["", "viscous_extra_nm_s_rad = 0.7\n", "gravity_m_s2 = [3.0, 0.0, -9.0]\n"]);
    text += &r.of(&[
        "",
        "drive_bandwidth_hz = 60.0\n",
        "friction_cold_factor = 2.0\nfriction_warm_up_s = 0.05\n",
    ]);
    if r.odds(2) {
        let (mass, start) = (r.within(0.05, 1.0), r.of(&["", ", start_s = 0.03, end_s = 0.06"]));
        writeln!(
            text,
            "payload = {{ frame = \"{tip}\", mass_kg = {mass}, com_m = [0.0, 0.01, 0.05]{start} }}"
        )
        .unwrap();
    }
    text += &drive(r);
    text += &r.of(&["", "", "[world.network]\ncommand_loss = 0.1\nsample_loss = 0.1\n"]);
    text += &r.of(&["", "", "[supervisor]\nerror_stop_rad = 0.05\n"]);
    let fault = |kind: &str, size: &str| {
        format!("[[fault]]\nkind = \"{kind}\"\nstart_s = 0.02\nduration_s = 0.015\n{size}\n")
    };
    text += &match r.next() % 10 {
        0 => fault("push", "size = 6.0") + &fault("push", "size = -1.5"),
        1 => fault("payload", "size = 0.4"),
        2 => fault("friction", "size = 1.7"),
        3 => fault("sensor_nan", ""),
        4 => fault("drive_gain", "size = 0.5") + &fault("push", "size = 2.0"),
        _ => String::new(),
    };
    let amplitude = r.within(0.02, 0.08);
    text + &format!(
        "[reference]\nkind = \"sines\"\ncenter = \"ready\"\nfade_in_s = 0.1\n[[reference.sine]]\n\
         amplitude_rad = {amplitude}\nfrequency_hz = {}\nphase_rad = 0.4\n",
        r.within(0.2, 1.5)
    )
}

pub(crate) fn study(text: &str) -> Study {
    let mut study = read(text);
    derive_substeps(&mut study);
    study
}

fn simulation(study: &Study) -> Simulation {
    Simulation::new(study, &gains(study)).unwrap()
}

/// Every bit of a record, with zeros of one sign.
pub(crate) fn bits(trace: &Trace) -> Vec<u64> {
    let numbers = trace.joints.iter().flat_map(|joint| {
        let columns = [
            &joint.q,
            &joint.dq,
            &joint.ddq,
            &joint.q_desired,
            &joint.dq_desired,
            &joint.ddq_desired,
            &joint.e,
            &joint.e_integral,
            &joint.de,
            &joint.q_measured,
            &joint.dq_measured,
            &joint.tau_command,
            &joint.tau_applied,
            &joint.phi,
            &joint.phi_hat,
        ];
        columns.into_iter().flatten().map(|x| (x + 0.0).to_bits()).collect::<Vec<_>>()
    });
    let flags =
        trace.joints.iter().flat_map(|joint| joint.saturated.iter().zip(&joint.rate_limited));
    let flags = flags.map(|(torque, rate)| 2 * u64::from(*torque) + u64::from(*rate));
    numbers.chain(flags).chain(trace.t_ns.iter().copied()).collect()
}

/// Records and ends of a batch, in blocks of some size put together again.
fn streamed(batch: Batch, arms: usize, block: usize) -> (Vec<Vec<Trace>>, Vec<Ended>) {
    let mut blocks: Vec<Vec<Trace>> = vec![Vec::new(); arms];
    let each = |arm: usize, trace: &mut Trace| -> Result<(), Infallible> {
        assert!(trace.len() <= block);
        blocks[arm].push(trace.clone());
        Ok(())
    };
    let Ok(ends) = batch.stream(block, each);
    (blocks, ends)
}

/// Sets a batch of studies against each study's own run.
fn compare(studies: &[Study]) -> usize {
    let batch = || Batch::new(studies.iter().map(simulation).collect());
    let alone = batch().alone().count();
    let (blocks, ends) = streamed(batch(), studies.len(), 23);
    let all: Vec<&Study> = studies.iter().collect();
    let measured = batch().measure(&all);
    assert_eq!(measured.len(), studies.len());
    for (arm, study) in studies.iter().enumerate() {
        let own = run(study);
        let end = (&own.divergence, &own.abort, &own.told_max, &own.told_step_max);
        for ended in [&ends[arm], &measured[arm].1] {
            let Ended { divergence, abort, told_max, told_step_max, contact: _ } = ended;
            assert_eq!((divergence, abort, told_max, told_step_max), end, "arm {arm}");
        }
        let mut from = 0;
        let mut supervision = BTreeMap::<&str, usize>::new();
        for block in &blocks[arm] {
            let mut part = own.trace.clone();
            let cut = |column: &mut Vec<f64>| *column = column[from..from + block.len()].to_vec();
            for joint in &mut part.joints {
                columns(joint).into_iter().for_each(cut);
                joint.saturated = joint.saturated[from..from + block.len()].to_vec();
                joint.rate_limited = joint.rate_limited[from..from + block.len()].to_vec();
            }
            part.t_ns = part.t_ns[from..from + block.len()].to_vec();
            assert_eq!(bits(block), bits(&part), "arm {arm} from sample {from}");
            if let (Some(own), Some(found)) = (&own.trace.supervision, &block.supervision) {
                assert_eq!(found.mode, own.mode[from..from + block.len()]);
                *supervision.entry("modes").or_default() += found.mode.len();
            }
            from += block.len();
        }
        assert_eq!(from, own.trace.len(), "arm {arm}");
        let expected = Metrics::of(&own.trace, study);
        // Text, so that NaN equals itself.
        assert_eq!(format!("{:?}", measured[arm].0), format!("{expected:?}"), "arm {arm}");
    }
    alone
}

#[test]
fn every_arm_of_a_batch_is_its_own_simulation() {
    let mut random = Random(2);
    for (arm, count) in ARMS.into_iter().zip([21, 19, 9, 9]) {
        let studies: Vec<Study> = (0..count).map(|_| study(&drawn(&mut random, arm))).collect();
        assert!(compare(&studies) < count / 2, "{}: most go in lanes", arm.0);
    }
}

#[test]
fn arms_of_several_structures_and_periods_come_in_any_order() {
    let mut random = Random(5);
    let mixed = |random: &mut Random, k: usize| {
        let text = drawn(random, ARMS[k % 2]);
        study(&if k.is_multiple_of(3) {
            text.replace("[loop]\n", "[loop]\nrate_hz = 500.0\n")
        } else {
            text
        })
    };
    let studies: Vec<Study> = (0..14).map(|k| mixed(&mut random, k)).collect();
    compare(&studies);
    assert_eq!(compare(&[]), 0);
    assert_eq!(compare(&studies[..1]), 1);
}

/// An arm that leaves every plausible state is redone by itself, and its neighbours do not notice.
#[test]
fn an_arm_that_diverges_ends_as_it_does_alone() {
    let mut random = Random(11);
    let texts = (0..6).map(|k| {
        let text = drawn(&mut random, ARMS[0]).replace("duration_s = 0.", "duration_s = 0.4");
        let text =
            text.replace("torque_rate_max_nm_s = 900.0\n", "").replace("torque_max_nm = 9.0\n", "");
        match k % 2 {
            0 => text.replace(ARMS[0].2, "[90.0, 80.0, 70.0]").replace(
                "[loop]\ndelay_samples = ",
                "[loop]\ntorque_max_nm = \"none\"\ndelay_samples = 4 # ",
            ),
            _ => text,
        }
    });
    let studies: Vec<Study> = texts.map(|text| study(&text)).collect();
    let diverged = studies.iter().filter(|study| run(study).divergence.is_some()).count();
    assert!(diverged >= 2, "{diverged} diverge");
    compare(&studies);
}

#[test]
fn what_runs_alone_is_told_with_the_reason() {
    let base = drawn(&mut Random(1), ARMS[0]);
    let first = ["[[fault]]", "[world.drive]", "[reference]"].map(|section| base.find(section));
    let base = &base[..first.into_iter().flatten().min().unwrap()];
    let hold = "[reference]\nkind = \"hold\"\nq_rad = [0.4, -0.7, 0.9]\n";
    let with = |more: &str| study(&format!("{base}{more}{hold}"));
    let cases = [
        ("", None),
        ("[world.drive]\ngain = 0.9\n", None),
        ("[world.end_stops]\nstiffness_nm_rad = 100.0\n", Some("end stops")),
        ("", None),
    ];
    let studies: Vec<Study> = cases.iter().map(|(more, _)| with(more)).collect();
    let batch = Batch::new(studies.iter().map(simulation).collect());
    let told: BTreeMap<usize, &str> = batch.alone().collect();
    for (arm, (_, why)) in cases.iter().enumerate() {
        assert_eq!(told.get(&arm), why.as_ref(), "arm {arm}");
    }
    compare(&studies);
}

#[test]
fn what_is_said_of_a_block_ends_all() {
    let studies: Vec<Study> = (0..4).map(|_| study(&drawn(&mut Random(8), ARMS[0]))).collect();
    let batch = Batch::new(studies.iter().map(simulation).collect());
    let mut blocks = 0;
    let each = |_: usize, _: &mut Trace| {
        blocks += 1;
        if blocks == 3 { Err("full") } else { Ok(()) }
    };
    assert_eq!(batch.stream(10, each).unwrap_err(), "full");
    assert_eq!(blocks, 3);
}
