"""The kernel's claims on random laws, decided again: `edges.py EDGES.jsonl`.

Shares no code with the kernel. Exact characteristic polynomials and enclosed roots come from FLINT; on the unit circle,
every condition is minimised over a grid and refined in balls of 200 bits, where the kernel uses Bernstein forms.
Each edge is looked at on both sides: what was proved has to hold, and what was not has to fail. Exit code 1: a claim
was proved that does not hold.
"""

import json
import math
import sys
from collections import Counter

import numpy as np
from flint import acb, acb_poly, arb, ctx, fmpq, fmpq_mat

ctx.prec = 200
GRID = np.concatenate([np.geomspace(1e-4, 0.3, 3000), np.linspace(0.3, math.pi, 9000)[1:]])


def exact(value):
    return fmpq(*float(value).as_integer_ratio())


class Loop:
    """Polynomials of a joint: `det(zI − A) = Δ + N/M` for the inertia `M`, and `Δ + K/M` where torque kicks."""

    def __init__(self, law, setting):
        columns = [self.sample(law, setting, place) for place in range(self.size(law, setting))]
        free, moved, kicked = ([[one[part][row] for one in columns] for row in range(len(columns))] for part in range(3))
        plus = lambda a, b: [[x + y for x, y in zip(p, q)] for p, q in zip(a, b)]
        poly = lambda rows: fmpq_mat(rows).charpoly()
        self.delta = poly(free)
        self.n = poly(plus(free, moved)) - self.delta
        self.k = poly(plus(free, kicked)) - self.delta
        self.inertia = exact(setting["inertia"])
        # L = N/(M̄Δ), in doubles for grids and in balls for what counts.
        scaled = [self.n, self.delta * self.inertia, self.k]
        self.doubles = [np.array([float(arb(c)) for c in p.coeffs()][::-1]) for p in scaled]
        self.balls = [acb_poly([acb(arb(c)) for c in p.coeffs()]) for p in scaled]

    @staticmethod
    def size(law, setting):
        return 6 + len(law["output"]) + setting["late"]

    @staticmethod
    def sample(law, setting, place):
        """One sample from a unit in one place of the state: what happens without torque, what torque moves, what it kicks."""
        states, late = len(law["output"]), setting["late"]
        zero, one = fmpq(0), fmpq(1)
        x = [zero] * (6 + states + late)
        x[place] = one
        q, dq, old_q, old_dq, reported, end = x[:6]
        own, line = x[6 : 6 + states], x[6 + states :]
        last, of_dq, of_q, of_old = map(exact, setting["velocity"])
        speed = last * old_dq + of_dq * dq + of_q * q + of_old * old_q
        inputs = [q, speed, reported]
        row = lambda a, b: sum((exact(w) * v for w, v in zip(a + b, own + inputs)), zero)
        command = row(law["output"], law["direct"])
        following = [row(a, b) for a, b in zip(law["state"], law["input"])]
        queue = line + [command]
        sent, queue = queue[0], queue[1:]
        t = exact(setting["period"])
        mean, double, after = sent, t * t / 2 * sent, sent
        if setting["drive"]:
            lost, of_mean, of_double = map(exact, setting["drive"])
            gap = end - sent
            mean, double, after = sent + of_mean * gap, double + of_double * gap, sent + (1 - lost) * gap
        tell = mean if setting["applied"] else sent
        free = [q + t * dq, dq, q, speed, tell, after, *following, *queue]
        rest = [zero] * (len(free) - 2)
        return free, [double, t * mean, *rest], [t * t / 2 * sent, zero, *rest]

    def stable(self, mu):
        """True if every root of the loop at an inertia ratio lies inside the unit circle."""
        p = self.delta * (self.inertia * exact(mu)) + self.n
        return all(abs(root) < 1 for root, _ in p.numer().complex_roots())

    def at(self, theta):
        """`N`, `M̄Δ`, `K` at `e^{jθ}` in balls."""
        z = acb(0, arb(theta)).exp()
        return [p(z) for p in self.balls]

    def grid(self):
        z = np.exp(1j * GRID)
        return [np.polyval(p, z) for p in self.doubles]


def golden(f, low, high):
    """Least value of `f` between two places, by golden sections."""
    ratio = (math.sqrt(5) - 1) / 2
    a, b = high - ratio * (high - low), low + ratio * (high - low)
    fa, fb = f(a), f(b)
    for _ in range(60):
        if fa < fb:
            high, b, fb = b, a, fa
            a = high - ratio * (high - low)
            fa = f(a)
        else:
            low, a, fa = a, b, fb
            b = low + ratio * (high - low)
            fb = f(b)
    return min(fa, fb)


def least(values, f):
    """Least value over the grid, refined around its lowest places."""
    lowest = sorted(
        (k for k in range(len(values)) if (k == 0 or values[k] <= values[k - 1]) and (k + 1 == len(values) or values[k] <= values[k + 1])),
        key=lambda k: values[k],
    )[:4]
    ends = lambda k: (float(GRID[max(k - 1, 0)]), float(GRID[min(k + 1, len(GRID) - 1)]))
    return min(golden(f, *ends(k)) for k in lowest)


def window(loop, low, high):
    return all(loop.stable(mu) for mu in [low, *np.geomspace(low, high, 7)[1:-1], high])


def modulus(loop, low, high):
    """Least `|1 + L/μ|`."""

    def value(n, d):
        # |1 + νL|² over ν = 1/μ is a parabola.
        back = (n / d).real, abs(n / d)
        nu = -back[0] / back[1] ** 2
        nu = min(max(nu, 1 / high), 1 / low) if not isinstance(nu, np.ndarray) else np.clip(nu, 1 / high, 1 / low)
        return abs(1 + nu * (n / d))

    n, d, _ = loop.grid()

    def ball(theta):
        n, d, _ = loop.at(theta)
        back = n / d
        nu = -float(back.real) / float(abs(back)) ** 2
        return float(abs(1 + back * arb(min(max(nu, 1 / high), 1 / low))))

    return least(value(n, d), ball)


def constrained(loop, low, high, angle, ball):
    """Least `angle` where `low ≤ |L| ≤ high`: inside such stretches, and at their ends."""
    n, d, _ = loop.grid()
    size = np.abs(n / d)
    inside = (size >= low) & (size <= high)
    values = np.where(inside, angle(-n / d, GRID), np.inf)
    found = [math.inf]
    if inside.any():
        found.append(float(values.min()))

    def size_at(theta):
        n, d, _ = loop.at(theta)
        return float(abs(n / d))

    for edge in (low, high):
        for k in np.flatnonzero((size[:-1] - edge) * (size[1:] - edge) < 0):
            a, b = float(GRID[k]), float(GRID[k + 1])
            rising = size[k] < edge
            for _ in range(60):
                middle = 0.5 * (a + b)
                a, b = (middle, b) if (size_at(middle) < edge) == rising else (a, middle)
            found.append(ball(a))
    for k in np.flatnonzero(inside):
        if 0 < k < len(GRID) - 1 and inside[k - 1] and inside[k + 1] and values[k] <= min(values[k - 1], values[k + 1]):
            found.append(golden(ball, float(GRID[k - 1]), float(GRID[k + 1])))
    return min(found)


def direction(loop, theta):
    n, d, _ = loop.at(theta)
    back = -n / d
    return math.atan2(float(back.imag), float(back.real))


def phase(loop, low, high):
    return constrained(loop, low, high, lambda back, _: np.abs(np.angle(back)), lambda theta: abs(direction(loop, theta)))


def delay(loop, low, high):
    turn = lambda angle: angle % math.tau
    return constrained(loop, low, high, lambda back, grid: turn(np.angle(back)) / grid, lambda theta: turn(direction(loop, theta)) / theta)


def level(loop, low, high, drift, rate, period, taps):
    """Least left side less right side of (X2), over the sizes of both."""
    c, r = (low + high) / 2, (high - low) / 2
    x, delta = high * rate * period, rate * period * (1 + (high * rate * period) ** 2 / (12 * low**4))
    eta = x / (6 * low * low)
    kappa = sum(abs(h) * min(j * delta, high - low) for j, h in enumerate(taps, 1))
    level = r * r + kappa + drift * eta * eta

    def margin(n, d, k, y):
        left = abs(n + c * d) ** 2 + y * (n * d.conjugate()).imag
        right = level * (abs(d) ** 2 + abs(k) ** 2 / drift) + abs(k) ** 2 * y * y / (4 * drift)
        return (left - right) / (abs(d) ** 2 + abs(n) ** 2)

    wave = lambda theta, sin: 2 * sum(h * sin(j * theta) for j, h in enumerate(taps, 1)) if taps else 0.0

    def ball(theta):
        n, d, k = loop.at(theta)
        y = arb(wave(theta, math.sin))
        left = abs(n + d * arb(c)) ** 2 + y * (n * d.conjugate()).imag
        right = arb(level) * (abs(d) ** 2 + abs(k) ** 2 / arb(drift)) + abs(k) ** 2 * y * y / arb(4 * drift)
        return float((left - right) / (abs(d) ** 2 + abs(n) ** 2))

    n, d, k = loop.grid()
    return least(margin(n, d, k, wave(GRID, np.sin)), ball)


def holds(loop, claim, value):
    """True, False, or `None` where the value lies within rounding of the edge."""
    name = claim["claim"]
    if name in ("window_low", "window_high"):
        return window(loop, *sorted((value, 1.0)))
    low, high = claim.get("range", (0.0, 0.0))
    if name in ("modulus", "phase", "delay"):
        edge = {"modulus": modulus, "phase": phase, "delay": delay}[name](loop, low, high)
        margin = edge - value
    elif name == "any_speed":
        low, high = 1.0 / value, value
        margin = level(loop, low, high, 3.0 * low * high, 0.0, 1.0, [])
        margin = margin if loop.stable((low + high) / 2) else -1.0
    else:
        margin = level(loop, low, high, claim["drift"], value, loop.period, claim["taps"])
    return None if abs(margin) < 1e-11 else margin > 0


def main():
    counts, wrong = Counter(), []
    for number, line in enumerate(open(sys.argv[1], encoding="utf-8")):
        entry = json.loads(line)
        loop = Loop(entry["law"], entry["setting"])
        loop.period = entry["setting"]["period"]
        for claim in entry["claims"]:
            good, bad = claim["edge"]
            name = claim["claim"]
            counts[name, "edges"] += 1
            if holds(loop, claim, good) is False:
                counts[name, "PROVED AND FALSE"] += 1
                wrong.append((number, claim))
            if bad != good and holds(loop, claim, bad):
                counts[name, "true and not proved"] += 1
    for (name, what), count in sorted(counts.items()):
        print(f"{name:12} {what:20} {count}")
    for number, claim in wrong[:20]:
        print(f"line {number + 1}: {claim}")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
