//! Every entry point of the core at the scalars and sizes a robot uses, without `std`. The project's tests
//! compile this to an object file and look for any reference to a panic or an allocator: there is none.
#![no_std]
#![allow(
    missing_docs,
    clippy::missing_errors_doc,
    reason = "compiled to be inspected, not to be used"
)]

use phihat::{
    Answer, Command, Controller, Delay, Events, GainError, JointDesign, JointGains, JointMap,
    JointMapError, JointOptions, JointState, Limits, LinearLaw, Log, Measurement, Memories,
    ModeEvents, MotionLimits, OptionError, Options, Reference, Report, Request, Rules, Sample,
    Shaper, Supervisor, SupervisorState, Transition, Unwrap, VelocityFilter, VelocityState,
    next_mode, supervise, update_joints,
};

macro_rules! entry_points {
    ($scalar:ty, $design:ident, $limits:ident, $command:ident, $resume:ident, $arm:ident, $slice:ident, $delay:ident,
        $supervised:ident) => {
        pub fn $design(design: &JointDesign<'_>) -> Result<JointGains<$scalar>, GainError> {
            JointGains::new(design)
        }
        pub fn $limits(t: Option<f64>, r: Option<f64>) -> Result<Limits<$scalar>, GainError> {
            Limits::new(t, r, 1e-3)
        }
        pub fn $command(limits: &Limits<$scalar>, tau: $scalar) -> Command<$scalar> {
            limits.command(tau, 0.0)
        }
        pub fn $resume(
            gains: &JointGains<$scalar>,
            state: &mut JointState<$scalar>,
            m: &Measurement<$scalar>,
            r: &Reference<$scalar>,
        ) -> bool {
            gains.resume(state, m, r, 1.0)
        }
        pub fn $arm(
            controller: &Controller<$scalar, 7>,
            states: &mut [JointState<$scalar>; 7],
            m: &[Measurement<$scalar>; 7],
            r: &[Reference<$scalar>; 7],
        ) -> [Command<$scalar>; 7] {
            controller.update(states, m, r)
        }
        pub fn $slice(
            gains: &[JointGains<$scalar>],
            states: &mut [JointState<$scalar>],
            m: &[Measurement<$scalar>],
            r: &[Reference<$scalar>],
            commands: &mut [Command<$scalar>],
        ) -> usize {
            update_joints(gains, states, m, r, commands)
        }
        pub fn $delay(line: &mut Delay<$scalar>, value: $scalar) -> $scalar {
            line.pass(value)
        }
        pub mod $supervised {
            use super::*;
            pub fn linear(gains: &JointGains<$scalar>) -> LinearLaw<$scalar> {
                gains.linear()
            }
            pub fn build(
                gains: [JointGains<$scalar>; 7],
                joints: &[JointOptions<$scalar>; 7],
                options: &Options,
            ) -> Result<Supervisor<$scalar, 7>, OptionError> {
                Supervisor::new(gains, joints, options)
            }
            pub fn step(
                arm: &Supervisor<$scalar, 7>,
                state: &mut SupervisorState<$scalar, 7>,
                sample: &Sample<'_, $scalar>,
                request: &Request<'_, $scalar>,
            ) -> Answer<$scalar, 7> {
                arm.step(state, sample, request)
            }
            pub fn slices(
                rules: Rules<'_, $scalar>,
                state: Memories<'_, $scalar>,
                sample: &Sample<'_, $scalar>,
                request: &Request<'_, $scalar>,
                commands: &mut [Command<$scalar>],
            ) -> Report {
                supervise(rules, state, sample, request, commands)
            }
            pub fn change(
                arm: &mut Supervisor<$scalar, 7>,
                state: &mut SupervisorState<$scalar, 7>,
                gains: [JointGains<$scalar>; 7],
            ) -> Result<(), OptionError> {
                arm.change_gains(state, gains)
            }
            pub fn shaper(l: &MotionLimits) -> Result<Shaper<$scalar>, GainError> {
                Shaper::new(l, 1e-3)
            }
            pub fn shape(
                shaper: &Shaper<$scalar>,
                now: &Reference<$scalar>,
                target: &Reference<$scalar>,
            ) -> Reference<$scalar> {
                shaper.step(now, target)
            }
            pub fn unwrap_angle(angle: &mut Unwrap<$scalar>, reading: $scalar) -> $scalar {
                angle.take(reading)
            }
            pub fn filter(hz: Option<f64>) -> Result<VelocityFilter<$scalar>, GainError> {
                VelocityFilter::new(hz, 1e-3)
            }
            pub fn velocity(
                filter: &VelocityFilter<$scalar>,
                state: &mut VelocityState<$scalar>,
                q: $scalar,
            ) -> $scalar {
                filter.estimate(state, q, 1e-3)
            }
            pub fn gather(map: &JointMap<7>, message: &[$scalar]) -> Option<[$scalar; 7]> {
                map.gather(message)
            }
            pub fn scatter(map: &JointMap<7>, v: &[$scalar; 7], message: &mut [$scalar]) -> bool {
                map.scatter(v, message)
            }
        }
    };
}

entry_points!(
    f64,
    design_f64,
    limits_f64,
    command_f64,
    resume_f64,
    arm_f64,
    slice_f64,
    delay_f64,
    supervised_f64
);
entry_points!(
    f32,
    design_f32,
    limits_f32,
    command_f32,
    resume_f32,
    arm_f32,
    slice_f32,
    delay_f32,
    supervised_f32
);

pub fn mode(mode: phihat::Mode, events: ModeEvents) -> Transition {
    next_mode(mode, events)
}

pub fn names(own: &[&str; 7], message: &[&str]) -> Result<JointMap<7>, JointMapError> {
    JointMap::new(own, message)
}

pub fn record(log: &mut Log<Events, 64>, events: Events) -> Option<Events> {
    log.push(events);
    log.pop()
}
