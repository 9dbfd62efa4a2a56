//! The mass matrix: composite rigid bodies.

use crate::columns::{Columns, LANES, Screws4, mask, unit_wrench};
use crate::description::JointMotion;
use crate::inertia::LinkInertia;
use crate::{Four, Model, Scalar, Workspace};

impl Model {
    /// Gives `M(q)`, armature on its diagonal, `n × n` row by row, both triangles.
    ///
    /// # Method
    ///
    /// From tips to base: the inertia `I_c` of a body and all it bears, and one column per joint,
    /// the wrench that moves `I_c` at unit acceleration of that joint. What column `j` does along
    /// joint `i` is
    ///
    /// ```text
    /// M_ij = S_iᵀ X_ij I_c,j S_j                                                      (1)
    /// ```
    ///
    /// All columns travel together: one vector operation serves several joints.
    ///
    /// # Panics
    ///
    /// If `q` is not of length `n`, or `m` not of length `n²`.
    ///
    /// # References
    ///
    /// R. Featherstone, *Rigid Body Dynamics Algorithms*, Springer 2008, section 6.2.
    pub fn mass_matrix<S: Scalar>(&self, ws: &mut Workspace<S>, q: &[S], m: &mut [S]) {
        let n = self.joint_count();
        assert!(m.len() == n * n, "n rows of one column per joint");
        ws.screws.place(self, q);
        self.sweep_in(ws, None);
        let rows = ws.rows.chunks_exact(ws.columns.len());
        for ((i, row), armature) in rows.enumerate().zip(self.armature()) {
            let (above, below) = m.split_at_mut(i * n);
            let (out, row) = (&mut below[..n], &row.as_flattened()[..n]);
            for j in 0..i {
                out[j] = above[j * n + i];
            }
            for (out, entry) in out[i..].iter_mut().zip(&row[i..]) {
                *out = *entry;
            }
            out[i] += S::splat(*armature);
        }
    }

    /// From tips to base: leaves the upper triangle of `M`, without armature, in the workspace's
    /// rows. With a `lane` for them, the segments' own wrenches are summed up there too.
    #[inline(always)]
    pub(crate) fn sweep_in<S: Scalar>(&self, ws: &mut Workspace<S>, lane: Option<usize>) {
        let Workspace { screws, nodes, columns, rows } = ws;
        let (n, chunks) = (self.joint_count(), columns.len());
        columns.fill(Columns::default());
        let mut inertia = LinkInertia::default();
        for (i, segment) in self.segments().iter().enumerate().rev() {
            let node = &mut nodes[i];
            let mut own = LinkInertia::of(segment);
            if segment.forks {
                own = own.plus(&core::mem::take(&mut node.inertia));
            }
            inertia = if segment.bears { inertia.plus(&own) } else { own };
            if let Some(lane) = lane {
                columns[lane / LANES].add(lane, (node.force, node.moment));
            }
            let (first, end) = segment.coordinates;
            // Columns of other branches stay where they are, and do nothing along this joint.
            let here = |k: usize| (first..end).contains(&k) || lane == Some(k);
            if segment.motion != JointMotion::Fixed {
                columns[first / LANES].add(first, unit_wrench(segment, &inertia));
                let row = &mut rows[first * chunks..][..chunks];
                for (chunk, (row, columns)) in row.iter_mut().zip(&*columns).enumerate() {
                    let along = columns.along(segment);
                    let valid = if end < n { along * mask::<S>(chunk, here) } else { along };
                    *row = valid.lanes();
                }
            }
            let Some(parent) = segment.parent else {
                lane.map(|lane| columns[lane / LANES].take(lane));
                continue;
            };
            let (tilt, turn) = (segment.tilt(), screws.at(i, segment));
            let screws = Screws4::new(tilt, turn);
            inertia = inertia.out_z(turn).out_x(tilt);
            for (chunk, columns) in columns.iter_mut().enumerate().skip(first / LANES) {
                let moved = columns.out(screws);
                *columns = if end < n { moved.or(mask::<S>(chunk, here), columns) } else { moved };
            }
            if segment.follows_parent(i) {
                continue;
            }
            // The parent's turn comes later: leave it what this branch adds up to.
            let parent = &mut nodes[parent];
            parent.inertia = parent.inertia.plus(&inertia);
            if let Some(lane) = lane {
                let (force, moment) = columns[lane / LANES].take(lane);
                parent.force += force;
                parent.moment += moment;
            }
        }
    }
}
