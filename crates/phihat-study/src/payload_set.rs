//! The payloads that a design has to bear: an interval of masses, a box of centres of mass, a spread.

use phihat_model::Body;

use crate::arm::StudyArm;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;
use crate::payload::Payload;

/// Slack for figures that were rounded when they were written down, relative \[1\] or \[m\].
const ROUNDING: f64 = 1e-9;

/// A set of rigid bodies welded to one frame; which of them is carried is a constant of a run.
///
/// The inertia of a body with mass `m`, centre of mass `c` and second moment `Σ = ∫ r rᵀ dm` about it
/// enters `M(q)` through `[[m, m cᵀ], [m c, Σ + m c cᵀ]]`, linearly and monotonically; in `c` it is convex.
#[derive(Debug, Clone, PartialEq)]
pub struct PayloadSet {
    /// Frame (link) they are welded to.
    pub frame: String,
    /// Lowest and highest mass `m` \[kg\].
    pub mass: (f64, f64),
    /// Box of the centre of mass `c` \[m\], in the frame's axes.
    pub com: [(f64, f64); 3],
    /// `|Σ_ij| ≤ m · gyration²` \[m\]; 0: point masses.
    pub gyration: f64,
    /// True if the study states where the centre of mass can be; else it is assumed where the world's payload is, or at
    /// the frame's origin.
    pub place_stated: bool,
}

impl PayloadSet {
    /// Corners of the box of centres of mass \[m\], each once.
    pub fn corners(&self) -> Vec<[f64; 3]> {
        let mut corners = vec![[0.0; 3]];
        for (axis, (low, high)) in self.com.into_iter().enumerate() {
            let ends = if high > low { vec![low, high] } else { vec![low] };
            corners = ends
                .iter()
                .flat_map(|end| {
                    corners.iter().map(move |corner| {
                        let mut corner = *corner;
                        corner[axis] = *end;
                        corner
                    })
                })
                .collect();
        }
        corners
    }

    /// The body below all of the set in the Loewner order of `M(q)`: `M` with it is `⪯ M` with any of them.
    ///
    /// The lightest point mass where the centre of mass is one point; none where it is not, because `M` is
    /// convex in the centre of mass and has its least inside the box.
    pub fn lightest(&self) -> Body {
        let one_point = self.com.iter().all(|(low, high)| high <= low);
        let mass = if one_point { self.mass.0 } else { 0.0 };
        Body { mass, com: self.com.map(|(low, _)| low), inertia: [0.0; 6] }
    }

    /// Bodies of which, whatever the motion, one has at least the kinetic energy of any body of the set: the
    /// heaviest, at the corners, with the second moment `3 m·gyration²·1 ⪰ Σ`.
    pub fn heaviest(&self) -> Vec<Body> {
        let i = 6.0 * self.second_moment();
        let body = |com| Body { mass: self.mass.1, com, inertia: [i, 0.0, 0.0, i, 0.0, i] };
        if self.mass.1 > 0.0 {
            self.corners().into_iter().map(body).collect()
        } else {
            vec![Body { mass: 0.0, com: [0.0; 3], inertia: [0.0; 6] }]
        }
    }

    /// Largest entry of any body's second moment about its centre of mass \[kg·m²\].
    pub fn second_moment(&self) -> f64 {
        self.mass.1 * self.gyration * self.gyration
    }
}

/// Reads the set; the world's payload is inside, and so is none where the world has none for a while.
pub(crate) fn read(
    node: &Node<'_>,
    arm: &StudyArm,
    world: Option<&Payload>,
) -> Result<PayloadSet, StudyError> {
    let mass = mass(node, world)?;
    Ok(PayloadSet {
        frame: frame(node, arm, (world, mass.1))?,
        mass,
        com: com(node, world)?,
        gyration: gyration(node, world)?,
        place_stated: node.has("payload_com_m"),
    })
}

fn mass(node: &Node<'_>, world: Option<&Payload>) -> Result<(f64, f64), StudyError> {
    let own = world.map_or(0.0, |payload| payload.mass);
    let key = if node.has("payload_kg") || node.has("payload_max_kg") {
        node.either("payload_kg", "payload_max_kg")?
    } else {
        return Ok((0.0, own));
    };
    let (low, high) = if key == "payload_kg" {
        let [low, high] = node.numbers(key)?;
        (low, high)
    } else {
        (0.0, node.number(key)?)
    };
    let refuse = |message: String, help: String| {
        Err(node.error(Kind::Conflict, key, message).with_help(help))
    };
    if low > high {
        return refuse(
            format!("{low} kg is above {high} kg"),
            "the lighter one comes first".into(),
        );
    }
    if own > high * (1.0 + ROUNDING) {
        let message = format!("{high} kg, while world.payload has {own} kg");
        return refuse(message, format!("valid: at least {own} kg for the heaviest"));
    }
    let always = world.is_some_and(|payload| payload.start <= 0.0 && payload.end.is_infinite());
    let lightest = if always { own } else { 0.0 };
    if low > lightest * (1.0 + ROUNDING) {
        let when = if always { "always" } else { "at some time" };
        let message =
            format!("{low} kg at least, while the world's payload is {lightest} kg {when}");
        return refuse(message, format!("valid: at most {lightest} kg for the lightest"));
    }
    Ok((low, high))
}

fn frame(
    node: &Node<'_>,
    arm: &StudyArm,
    (world, heaviest): (Option<&Payload>, f64),
) -> Result<String, StudyError> {
    let key = "payload_frame";
    if !node.has(key)
        && let Some(payload) = world
    {
        return Ok(payload.frame.clone());
    }
    let name = arm.frame(node, key)?;
    if let Some(payload) = world.filter(|payload| payload.frame != name) {
        let message = format!("`{name}`, while world.payload is welded to `{}`", payload.frame);
        return Err(node
            .error(Kind::Conflict, key, message)
            .with_help(format!("valid: `{}`, or no world.payload", payload.frame)));
    }
    if heaviest > 0.0 || node.has(key) {
        let blamed = ["payload_frame", "payload_kg", "payload_max_kg"];
        let key = blamed.into_iter().find(|blamed| node.has(blamed)).unwrap_or(key);
        arm.moves(node, key, &name)?;
    }
    Ok(name)
}

fn com(node: &Node<'_>, world: Option<&Payload>) -> Result<[(f64, f64); 3], StudyError> {
    let key = "payload_com_m";
    let own = world.map_or([0.0; 3], |payload| payload.com);
    let Some(typed) = node.intervals::<3>(key) else {
        return Ok(own.map(|x| (x.min(0.0), x.max(0.0))));
    };
    if world.is_none() {
        return Ok(typed);
    }
    for ((low, high), (x, axis)) in typed.into_iter().zip(own.into_iter().zip(["x", "y", "z"])) {
        if x < low - ROUNDING || x > high + ROUNDING {
            let message = format!("{axis} from {low} m to {high} m, while world.payload has {x} m");
            return Err(node
                .error(Kind::Conflict, key, message)
                .with_help(format!("valid: an interval for {axis} that holds {x} m")));
        }
    }
    Ok(typed)
}

fn gyration(node: &Node<'_>, world: Option<&Payload>) -> Result<f64, StudyError> {
    let key = "payload_gyration_m";
    let own = world.map_or(0.0, |payload| needed(payload.mass, payload.inertia));
    let Some(typed) = node.number_if(key) else { return Ok(own) };
    if own > typed * (1.0 + ROUNDING) {
        let message = format!("{typed} m, while the inertia of world.payload needs {own:.6} m");
        return Err(node
            .error(Kind::Conflict, key, message)
            .with_help(format!("valid: at least {own:.6} m")));
    }
    Ok(typed)
}

/// `√(max Σ_ii / m)` of a body: off the diagonal a semidefinite `Σ` is no larger.
fn needed(mass: f64, [xx, _, _, yy, _, zz]: [f64; 6]) -> f64 {
    let half = 0.5 * (xx + yy + zz);
    let largest = [half - xx, half - yy, half - zz].into_iter().fold(0.0_f64, f64::max);
    (largest / mass).sqrt()
}
