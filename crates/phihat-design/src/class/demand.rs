//! Bounds on each joint's unknown torque over a class, for a search for gains.

use phihat_certificate::{Gains, JointRecord, Phi, PhiBasis, ReferenceBounds};
use phihat_study::Study;

use super::extent::{ClassPaceLimits, Rates};
use super::refusal::ClassRefusal;
use super::scene::ClassScene;
use super::slopes::Slopes;

/// Unknown torque of every motion of a class: what a search for gains reckons with.
///
/// # Not claimed
///
/// The jerk's part is of the inertia in the middle of the box; [`class_bound`](super::class_bound) is what bounds.
#[derive(Debug, Clone)]
pub struct ClassDemand {
    rate: Vec<f64>,
    jump: Vec<f64>,
    motion: Vec<ReferenceBounds>,
}

impl ClassDemand {
    /// Looks for the largest rates over box, signs and payloads.
    ///
    /// # Errors
    ///
    /// [`ClassRefusal`]: the study has no class, or the theorem does not cover it.
    pub fn of(study: &Study) -> Result<Self, ClassRefusal> {
        let blank = |inertia_kg_m2: f64, name: &str| JointRecord {
            name: name.to_owned(),
            inertia_kg_m2,
            kp_per_s2: 1.0,
            kd_per_s: 1.0,
            a: Vec::new(),
            observer: None,
        };
        let of = |inertia: &[f64]| {
            let joints = study.robot.joints.iter().zip(inertia);
            let records = joints.map(|(joint, inertia)| blank(*inertia, &joint.name)).collect();
            Gains::of(study, records, "none")
        };
        let mut inertia = vec![1.0; study.robot.joints.len()];
        let gains = of(&inertia);
        let scene = ClassScene::new(study, &gains)?;
        if let Some(case) = scene.cases.first() {
            let slopes = Slopes::at(&mut scene.posed(case), &scene.class.center);
            for (i, inertia) in inertia.iter_mut().enumerate() {
                *inertia = slopes.mass[i * scene.n + i];
            }
        }
        let gains = of(&inertia);
        let scene = ClassScene::new(study, &gains)?;
        let pace = ClassPaceLimits::of(scene.class);
        let rates = Rates::of(&scene, &pace);
        let n = scene.n;
        let rate = |i: usize| rates.whole[i] + rates.jerk[i] + scene.slope[i] * pace.a[i];
        let motion = |i: usize| ReferenceBounds {
            velocity_rad_s: pace.v[i],
            acceleration_rad_s2: pace.a[i],
            jerk_rad_s3: pace.j[i],
        };
        Ok(Self {
            rate: (0..n).map(rate).collect(),
            jump: scene.dry.clone(),
            motion: (0..n).map(motion).collect(),
        })
    }

    /// Bounds on a joint's `φ`.
    pub fn phi(&self, joint: usize) -> Phi {
        Phi {
            basis: PhiBasis::Reference,
            source: "every motion of the class: box, signs and payloads searched".to_owned(),
            size_nm: None,
            rate_nm_s: self.rate[joint],
            jump_nm: self.jump[joint],
            motion: Some(self.motion[joint]),
        }
    }
}
