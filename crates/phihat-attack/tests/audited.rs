//! Records in which exactly one assumption is broken, and clean ones. Wrong if the audit did not name the assumption,
//! or named one of a clean record.

use std::path::Path;

use phihat::Form;
use phihat_attack::Dice;
use phihat_design::requested_gains;
use phihat_session::{Assumption, Audit, audited};
use phihat_sim::{SimError, Simulation};
use phihat_study::Study;

/// Records of either kind: so many in the gate, so many with `PHIHAT_ALL`.
const RECORDS: (u64, u64) = (24, 200);

/// A study's figures.
struct Figures {
    rotor: [f64; 3],
    payload: f64,
    coulomb: f64,
    delay: u32,
    bits: u32,
    noise: f64,
    sample_loss: f64,
    command_loss: f64,
    gain: f64,
    torque_max: Option<f64>,
    amplitude: f64,
    frequency: [f64; 3],
    bandwidth: f64,
}

impl Figures {
    fn draw(dice: &mut Dice) -> Self {
        Self {
            rotor: [0, 1, 2].map(|_| dice.between(0.05, 0.15)),
            payload: if dice.chance(0.5) { 0.0 } else { dice.between(0.2, 0.8) },
            coulomb: dice.between(0.02, 0.2),
            delay: dice.pick(&[0, 1, 1, 2]),
            bits: dice.pick(&[17, 18, 19, 20]),
            noise: 0.0,
            sample_loss: 0.0,
            command_loss: 0.0,
            gain: 1.0,
            torque_max: None,
            amplitude: dice.between(0.2, 0.4),
            frequency: [0, 1, 2].map(|_| dice.between(0.3, 0.8)),
            bandwidth: dice.between(12.0, 18.0),
        }
    }

    fn text(&self) -> String {
        let [a, b, c] = self.frequency;
        let limit = self.torque_max.map_or("\"none\"".to_owned(), |most| format!("{most:?}"));
        format!(
            "duration_s = 5.0\nseed = 7\n[robot]\nname = \"planar3r\"\narmature_kg_m2 = {:?}\n[spec]\nsettle_s = 1.0\n\
             [gains]\nbandwidth_rad_s = {:?}\nestimator_bandwidth_rad_s = {:?}\ninertia_kg_m2 = [0.5, 0.25, 0.15]\n\
             [loop]\ndelay_samples = {}\ntorque_max_nm = {limit}\nbeyond_drives = \"allow\"\n\
             [sensor]\nencoder_bits = {}\nposition_noise_rad = {:?}\nvelocity = \"differenced\"\n\
             velocity_filter_hz = 100.0\n[world]\nfriction = \"none\"\ncoulomb_extra_nm = {:?}\nsubsteps = SUBSTEPS\n\
             [world.network]\nsample_loss = {:?}\ncommand_loss = {:?}\n[world.drive]\ngain = {:?}\n{}\
             [start]\ntorque_nm = \"gravity\"\n[reference]\nkind = \"sines\"\ncenter = \"ready\"\nfade_in_s = 0.5\n\
             [[reference.sine]]\namplitude_rad = {:?}\nfrequency_hz = [{a}, {b}, {c}]\n\
             [[reference.sine]]\namplitude_rad = 0.05\nfrequency_hz = [{}, {}, {}]\nphase_rad = [0.3, 1.1, 2.0]\n",
            self.rotor,
            self.bandwidth,
            2.5 * self.bandwidth,
            self.delay,
            self.bits,
            self.noise,
            self.coulomb,
            self.sample_loss,
            self.command_loss,
            self.gain,
            if self.payload > 0.0 {
                format!("[world.payload]\nmass_kg = {:?}\n", self.payload)
            } else {
                String::new()
            },
            self.amplitude,
            3.1 * a,
            2.7 * b,
            2.3 * c,
        )
    }

    fn study(&self) -> Study {
        self.study_of(1)
    }

    fn study_of(&self, substeps: u32) -> Study {
        let text = self.text().replace("SUBSTEPS", &substeps.to_string());
        Study::from_text(&text, "study.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
    }

    /// Breaks one assumption about the world.
    fn broken(&mut self, dice: &mut Dice) -> Assumption {
        let all = [
            Assumption::Inertia,
            Assumption::Payload,
            Assumption::Friction,
            Assumption::Delay,
            Assumption::Encoder,
            Assumption::Noise,
            Assumption::Losses,
            Assumption::TorqueEcho,
            Assumption::Limits,
            Assumption::Reference,
        ];
        let which = dice.pick(&all);
        match which {
            Assumption::Inertia => {
                let joint = dice.below(3);
                self.rotor[joint] += dice.between(0.25, 0.5);
            }
            Assumption::Payload => self.payload += dice.between(0.4, 1.0),
            Assumption::Friction => self.coulomb += dice.between(0.2, 0.5),
            Assumption::Delay => self.delay += dice.pick(&[1, 2]),
            Assumption::Encoder => self.bits -= dice.pick(&[1, 2, 3]),
            Assumption::Noise => {
                let quantum = core::f64::consts::TAU / 2.0_f64.powi(self.bits.cast_signed());
                self.noise = quantum * dice.between(2.0, 4.0);
            }
            Assumption::Losses if dice.chance(0.5) => self.sample_loss = dice.between(0.005, 0.03),
            Assumption::Losses => self.command_loss = dice.between(0.005, 0.03),
            Assumption::TorqueEcho => {
                self.gain = dice.pick(&[-1.0, 1.0]) * dice.between(0.02, 0.08) + 1.0;
            }
            Assumption::Limits => self.torque_max = Some(dice.between(0.5, 2.0)),
            _ => self.amplitude *= dice.between(1.05, 1.2),
        }
        which
    }
}

/// The audit of a record of one world against the study of another; `None`: the gains do not hold that arm.
fn found(assumed: &Figures, world: &Figures) -> Option<Audit> {
    let mut substeps = 1;
    let trace = loop {
        let study = world.study_of(substeps);
        let gains = requested_gains(&study)?;
        let names = study.robot.joint_names();
        let law = gains.joint_gains(&names, study.control.period_ns, Form::Observer).ok()?;
        match Simulation::new(&study, &law) {
            Ok(simulation) => {
                let done = simulation.run(|_| ());
                if done.divergence.is_some() {
                    return None;
                }
                break done.trace;
            }
            Err(SimError::TooStiff { needed, .. }) if needed <= 24 => substeps = needed + 2,
            Err(_) => return None,
        }
    };
    let study = assumed.study();
    let gains = requested_gains(&study)?;
    Some(audited(&study, Some(&gains), &trace))
}

#[test]
fn the_one_broken_assumption_is_named_and_none_of_a_clean_record() {
    let all = std::env::var_os("PHIHAT_ALL").is_some();
    let wanted = if all { RECORDS.1 } else { RECORDS.0 };
    let (mut named, mut others, mut records, mut index) = (0_u64, 0_u64, 0_u64, 0);
    let mut missed = Vec::new();
    let mut accused = Vec::new();
    while records < wanted {
        index += 1;
        let mut dice = Dice::new(47, index);
        let assumed = Figures::draw(&mut dice);
        let mut world = Figures::draw(&mut Dice::new(47, index));
        let which = world.broken(&mut dice);
        let (Some(clean), Some(broken)) = (found(&assumed, &assumed), found(&assumed, &world))
        else {
            continue;
        };
        records += 1;
        for row in clean.broken() {
            accused.push(format!("{index}: {row:?}"));
        }
        let rows: Vec<_> = broken.broken().map(|row| row.assumption).collect();
        if rows.contains(&which) {
            named += 1;
        } else {
            let own: Vec<_> = broken.rows.iter().filter(|row| row.assumption == which).collect();
            missed.push(format!("{index}: {which:?}: {own:#?}"));
        }
        others += u64::from(rows.iter().any(|row| *row != which));
    }
    println!(
        "{records} records: {named} named, {others} with others too; {} accusations of clean ones",
        accused.len()
    );
    println!("{missed:#?}");
    assert!(accused.is_empty(), "{accused:#?}");
    assert!(100 * named >= 98 * records, "{named} of {records}");
}
