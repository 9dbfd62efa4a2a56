//! 03: a robot's description and its rigid-body dynamics.
//!
//! `Robot` is what the files say. `Model` computes; it is constant, so threads may share it. `Workspace` is the scratch
//! memory of one thread: nothing is allocated after it is made.
//!
//! Run it: `cargo run -p phihat-examples --example 03_robot`

use std::error::Error;

use phihat_model::{Body, Robot, Workspace};

fn main() -> Result<(), Box<dyn Error>> {
    println!("arms at hand: {}", Robot::names().join(", "));
    let panda = Robot::named("panda")?;
    let q = panda.poses.get("ready").ok_or("no pose of that name")?;
    let rest = [0.0; 7];

    // `model` has links and joints only; `plant_model()` adds the rotors' inertia.
    let model = &panda.model;
    let mut ws = Workspace::new(model);

    // Held by gravity's torque and nothing else, an arm at rest stays at rest.
    let (mut gravity, mut ddq) = ([0.0; 7], [1.0; 7]);
    model.gravity_torque(&mut ws, q, &mut gravity);
    model.forward_dynamics(&mut ws, q, &rest, &gravity, &mut ddq);
    assert!(ddq.iter().all(|ddq| ddq.abs() < 1e-12));

    // M(q) q̈ + C(q, q̇) q̇ + g(q) = τ, all in one call, and the same from its terms.
    let dq = [0.3, -0.2, 0.5, 0.1, -0.4, 0.2, 0.6];
    let ddq = [1.0, 0.5, -0.5, 2.0, 0.0, -1.0, 0.3];
    let (mut tau, mut bias, mut mass) = ([0.0; 7], [0.0; 7], [0.0; 49]);
    model.inverse_dynamics(&mut ws, q, &dq, &ddq, &mut tau);
    model.bias(&mut ws, q, &dq, &mut bias);
    model.mass_matrix(&mut ws, q, &mut mass);
    for i in 0..7 {
        let inertial: f64 = (0..7).map(|j| mass[7 * i + j] * ddq[j]).sum();
        assert!((inertial + bias[i] - tau[i]).abs() < 1e-12);
    }

    // Rotor inertia and friction are in the description; they count where you ask for them.
    let plant = panda.plant_model();
    let mut whole = [0.0; 7];
    plant.inverse_dynamics(&mut Workspace::new(&plant), q, &dq, &ddq, &mut whole);
    for (i, joint) in panda.joints.iter().enumerate() {
        let rotor = whole[i] - tau[i];
        assert!((rotor - joint.armature * ddq[i]).abs() < 1e-12);
        let own = &joint.friction;
        let smooth = own.sigmoid.map_or(0.0, |sigmoid| sigmoid.torque(dq[i]));
        let friction = own.viscous * dq[i] + own.coulomb * dq[i].signum() + smooth;
        println!("{}: rotor {rotor:+.2} N·m, friction {friction:+.2} N·m", joint.name);
    }

    // Where the flange is.
    let tip = model.frame(&panda.tip).ok_or("no such frame")?;
    model.forward_kinematics(&mut ws, q);
    let [x, y, z] = model.pose(&ws, tip).p;
    println!("{} is at {x:.3}, {y:.3}, {z:.3} m", panda.tip);

    // With a kilogram welded to the flange, joint 2 carries more.
    let kilogram = Body { mass: 1.0, com: [0.0, 0.0, 0.05], inertia: [0.0; 6] };
    let loaded = panda.model.clone().with_payload_on("panda_link8", &kilogram)?;
    let mut more = [0.0; 7];
    loaded.gravity_torque(&mut Workspace::new(&loaded), q, &mut more);
    let extra = more[1] - gravity[1];
    println!("with 1 kg, joint 2 holds {extra:+.2} N·m besides");
    assert!(extra.abs() > 1.0);
    Ok(())
}

#[test]
fn runs() -> Result<(), Box<dyn Error>> {
    main()
}
