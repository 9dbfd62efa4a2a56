//! Wrong if an arm in a lane did not move as it does alone, or a lane's sine or exponential had other bits
//! than one number's.

use phihat_model::{Body, Lanes, Lockstep, LockstepError, Model, Robot, Scalar, Workspace};

use crate::support::{Random, robots, tree};

/// The bits of a number, where zero has no sign.
fn bits(x: f64) -> u64 {
    (x + 0.0).to_bits()
}

fn body(random: &mut Random) -> Body {
    let d = [0; 3].map(|_| random.within(1e-4, 0.01));
    let com = [0; 3].map(|_| random.within(-0.1, 0.1));
    let inertia = [d[1] + d[2], 0.0, 0.0, d[0] + d[2], 0.0, d[0] + d[1]];
    Body { mass: random.within(0.0, 3.0), com, inertia }
}

/// This arm with a body at its tip, rotors and gravity of its own.
fn varied(model: &Model, tip: &str, random: &mut Random) -> Model {
    let n = model.joint_count();
    let rotors: Vec<f64> = (0..n).map(|_| random.within(0.0, 0.5)).collect();
    let gravity = [0; 3].map(|_| random.within(-9.81, 9.81));
    let model = model.clone().with_armature(&rotors).unwrap().with_gravity(gravity);
    model.with_payload_on(tip, &body(random)).unwrap()
}

/// Compares all lanes on random states with the arms one by one.
fn compare(models: &[Model], arms: &Lockstep, random: &mut Random, states: usize, size: f64) {
    let n = models[0].joint_count();
    for _ in 0..states {
        let states: Vec<[Vec<f64>; 3]> =
            models.iter().map(|_| [size, 2.0, 40.0].map(|size| random.vector(n, size))).collect();
        let lanes = |what: usize, i: usize| {
            Lanes::from(core::array::from_fn(|k| states[k.min(models.len() - 1)][what][i]))
        };
        let side = |what: usize| (0..n).map(|i| lanes(what, i)).collect::<Vec<_>>();
        let mut ddq = vec![Lanes::splat(0.0); n];
        arms.forward_dynamics(&side(0), &side(1), &side(2), &mut ddq);
        for (k, (model, [q, dq, tau])) in models.iter().zip(&states).enumerate() {
            let (mut ws, mut alone) = (Workspace::new(model), vec![0.0; n]);
            model.forward_dynamics(&mut ws, q, dq, tau, &mut alone);
            for i in 0..n {
                let found = <[f64; Lanes::COUNT]>::from(ddq[i])[k];
                assert_eq!(bits(found), bits(alone[i]), "lane {k} joint {i}: {found} {}", alone[i]);
            }
        }
    }
}

#[test]
fn arms_with_own_loads_rotors_and_gravity_move_as_they_do_alone() {
    let mut random = Random(21);
    for robot in robots() {
        for arms in [1, 3, 8] {
            let models: Vec<Model> =
                (0..arms).map(|_| varied(&robot.model, &robot.tip, &mut random)).collect();
            let side: Vec<&Model> = models.iter().collect();
            let lockstep = Lockstep::new(&side).unwrap();
            assert_eq!(lockstep.joint_count(), models[0].joint_count());
            compare(&models, &lockstep, &mut random, 40, 3.0);
            // Beyond the range of the sines in lanes.
            compare(&models, &lockstep, &mut random, 2, 3e5);
        }
    }
}

/// Random chains: sliders, oblique and nearly parallel axes, fixed links; some are other arms of the same joints.
#[test]
fn random_chains_of_any_joints_move_as_they_do_alone() {
    let mut random = Random(7);
    let mut seen = 0;
    for seed in 1..=60 {
        let chain = tree(seed, 3 + usize::from(seed) % 7, false);
        let tip = chain.bodies.last().unwrap().0.clone();
        if chain.model.joint_count() == 0 {
            continue;
        }
        let models: Vec<Model> = (0..8).map(|_| varied(&chain.model, &tip, &mut random)).collect();
        let side: Vec<&Model> = models.iter().collect();
        match Lockstep::new(&side) {
            Ok(lockstep) => compare(&models, &lockstep, &mut random, 5, 2.0),
            Err(LockstepError::Segments(_)) => continue,
            Err(other) => panic!("{other}"),
        }
        seen += 1;
    }
    assert!(seen > 40, "{seen} chains");
}

/// Three joints each, of other lengths and tilts: what is a branch for one arm is none for all.
#[test]
fn arms_of_other_dimensions_share_lanes() {
    let joint = |k: usize, rpy: [f64; 3], xyz: [f64; 3]| {
        let ([r, p, y], [a, b, c]) = (rpy, xyz);
        format!(
            "<link name=\"l{k}\"><inertial><origin xyz=\"0.1 0.02 {k}e-2\"/><mass value=\"{k}.5\"/>\
             <inertia ixx=\"0.02\" iyy=\"0.03\" izz=\"0.04\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\
             <joint name=\"j{k}\" type=\"revolute\"><parent link=\"l{}\"/><child link=\"l{k}\"/>\
             <origin rpy=\"{r} {p} {y}\" xyz=\"{a} {b} {c}\"/><axis xyz=\"0 0 1\"/>\
             <limit effort=\"9\" velocity=\"9\" lower=\"-3\" upper=\"3\"/></joint>",
            k - 1
        )
    };
    let mut random = Random(3);
    let half = core::f64::consts::FRAC_PI_2;
    let mut models = Vec::new();
    for tilt in [0.0, half, -half, 0.7, 0.0, half, 2.0, half] {
        let mut urdf = "<robot name=\"r\"><link name=\"l0\"/>".to_owned();
        for k in 1..=3 {
            let xyz = if random.within(0.0, 1.0) < 0.4 { [0.0; 3] } else { [0.3, 0.0, 0.1] };
            urdf += &joint(k, [if k == 2 { tilt } else { 0.0 }, 0.0, 0.0], xyz);
        }
        models.push(Robot::from_text(&(urdf + "</robot>"), None, "three.urdf").unwrap().model);
    }
    let side: Vec<&Model> = models.iter().collect();
    compare(&models, &Lockstep::new(&side).unwrap(), &mut random, 40, 3.0);
}

#[test]
fn what_is_not_alike_is_told() {
    let [panda, ur5] = ["panda", "ur5"].map(|name| Robot::named(name).unwrap().model);
    let new = |models: &[&Model]| Lockstep::new(models).unwrap_err();
    assert_eq!(new(&[]), LockstepError::Arms(0));
    assert_eq!(new(&[&panda; 9]).to_string(), "9 arms; lanes hold from 1 to 8");
    assert_eq!(new(&[&panda, &panda, &ur5]), LockstepError::Structure(2));
    let forked = (1..=40).map(|seed| tree(seed, 8, true).model);
    let refused =
        forked.filter(|model| matches!(Lockstep::new(&[model]), Err(LockstepError::Fork(0))));
    assert!(refused.count() > 20);
}

fn each(angles: [f64; 8], lanes: impl Fn(Lanes) -> Lanes, one: impl Fn(f64) -> f64) {
    let found = <[f64; 8]>::from(lanes(Lanes::from(angles)));
    for (x, found) in angles.into_iter().zip(found) {
        let expected = one(x);
        let same = found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan());
        assert!(same, "{x:e}: {found:e} in lanes, {expected:e} alone");
    }
}

#[test]
fn sines_and_exponentials_in_lanes_have_the_bits_of_one_number() {
    let mut random = Random(99);
    let ln2 = core::f64::consts::LN_2;
    // Sizes of all kinds, what is near the branches of the exponential, and what is no number.
    let edges = [2.0_f64.powi(-28), 0.5 * ln2, 1.5 * ln2, 699.9, 708.4, 745.2, 1e5, f64::INFINITY];
    for round in 0..20_000 {
        let size = 10.0_f64.powf(random.within(-12.0, 3.0));
        let mut angles = [0; 8].map(|_| random.within(-size, size));
        if round % 3 == 0 {
            let near = edges[random.below(8)] * if round % 2 == 0 { 1.0 } else { -1.0 };
            angles = angles.map(|_| near * (1.0 + random.within(-4e-7, 4e-7)));
        }
        if round % 50 == 0 {
            angles[random.below(8)] = [f64::NAN, 0.0, -0.0, 1e6][random.below(4)];
        }
        each(angles, Lanes::exp, libm::exp);
        each(angles, |x| x.sin_cos().0, |x| Scalar::sin_cos(x).0);
        each(angles, |x| x.sin_cos().1, |x| Scalar::sin_cos(x).1);
        each(angles, Lanes::sqrt, f64::sqrt);
        each(angles, |x| -x.abs(), |x| -x.abs());
    }
    // Next to each other across every branch, to the last bit.
    for edge in edges {
        for step in -40..40_i64 {
            let at = f64::from_bits(edge.to_bits().wrapping_add_signed(step << 32));
            each([at; 8], Lanes::exp, libm::exp);
            each([-at; 8], Lanes::exp, libm::exp);
        }
    }
}
