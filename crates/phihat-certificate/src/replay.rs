//! Postures and payloads that a file names, looked at again in the study's arm.

use phihat_model::{Body, Rotor, Workspace};
use phihat_study::{PayloadSet, Study};

use crate::check::agree::agrees;
use crate::loaded::loaded;
use crate::{CoupledGains, Refutation, Witness};

const CLAIM: &str = "coupled gains";

/// Rounding of a mass matrix, and of a payload at the edge of its set.
const SAME: f64 = 1e-9;

impl CoupledGains {
    /// Every witness has the inertia that the study's arm has there, with a payload of the study.
    ///
    /// # Errors
    ///
    /// The first [`Refutation`].
    pub(crate) fn replay(&self, study: &Study) -> Result<(), Refutation> {
        let n = study.robot.joints.len();
        let set = &study.design.payload;
        for witness in &self.witnesses {
            let nothing = Body { mass: 0.0, com: [0.0; 3], inertia: [0.0; 6] };
            let held = witness.payload.as_ref();
            let body = held.map_or(nothing, |held| Body {
                mass: held.mass_kg,
                com: held.com_m,
                inertia: held.inertia_kg_m2,
            });
            let same = held.is_none_or(|held| held.frame == set.frame);
            Refutation::unless(CLAIM, "payload's frame is the study's", 0.0, 1.0, same)?;
            within(CLAIM, set, &body)?;
            let model = loaded(study, (Rotor::Stated, &body), &set.frame)?;
            let mut m = vec![0.0; n * n];
            model.mass_matrix(&mut Workspace::new(&model), &witness.q_rad, &mut m);
            let claimed = witness.mass_matrix_kg_m2.iter().flatten();
            for (at, (claimed, own)) in claimed.zip(&m).enumerate() {
                let size = (m[at / n * (n + 1)] * m[at % n * (n + 1)]).sqrt();
                let what = "the witness's inertia is the arm's";
                agrees(CLAIM, what, (claimed / size + 1.0, own / size + 1.0), SAME)
                    .map_err(|why| why.on(&witness.source))?;
            }
        }
        Ok(())
    }
}

impl Witness {
    /// Its payload is one of the study's.
    pub(crate) fn carries(&self, set: &PayloadSet) -> Result<(), Refutation> {
        let (mass, com, inertia) = (self.mass_kg, self.com_m, self.inertia_kg_m2);
        within("witness", set, &Body { mass, com, inertia })
    }
}

/// Checks that a body is one of the set, the one that covers them all (three times their second moments about
/// every axis), or nothing at all.
fn within(claim: &str, set: &PayloadSet, body: &Body) -> Result<(), Refutation> {
    let yes = |what: &str, own: f64, bound: f64, truth: bool| {
        Refutation::unless(claim, what, own, bound, truth)
    };
    let inside = |x: f64, (low, high): (f64, f64)| low - SAME <= x && x <= high + SAME;
    let mass = body.mass;
    let light = mass.abs() <= 0.0;
    yes("payload's mass is in the study's set", mass, set.mass.1, light || inside(mass, set.mass))?;
    let away = |x: &f64| x.abs() > 0.0;
    for (x, ends) in body.com.iter().zip(set.com) {
        let there = inside(*x, ends) || light && !away(x);
        yes("payload's centre of mass is in the study's box", *x, ends.1, there)?;
    }
    let [xx, xy, xz, yy, yz, zz] = body.inertia;
    let half = 0.5 * (xx + yy + zz);
    let most = 3.0 * mass * set.gyration * set.gyration * (1.0 + SAME) + 1e-15;
    for second in [half - xx, half - yy, half - zz, xy, xz, yz] {
        let small = second.abs() <= most;
        yes("payload's second moments are in the study's set", second.abs(), most, small)?;
    }
    Ok(())
}
