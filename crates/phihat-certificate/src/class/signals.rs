//! Imperfect signals of a study as the class bound counts them: stiction, cogging, jitter, rows of lost commands.

use phihat::TorqueSource;
use phihat_study::{Drive, FaultKind, Payload, SampleStamps, Study};

use super::document::ClassSignals;
use super::sums::LostSpacing;
use crate::Refutation;

const CLAIM: &str = "class of motions";

/// Stiction, jitter and lost commands.
///
/// # Errors
///
/// [`Refutation`]: a law that is fed the torque that acted counts cogging as its own, one that is fed stamps takes
/// other intervals.
pub(super) fn imperfect(study: &Study) -> Result<ClassSignals, Refutation> {
    let n = study.robot.joints.len();
    let mut own = ClassSignals {
        stiction_nm: vec![0.0; n],
        stiction_nm_s_rad: vec![0.0; n],
        jitter_s: study.sensor.jitter,
        stamped: study.sensor.jitter > 0.0 && study.sensor.stamps == SampleStamps::Taken,
        ..ClassSignals::default()
    };
    if let Some(bristles) = &study.world.stiction {
        for i in 0..n {
            let ratio = bristles.breakaway_ratio[i];
            own.stiction_nm[i] = ratio * study.design.coulomb.1[i];
            // |σ_1 ż| ≤ σ_1 |v| (1 + |z| σ_0/g), and bristles bend by at most ρ c/σ_0.
            own.stiction_nm_s_rad[i] = bristles.damping[i] * (1.0 + ratio);
        }
    }
    if let Some(rows) = study.world.network.rows {
        (own.commands_lost, own.lost_every_s) = (rows.most, rows.apart);
    }
    let cogs =
        study.world.drive.as_ref().is_some_and(|drive| drive.cogging.iter().any(|x| *x > 0.0));
    if let Some(drive) = study.world.drive.as_ref().filter(|_| cogs) {
        own.cogging_nm.clone_from(&drive.cogging);
        own.cogging_per_turn = drive.ripple_per_turn.iter().map(|n| f64::from(*n)).collect();
    }
    let what = "cogging is no part of the torque that the law is fed";
    Refutation::unless(
        CLAIM,
        what,
        1.0,
        0.0,
        !cogs || study.sensor.torque == TorqueSource::Demanded,
    )?;
    let known = study.supervisor.is_some() && study.sensor.stamps == SampleStamps::Taken;
    let what = "a supervisor is not fed the time at which a sample was taken early";
    Refutation::unless(CLAIM, what, own.jitter_s, 0.0, own.jitter_s <= 0.0 || !known)?;
    Ok(own)
}

/// Rows of lost commands in samples.
///
/// # Errors
///
/// [`Refutation`]: rows that touch each other, or a robot that stops on them.
pub(super) fn lost_rows(study: &Study) -> Result<Option<LostSpacing>, Refutation> {
    let Some(rows) = study.world.network.rows else { return Ok(None) };
    let profile = &study.interface.profile;
    let stops = profile.torque_rate_max.is_some()
        || profile.losses_max.is_some_and(|losses| losses <= rows.most);
    let what = "the robot does not stop on lost commands, nor on the step after them";
    Refutation::unless(CLAIM, what, 1.0, 0.0, !stops)?;
    let most = rows.most as usize;
    let period = study.control.period_ns as f64 * 1e-9;
    let apart = whole_samples(rows.apart, period);
    let delay = study.control.delay_samples as usize;
    let what = "lost rows do not touch, nor do they while commands are on their way";
    Refutation::unless(CLAIM, what, most as f64, apart as f64, apart > most + delay)?;
    Ok(Some(LostSpacing { most, apart, delay }))
}

/// Whole samples in a time, rounded down; at most 2³¹ − 1, which a machine of 32 bits counts too.
fn whole_samples(time: f64, period: f64) -> usize {
    let (mut low, mut high) = (0_usize, 1_usize << 31);
    while low + 1 < high {
        let middle = low + (high - low) / 2;
        if middle as f64 * period <= time { low = middle } else { high = middle }
    }
    low
}

/// The study without what [`imperfect`] counts, and without its supervisor.
pub(super) fn without_imperfections(study: &Study) -> Study {
    let mut own = study.clone();
    own.supervisor = None;
    own.sensor.jitter = 0.0;
    own.world.stiction = None;
    own.world.network.rows = None;
    if own.world.drive.as_deref().is_some_and(cogs_alone) {
        own.world.drive = None;
    }
    if own.contact.is_some() {
        // A claim about an arm that nothing touches: what comes from outside, and a payload that changes, end it.
        own.world.forces = Vec::new();
        own.world.walls = Vec::new();
        let outside = [FaultKind::Push, FaultKind::Payload];
        own.faults = own.faults.iter().filter(|f| !outside.contains(&f.kind)).cloned().collect();
        if let Some(payload) = own.world.payload.take() {
            own.world.payload = Some(Payload { start: 0.0, end: f64::INFINITY, ..payload });
        }
    }
    own
}

/// Returns true if cogging is all that is imperfect of a drive.
fn cogs_alone(drive: &Drive) -> bool {
    let zero = |list: &[f64]| list.iter().all(|x| x.abs() <= 0.0);
    let one = drive.gain.iter().all(|gain| (gain - 1.0).abs() <= 0.0);
    let limits = [&drive.torque_max, &drive.torque_rate_max, &drive.no_load_speed];
    one && zero(&drive.gain_error)
        && zero(&drive.gain_drift)
        && zero(&drive.ripple)
        && limits.iter().all(|limit| limit.is_none())
}
