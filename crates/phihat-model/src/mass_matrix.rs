//! The mass matrix: composite rigid bodies.

use crate::columns::{Columns, unit_wrench};
use crate::description::Motion;
use crate::inertia::Inertia;
use crate::{Model, Scalar, Workspace};

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
        self.place(ws, q);
        match n {
            0..=4 => self.composite::<S, 4>(ws, m),
            5..=8 => self.composite::<S, 8>(ws, m),
            _ => self.composite::<S, 16>(ws, m),
        }
    }

    #[inline(always)]
    fn composite<S: Scalar, const L: usize>(&self, ws: &mut Workspace<S>, m: &mut [S]) {
        let n = self.joint_count();
        self.sweep_in::<S, L>(ws, None, |joint, end, row| {
            for column in joint..n {
                let entry = if column < end { row[column] } else { S::splat(0.0) };
                m[joint * n + column] = entry;
                m[column * n + joint] = entry;
            }
            m[joint * n + joint] += S::splat(self.armature()[joint]);
        });
    }

    /// From tips to base: hands over each row of `M` as it becomes known, with the joint's index
    /// and the end of what it carries: entries from the one up to the other are valid. With a
    /// `lane` for them, the segments' own wrenches are summed up there too.
    #[inline(always)]
    pub(crate) fn sweep_in<S: Scalar, const L: usize>(
        &self,
        ws: &mut Workspace<S>,
        lane: Option<usize>,
        mut row: impl FnMut(usize, usize, &[S; L]),
    ) {
        let segments = self.segments();
        let nodes = &mut ws.segments[..segments.len()];
        let mut columns = Columns::<S, L>::zero();
        let mut inertia = Inertia::default();
        for i in (0..segments.len()).rev() {
            let (segment, node) = (&segments[i], &mut nodes[i]);
            let mut own = Inertia::of(segment);
            if segment.forks {
                own = own.plus(&core::mem::take(&mut node.inertia));
            }
            inertia = if segment.bears { inertia.plus(&own) } else { own };
            if let Some(lane) = lane {
                let borne = if segment.bears { columns.get(lane) } else { Default::default() };
                columns.set(lane, borne.0 + node.force, borne.1 + node.moment);
            }
            let (first, end) = segment.coordinates;
            if segment.motion != Motion::Fixed {
                let (force, moment) = unit_wrench(segment, &inertia);
                columns.set(segment.joint, force, moment);
                row(segment.joint, end, columns.along(segment));
            }
            let (tilt, a) = segment.tilt();
            let (turn, d) = (node.turn, node.d);
            inertia = inertia.out_z(turn, d).out_x(tilt, a);
            if end == self.joint_count() {
                columns.out(tilt, a, turn, d);
            } else {
                (first..end).chain(lane).for_each(|k| columns.out_one(k, tilt, a, turn, d));
            }
            if let Some(parent) = segment.parent
                && !segment.follows_parent(i)
            {
                nodes[parent].inertia = nodes[parent].inertia.plus(&inertia);
                if let Some(lane) = lane {
                    let (force, moment) = columns.get(lane);
                    nodes[parent].force += force;
                    nodes[parent].moment += moment;
                }
            }
        }
    }
}
