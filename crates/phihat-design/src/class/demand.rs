//! Bounds on each joint's unknown torque over a class, for a search for gains.

use phihat_certificate::extremes::larger;
use phihat_certificate::{Gains, JointRecord, Phi, PhiBasis, ReferenceBounds};
use phihat_model::Joint;
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

/// Part of a joint's error bound that no law with an integrator takes away \[rad\]: their sum is below every class
/// bound of the study.
///
/// (CM2) has `Γ^n N ≥ N` of a joint's own reading, as the answer to a reading that stays off is `Σ n_k = −1`, and
/// `Γ^τ f̄ ≥ ½ ((n_d + 1) T)² |M⁻¹| f̄`, as no torque answers an impulse before: until then its kernel is that of the
/// arm alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeastError {
    /// Largest error of a reading: half an encoder step, bias, and noise.
    pub reading_rad: f64,
    /// By forces of any course (dry friction, stiction, pushes) before a torque answers.
    pub force_rad: f64,
}

impl LeastError {
    /// Least error of each joint of a study's class, over payloads in the middle of the box.
    ///
    /// # Errors
    ///
    /// [`ClassRefusal`]: the study has no class, or the theorem does not cover it.
    pub fn of_class(study: &Study) -> Result<Vec<Self>, ClassRefusal> {
        let gains = blank(study, &vec![1.0; study.robot.joints.len()]);
        let scene = ClassScene::new(study, &gains)?;
        let n = scene.n;
        let before = (scene.delay as f64 + 1.0) * scene.period;
        let mut forces = vec![0.0; n];
        for case in &scene.cases {
            let slopes = Slopes::at(&mut scene.posed(case), &scene.class.center);
            let Some(inverse) = slopes.inverse() else { continue };
            for (i, most) in forces.iter_mut().enumerate() {
                let pull: f64 = (0..n).map(|j| inverse[(i, j)].abs() * scene.dry[j]).sum();
                *most = larger(*most, 0.5 * before * before * pull);
            }
        }
        let each = scene.reading.iter().zip(forces);
        Ok(each.map(|(reading, force)| Self { reading_rad: *reading, force_rad: force }).collect())
    }
}

impl ClassDemand {
    /// Looks for the largest rates over box, signs and payloads.
    ///
    /// # Errors
    ///
    /// [`ClassRefusal`]: the study has no class, or the theorem does not cover it.
    pub fn of(study: &Study) -> Result<Self, ClassRefusal> {
        let mut inertia = vec![1.0; study.robot.joints.len()];
        let gains = blank(study, &inertia);
        let scene = ClassScene::new(study, &gains)?;
        if let Some(case) = scene.cases.first() {
            let slopes = Slopes::at(&mut scene.posed(case), &scene.class.center);
            for (i, inertia) in inertia.iter_mut().enumerate() {
                *inertia = slopes.mass[i * scene.n + i];
            }
        }
        let gains = blank(study, &inertia);
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

/// Gains of these nominal inertias \[kg·m²\] and any law.
fn blank(study: &Study, inertia: &[f64]) -> Gains {
    let joints = study.robot.joints.iter().zip(inertia);
    let record = |(joint, inertia): (&Joint, &f64)| JointRecord {
        name: joint.name.clone(),
        inertia_kg_m2: *inertia,
        kp_per_s2: 1.0,
        kd_per_s: 1.0,
        a: Vec::new(),
        observer: None,
    };
    Gains::of(study, joints.map(record).collect(), "none")
}
