"""Studies that an attack kept, run again by programs that share no line with phihat.

For every folder: ``study.toml`` (and ``world*.toml``), the arm's files, ``gains.json``, ``claim.json``. The control loop is
written here from docs/theory and docs/study.md; the arm's dynamics are Pinocchio's and MuJoCo's, both from the URDF. Every
sample is held against the claim. Prints one JSON line per folder; exit code 1 where a claim was left.
"""

from __future__ import annotations

import json
import math
import re
import sys
import tomllib
from pathlib import Path
from typing import Any, Callable

import mujoco
import numpy as np
import pinocchio

REPOSITORY = Path(__file__).resolve().parents[3]
COULOMB_VELOCITY = 1e-3
LONGEST_STEP = 2.5e-4
STEPS_MAX = 40_000
ROUNDING = 1e-6
"""By which an integrator of one's own may be beyond a claim."""


class Skip(Exception):
    """Something that is not written down here."""


class Arm:
    """The arm as its files have it: URDF text, rotor inertia, friction, limits."""

    def __init__(self, folder: Path, study: dict[str, Any]) -> None:
        named = study["robot"].get("name")
        base = REPOSITORY / "crates" / "phihat-model" / "robots" if named else folder
        self.extras = tomllib.loads((base / f"{named or 'arm'}.toml").read_text())
        self.urdf = (base / self.extras["urdf"]).read_text()
        self.names: list[str] = self.extras["joints"]
        n = len(self.names)
        self.kinds = {k: v for k, v in re.findall(r'<joint name="([^"]+)"\s+type="(\w+)"', self.urdf)}

        def values(section: str, key: str, otherwise: Any) -> np.ndarray:
            value = self.extras.get(section, {}).get(key, otherwise)
            return np.broadcast_to(np.asarray(value, dtype=float), (n,)).copy()

        def tag(name: str, key: str) -> float:
            found = re.search(rf'<joint name="{re.escape(name)}".*?</joint>', self.urdf, re.S)
            value = re.search(rf'\b{key}="([^"]+)"', found.group(0) if found else "")
            return float(value.group(1)) if value else 0.0

        self.armature = values("rotor", "armature_kg_m2", 0.0)
        self.viscous = values("friction", "viscous_nm_s_rad", [tag(name, "damping") for name in self.names])
        self.coulomb = values("friction", "coulomb_nm", [tag(name, "friction") for name in self.names])
        self.sigmoid = [values("friction", f"sigmoid_{key}", 0.0) for key in ("amplitude_nm", "steepness_s_rad", "offset_rad_s")]
        most = [tag(name, "effort") or math.inf for name in self.names]
        self.torque_max = values("limits", "torque_max_nm", most)
        self.bits = self.extras.get("encoder", {}).get("bits")

    def loaded(self, payload: dict[str, Any] | None) -> str:
        """The URDF with a body welded to a frame."""
        if payload is None:
            return self.urdf
        xx, xy, xz, yy, yz, zz = payload.get("inertia_kg_m2", [0.0] * 6)
        com = " ".join(map(repr, payload.get("com_m", [0.0, 0.0, 0.0])))
        link = f"""
  <link name="payload_body"><inertial><origin xyz="{com}"/><mass value="{payload['mass_kg']!r}"/>
    <inertia ixx="{xx!r}" ixy="{xy!r}" ixz="{xz!r}" iyy="{yy!r}" iyz="{yz!r}" izz="{zz!r}"/></inertial></link>
  <joint name="payload_weld" type="fixed"><parent link="{payload.get('frame', self.extras['tip'])}"/>
    <child link="payload_body"/></joint>
</robot>"""
        return self.urdf.replace("</robot>", link)


class Pinocchio:
    """Forward dynamics by Pinocchio."""

    def __init__(self, arm: Arm, urdf: str, gravity: list[float]) -> None:
        self.model = pinocchio.buildModelFromXML(urdf)
        self.model.gravity.linear = np.array(gravity)
        self.model.armature[:] = 0.0
        self.data = self.model.createData()
        ids = [self.model.getJointId(name) for name in arm.names]
        self.velocity = [self.model.joints[i].idx_v for i in ids]
        self.position = [(self.model.joints[i].idx_q, self.model.joints[i].nq) for i in ids]
        if self.model.nv != len(arm.names):
            raise Skip("joints that are locked")
        self.armature = arm.armature

    def acceleration(self, q: np.ndarray, dq: np.ndarray, tau: np.ndarray) -> np.ndarray:
        full, speed = np.zeros(self.model.nq), np.zeros(self.model.nv)
        for (at, size), value in zip(self.position, q):
            full[at : at + size] = value if size == 1 else (math.cos(value), math.sin(value))
        speed[self.velocity] = dq
        bias = pinocchio.nonLinearEffects(self.model, self.data, full, speed)
        upper = pinocchio.crba(self.model, self.data, full)
        mass = np.triu(upper) + np.triu(upper, 1).T
        at = np.ix_(self.velocity, self.velocity)
        return np.linalg.solve(mass[at] + np.diag(self.armature), tau - bias[self.velocity])


class Mujoco:
    """Forward dynamics by MuJoCo."""

    def __init__(self, arm: Arm, urdf: str, gravity: list[float]) -> None:
        head, rest = re.match(r"(.*?<robot[^>]*>)(.*)", urdf, re.S).groups()
        keep = '<mujoco><compiler balanceinertia="false" inertiafromgeom="false"/></mujoco>'
        # A point mass has no inertia of its own; MuJoCo wants some.
        rest = rest.replace('ixx="0.0" ixy="0.0" ixz="0.0" iyy="0.0" iyz="0.0" izz="0.0"', 'ixx="1e-12" ixy="0" ixz="0" iyy="1e-12" iyz="0" izz="1e-12"')
        self.model = mujoco.MjModel.from_xml_string(head + keep + rest)
        self.model.opt.gravity[:] = gravity
        for flag in (mujoco.mjtDisableBit.mjDSBL_CONTACT, mujoco.mjtDisableBit.mjDSBL_LIMIT):
            self.model.opt.disableflags |= flag
        self.model.dof_damping[:] = 0.0
        self.model.dof_frictionloss[:] = 0.0
        ids = [mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, name) for name in arm.names]
        if self.model.nv != len(arm.names) or min(ids) < 0:
            raise Skip("joints that are locked")
        self.q, self.dq = self.model.jnt_qposadr[ids].copy(), self.model.jnt_dofadr[ids].copy()
        self.model.dof_armature[self.dq] = arm.armature
        self.data = mujoco.MjData(self.model)

    def acceleration(self, q: np.ndarray, dq: np.ndarray, tau: np.ndarray) -> np.ndarray:
        self.data.qpos[self.q], self.data.qvel[self.dq] = q, dq
        self.data.qfrc_applied[self.dq] = tau
        mujoco.mj_forward(self.model, self.data)
        return np.array(self.data.qacc[self.dq])


def quintic(t: float, whole: float) -> tuple[float, float, float]:
    """From 0 to 1 with rest at both ends, its slope and bend."""
    if whole <= 0.0 or t >= whole:
        return 1.0, 0.0, 0.0
    s = t / whole
    value = s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
    slope = 30.0 * s * s * (1.0 - s) ** 2 / whole
    return value, slope, 60.0 * s * (1.0 - 3.0 * s + 2.0 * s * s) / whole**2


def reference(arm: Arm, section: dict[str, Any]) -> Callable[[float], tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """What the arm shall do."""
    n = len(arm.names)
    spread = lambda x: np.broadcast_to(np.asarray(x, dtype=float), (n,))
    posture = lambda s, key, pose: spread(s[key]) if key in s else spread(arm.extras["poses"][s[pose]])
    if section["kind"] == "hold":
        q, zero = posture(section, "q_rad", "pose"), np.zeros(n)
        return lambda t: (q, zero, zero)
    if section["kind"] == "waypoints":
        points = [(p["t_s"], posture(p, "q_rad", "pose")) for p in section["waypoint"]]

        def along(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            at = max(sum(1 for start, _ in points if start <= t), 1)
            start, q = points[at - 1]
            if at == len(points):
                return q, np.zeros(n), np.zeros(n)
            value, slope, bend = quintic(t - start, points[at][0] - start)
            change = points[at][1] - q
            return q + change * value, change * slope, change * bend

        return along
    if section["kind"] != "sines":
        raise Skip(f"reference {section['kind']}")
    center, fade = posture(section, "center_rad", "center"), section.get("fade_in_s", 1.0)
    terms = [
        (spread(s["amplitude_rad"]), 2.0 * np.pi * spread(s["frequency_hz"]), spread(s.get("phase_rad", 0.0)))
        for s in section["sine"]
    ]

    def sines(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        a = sum(A * np.sin(w * t + p) for A, w, p in terms)
        b = sum(A * w * np.cos(w * t + p) for A, w, p in terms)
        c = sum(-A * w * w * np.sin(w * t + p) for A, w, p in terms)
        w0, w1, w2 = quintic(t, fade)
        return center + w0 * a, w0 * b + w1 * a, w0 * c + 2.0 * w1 * b + w2 * a

    return sines


def sampled(a: list[float], period: float) -> np.ndarray:
    """(T5): coefficients of the estimator in the difference operator."""
    m = len(a)
    companion = np.diag(np.ones(m - 1), 1)
    companion[-1, :] = [-x for x in a]
    # Scaled so that all entries are of one size.
    scale = a[-1] ** np.arange(m)
    x = companion * period * scale[None, :] / scale[:, None]
    halvings = max(0, math.ceil(math.log2(max(np.abs(x).max(), 1e-9))) + 3)
    x = x / 2.0**halvings
    term, whole = x.copy(), x.copy()
    for k in range(2, 24):
        term = term @ x / k
        whole = whole + term
    for _ in range(halvings):
        whole = whole @ whole + 2.0 * whole
    return np.poly(whole / period)[1:].real  # alpha_{m-1} … alpha_0


class Law:
    """(T1) with (T4), or with (9), (10), (16); all joints at once."""

    def __init__(self, gains: dict[str, Any], period: float, literal: bool) -> None:
        joints = gains["joints"]
        self.inertia = np.array([j["inertia_kg_m2"] for j in joints])
        self.kp = np.array([j["kp_per_s2"] for j in joints])
        self.kd = np.array([j["kd_per_s"] for j in joints])
        self.a = np.array([j["a"] for j in joints])
        self.alpha = np.array([sampled(j["a"], period) for j in joints])
        self.period, self.literal = period, literal
        self.order = self.a.shape[1]
        self.memory = np.zeros((self.order, len(joints)))
        self.last: np.ndarray | None = None

    def torque(self, q: np.ndarray, dq: np.ndarray, applied: np.ndarray, wanted: tuple[np.ndarray, ...]) -> np.ndarray:
        e, de = q - wanted[0], dq - wanted[1]
        if self.literal:
            phi = self._literal(e, de)
        else:
            phi = self._observed(dq, applied)
        self.last = dq.copy()
        return self.inertia * (wanted[2] - self.kd * de - self.kp * e) + phi

    def _observed(self, dq: np.ndarray, applied: np.ndarray) -> np.ndarray:
        if self.last is not None:
            innovation = self.period * (applied - self.memory[0]) - self.inertia * (dq - self.last)
            above = np.vstack([self.memory[1:], np.zeros_like(self.memory[:1])])
            self.memory = self.memory + self.period * above + self.alpha.T * innovation
        return self.memory[0]

    def _literal(self, e: np.ndarray, de: np.ndarray) -> np.ndarray:
        below = e
        for k in range(self.order):
            if self.last is not None:
                self.memory[k] = self.memory[k] + self.period * below
            below = self.memory[k]
        ladder = [*self.memory[::-1], e, de]
        a = lambda i: self.a[:, i] if 0 <= i < self.order else 0.0
        total = sum((a(i - 1) * self.kp + a(i - 2) * self.kd + a(i - 3)) * x for i, x in enumerate(ladder, 1))
        return -self.inertia * total


def run(folder: Path, study: dict[str, Any], phase: list[float], gains: dict[str, Any], engine: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray, bool]:
    """Times, errors and velocity errors of a run, and whether a torque limit acted."""
    for section in ("supervisor", "profile", "fault"):
        if section in study:
            raise Skip(section)
    arm = Arm(folder, study)
    n = len(arm.names)
    world, sensor, loop = study.get("world", {}), study.get("sensor", {}), study.get("loop", {})
    spread = lambda x: np.broadcast_to(np.asarray(x, dtype=float), (n,))
    rate = loop.get("rate_hz", 1000.0)
    period = round(1e9 / rate) * 1e-9
    samples = max(round(study["duration_s"] / period), 1)
    plant = engine(arm, arm.loaded(world.get("payload")), world.get("gravity_m_s2", [0.0, 0.0, -9.81]))
    own = 1.0 if world.get("friction", "robot") == "robot" else 0.0
    viscous = own * arm.viscous + spread(world.get("viscous_extra_nm_s_rad", 0.0))
    coulomb = own * arm.coulomb + spread(world.get("coulomb_extra_nm", 0.0))
    amplitude, steep, offset = own * arm.sigmoid[0], arm.sigmoid[1], arm.sigmoid[2]

    def friction(v: np.ndarray) -> np.ndarray:
        smooth = amplitude / (1.0 + np.exp(-steep * (v + offset))) - amplitude / (1.0 + np.exp(-steep * offset))
        return viscous * v + coulomb * v / np.sqrt(v * v + COULOMB_VELOCITY**2) + smooth

    bits = sensor.get("encoder_bits", "none")
    bits = arm.bits if bits == "robot" else bits
    quantum = None if bits in ("none", None) else 2.0 * np.pi / 2.0 ** spread(bits)
    bias = spread(sensor.get("position_bias_rad", 0.0))
    displaced = spread(phase or 0.0)
    cut = sensor.get("velocity_filter_hz")
    cut = gains.get("velocity_filter_hz") if cut == "design" else cut
    share = 1.0 if cut is None else -math.expm1(-2.0 * math.pi * cut * period)
    measured = sensor.get("velocity", "measured") == "measured"
    demanded = sensor.get("torque", "applied") == "demanded"
    limit = loop.get("torque_max_nm", "robot")
    limit = arm.torque_max if limit == "robot" else np.full(n, np.inf) if limit == "none" else spread(limit)
    lag = world.get("drive_bandwidth_hz", "none")
    lag = None if lag == "none" else 2.0 * np.pi * spread(lag)
    pushes = [(arm.names.index(p["joint"]), p["torque_nm"], p["start_s"], p["start_s"] + p["duration_s"]) for p in world.get("push", [])]
    along = reference(arm, study["reference"])
    law = Law(gains, period, loop.get("form", "observer") == "literal")
    # Steps of its own; where friction is stiff, finer than the study's.
    needed = world.get("substeps", 1)
    substeps = max(needed + 1 if needed > 1 else 1, math.ceil(period / LONGEST_STEP))
    if samples * substeps > STEPS_MAX:
        raise Skip("too many steps of integration")
    h = period / substeps

    q, dq, _ = (np.array(x) for x in along(0.0))
    if "start" in study:
        start = study["start"]
        q = np.array(spread(start["q_rad"] if "q_rad" in start else arm.extras["poses"][start["pose"]]))
        dq = np.array(spread(start.get("dq_rad_s", 0.0)))
    queue = [np.zeros(n) for _ in range(loop.get("delay_samples", 0))]
    told, gap, applied = np.zeros(n), np.zeros(n), np.zeros(n)
    before: tuple[np.ndarray, np.ndarray] | None = None
    times, errors, speeds, limited = [], [], [], False
    for k in range(samples):
        t = k * period
        wanted = along(t)
        times.append(t)
        errors.append(q - wanted[0])
        speeds.append(dq - wanted[1])
        read = q + bias
        if quantum is not None:
            steps = read / quantum + displaced
            read = quantum * (np.copysign(np.floor(np.abs(steps) + 0.5), steps) - displaced)
        if before is None:
            speed = dq.copy()
        else:
            raw = dq if measured else (read - before[0]) / period
            speed = before[1] + share * (raw - before[1])
        before = read, speed
        tau = law.torque(read, speed, told if demanded else applied, wanted)
        limited = limited or bool((np.abs(tau) > limit).any())
        queue.append(np.clip(tau, -limit, limit))
        new = queue.pop(0)
        gap, told = (np.zeros(n), new) if lag is None else (gap + told - new, new)
        for step in range(substeps):
            began = step * h
            external = np.zeros(n)
            for joint, torque, start_s, end_s in pushes:
                if start_s <= t + began < end_s:
                    external[joint] += torque

            def ddq(s: float, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
                acts = told if lag is None else told + gap * np.exp(-lag * s)
                return plant.acceleration(q, dq, acts + external - friction(dq))

            a1 = ddq(began, q, dq)
            a2 = ddq(began + 0.5 * h, q + 0.5 * h * dq, dq + 0.5 * h * a1)
            a3 = ddq(began + 0.5 * h, q + 0.5 * h * dq + 0.25 * h * h * a1, dq + 0.5 * h * a2)
            a4 = ddq(began + h, q + h * dq + 0.5 * h * h * a2, dq + h * a3)
            q = q + h * dq + h * h / 6.0 * (a1 + a2 + a3)
            dq = dq + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        applied = told
        if lag is not None:
            applied = told - gap * np.expm1(-lag * period) / (lag * period)
            gap = gap * np.exp(-lag * period)
        if not np.isfinite(q).all() or np.abs(dq).max() > 1e3:
            break
    return np.array(times), np.array(errors), np.array(speeds), limited


def against(claim: dict[str, Any], t: np.ndarray, errors: np.ndarray, speeds: np.ndarray) -> dict[str, Any]:
    """Furthest out of the claim: a ratio above 1 has left it."""
    worst: dict[str, Any] = {"ratio": 0.0}
    for i, joint in enumerate(claim["joints"]):
        since = t - joint["from_s"]
        there = since >= -1e-12
        for signal, values in (("error", errors), ("velocity", speeds)):
            bins = np.array(joint[signal])
            place = np.zeros(len(t), dtype=int)
            if joint["bin_s"] is not None:  # one bin else
                place = np.clip((since / joint["bin_s"] + 1e-9).astype(int), 0, len(bins) - 1)
            low, high = bins[place, 0], bins[place, 1]
            ratio = np.abs(values[:, i] - 0.5 * (low + high)) / (0.5 * (high - low) + 1e-12)
            ratio = np.where(there, np.nan_to_num(ratio, nan=np.inf), 0.0)
            k = int(ratio.argmax())
            if ratio[k] > worst["ratio"]:
                worst = {"ratio": float(ratio[k]), "joint": joint["name"], "signal": signal, "t_s": float(t[k]), "measured": float(values[k, i]), "claimed": [float(low[k]), float(high[k])]}
    return worst


def examine(folder: Path) -> dict[str, Any]:
    """All worlds of one kept study, by both engines."""
    gains = json.loads((folder / "gains.json").read_text())
    claim = json.loads((folder / "claim.json").read_text())
    found: dict[str, Any] = {"folder": str(folder), "runs": [], "left": 0, "skipped": None}
    for path in sorted(folder.glob("study.toml")) + sorted(folder.glob("world*.toml")):
        text = path.read_text()
        study = tomllib.loads(text)
        phase = re.match(r"# encoder_phase = (\[.*\])", text)
        displaced = json.loads(phase.group(1)) if phase else []
        for engine in (Pinocchio, Mujoco):
            try:
                t, errors, speeds, limited = run(folder, study, displaced, gains, engine)
            except Skip as why:
                found["skipped"] = str(why)
                return found
            worst = against(claim, t, errors, speeds)
            steady = t >= claim["settle_s"] - 1e-12
            entry = {"world": path.name, "engine": engine.__name__, "limited": limited, "worst": worst}
            entry["error_peak_rad"] = [float(x) for x in np.abs(errors[steady]).max(axis=0)] if steady.any() else []
            outside = limited and not claim["limits_silent"]
            left = not outside and (limited or worst["ratio"] > 1.0 + ROUNDING)
            entry["left"] = left
            found["left"] += int(left)
            found["runs"].append(entry)
    return found


def main() -> int:
    """Examines the folders named."""
    left = 0
    for name in sys.argv[1:]:
        found = examine(Path(name))
        print(json.dumps(found), flush=True)
        left += found["left"]
    return 1 if left else 0


if __name__ == "__main__":
    sys.exit(main())
