"""FMU of a crude DP for four azimuth thrusters, for logs of a ferry: told where to be, it sets speeds and angles."""

import numpy as np

from shipcosim.fmi import Fmu, Input, Output, Parameter

UNITS = range(1, 5)


class Helm(Fmu):
    """Proportional, derivative and integral action, shared out by the pseudo-inverse; units run astern where nearer."""

    x = Input("m", "position northwards")
    y = Input("m", "position eastwards")
    psi = Input("rad", "heading")
    u = Input("m/s", "velocity forward")
    v = Input("m/s", "velocity to starboard")
    r = Input("rad/s", "yaw rate")
    x_d = Input("m", "where to be, northwards")
    y_d = Input("m", "where to be, eastwards")
    psi_d = Input("rad", "where to point")
    on = Input("1", "whether it may push", start=1.0)
    rpm_1 = Output("rpm", "speed of a propeller")
    rpm_2 = Output("rpm", "speed of a propeller")
    rpm_3 = Output("rpm", "speed of a propeller")
    rpm_4 = Output("rpm", "speed of a propeller")
    azimuth_1 = Output("rad", "direction of a unit")
    azimuth_2 = Output("rad", "direction of a unit")
    azimuth_3 = Output("rad", "direction of a unit")
    azimuth_4 = Output("rad", "direction of a unit")
    mass = Parameter(3e6, "kg", "mass with its water")
    inertia = Parameter(3e9, "kg.m2", "moment of inertia with its water")
    frequency = Parameter(0.06, "rad/s", "of the closed loop")
    end = Parameter(42.0, "m", "units forward and aft of the origin")
    aside = Parameter(4.0, "m", "units to starboard of the origin")
    gain = Parameter(14e3, "kg.m", "bollard thrust over squared speed")
    fastest = Parameter(200.0, "rpm", "largest speed")
    apart = Parameter(12e3, "N", "by which fore and aft units push against each other")

    def start(self):
        self.places = [(e, s) for e in (self.end, -self.end) for s in (-self.aside, self.aside)]
        blocks = [[[1.0, 0.0], [0.0, 1.0], [-s, e]] for e, s in self.places]
        scale = np.array([1.0, 1.0, 1.0 / self.end])
        self.shared = np.linalg.pinv(scale[:, None] * np.hstack(blocks)) * scale
        self.integral, self.rate, self.before = np.zeros(3), np.zeros(3), None
        self.angles, self.speeds = np.array([np.pi, np.pi, 0.0, 0.0]), np.zeros(4)
        self._write()

    def step(self, t, h):
        want = np.array([self.x_d, self.y_d, self.psi_d])
        self.before = want if self.before is None else self.before
        self.rate += min(h / 2.0, 1.0) * ((want - self.before) / h - self.rate)
        self.before = want
        self._turned(self._forces(want, h), h)
        self._write()

    def _forces(self, want, h):
        c, s = np.cos(self.psi), np.sin(self.psi)
        there = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        error = there @ (want - [self.x, self.y, self.psi])
        error[2] = np.angle(np.exp(1j * error[2]))
        slow = there @ self.rate - [self.u, self.v, self.r]
        w = self.frequency
        self.integral = np.clip(self.integral + 0.1 * h * w**3 * error, -0.05, 0.05)
        load = np.array([self.mass, self.mass, self.inertia]) * (
            w * w * error + 1.6 * w * slow + self.integral
        )
        forces = (self.shared @ load).reshape(4, 2)
        forces[:, 0] += self.apart * np.array([-1.0, -1.0, 1.0, 1.0])
        return forces if self.on > 0.5 else 0.0 * forces

    def _turned(self, forces, h):
        sizes, angles = np.hypot(*forces.T), np.arctan2(forces[:, 1], forces[:, 0])
        off = np.angle(np.exp(1j * (angles - self.angles)))
        astern = np.abs(off) > 1.9
        off = np.where(astern, np.angle(np.exp(1j * (off + np.pi))), off) * (sizes > 0.0)
        self.angles = self.angles + np.clip(off, -0.15 * h, 0.15 * h)
        wanted = 60.0 * np.sqrt(sizes / self.gain) * np.where(astern, -1.0, 1.0)
        wanted = np.clip(wanted, -self.fastest, self.fastest)
        self.speeds = self.speeds + np.clip(wanted - self.speeds, -20.0 * h, 20.0 * h)

    def _write(self):
        for i, speed, angle in zip(UNITS, self.speeds, self.angles, strict=True):
            setattr(self, f"rpm_{i}", float(speed))
            setattr(self, f"azimuth_{i}", float(np.angle(np.exp(1j * angle))))
