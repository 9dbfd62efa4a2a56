//! Mass and inertia of a body, and what the compiler makes of them.

use super::attributes::{AutoSetting, finite, wrong};
use super::compiler::CompilerSettings;
use super::orientation::own_pose;
use crate::body::{Body, LumpedBody};
use crate::markup::MarkupElement;
use crate::placement::{IDENTITY, Matrix3, Placement, mul, transpose};
use crate::whole::Result;

/// Sweeps of Jacobi's rotations: far more than three rows need.
const SWEEPS: usize = 12;

/// Matter of a body about its centre of mass, and that centre's pose in the body.
#[derive(Debug, Clone, Copy)]
pub(super) struct StatedMatter {
    pub(super) body: Body,
    pub(super) at: Placement,
}

impl StatedMatter {
    /// No matter, where MuJoCo has it: at the body's pose in its parent, as if that were one in the body.
    pub(super) fn none(at: Placement) -> Self {
        Self { body: Body { mass: 0.0, com: [0.0; 3], inertia: [0.0; 6] }, at }
    }

    /// That of an `<inertial>`.
    pub(super) fn of(inertial: &MarkupElement, settings: &CompilerSettings) -> Result<Self> {
        let needed = |key: &str| wrong(inertial, &format!("it has no \"{key}\""));
        let [mass] = finite(inertial, "mass")?.ok_or_else(|| needed("mass"))?;
        if inertial.attribute("pos").is_none() {
            return Err(needed("pos"));
        }
        let at = own_pose(inertial, settings)?;
        let inertia =
            match (finite::<3>(inertial, "diaginertia")?, finite::<6>(inertial, "fullinertia")?) {
                (Some(_), Some(_)) => {
                    return Err(wrong(inertial, "it has both \"diaginertia\" and \"fullinertia\""));
                }
                (None, None) => [0.0; 6],
                (Some([xx, yy, zz]), None) => [xx, 0.0, 0.0, yy, 0.0, zz],
                (None, Some([xx, yy, zz, xy, xz, yz])) => {
                    let ways = ["quat", "axisangle", "xyaxes", "zaxis", "euler"];
                    if ways.iter().any(|way| inertial.attribute(way).is_some()) {
                        let why =
                            "\"fullinertia\" is in the body's axes: no orientation goes with it";
                        return Err(wrong(inertial, why));
                    }
                    [xx, xy, xz, yy, yz, zz]
                }
            };
        Ok(Self { body: Body { mass, com: [0.0; 3], inertia }, at })
    }

    /// That of geoms together; `None`: they have none.
    pub(super) fn of_geoms(geoms: &[LumpedBody]) -> Option<Self> {
        let all = geoms.iter().fold(LumpedBody::default(), |sum, own| sum.plus(own));
        if all.m <= 0.0 {
            return None;
        }
        let centre = all.h.map(|x| x / all.m);
        let back = Placement { p: centre.map(|x| -x), ..Placement::IDENTITY };
        let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = all.seen_from(&back).i;
        let body = Body { mass: all.m, com: [0.0; 3], inertia: [xx, xy, xz, yy, yz, zz] };
        Some(Self { body, at: Placement { p: centre, ..Placement::IDENTITY } })
    }

    /// With the compiler's least mass and moments, and with one moment for all where it balances three
    /// that no body has.
    pub(super) fn bounded(mut self, settings: &CompilerSettings) -> Self {
        if settings.least_mass > 0.0 {
            self.body.mass = self.body.mass.max(settings.least_mass);
        }
        let balances = settings.balances && !self.body.obeys_triangle_inequality();
        if settings.least_inertia <= 0.0 && !balances {
            return self;
        }
        let [xx, xy, xz, yy, yz, zz] = self.body.inertia;
        let (axes, moments) = principal([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
        let mut moments = moments.map(|moment| moment.max(settings.least_inertia));
        let [a, b, c] = moments;
        if settings.balances && (a + b < c || a + c < b || b + c < a) {
            moments = [(a + b + c) / 3.0; 3];
        }
        self.at.r = mul(&self.at.r, &axes);
        let [a, b, c] = moments;
        self.body.inertia = [a, 0.0, 0.0, b, 0.0, c];
        self
    }

    pub(super) fn times(mut self, factor: f64) -> Self {
        self.body.mass *= factor;
        self.body.inertia = self.body.inertia.map(|x| factor * x);
        self
    }
}

/// Principal axes, as the columns of a rotation or of a reflection, and moments: Jacobi's rotations.
fn principal(mut a: Matrix3) -> (Matrix3, [f64; 3]) {
    let mut axes = IDENTITY;
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            let mut turn = IDENTITY;
            (turn[p][p], turn[q][q], turn[p][q], turn[q][p]) = (c, c, s, -s);
            a = mul(&mul(&transpose(&turn), &a), &turn);
            axes = mul(&axes, &turn);
        }
    }
    (axes, [a[0][0], a[1][1], a[2][2]])
}

/// Matter of a body by its `<inertial>` or its geoms, as the compiler is set.
pub(super) fn of_body(
    (inertial, geoms): (Option<&MarkupElement>, Result<Vec<LumpedBody>>),
    settings: &CompilerSettings,
    pose: Placement,
) -> Result<StatedMatter> {
    let own = inertial.map(|inertial| StatedMatter::of(inertial, settings)).transpose()?;
    let by_geoms = match settings.inertia_from_geom {
        AutoSetting::True => true,
        AutoSetting::False => false,
        AutoSetting::Auto => own.is_none(),
    };
    let found = if by_geoms { StatedMatter::of_geoms(&geoms?) } else { None };
    Ok(found.or(own).unwrap_or_else(|| StatedMatter::none(pose)).bounded(settings))
}
