//! A joint that moves, with its drive and its friction.

/// A joint that moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name.
    pub name: String,
    /// Kind of the joint.
    pub kind: JointKind,
    /// Lower and upper end of travel \[rad, m\]; `None`: endless.
    pub position: Option<(f64, f64)>,
    /// Largest speed \[rad/s, m/s\].
    pub velocity_max: Option<f64>,
    /// Largest torque \[N·m, N\].
    pub torque_max: Option<f64>,
    /// Largest rate of torque \[N·m/s\].
    pub torque_rate_max: Option<f64>,
    /// Reflected rotor inertia \[kg·m²\]: what a simulated plant has.
    pub armature: f64,
    /// Interval that the rotor inertia is known to lie in \[kg·m²\], `armature` among it; `None`: it is `armature`.
    pub armature_range: Option<(f64, f64)>,
    /// Spring between rotor and child; `None`: the description does not state it.
    pub spring: Option<JointSpring>,
    /// Friction between rotor and child.
    pub friction: Friction,
    /// Bandwidth of the drive's torque loop \[Hz\]; `None`: torque acts at once.
    pub drive_bandwidth_hz: Option<f64>,
    /// Encoder resolution \[bit\] over one turn; `None`: exact.
    pub encoder_bits: Option<u32>,
}

impl Joint {
    /// Returns true if the joint turns; false if it slides.
    pub fn turns(&self) -> bool {
        self.kind != JointKind::Prismatic
    }

    /// Rotor inertia \[kg·m²\] at a place of its interval.
    pub fn armature_at(&self, place: Rotor) -> f64 {
        let (low, high) = self.armature_range.unwrap_or((self.armature, self.armature));
        match place {
            Rotor::Least => low,
            Rotor::Stated => self.armature,
            Rotor::Most => high,
        }
    }
}

/// Position of every rotor inertia of an arm in its interval.
///
/// `M(q) + diag(J)` grows with each `J` in the Loewner order: what holds at both ends about the largest and the
/// smallest eigenvalue holds for every rotor between them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rotor {
    /// At the lower end.
    Least,
    /// At the value that is simulated.
    Stated,
    /// At the upper end.
    Most,
}

/// Spring and damper between a joint's rotor and its link: `τ_l = k (θ − q) + c (θ̇ − q̇)`, constants of a run, each
/// known by an interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointSpring {
    /// Least and largest stiffness `k` \[N·m/rad, N/m\].
    pub stiffness: (f64, f64),
    /// Least and largest damping `c` \[N·m·s/rad, N·s/m\].
    pub damping: (f64, f64),
}

impl JointSpring {
    /// Share of critical damping of a rotor on its spring that is assumed where none is stated: `c = 2ζ√(kB)`.
    pub const DAMPING_ASSUMED: f64 = 0.01;

    /// Largest damping that is assumed, in multiples of that.
    const MOST_DAMPING: f64 = 5.0;

    /// Torque limit \[N·m\] from which on a joint is assumed to have the stiffness of an arm's large joints.
    const LARGE: f64 = 50.0;

    /// Spring that is assumed of a joint whose description states none; `None`: it slides.
    ///
    /// Source: an assumption of this project. Torque-controlled arms that lift some kilograms have strain-wave gears
    /// with torque sensors; the order of magnitude of what is published of such joints is 10 … 30 kN·m/rad, in the
    /// wrist 3 … 10. No arm was measured for it.
    pub fn assumed(joint: &Joint) -> Option<Self> {
        let large = joint.torque_max.is_none_or(|most| most >= Self::LARGE);
        let (low, high) = if large { (1e4, 3e4) } else { (3e3, 1e4) };
        let damping = Self::damping_assumed(low, joint.armature_at(Rotor::Least));
        let damping = (damping, Self::MOST_DAMPING * damping);
        joint.turns().then_some(Self { stiffness: (low, high), damping })
    }

    /// Damping \[N·m·s/rad\] of [`Self::DAMPING_ASSUMED`] of a rotor \[kg·m²\] on a spring \[N·m/rad\].
    pub fn damping_assumed(stiffness: f64, rotor: f64) -> f64 {
        2.0 * Self::DAMPING_ASSUMED * (stiffness * rotor).sqrt()
    }
}

/// Kind of a joint: the motion of its child.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Turns between two ends.
    Revolute,
    /// Turns without end.
    Continuous,
    /// Slides between two ends.
    Prismatic,
}

/// Friction of one joint: `τ_f = viscous q̇ + coulomb sign(q̇) + sigmoid(q̇)`, against the motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Friction {
    /// Viscous part \[N·m·s/rad\].
    pub viscous: f64,
    /// Coulomb part \[N·m\].
    pub coulomb: f64,
    /// Interval that the Coulomb part is known to lie in \[N·m\], `coulomb` among it; `None`: none is stated.
    pub coulomb_range: Option<(f64, f64)>,
    /// Identified smooth part.
    pub sigmoid: Option<Sigmoid>,
}

/// Smooth friction `A/(1 + e^{−s(q̇ + o)}) − A/(1 + e^{−s o})`.
///
/// # References
///
/// C. Gaz, M. Cognetti, A. Oliva, P. Robuffo Giordano, A. De Luca, IEEE RA-L 4(4), 2019.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sigmoid {
    /// `A` \[N·m\].
    pub amplitude_nm: f64,
    /// `s` \[s/rad\].
    pub steepness_s_rad: f64,
    /// `o` \[rad/s\].
    pub offset_rad_s: f64,
}

impl Sigmoid {
    /// Friction torque \[N·m\] at speed `dq` \[rad/s\].
    pub fn torque(&self, dq: f64) -> f64 {
        let Self { amplitude_nm, steepness_s_rad, offset_rad_s } = *self;
        let logistic = |v: f64| amplitude_nm / (1.0 + libm::exp(-steepness_s_rad * v));
        logistic(dq + offset_rad_s) - logistic(offset_rad_s)
    }
}
