//! Motion of the payload with the joints along the nominal run.

use phihat_model::{Model, Workspace};

use super::nominal::NominalRun;
use super::scene::{Scene, centre};

/// Twist of the middle of the payload's box per joint velocity, in the frame's axes, at every sample.
pub(super) fn jacobians(
    scene: &Scene<'_>,
    nominal: &NominalRun,
    (model, off): (&Model, &[f64; 3]),
) -> Vec<Vec<f64>> {
    let Some(set) = &scene.payload else { return Vec::new() };
    let Some(frame) = model.frame(&set.frame) else { return Vec::new() };
    let n = scene.n;
    let mut workspace = Workspace::new(model);
    let mut world = vec![0.0; 6 * n];
    let middle = centre(set);
    let c: [f64; 3] = core::array::from_fn(|i| middle[i] + off[i]);
    (0..scene.samples)
        .map(|k| {
            model.jacobian(&mut workspace, &nominal.q[k * n..(k + 1) * n], frame, &mut world);
            let r = model.pose(&workspace, frame).r;
            let mut out = vec![0.0; 6 * n];
            for j in 0..n {
                let turned = |at: usize| -> [f64; 3] {
                    core::array::from_fn(|i| {
                        (0..3).map(|w| r[w][i] * world[(at + w) * n + j]).sum()
                    })
                };
                let (linear, angular) = (turned(0), turned(3));
                let [x, y, z] = angular;
                let at = [
                    linear[0] + y * c[2] - z * c[1],
                    linear[1] + z * c[0] - x * c[2],
                    linear[2] + x * c[1] - y * c[0],
                ];
                for i in 0..3 {
                    out[i * n + j] = at[i];
                    out[(3 + i) * n + j] = angular[i];
                }
            }
            out
        })
        .collect()
}
