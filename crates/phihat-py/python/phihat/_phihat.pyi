"""The compiled half of phihat."""

import os
from collections.abc import Sequence
from typing import Any, Literal, final

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[np.float64]
_Numbers = _Array | Sequence[float]
_Path = str | os.PathLike[str]

__all__ = [
    "Controller",
    "Gains",
    "Robot",
    "Trace",
    "command",
    "design",
    "simulate",
    "study_document",
    "version",
]

def version() -> str: ...
def command(arguments: Sequence[str]) -> int: ...
def design(path: _Path | None, document: str | None, name: str) -> Gains: ...
def simulate(
    path: _Path | None,
    document: str | None,
    name: str,
    gains: Gains | None,
    uncertified: bool,
) -> Trace: ...
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
    def from_urdf(path: _Path, gravity: tuple[float, float, float] = ...) -> Robot:
        """Read a URDF, or the TOML file beside one that adds rotors, friction and limits.

        Args:
            gravity: in the axes of the robot's base [m/s^2].

        Raises:
            RobotError: with file and line, link or joint, and what would be valid.
        """

    @staticmethod
    def from_text(
        urdf: str,
        toml: str | None = None,
        origin: str = "text",
        gravity: tuple[float, float, float] = ...,
    ) -> Robot:
        """Read a URDF and what it leaves out from their texts; ``origin`` stands for the file in errors."""

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
    """Gains of an arm's joints, as in ``gains.json``, with what is certified about them."""

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

@final
class Controller:
    """The controller of an arm: one :meth:`update` per sample.

        tau = M (ddq_des - K_d de - K_p e) + phi_hat,      e = q - q_des

    Args:
        gains: what to run.
        torque_max: largest ``|tau|`` per joint [N m], infinite for none; by default what the certificate is about.
        torque_rate_max: likewise for the change of torque [N m/s].
        form: ``"literal"`` runs the paper's integrals of the error, for reproduction.
    """

    def __new__(
        cls,
        gains: Gains,
        *,
        torque_max: Sequence[float] | None = None,
        torque_rate_max: Sequence[float] | None = None,
        form: Literal["observer", "literal"] = "observer",
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
            q_des, dq_des, ddq_des: what the arm shall do [rad, rad/s, rad/s^2].
            tau_applied: torque that acted since the last sample (mean) [N m]; if it is not measured, the torque that was
                commanded last is taken. With a transport delay, pass what was commanded for that time.
            t_ns: a stamp of any clock [ns]; must go forward by at most three periods.

        Returns:
            The torque to apply until the next sample [N m], finite and within the limits.

        Raises:
            SampleRefused: a value is not finite; hold its ``tau``. The state is as before.
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
class Trace:
    def column(self, name: str) -> _Array: ...
    def flag(self, name: str) -> NDArray[np.bool_]: ...
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
    def run(self) -> dict[str, Any]: ...
    def page(self) -> str: ...
    def write(self, folder: _Path) -> None: ...
    def write_report(self, path: _Path) -> None: ...
