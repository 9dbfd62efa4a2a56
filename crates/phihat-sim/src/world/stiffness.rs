//! Integration steps that the stiff parts of a world require.

use super::friction::SimulatedFriction;
use super::plant::Plant;

/// RK4 is stable for `|λ| h < 2.6` in the left half plane; used up to this.
const REACH: f64 = 2.0;

/// A spring and a damper between two things, seen from the coordinate between them.
struct Stiff {
    /// Acceleration per torque \[1/(kg·m²)\].
    mobility: f64,
    stiffness: f64,
    damping: f64,
}

impl Stiff {
    /// Largest `|λ|` of `s² + d a s + k a`, at most.
    fn rate(&self) -> f64 {
        (self.damping * self.mobility).max((self.stiffness * self.mobility).sqrt())
    }
}

impl Plant {
    /// RK4 steps per `period` that the stiffest part asks for at this pose, and the joint that it is on.
    pub(super) fn steps_needed(&mut self, period: f64) -> (u32, usize) {
        let mut worst = (1.0_f64, 0);
        for (joint, stiff) in self.stiff() {
            let needed = (stiff.rate() * period / REACH).ceil();
            if needed > worst.0 {
                worst = (needed, joint);
            }
        }
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a positive whole number; saturates far beyond what a study may ask"
        )]
        (worst.0 as u32, worst.1)
    }

    fn stiff(&mut self) -> Vec<(usize, Stiff)> {
        let n = self.forces.tau.len();
        let q = self.q[..n].to_vec();
        let rest = vec![0.0; n];
        let mut mobility = vec![vec![0.0; n]; n];
        let mut bias = vec![0.0; n];
        let (model, workspace) = self.forces.carried.model();
        model.forward_dynamics(workspace, &q, &rest, &rest, &mut bias);
        for (i, column) in mobility.iter_mut().enumerate() {
            let mut unit = rest.clone();
            unit[i] = 1.0;
            model.forward_dynamics(workspace, &q, &rest, &unit, column);
            column.iter_mut().zip(&bias).for_each(|(ddq, bias)| *ddq -= bias);
        }
        let mut found = Vec::new();
        for i in 0..n {
            let link = mobility[i][i];
            let cold = self.warm_up.map_or(1.0, |(cold, _)| cold.max(1.0));
            let friction = self.healthy[i].times(cold).worst(&self.faults, i);
            let rotor = self.forces.transmissions.as_ref().map(|springs| springs[i]);
            let mobility = rotor.map_or(link, |spring| 1.0 / spring.rotor);
            found.push((i, self.dry(i, friction, mobility)));
            if let Some(spring) = rotor {
                let (stiffness, damping) = (spring.stiffness, spring.damping);
                found.push((i, Stiff { mobility: mobility + link, stiffness, damping }));
            }
            if let Some(stops) = &self.forces.stops {
                let (stiffness, damping) = (stops[i].stiffness, stops[i].damping);
                found.push((i, Stiff { mobility: link, stiffness, damping }));
            }
        }
        let forces = &mut self.forces;
        let walls = forces.contacts.as_mut().map(|c| c.walls(forces.carried.model(), &q));
        for (row, stiffness, damping) in walls.into_iter().flatten() {
            let along =
                |column: &Vec<f64>| -> f64 { column.iter().zip(&row).map(|(a, b)| a * b).sum() };
            let mobility = mobility.iter().map(along).zip(&row).map(|(a, b)| a * b).sum();
            let joint = (0..n).max_by(|a, b| row[*a].abs().total_cmp(&row[*b].abs())).unwrap_or(0);
            found.push((joint, Stiff { mobility, stiffness, damping }));
        }
        found
    }

    fn dry(&self, i: usize, friction: SimulatedFriction, mobility: f64) -> Stiff {
        match &self.forces.bristles {
            Some(bristles) if friction.coulomb > 0.0 => Stiff {
                mobility,
                stiffness: bristles[i].stiffness,
                damping: bristles[i].damping
                    + SimulatedFriction { coulomb: 0.0, ..friction }.stiffness(),
            },
            _ => Stiff { mobility, stiffness: 0.0, damping: friction.stiffness() },
        }
    }
}
