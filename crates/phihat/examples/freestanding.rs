//! Every entry point of the core at the scalars and sizes a robot uses, without `std`. The project's tests
//! compile this to an object file and look for any reference to a panic or an allocator: there is none.
#![no_std]
#![allow(
    missing_docs,
    clippy::missing_errors_doc,
    reason = "compiled to be inspected, not to be used"
)]

use phihat::{
    Command, Controller, Delay, GainError, JointDesign, JointGains, JointState, Limits,
    Measurement, Reference, update_joints,
};

macro_rules! entry_points {
    ($scalar:ty, $design:ident, $limits:ident, $resume:ident, $arm:ident, $slice:ident, $delay:ident) => {
        pub fn $design(design: &JointDesign<'_>) -> Result<JointGains<$scalar>, GainError> {
            JointGains::new(design)
        }
        pub fn $limits(t: Option<f64>, r: Option<f64>) -> Result<Limits<$scalar>, GainError> {
            Limits::new(t, r, 1e-3)
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
    };
}

entry_points!(f64, design_f64, limits_f64, resume_f64, arm_f64, slice_f64, delay_f64);
entry_points!(f32, design_f32, limits_f32, resume_f32, arm_f32, slice_f32, delay_f32);
