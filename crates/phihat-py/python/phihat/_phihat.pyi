"""The compiled half of phihat."""

import os
from collections.abc import Callable, Sequence
from typing import Any, Literal, TypedDict, final

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[np.float64]
_Numbers = _Array | Sequence[float]
_Path = str | os.PathLike[str]
_Section = tuple[tuple[float, float], tuple[float, float]]

class _CoupledGains(TypedDict):
    """Coupled gains at frozen postures; each an array of one row and one column per joint."""

    error_rad_per_nm: _Array
    velocity_rad_s_per_nm: _Array
    acceleration_rad_s2_per_nm: _Array
    torque_step_nm_per_nm: _Array
    encoder_error_rad_per_rad: _Array
    encoder_velocity_per_s: _Array
    encoder_torque_step_nm_per_rad: _Array

__all__ = [
    "Controller",
    "Gains",
    "Gate",
    "Plant",
    "PositionGains",
    "Robot",
    "Rollouts",
    "Sample",
    "Supervisor",
    "Trace",
    "Worlds",
    "bound",
    "design",
    "drive",
    "faults",
    "compare",
    "merge",
    "recorded",
    "report",
    "reproduce",
    "simulate",
    "study_document",
    "sweep",
    "parquet_columns",
    "sweep_folder",
    "trace_file",
    "version",
]

def version() -> str: ...
def design(path: _Path | None, document: str | None, name: str) -> Gains: ...
def simulate(
    path: _Path | None,
    document: str | None,
    name: str,
    gains: Gains | None,
    uncertified: bool,
) -> Trace: ...
def bound(
    gains: Gains,
    t: Sequence[float],
    q: _Array,
    path: _Path | None,
    document: str | None,
    name: str,
) -> dict[str, Any]: ...
def recorded(folder: _Path) -> Trace: ...
def report(trace: _Path, page: _Path) -> None: ...
def trace_file(path: _Path) -> tuple[_Path, bool]: ...
def parquet_columns(path: _Path) -> dict[str, NDArray[Any] | tuple[list[str], NDArray[np.uint32]]]: ...
def drive(asked: dict[str, Any]) -> tuple[Trace, dict[str, Any], bool, _Path]: ...
def faults(asked: dict[str, Any]) -> dict[str, Any]: ...
def compare(asked: dict[str, Any]) -> dict[str, Any]: ...
def reproduce(only: str | None, quick: bool, threads: int | None, out: _Path | None) -> dict[str, Any]: ...
def sweep(asked: dict[str, Any], progress: Callable[[int, int], object] | None) -> dict[str, Any]: ...
def sweep_folder(asked: dict[str, Any]) -> str | os.PathLike[str]: ...
def merge(folders: Sequence[_Path], out: _Path | None) -> dict[str, Any]: ...
def study_document(
    path: _Path | None, document: str | None, name: str
) -> tuple[dict[str, Any], Robot]: ...
@final
class Robot:
    """A robot arm: its description, and its rigid-body dynamics

        M(q) ddq + C(q, dq) dq + g(q) = tau

    ``q, dq, ddq, tau`` are arrays of float64, or sequences of numbers, whose last axis is the joints in the order of
    ``joint_names``; axes before it are a batch, of which all arguments have the same or none. The functions leave out rotor
    inertia (``armature``), viscous friction (``damping``) and dry friction (``friction``) unless asked.
    """

    @staticmethod
    def from_file(
        path: _Path,
        gravity: tuple[float, float, float] | None = ...,
        *,
        base: str | None = None,
        tip: str | None = None,
        joints: Sequence[str] | None = None,
        locked: dict[str, float] | None = None,
    ) -> Robot:
        """Read a URDF or an MJCF, or the TOML file beside one that adds rotors, friction and limits.

        Args:
            gravity: in the axes of the robot's base [m/s^2]; default: an MJCF's own, else 9.81 downward.
            base: link that the arm stands on, in a file of a larger robot: joints from it to ``tip`` are the arm's.
            tip: link that the arm ends in; of an MJCF, a body, a site or a joint.
            joints: the arm's joints, in place of those from ``base`` to ``tip``.
            locked: where joints stand that are none of the arm's [rad, m]; those not named, as near to where they are
                drawn as they come.

        Raises:
            RobotError: with file and line, link or joint, and what would be valid.
        """

    @staticmethod
    def from_text(
        text: str,
        toml: str | None = None,
        origin: str = "text",
        gravity: tuple[float, float, float] | None = ...,
    ) -> Robot:
        """Read a URDF or an MJCF and what it leaves out from their texts; ``origin`` stands for the file in errors."""

    def as_urdf(self) -> str:
        """The text of a URDF with the same links, joints, limits and friction; rotor inertia has no place in it."""

    @staticmethod
    def from_name(name: str, gravity: tuple[float, float, float] = ...) -> Robot:
        """One of the arms that come with phihat: see :func:`phihat.robots`."""

    @staticmethod
    def names_built_in() -> list[str]: ...
    def with_payload(
        self, frame: str, mass: float, com: Sequence[float], inertia: Sequence[float]
    ) -> Robot:
        """The same robot with a body welded to a frame.

        Args:
            mass: [kg].
            com: centre of mass in the frame [m].
            inertia: about the centre of mass, axes as the frame's, ``xx, xy, xz, yy, yz, zz`` [kg m^2].
        """

    def with_locked(self, joints: dict[str, float]) -> Robot:
        """The same robot with some joints fixed at a position [rad, m for prismatic joints]."""

    @property
    def name(self) -> str: ...
    @property
    def description(self) -> str: ...
    @property
    def joint_names(self) -> list[str]:
        """The joints that move: the order of every array."""

    @property
    def frame_names(self) -> list[str]:
        """All links of the description."""

    @property
    def joint_frames(self) -> list[str]:
        """The frame (link) that each joint moves."""

    @property
    def joint_kinds(self) -> list[str]:
        """``revolute``, ``continuous`` or ``prismatic``."""

    def joint_values(
        self,
        what: Literal[
            "position_min",
            "position_max",
            "velocity_max",
            "torque_max",
            "torque_rate_max",
            "armature",
            "viscous",
            "coulomb",
        ],
    ) -> list[float]:
        """One figure of every joint, SI units; infinite where there is no limit."""

    @property
    def tip(self) -> str:
        """The frame that does the work."""

    @property
    def poses(self) -> dict[str, list[float]]:
        """Named postures [rad]."""

    @property
    def warnings(self) -> list[str]:
        """What is odd about the description but does not prevent its use."""

    @property
    def gravity_m_s2(self) -> list[float]: ...
    @property
    def dynamic_parameters(self) -> _Array:
        """``(n, 10)``: of each joint's body ``m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz``, about the origin of the
        frame that the joint moves; ``regressor(q, dq, ddq) @ dynamic_parameters.ravel()`` is the inverse dynamics."""

    def inverse_dynamics(
        self,
        q: _Numbers,
        dq: _Numbers,
        ddq: _Numbers,
        *,
        armature: bool = False,
        damping: bool = False,
        friction: bool = False,
    ) -> _Array:
        """``tau`` of a motion [N m], shape ``(..., n)``."""

    def forward_dynamics(
        self,
        q: _Numbers,
        dq: _Numbers,
        tau: _Numbers,
        *,
        armature: bool = False,
        damping: bool = False,
        friction: bool = False,
    ) -> _Array:
        """``ddq`` under a torque [rad/s^2], shape ``(..., n)``."""

    def friction_torque(
        self, dq: _Numbers, own: bool, extra_viscous: Sequence[float], extra_coulomb: Sequence[float]
    ) -> _Array:
        """Friction at a speed [N m], against the motion: the description's (``own``), and what a study puts on top."""

    def smooth_friction(self, dq: _Numbers) -> _Array:
        """The part of the description's friction that is neither viscous nor dry [N m]."""

    def mass_matrix(self, q: _Numbers, *, armature: bool = False) -> _Array:
        """``M(q)`` [kg m^2], shape ``(..., n, n)``."""

    def bias(self, q: _Numbers, dq: _Numbers) -> _Array:
        """``C(q, dq) dq + g(q)`` [N m], shape ``(..., n)``."""

    def gravity(self, q: _Numbers) -> _Array:
        """``g(q)``, the torque that holds the arm still [N m], shape ``(..., n)``."""

    def frame_pose(self, q: _Numbers, frame: str | None = None) -> _Array:
        """Pose of a frame (the tip) in the world, homogeneous, shape ``(..., 4, 4)`` [m]."""

    def jacobian(self, q: _Numbers, frame: str | None = None) -> _Array:
        """Jacobian of a frame's origin (the tip's), shape ``(..., 6, n)``: three rows linear, three angular, world axes."""

    def regressor(self, q: _Numbers, dq: _Numbers, ddq: _Numbers) -> _Array:
        """``Y`` with ``tau = Y pi``, ``pi = dynamic_parameters.ravel()``, shape ``(..., n, 10 n)``."""

@final
class Gains:
    """Gains of an arm's joints, as in ``gains.json``, with what is certified about them.

    Made from numbers, nothing is certified about them.

    Args:
        rate_hz: rate of the loop [Hz].
        inertia, kp, kd: nominal inertia [kg m^2], ``K_p`` [1/s^2] and ``K_d`` [1/s] of each joint.
        a: estimator coefficients of each joint, ``a_0`` first [1/s^m ... 1/s]; as many as its order.
        joint_names: joints, in order; ``joint_1`` and so on unless given.
        torque_filter_hz: cut-off of a first-order low-pass on the torque command, before its limits [Hz]; none unless given.

    Raises:
        GainsError, ArgumentError: gains that cannot be, or not one value per joint.
    """

    def __new__(
        cls,
        *,
        rate_hz: float,
        inertia: Sequence[float],
        kp: Sequence[float],
        kd: Sequence[float],
        a: Sequence[Sequence[float]],
        joint_names: Sequence[str] | None = None,
        torque_filter_hz: float | None = None,
    ) -> Gains: ...
    @staticmethod
    def from_file(path: _Path) -> Gains:
        """Read a gains document (JSON)."""

    @staticmethod
    def from_json(text: str) -> Gains:
        """Read a gains document from its text."""

    def to_json(self) -> str:
        """The document's text."""

    def export(self, format: Literal["ros", "c-header", "csv"]) -> str:
        """The text of these gains for controllers that people already run.

        ``ros``: parameters (YAML) of joint_trajectory_controller with effort commands, order 1 only; ``c-header``: constants
        for C99 and C++; ``csv``: a table. Each says what its target lacks, and what is claimed of it instead.
        """

    def verify(self) -> None:
        """Check every claim of the certificate again, from these gains alone.

        Raises:
            Refuted: the first claim that does not hold.
        """

    @property
    def joint_names(self) -> list[str]: ...
    @property
    def rate_hz(self) -> float:
        """Rate of the loop that the gains are for [Hz]."""

    @property
    def method(self) -> str:
        """How they were found, in words."""

    @property
    def study(self) -> str:
        """Name of the study they were made from."""

    @property
    def inertia(self) -> list[float]:
        """Nominal inertia of each joint [kg m^2]."""

    @property
    def kp(self) -> list[float]:
        """``K_p`` of each joint [1/s^2]."""

    @property
    def kd(self) -> list[float]:
        """``K_d`` of each joint [1/s]."""

    @property
    def a(self) -> list[list[float]]:
        """Estimator coefficients ``a_0, a_1, ...`` of each joint."""

    @property
    def certificate(self) -> dict[str, Any] | None:
        """The certificate as a document."""

    @property
    def window(self) -> list[tuple[float, float]] | None:
        """Range of true over nominal inertia in which each joint's sampled loop is stable; ``None`` if not certified."""

    @property
    def error_bound(self) -> list[float] | None:
        """Certified bound on ``|e|`` of each joint [rad]; ``None`` if not certified."""

    def _repr_html_(self) -> str:
        """What notebooks show: the law of every joint, and what is promised of it."""

    @property
    def coupled(self) -> _CoupledGains | None:
        """How far a push on one joint moves every joint, at frozen postures; ``None`` if nothing is claimed.

        Row: the joint that moves; column: the joint that is hit. With external torques of at most ``d`` [N m] per joint, of any
        course in time, ``gains.coupled["error_rad_per_nm"] @ d`` bounds ``|e|`` [rad] of every joint. No claim about motion.
        """

@final
class PositionGains:
    """Gains for the law whose observer sees the position and the torque that acted, not a velocity.

    With ``l = correction``, ``v = velocity_correction``, ``g = share`` and ``d = delay_samples``, and ``((c_0, c_1), (b_0, b_1))``
    each section of ``innovation_filter``, at sample ``k``::

        z     = estimates of e, de, phi, ... at the last sample, carried on by the torque that acted less its ff
        nu    = q - q_des - z_e
        z    += l nu                                   (and v (dq - dq_des - z_de), where v is not zero)
        x, y  = x + y, y + nu - c_0 x - c_1 y          of each section, from 0, 0 at the first sample
        z+    = z carried on through the d torques that are on their way, and phi by T (1/g - 1) more
        ff    = M ddq_des
        r     = the last torque, as the limits let it through, less its ff
        want  = phi+ - M (K_d de+ + K_p e+) + M (sum of b_0 x + b_1 y over the sections)
        tau   = ff + r + g (want - r)

    ``tau`` acts from sample ``k + d`` to ``k + d + 1``. Its feed-forward enters with the reference: ``ddq_des`` is the mean
    of that interval, the desired velocity at its end less that at its begin, over the period; ``q_des`` and ``dq_des`` are
    those of now. ``phihat.Gains`` from a design may be of this form too, with a certificate; these have none.

    Args:
        joint_names: joints, in order.
        rate_hz: rate of the loop [Hz].
        inertia, kp, kd: nominal inertia [kg m^2], ``K_p`` [1/s^2] and ``K_d`` [1/s] of each joint.
        correction: of each joint, what one radian that it is farther than expected adds to the estimate of ``e`` [1],
            of ``de`` [1/s], of ``phi/M`` [1/s^2] and of its derivatives: 3 to 5 numbers, two more than the order.
        share: share of the way to the wanted torque that is gone in one sample, above 0, at most 1 [1].
        delay_samples: transport delay of each joint from a sample to its torque, 0 to 4 [samples].
        velocity_correction: as ``correction``, per rad/s of the measured velocity; left out or, of a joint, all zero: this law
            uses a velocity only where it starts or takes over. A number has to be there always, and a supervisor judges it.
        innovation_filter: of each joint, up to two sections ``((c_0, c_1), (b_0, b_1))`` of a filter on what its position tells
            that was not expected; left out or, of a joint, an empty list: none. ``c`` are rates per sample [1]: a section's
            poles are ``z = 1 + w`` with ``w**2 + c_1 w + c_0 = 0``, inside of the circle where ``0 < c_0 < c_1`` and
            ``2 c_1 < 4 + c_0``. ``b`` are weights in the torque that is wanted, per ``M`` [1/s^2].
        torque_filter_hz: cut-off of a first-order low-pass on the torque command, before its limits [Hz]; none unless given.

    Raises:
        GainsError: gains that cannot be; ``field`` is the argument.
        ArgumentError: not one value per joint, or a rate or a delay that cannot be.
    """

    def __new__(
        cls,
        *,
        joint_names: Sequence[str],
        rate_hz: float,
        inertia: Sequence[float],
        kp: Sequence[float],
        kd: Sequence[float],
        correction: Sequence[Sequence[float]],
        share: Sequence[float],
        delay_samples: Sequence[int],
        velocity_correction: Sequence[Sequence[float]] | None = None,
        innovation_filter: Sequence[Sequence[_Section]] | None = None,
        torque_filter_hz: float | None = None,
    ) -> PositionGains: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def rate_hz(self) -> float:
        """Rate of the loop that the gains are for [Hz]."""

    @property
    def inertia(self) -> list[float]:
        """Nominal inertia of each joint [kg m^2]."""

    @property
    def kp(self) -> list[float]:
        """``K_p`` of each joint [1/s^2]."""

    @property
    def kd(self) -> list[float]:
        """``K_d`` of each joint [1/s]."""

    @property
    def correction(self) -> list[list[float]]:
        """What an innovation of each joint's position corrects."""

    @property
    def share(self) -> list[float]:
        """Share of the way to the wanted torque per sample, of each joint [1]."""

    @property
    def delay_samples(self) -> list[int]:
        """Transport delay of each joint [samples]."""

    @property
    def velocity_correction(self) -> list[list[float]] | None:
        """What an innovation of each joint's velocity corrects; ``None``: it is not used."""

    @property
    def innovation_filter(self) -> list[list[_Section]] | None:
        """Sections of the filter on each joint's innovation; ``None``: there is none."""

    @property
    def torque_filter_hz(self) -> float | None:
        """Cut-off of the low-pass on the torque command [Hz]; ``None``: there is none."""

@final
class Controller:
    """The controller of an arm: one :meth:`update` per sample.

        tau = M (ddq_des - K_d de - K_p e) + phi_hat,      e = q - q_des

    or, with :class:`PositionGains`, what they say.

    ``Controller(rate_hz=1000, inertia=[...], kp=[...], kd=[...], a=[[...], ...])`` makes one from numbers: the keywords are
    those of :class:`Gains`, or of :class:`PositionGains` where a ``correction`` is among them.

    Args:
        gains: what to run.
        torque_max: largest ``|tau|`` per joint [N m], infinite for none; by default what the certificate is about.
        torque_rate_max: likewise for the change of torque [N m/s].
        form: of :class:`Gains`: ``"observer"``, the default, or ``"literal"``, the paper's integrals of the error, for
            reproduction.
    """

    def __new__(
        cls,
        gains: Gains | PositionGains | None = None,
        *,
        torque_max: Sequence[float] | None = None,
        torque_rate_max: Sequence[float] | None = None,
        form: Literal["observer", "literal"] | None = None,
        **law: Any,
    ) -> Controller: ...
    def update(
        self,
        q: _Array,
        dq: _Array,
        q_des: _Array,
        dq_des: _Array,
        ddq_des: _Array,
        tau_applied: _Array | None = None,
        t_ns: int | None = None,
    ) -> _Array:
        """Answer one sample; call it once per period.

        Args:
            q, dq: what the sensors say [rad, rad/s].
            q_des, dq_des, ddq_des: what the arm shall do [rad, rad/s, rad/s^2]; with :class:`PositionGains`, ``ddq_des`` is
                the mean of the interval in which this torque acts.
            tau_applied: torque that acted since the last sample (mean) [N m]; if it is not measured, the torque that was
                commanded last is taken. With a transport delay, pass what was commanded for that time.
            t_ns: a stamp of any clock [ns]; must go forward by at most three periods.

        Returns:
            The torque to apply until the next sample [N m], finite and within the limits.

        Raises:
            SampleRefused: a value is not finite, or beyond 2^32; hold its ``tau``. The state is as before.
            ArgumentError: an array is no float64 array of one number per joint, or the stamp is wrong.
        """

    def resume(
        self,
        q: _Array,
        dq: _Array,
        q_des: _Array,
        dq_des: _Array,
        ddq_des: _Array,
        tau: _Array,
    ) -> None:
        """Take over a moving or loaded arm without a bump: the next torque continues ``tau`` [N m]."""

    def reset(self) -> None:
        """Back to rest and zero knowledge of the arm."""

    @property
    def joint_names(self) -> list[str]: ...
    @property
    def period(self) -> float:
        """Time between samples [s]."""

    @property
    def tau(self) -> _Array:
        """The last torque [N m]."""

    @property
    def phi_hat(self) -> _Array:
        """Estimate of the unknown dynamics [N m], contained in the last torque."""

    @property
    def saturated(self) -> NDArray[np.bool_]:
        """Whether the torque limit acted on the last torque."""

    @property
    def rate_limited(self) -> NDArray[np.bool_]:
        """Whether the torque-rate limit acted on the last torque."""

    @property
    def torque_max(self) -> _Array:
        """Torque limit [N m]; infinite where there is none."""

@final
class Gate:
    """The last thing before a torque leaves: behind gravity compensation, feed-forward and all else that computes on it.

    Args:
        rate_hz: samples per second.
        torque_max: largest ``|tau|`` per joint [N m], infinite for none.
        torque_rate_max: likewise for the change of torque [N m/s].
        energy_max_j: the most energy that all drives together may give the arm within ``energy_window_s`` [J].
    """

    def __new__(
        cls,
        *,
        rate_hz: float,
        torque_max: Sequence[float],
        torque_rate_max: Sequence[float] | None = None,
        energy_max_j: float | None = None,
        energy_window_s: float = 0.1,
    ) -> Gate: ...
    def release(self, q: _Array, tau: _Array) -> _Array:
        """Let the torques of a sample out; call it once per period.

        Args:
            q: measured positions [rad]; what is not finite counts as the last one.
            tau: torques that are asked for [N m]; one that is not finite becomes the last one.

        Returns:
            The torques to send [N m]: finite, within the limits of size and rate, and, where an energy is limited, scaled down along the
            motion.
        """

    def hold(self, tau: _Array) -> None:
        """Let the rate count from these torques [N m], with which something else holds the arm."""
    @property
    def saturated(self) -> NDArray[np.bool_]:
        """Whether the torque limit, or that of the energy, acted on the last torque."""
    @property
    def rate_limited(self) -> NDArray[np.bool_]:
        """Whether the torque-rate limit acted on the last torque."""
    @property
    def refused(self) -> NDArray[np.bool_]:
        """Whether the last torque was not finite."""

@final
class Supervisor:
    """A controller under supervision: what a real arm needs around the law.

    A guard judges every sample (finite, fresh, in order, plausible); limits hold joints, torques and their rates; modes go
    ``idle, armed, holding, tracking`` and into a latched ``safe-stop``; starts do not jolt. Call :meth:`step` once per period,
    whether a new sample came or not; whatever the values, torques are finite and within their limits.

    ``Controller(rate_hz=1000, inertia=[...], kp=[...], kd=[...], a=[[...], ...])`` makes one from numbers: the keywords are
    those of :class:`Gains`, or of :class:`PositionGains` where a ``correction`` is among them.

    Args:
        gains: what to run.
        torque_max: largest ``|tau|`` per joint [N m]; by default what the certificate is about.
        torque_rate_max: likewise for its change [N m/s].
        velocity_max: largest speed per joint [rad/s]; a faster joint is stopped, a jump beyond is refused.
        position_range: hard limits per joint [rad], beyond which the arm stops.
        soft_zone: width of the zone inside of them where the estimate does not grow outward [rad].
        braking: deceleration that a joint can always afford near a limit [rad/s^2].
        error_stop: largest ``|e|`` per joint while the law runs [rad]; beyond it the arm stops.
        frozen_travel: a position that stands still while the joint should have moved this far is frozen [rad].
        reference_limits: velocity, acceleration and jerk that every reference is shaped to [rad/s, rad/s^2, rad/s^3].
        dead_zone: inside this ``|e|``, with the reference at rest, the estimate is held [rad].
        oscillation: root mean square of the torque's second difference that counts as oscillation [N m].
        first_motion: torque variation that is enough to judge whether a joint goes the way the torque pushes [N m].
        hold_samples: samples missed in a row for which the last torque is held; then it fades to ``phi_hat``.
        stop_samples: samples missed in a row that stop the arm.
        bad_samples: unbelievable samples in a row that stop the arm.
        blend: how long a change of reference is blended over [s].
        start_mismatch_max: largest distance between pose and reference at which tracking starts [rad].
        saturation: how long a torque may stay at its limit before the arm is stopped [s]; by default for ever.
        brake_closing: how long the brakes take to hold the arm [s]; by default it has none, and the law holds it.
        error_bound: certified bound on the measured ``|e|`` per joint in holding and tracking, half a quantum of the
            encoder included [rad]; an error beyond it in three samples in a row stops the arm.
        reference_box: ends of the box per joint that every reference is kept in [rad]; with ``reference_limits``.
    """

    def __new__(
        cls,
        gains: Gains | PositionGains,
        *,
        torque_max: Sequence[float] | None = None,
        torque_rate_max: Sequence[float] | None = None,
        velocity_max: Sequence[float] | None = None,
        position_range: Sequence[tuple[float, float]] | None = None,
        soft_zone: float = 0.05,
        braking: float = 5.0,
        error_stop: Sequence[float] | None = None,
        frozen_travel: Sequence[float] | None = None,
        reference_limits: tuple[float, float, float] | None = None,
        dead_zone: Sequence[float] | None = None,
        oscillation: Sequence[float] | None = None,
        first_motion: Sequence[float] | None = None,
        hold_samples: int = 5,
        stop_samples: int = 20,
        bad_samples: int = 5,
        blend: float = 0.5,
        start_mismatch_max: float = 0.05,
        saturation: float | None = None,
        brake_closing: float | None = None,
        error_bound: Sequence[float] | None = None,
        reference_box: Sequence[tuple[float, float]] | None = None,
    ) -> Supervisor: ...
    def step(
        self,
        q: _Array,
        dq: _Array,
        q_des: _Array,
        dq_des: _Array,
        ddq_des: _Array,
        tau_applied: _Array | None = None,
        *,
        request: Literal["idle", "arm", "hold", "track", "stop"],
        sequence: int,
        t_ns: int | None = None,
        now_ns: int | None = None,
        preset: _Array | None = None,
        feed_forward: _Array | None = None,
    ) -> _Array:
        """Answer one period: the torque to apply until the next [N m].

        Args:
            q, dq, q_des, dq_des, ddq_des, tau_applied: as for :meth:`Controller.update`; not-a-number is judged, not raised.
            request: what is wanted, repeated at every step; ``"arm"`` counts when it is new.
            sequence: number of the sample; repeat the last one when none came.
            t_ns, now_ns: when the sample was taken, and now, by one clock [ns]; default: one period per number.
            preset: torques that hold the arm, heeded when it is armed [N m].
            feed_forward: torque that is known to be needed along the reference in force, beside inertia times ``ddq_des`` [N m], as the
                gravity of a description. A law from positions estimates what is left; where a feed-forward begins or ends the torque
                does not step, and one that is not finite is refused, the last one held. The other forms take no notice.

        Raises:
            ArgumentError: an array is no float64 array of one number per joint.
        """

    @property
    def joint_names(self) -> list[str]: ...
    @property
    def period(self) -> float:
        """Time between samples [s]."""

    @property
    def mode(self) -> str:
        """``idle``, ``armed``, ``holding``, ``tracking`` or ``safe-stop``, since the last step."""

    @property
    def fault(self) -> tuple[str, str] | None:
        """What stopped the arm, and the joint; kept until it is armed again."""

    @property
    def refusal(self) -> str | None:
        """Why the last request was not granted."""

    @property
    def error_share(self) -> float:
        """Largest measured error of a joint at the last step, as a share of ``error_bound``; 0 where there is none."""

    @property
    def events(self) -> list[str]:
        """What happened at the last step."""

    @property
    def brake(self) -> bool:
        """Whether the brakes should be closed."""

    @property
    def misses(self) -> int:
        """Samples missed in a row."""

    @property
    def tau(self) -> _Array:
        """The last torque [N m]."""

    @property
    def phi_hat(self) -> _Array:
        """Estimate of the unknown dynamics [N m], contained in the last torque."""

@final
class Trace:
    def column(self, name: str) -> _Array: ...
    def flag(self, name: str) -> NDArray[np.bool_]: ...
    @property
    def bounded(self) -> bool: ...
    @property
    def t(self) -> _Array: ...
    @property
    def period(self) -> float: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def gains(self) -> Gains: ...
    @property
    def metrics(self) -> dict[str, Any]: ...
    @property
    def within_spec(self) -> bool: ...
    @property
    def divergence(self) -> tuple[float, str] | None: ...
    @property
    def mode(self) -> list[str] | None: ...
    @property
    def events(self) -> list[list[str]] | None: ...
    @property
    def fault(self) -> list[str | None] | None: ...
    @property
    def run(self) -> dict[str, Any]: ...
    def page(self) -> str: ...
    def write(self, folder: _Path, csv: bool) -> None: ...
    def write_report(self, path: _Path) -> None: ...

@final
class Sample:
    """What a controller is handed at one sample; arrays of one number per joint."""

    t: float
    """Time since the start of the run [s]."""
    q: _Array
    """Measured position [rad]."""
    dq: _Array
    """Measured velocity [rad/s]."""
    q_des: _Array
    """Desired position [rad]."""
    dq_des: _Array
    """Desired velocity [rad/s]."""
    ddq_des: _Array
    """Desired acceleration [rad/s^2]."""
    tau_applied: _Array
    """Torque that acted since the sample before (mean) [N m]."""

@final
class Plant:
    def __new__(
        cls, path: str | None, document: str | None, name: str, inertia: _Array | None, command: str
    ) -> Plant: ...
    joint_names: list[str]
    period: float
    inertia: list[float]
    torque_max: list[float] | None
    @property
    def sample(self) -> Sample: ...
    @property
    def done(self) -> bool: ...
    def step(self, tau: _Array) -> Sample: ...
    def trace(self) -> Trace: ...

@final
class Rollouts:
    """Many runs of a study, ready to go; see :func:`phihat.rollouts`."""

    def __new__(cls, asked: dict[str, Any]) -> Rollouts: ...
    @property
    def gains(self) -> Gains: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def period(self) -> float: ...
    def study(self, run: int) -> dict[str, Any]: ...
    def run(
        self,
        signals: list[str],
        every: int,
        threads: int | None,
        progress: Callable[[int, int], object] | None,
    ) -> dict[str, Any]: ...

@final
class Worlds:
    """Many worlds of a study, each of which waits for the torque of its next sample; see :mod:`phihat.gym`."""

    def __new__(
        cls,
        path: _Path | None,
        document: str | None,
        name: str,
        count: int,
        gains: Gains | None,
        corrects_and_records: tuple[bool, bool],
    ) -> Worlds: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def period(self) -> float: ...
    @property
    def torque_max(self) -> list[float]: ...
    @property
    def error_bound(self) -> list[float]: ...
    def begin(self, world: int, seed: int, numbers: list[tuple[str, float]]) -> None: ...
    def step(self, acting: list[bool], actions: _Array, repeat: int) -> None: ...
    def observed(self) -> _Array: ...
    def states(self) -> tuple[_Array, NDArray[np.uint8]]: ...
    def trace(self, world: int) -> Trace: ...
