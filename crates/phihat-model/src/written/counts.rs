//! Number of operations of the dynamics, counted exactly. Fails if a change makes the dynamics do more (or
//! less: then the table is to be updated), whatever the load of the machine; or if the recorded operations,
//! done again one by one, give other bits than the dynamics themselves.
//!
//! *Performed* are the operations of the one-arm code for any arm, four lanes counted as four. *Live* are
//! those that remain once products with 0 and 1 are folded, repeated ones are computed once, and those that
//! no result needs are left out: the operations of code written out for this one arm. Signs and sines are not
//! counted.

use super::{Program, scattered};
use crate::{Model, Robot, Scalar, Workspace};

/// One of the three algorithms, on any number type.
#[derive(Debug, Clone, Copy)]
enum Algorithm {
    ForwardDynamics,
    InverseDynamics,
    MassMatrix,
}

impl Algorithm {
    fn run<S: Scalar>(self, model: &Model, inputs: &[S]) -> Vec<S> {
        let n = model.joint_count();
        let ws = &mut Workspace::new(model);
        let [q, dq, last] = [0, 1, 2].map(|part| &inputs[part * n..][..n]);
        let zeros = |len: usize| vec![S::splat(0.0); len];
        let mut out = zeros(n);
        match self {
            Self::ForwardDynamics => model.forward_dynamics(ws, q, dq, last, &mut out),
            Self::InverseDynamics => model.inverse_dynamics(ws, q, dq, last, &mut out),
            Self::MassMatrix => {
                out = zeros(n * n);
                model.mass_matrix(ws, q, &mut out);
            }
        }
        out
    }
}

/// Live and performed operations.
fn counts(arm: &str, algorithm: Algorithm) -> (usize, usize) {
    let model = Robot::named(arm).unwrap().model;
    let n = model.joint_count();
    let program = Program::of(3 * n, |inputs| algorithm.run(&model, inputs));
    for round in 0..20 {
        let inputs = scattered(round, 3 * n);
        let (again, itself) = (program.run(&inputs), algorithm.run(&model, &inputs));
        // Folding leaves no sign of a zero.
        let bits =
            |values: &[f64]| -> Vec<u64> { values.iter().map(|x| (x + 0.0).to_bits()).collect() };
        assert_eq!(bits(&again), bits(&itself), "{arm}: {algorithm:?}");
    }
    (program.operations(), program.performed)
}

#[test]
fn operations_of_the_dynamics_are_counted_exactly() {
    use Algorithm::{ForwardDynamics, InverseDynamics, MassMatrix};
    let all = [ForwardDynamics, InverseDynamics, MassMatrix];
    for (arm, expected) in [
        ("panda", [(1_353, 3_828), (722, 1_255), (429, 2_054)]),
        ("iiwa14", [(1_689, 3_828), (837, 1_255), (645, 2_054)]),
        ("ur5", [(818, 3_267), (454, 1_070), (239, 1_784)]),
    ] {
        let found = all.map(|algorithm| counts(arm, algorithm));
        assert_eq!(found, expected, "{arm}: live and performed, of {all:?}");
    }
}
