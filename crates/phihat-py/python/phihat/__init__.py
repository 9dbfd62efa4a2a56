"""phihat controls a robot arm by torque without a model of it, with a guarantee on the joint error.

>>> import phihat
>>> gains = phihat.design("studies/panda_design.toml")     # for an error bound, with a certificate
>>> gains.verify()                                          # anyone can check it again
>>> trace = phihat.simulate("studies/panda_design.toml", gains=gains)
>>> trace.within_spec
True
>>> controller = phihat.Controller(gains)                   # the law: one call per sample
>>> mine = phihat.simulate("studies/panda.toml", controller=my_law)     # your own law in the same world
>>> rolled = phihat.rollouts("studies/first.toml", {"payload_kg": [0.1, 0.5]})    # many runs, as arrays
>>> arm = phihat.Supervisor(gains)                          # and around it what a real arm needs
>>> phihat.drive("studies/panda.toml", my_robot)            # the whole of it on your own robot     # doctest: +SKIP

Everything is in SI units and radians; the error is measured minus desired, ``e = q - q_des``. Arrays have one
entry per joint in the order of ``joint_names``.
"""

from ._errors import (
    ArgumentError,
    Error,
    GainsError,
    Infeasible,
    Refuted,
    RobotError,
    SampleRefused,
    StudyError,
)
from ._phihat import Controller, Gains, Gate, PositionGains, Robot, Sample, Supervisor
from ._phihat import version as _version
from ._crosscheck import Crosscheck, crosscheck
from ._document import Study
from ._drive import Driven, Link, drive
from ._read import read_trace
from ._rollouts import Rollouts, rollouts
from ._sweep import sweep
from .own import ArmFacts, Law, Plant
from .study import bound, compare, design, faults, read_run, report, reproduce, robots, simulate, verify
from .trace import Trace

__version__ = _version()

__all__ = [
    "ArgumentError",
    "ArmFacts",
    "Controller",
    "Crosscheck",
    "Driven",
    "Error",
    "Gains",
    "GainsError",
    "Gate",
    "Infeasible",
    "Law",
    "Link",
    "Plant",
    "PositionGains",
    "Refuted",
    "Robot",
    "RobotError",
    "Rollouts",
    "Sample",
    "SampleRefused",
    "Study",
    "StudyError",
    "Supervisor",
    "Trace",
    "bound",
    "compare",
    "crosscheck",
    "design",
    "drive",
    "faults",
    "read_run",
    "read_trace",
    "report",
    "reproduce",
    "robots",
    "rollouts",
    "simulate",
    "sweep",
    "verify",
]
