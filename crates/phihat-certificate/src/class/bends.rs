//! Maxima over box and payloads of derivatives of the dynamics, weighted by the class's speeds and accelerations.

use phihat_model::{Model, Workspace};
use phihat_study::MotionClass;

use super::dynamics::{Dynamics, weights};
use super::sums::SquareBlock;
use crate::extremes::larger;

/// Step of second differences \[rad, m\].
const STEP: f64 = 1e-3;

/// Factor on what is the largest of a search among postures.
pub(super) const MARGIN: f64 = 1.1;

/// Maxima, entry by entry.
#[derive(Debug, Clone)]
pub(super) struct ClassBends {
    /// `M₂ = Σ_cb |∂_b ∂_c M| v_c v_b`, `Q₂ = Σ_cb |∂_b (2 ∂_c M − D_c)| v_c v_b`, the same of `∂_c M − D_c`.
    pub(super) mass: SquareBlock,
    pub(super) twice: SquareBlock,
    pub(super) once: SquareBlock,
    /// `P₂ = Σ_c |∂_c M − D_c| a_c + Σ_cb |∂_b (∂_c M − D_c)| v_c v_b`, and its first sum alone.
    pub(super) force: SquareBlock,
    pub(super) push: SquareBlock,
    /// `Σ_b |∂_b K_g| v_b`, and `K_a`.
    pub(super) gravity_rate: SquareBlock,
    pub(super) gradient: SquareBlock,
    /// `Σ_c |∂_c M| v_c`, `Σ_c |∂_c M − D_c| v_c`.
    pub(super) moved: SquareBlock,
    pub(super) started: SquareBlock,
    /// `|∂g_0/∂q|` of the arm whose gravity the robot adds.
    pub(super) added: SquareBlock,
    /// For each `c`: `|∂_c M|`, `|D_c|`, `|∂_c K_g|`, `Σ_b |∂_c D_b| v_b`, `Σ_b |∂_c ∂_b M| v_b`.
    pub(super) masses: Vec<SquareBlock>,
    pub(super) coriolis: Vec<SquareBlock>,
    pub(super) gravity: Vec<SquareBlock>,
    pub(super) turned: Vec<SquareBlock>,
    pub(super) bent: Vec<SquareBlock>,
    /// Postures looked at.
    pub(super) postures: usize,
}

impl ClassBends {
    pub(super) fn none(n: usize) -> Self {
        let zero = || vec![0.0; n * n];
        let each = || vec![zero(); n];
        Self {
            mass: zero(),
            twice: zero(),
            once: zero(),
            force: zero(),
            push: zero(),
            gravity_rate: zero(),
            gradient: zero(),
            moved: zero(),
            started: zero(),
            added: zero(),
            masses: each(),
            coriolis: each(),
            gravity: each(),
            turned: each(),
            bent: each(),
            postures: 0,
        }
    }

    fn lists(&mut self) -> impl Iterator<Item = &mut SquareBlock> {
        let single = [
            &mut self.mass,
            &mut self.twice,
            &mut self.once,
            &mut self.force,
            &mut self.push,
            &mut self.gravity_rate,
            &mut self.gradient,
            &mut self.moved,
            &mut self.started,
            &mut self.added,
        ];
        let many = [
            &mut self.masses,
            &mut self.coriolis,
            &mut self.gravity,
            &mut self.turned,
            &mut self.bent,
        ];
        single.into_iter().chain(many.into_iter().flatten())
    }

    /// The larger of both, entry by entry.
    pub(super) fn and(&mut self, mut other: Self) {
        self.postures += other.postures;
        for (own, other) in self.lists().zip(other.lists()) {
            own.iter_mut().zip(other).for_each(|(own, other)| *own = larger(*own, *other));
        }
    }

    /// All entries times a factor.
    pub(super) fn times(mut self, factor: f64) -> Self {
        self.lists().flatten().for_each(|entry| *entry *= factor);
        self
    }

    /// At one posture, of an arm with its payload; `added` is the arm whose gravity the robot adds by itself.
    pub(super) fn at(
        (model, added): (&Model, Option<&Model>),
        class: &MotionClass,
        q: &[f64],
    ) -> Self {
        let n = q.len();
        let dynamics = Dynamics::at(model, added, q);
        let bent = BentDynamics::at((model, added), q);
        let (v, a) = (&class.speed, &class.acceleration);
        let mut own = Self::none(n);
        own.postures = 1;
        for i in 0..n {
            for j in 0..n {
                let k = i * n + j;
                for c in 0..n {
                    let (m, d) = (dynamics.slopes[c][i][j], dynamics.coriolis[c][i][j]);
                    own.masses[c][k] = m.abs();
                    own.coriolis[c][k] = d.abs();
                    own.moved[k] += m.abs() * v[c];
                    own.started[k] += (m - d).abs() * v[c];
                    own.push[k] += (m - d).abs() * a[c];
                    // ½ of the rate of D, and of what the acceleration weighs.
                    own.gradient[k] += dynamics.slopes[j][i][c].abs() * a[c];
                    own.gravity[c][k] = bent.gravity(c, i, j).abs();
                    own.gravity_rate[k] += bent.gravity(c, i, j).abs() * v[c];
                    for b in 0..n {
                        let (m, d) = (bent.mass(b, c, i, j), bent.coriolis(b, c, i, j));
                        let speed = v[c] * v[b];
                        own.mass[k] += m.abs() * speed;
                        own.twice[k] += (2.0 * m - d).abs() * speed;
                        own.once[k] += (m - d).abs() * speed;
                        own.bent[b][k] += m.abs() * v[c];
                        own.turned[b][k] += d.abs() * v[c];
                        // Of (∂_j D_c)_ib.
                        own.gradient[k] += 0.5 * bent.coriolis(j, c, i, b).abs() * speed;
                    }
                }
                own.force[k] = own.push[k] + own.once[k];
            }
        }
        if let Some(bare) = added {
            own.added = weights(bare, q).into_iter().flatten().map(f64::abs).collect();
        }
        own
    }
}

/// Second derivatives at a posture.
struct BentDynamics {
    n: usize,
    /// `∂_b ∂_c M`, and `∂_b ∂_c g`, at `b n + c`.
    mass: Vec<SquareBlock>,
    gravity: Vec<Vec<f64>>,
}

impl BentDynamics {
    /// By differences of the mass matrix and of gravity's torque themselves, at four corners around the posture.
    fn at((model, added): (&Model, Option<&Model>), q: &[f64]) -> Self {
        let n = q.len();
        let mut arm = AddedArm::of(model, added, n);
        let middle = arm.at(q);
        let mut own = Self { n, mass: vec![Vec::new(); n * n], gravity: vec![Vec::new(); n * n] };
        for b in 0..n {
            for c in 0..=b {
                let mut moved = |up: f64, across: f64| {
                    let mut place = q.to_vec();
                    place[b] += up * STEP;
                    place[c] += across * STEP;
                    arm.at(&place)
                };
                let found = if b == c {
                    let (more, less) = (moved(1.0, 0.0), moved(-1.0, 0.0));
                    second(&[&more, &less, &middle, &middle], STEP * STEP)
                } else {
                    let ends =
                        [moved(1.0, 1.0), moved(-1.0, -1.0), moved(1.0, -1.0), moved(-1.0, 1.0)];
                    second(&[&ends[0], &ends[1], &ends[2], &ends[3]], 4.0 * STEP * STEP)
                };
                let (mass, gravity) = found.split_at(n * n);
                for at in [b * n + c, c * n + b] {
                    own.mass[at] = mass.to_vec();
                    own.gravity[at] = gravity.to_vec();
                }
            }
        }
        own
    }

    /// `(∂_b ∂_c M)_ij`.
    fn mass(&self, b: usize, c: usize, i: usize, j: usize) -> f64 {
        self.mass[b * self.n + c][i * self.n + j]
    }

    /// `(∂_b D_c)_ij`, by Christoffel's symbols.
    fn coriolis(&self, b: usize, c: usize, i: usize, j: usize) -> f64 {
        self.mass(b, c, i, j) + self.mass(b, j, i, c) - self.mass(b, i, c, j)
    }

    /// `(∂_c K_g)_ij`.
    fn gravity(&self, c: usize, i: usize, j: usize) -> f64 {
        self.gravity[c * self.n + j][i]
    }
}

/// `(a + b − c − d)/h`.
fn second([a, b, c, d]: &[&Vec<f64>; 4], h: f64) -> Vec<f64> {
    a.iter().zip(*b).zip(c.iter().zip(*d)).map(|((a, b), (c, d))| (a + b - c - d) / h).collect()
}

/// An arm at rest.
struct AddedArm<'a> {
    model: &'a Model,
    added: Option<(&'a Model, Workspace<f64>)>,
    room: Workspace<f64>,
    rest: Vec<f64>,
}

impl<'a> AddedArm<'a> {
    fn of(model: &'a Model, added: Option<&'a Model>, n: usize) -> Self {
        let added = added.map(|bare| (bare, Workspace::new(bare)));
        Self { model, added, room: Workspace::new(model), rest: vec![0.0; n] }
    }

    /// Inertia, row by row, and the torque of gravity that the law has to hold.
    fn at(&mut self, q: &[f64]) -> Vec<f64> {
        let n = q.len();
        let mut all = vec![0.0; n * n + n];
        let (mass, gravity) = all.split_at_mut(n * n);
        self.model.mass_matrix(&mut self.room, q, mass);
        self.model.bias(&mut self.room, q, &self.rest, gravity);
        if let Some((bare, room)) = &mut self.added {
            let mut own = vec![0.0; n];
            bare.bias(room, q, &self.rest, &mut own);
            gravity.iter_mut().zip(own).for_each(|(gravity, own)| *gravity -= own);
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use phihat_model::Robot;

    use super::{BentDynamics, Dynamics, STEP};

    #[test]
    fn second_derivatives_are_those_of_the_first() {
        // Coriolis torque comes from inverse dynamics there, from Christoffel's symbols here.
        let robot = Robot::named("panda").unwrap();
        let model = robot.plant_model().with_gravity(phihat_model::GRAVITY);
        let q = [0.1, -0.7, 0.2, -2.1, 0.3, 1.4, 0.6];
        let own = BentDynamics::at((&model, None), &q);
        for b in 0..7 {
            let moved = |by: f64| {
                let place: Vec<f64> =
                    (0..7).map(|i| if i == b { q[i] + by } else { q[i] }).collect();
                Dynamics::at(&model, None, &place)
            };
            let (more, less) = (moved(STEP), moved(-STEP));
            let rate = |a: f64, b: f64| (a - b) / (2.0 * STEP);
            for (c, i, j) in (0..343).map(|k| (k / 49, k / 7 % 7, k % 7)) {
                for (own, wanted) in [
                    (own.mass(b, c, i, j), rate(more.slopes[c][i][j], less.slopes[c][i][j])),
                    (
                        own.coriolis(b, c, i, j),
                        rate(more.coriolis[c][i][j], less.coriolis[c][i][j]),
                    ),
                    (own.gravity(b, i, j), rate(more.gravity[i][j], less.gravity[i][j])),
                ] {
                    assert!((own - wanted).abs() < 1e-4, "{b} {c} {i} {j}: {own} {wanted}");
                }
            }
        }
    }
}
