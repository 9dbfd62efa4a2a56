//! Imperfect signals of a study, as the class bound counts them.

use phihat::TorqueSource;
use phihat_certificate::ClassSignals;
use phihat_certificate::extremes::larger;
use phihat_study::{FaultKind, SampleStamps, Study};

use super::refusal::ClassRefusal;

/// Rows of lost commands.
#[derive(Debug, Clone, Copy)]
pub(super) struct LossSpan {
    /// Most commands in a row.
    pub(super) most: usize,
    /// Samples from the start of a row to the start of the next, at least.
    pub(super) apart: usize,
}

impl LossSpan {
    /// `None` where no command is lost.
    pub(super) fn of(study: &Study) -> Result<Option<Self>, ClassRefusal> {
        let Some(rows) = study.world.network.rows else { return Ok(None) };
        let samples = (rows.apart * 1e9 / study.control.period_ns as f64).floor();
        let most = rows.most as usize;
        if samples <= f64::from(rows.most) + f64::from(study.control.delay_samples) {
            let why = "rows of lost commands that touch (world.network.commands_lost_every_s)";
            return Err(ClassRefusal::Unsupported(why.to_owned()));
        }
        let whole =
            std::time::Duration::try_from_secs_f64(samples).map_or(u64::MAX, |own| own.as_secs());
        let apart = usize::try_from(whole).unwrap_or(usize::MAX);
        Ok(Some(Self { most, apart }))
    }
}

/// Stiction, jitter and lost commands of a study.
pub(super) fn signals(study: &Study) -> ClassSignals {
    let n = study.robot.joints.len();
    let bristles = study.world.stiction.as_ref();
    let of = |value: &dyn Fn(&phihat_study::Stiction, usize) -> f64| -> Vec<f64> {
        (0..n).map(|i| bristles.map_or(0.0, |own| value(own, i))).collect()
    };
    let rows = study.world.network.rows;
    let cogs = study.world.drive.as_ref().filter(|own| own.cogging.iter().any(|x| *x > 0.0));
    let of_drive = |value: &dyn Fn(&phihat_study::Drive, usize) -> f64| -> Vec<f64> {
        cogs.map_or_else(Vec::new, |own| (0..n).map(|i| value(own, i)).collect())
    };
    ClassSignals {
        stiction_nm: of(&|own, i| own.breakaway_ratio[i] * study.design.coulomb.1[i]),
        stiction_nm_s_rad: of(&|own, i| own.damping[i] * (1.0 + own.breakaway_ratio[i])),
        cogging_nm: of_drive(&|own, i| own.cogging[i]),
        cogging_per_turn: of_drive(&|own, i| f64::from(own.ripple_per_turn[i])),
        jitter_s: study.sensor.jitter,
        stamped: study.sensor.jitter > 0.0 && study.sensor.stamps == SampleStamps::Taken,
        commands_lost: rows.map_or(0, |rows| rows.most),
        lost_every_s: rows.map_or(0.0, |rows| rows.apart),
    }
}

/// Error of a reading by jitter \[rad\], at a speed of the reference and a velocity error.
pub(super) fn misread(signals: &ClassSignals, speed: f64, error: f64) -> f64 {
    signals.jitter_s * if signals.stamped { error } else { speed + error }
}

/// Largest cogging of a joint \[N·m\], and its largest rate at a speed \[N·m/s\]: that of `sin(n q)`.
pub(super) fn cogging(signals: &ClassSignals, joint: usize, speed: f64) -> [f64; 2] {
    let of = |list: &[f64]| list.get(joint).copied().unwrap_or(0.0);
    let size = of(&signals.cogging_nm);
    [size, size * of(&signals.cogging_per_turn) * speed]
}

/// Level of a joint's dry friction, which sticks \[N·m\].
pub(super) fn loosening(study: &Study, signals: &ClassSignals, joint: usize) -> f64 {
    larger(study.design.coulomb.1[joint], signals.stiction_nm[joint])
}

/// Largest error of a reading before it is rounded \[rad\].
pub(super) fn offset(study: &Study, joint: usize) -> f64 {
    study.sensor.position_bias[joint].abs() + study.sensor.position_noise_max[joint]
}

/// Imperfection that the theorem does not cover, with the reason.
pub(super) fn refused_signals(study: &Study) -> Option<&'static str> {
    let cogs = study.world.drive.as_ref().is_some_and(|own| own.cogging.iter().any(|x| *x > 0.0));
    let profile = &study.interface.profile;
    let rows = study.world.network.rows;
    let too_many = |most: u32| profile.losses_max.is_some_and(|losses| losses <= most);
    let listed = [
        (
            cogs && study.sensor.torque == TorqueSource::Applied,
            "`world.drive.cogging_nm` with sensor.torque = \"applied\" (the law is fed the cogging too; \
             sensor.torque = \"demanded\" is covered)",
        ),
        (
            study.sensor.jitter > 0.0
                && study.supervisor.is_some()
                && study.sensor.stamps == SampleStamps::Taken,
            "`sensor.sample_jitter_s` with a [supervisor] and stamps that tell it (the law then takes other intervals; \
             sensor.sample_stamps = \"nominal\" is covered)",
        ),
        (
            rows.is_some() && profile.torque_rate_max.is_some(),
            "`world.network.commands_lost_max` with a robot that stops on a torque step (after a row of losses the \
             step is that of all of them)",
        ),
        (
            rows.is_some_and(|rows| too_many(rows.most)),
            "`world.network.commands_lost_max` with a robot that stops on as many losses",
        ),
    ];
    listed.into_iter().find(|(is, _)| *is).map(|(_, why)| why)
}

/// The study without what is counted here.
pub(super) fn imperfections(study: &Study) -> Study {
    let mut own = study.clone();
    (own.sensor.jitter, own.world.stiction, own.world.network.rows) = (0.0, None, None);
    let perfect = own.world.drive.as_deref().is_some_and(|drive| {
        let zero = |list: &[f64]| list.iter().all(|x| x.abs() <= 0.0);
        let limits = [&drive.torque_max, &drive.torque_rate_max, &drive.no_load_speed];
        drive.gain.iter().all(|gain| (gain - 1.0).abs() <= 0.0)
            && [&drive.gain_error, &drive.gain_drift, &drive.ripple].into_iter().all(|l| zero(l))
            && limits.into_iter().all(Option::is_none)
    });
    if perfect {
        own.world.drive = None;
    }
    if own.contact.is_some() {
        until_contact(&mut own);
    }
    own
}

/// Takes what a watch looks for out of a study: the bound is one of an arm that nothing touches.
fn until_contact(study: &mut Study) {
    study.world.forces.clear();
    study.world.walls.clear();
    study.faults.retain(|fault| !matches!(fault.kind, FaultKind::Push | FaultKind::Payload));
    if let Some(payload) = &mut study.world.payload {
        (payload.start, payload.end) = (0.0, f64::INFINITY);
    }
}
