"""Steady vibration under harmonic loads: u(t) = Re(u e^(i omega t)), by modes, or by a system for every frequency.

By modes phi_k of unit mass, lambda_k = omega_k^2, with damping ratios zeta_k and loads f,

    q = sum_k phi_k (phi_k . f) / (lambda_k - omega^2 + 2 i zeta_k omega_k omega)
        + (K^-1 f - sum_k phi_k (phi_k . f) / lambda_k) / (1 + i omega tau);

the last terms are what the modes left out do at rest (Hansteen & Bell, Earthq. Eng. Struct. Dyn. 7 (1979) 481-501).
A material of Kelvin and Voigt with the time tau, and drag d on the mass, make zeta_k = (tau omega_k + d / omega_k) / 2.
Direct: (K (1 + i omega tau) + i omega d M - omega^2 M) q = f, nothing left out.

Of a structure under loads at rest K becomes K + G with the geometric stiffness G of its stresses, which damps nothing:
zeta_k = (tau omega_k e_k + d / omega_k) / 2 with the share e_k of K in the stiffness phi_k . (K + G) phi_k of a mode;
what viscosity couples of different modes is left out by modes, not by the direct solution.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.at_rest import AtRest
from kshell.analysis.modal_result import modal_result
from kshell.analysis.run import Run, described
from kshell.equilibrium.model import Model
from kshell.errors import InputError
from kshell.result.result import Result
from kshell.scene.motion import Damping
from kshell.scene.supports import Elastic
from kshell.solvers.eigen import in_range, smallest
from kshell.solvers.harmonic import harmonic_solution
from kshell.solvers.pencil import Pencil, Spectrum

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

# modes beyond the last frequency, in octaves and as a number
BEYOND, LEAST = 2.0, 6
MOST = 300
FREQUENCIES = 200
# of the range around a resonance, in half-widths of its peak, that is looked at more closely
CLOSE = np.array([-3.0, -1.0, -0.5, 0.0, 0.5, 1.0, 3.0])
# half-width of a peak without damping, relative, for the choice of frequencies
SHARP = 1e-4


@dataclass
class Harmonic:
    """A model under harmonic loads.

    Attributes
    ----------
    model : Model
    pencil : Pencil
    load : (free,)
    found : Spectrum
        Its modes from the first on.
    viscosity, drag : float
        tau and d; zero where every mode has a ratio of its own.
    ratios : (mode,)
        Of critical damping.
    points : (probe, 3)
    at_rest : AtRest, optional
        The state that it vibrates about; the modes are those of K + G.
    """

    model: Model
    pencil: Pencil
    load: Floats
    found: Spectrum
    viscosity: float
    drag: float
    ratios: Floats
    points: Floats
    at_rest: AtRest | None = None

    def by_modes(self, omega: Floats, solver: str) -> Complexes:
        """(frequency, probe, 3) at circular frequencies, with the static share of modes left out."""
        found, model = self.found, self.model
        shapes = model.expand(found.vectors)
        at_modes = np.array([model.motion_at(x, self.points) for x in shapes.T])  # (mode, probe, 3)
        push = found.vectors.T @ self.load
        loaded = self.at_rest
        slow = model.solve(solver).x if loaded is None else model.expand(loaded.solve(self.load))
        still = model.motion_at(slow, self.points)
        rest = still - np.einsum("k,kpx->px", push / found.values, at_modes)
        delay = (1.0 + 1j * omega * self.viscosity)[:, None, None]
        return amplitudes(omega, found.values, push, at_modes, self.ratios) + rest / delay

    def directly(self, omega: Floats) -> Complexes:
        """The same from a system for every frequency."""
        model, out = self.model, []
        for w in omega.tolist():
            k, m = self.model.stiffness(), self.pencil.mass
            g = None if self.at_rest is None else self.at_rest.geometric
            q = harmonic_solution(k, m, self.load, w, self.viscosity, self.drag, g)
            x = model.expand(np.column_stack([q.real, q.imag]))
            real, imag = (model.motion_at(column, self.points) for column in x.T)
            out.append(real + 1j * imag)
        return np.array(out)

    def frequencies(self, low: float, high: float) -> Floats:
        """Evenly spread, and more of them at the resonances, which themselves have no answer without damping."""
        peaks = np.sqrt(self.found.values) / (2 * np.pi)
        near = peaks[:, None] * (1 + np.maximum(self.ratios, SHARP)[:, None] * CLOSE)
        near[self.ratios == 0.0] = near[self.ratios == 0.0][:, CLOSE != 0.0][:, [*range(len(CLOSE) - 1), 0]]
        every = np.concatenate([np.linspace(low, high, FREQUENCIES), near.ravel()])
        return np.unique(every[(every >= low) & (every <= high)])


def analyse(model: Model, run: Run) -> Result:
    """Amplitudes at the probes over a range of frequencies.

    Raises
    ------
    InputError
        If there is no range, no probe, no load or no mass.
    SolveError
        If no answer was reached.
    """
    options, structure = run.options, run.structure
    _require(run)
    low, high = options.range
    direct = options.scheme == "direct"
    with run.clock.stage("assemble"):
        mass = model.mass()
        at_rest = AtRest.of(model, run) if options.prestress else None
        shakes = np.array([not placed.item.fixed for placed in model.structure.loads], dtype=float)
        load = shakes @ model.load_vectors()
        nothing = np.zeros((model.unknowns, 0))
        pencil = Pencil(model.stiffness(), mass, nothing, model.energies)
        if at_rest is not None:
            pencil = Pencil(at_rest.state.stiffness, mass, nothing)
    with run.clock.stage("solve"):
        found = in_range(pencil, 0.0, (2 * np.pi * (1.0 if direct else BEYOND) * high) ** 2, MOST)
        least = 1 if direct else LEAST
        if len(found.values) < least:
            found = smallest(pencil, least)
        damping = Damping() if run.scene.damping is None else run.scene.damping
        omega_k = np.sqrt(found.values)
        elastic = np.ones(len(omega_k))
        if at_rest is not None:
            elastic = np.diag(model.energies(found.vectors)) / found.values
        viscosity, drag = damping.material(float(omega_k[0] * elastic[0])), damping.drag
        ratios = 0.5 * (viscosity * omega_k * elastic + drag / omega_k)
        if damping.per_mode is not None:
            given = damping.per_mode
            ratios = np.array([given[min(k, len(given) - 1)] for k in range(len(omega_k))])
        points = np.array(list(structure.probes.values()), dtype=float)
        shaken = Harmonic(model, pencil, load, found, viscosity, drag, ratios, points, at_rest)
        omega = 2 * np.pi * shaken.frequencies(low, high)
        u = shaken.directly(omega) if direct else shaken.by_modes(omega, options.solver)
    with run.clock.stage("recover"):
        result = modal_result(model, found.vectors)
    result.response = {
        "frequency": (omega / (2 * np.pi)).tolist(),
        "damping": ratios.tolist(),
        "modes": (omega_k / (2 * np.pi)).tolist(),
        "probes": {
            name: {"u": {"real": u[:, p].real.tolist(), "imag": u[:, p].imag.tolist()}}
            for p, name in enumerate(structure.probes)
        },
    }
    result.warnings += found.notes
    inside = (omega_k >= 2 * np.pi * low) & (omega_k <= 2 * np.pi * high) & (ratios == 0.0)
    if inside.any():
        result.warnings.append(
            f"nothing damps the resonance at {omega_k[inside][0] / (2 * np.pi):.5g} Hz: amplitudes grow without bound "
            "towards it, those given are of frequencies beside it; give [damping]"
        )
    reasons = [_words(shaken, direct)]
    if at_rest is not None:
        reasons += at_rest.state.reasons
        result.warnings += at_rest.state.warnings
        if viscosity and not direct:
            reasons.append(
                "damping: stresses at rest damp nothing; what viscosity couples of different modes is left out"
            )
    if viscosity and any(isinstance(placed.item, Elastic) for placed in structure.supports):
        reasons.append("damping: elastic supports are as viscous as the material")
    why = "a complex system for every frequency" if direct else "modes, by Lanczos' method"
    name = "SuperLU (scipy)" if direct else found.solver
    solver = {"name": name, "why": why, "iterations": len(omega) if direct else found.solves}
    return described(result, model, run, reasons, solver, large=False)


def _words(shaken: Harmonic, direct: bool) -> str:
    found, ratios = shaken.found, shaken.ratios
    damped = (
        f"{ratios[0]:.4g}" if np.ptp(ratios) == 0 else f"{ratios[0]:.4g} (first) to {ratios[-1]:.4g} (last)"
    )
    if direct:
        return (
            f"harmonic response: a system for every frequency; damping ratio of the modes up to "
            f"{np.sqrt(found.values[-1]) / (2 * np.pi):.5g} Hz: {damped}"
        )
    return (
        f"harmonic response: {len(found.values)} modes up to {np.sqrt(found.values[-1]) / (2 * np.pi):.5g} Hz with the "
        f"damping ratio {damped}, the others by their static share"
    )


def amplitudes(omega: Floats, values: Floats, push: Floats, shapes: Floats, ratios: Floats) -> Complexes:
    """(frequency, probe, 3) of the modes alone.

    Parameters
    ----------
    omega : (frequency,)
    values, push, ratios : (mode,)
        lambda_k, phi_k . f and zeta_k.
    shapes : (mode, probe, 3)
    """
    w = omega[:, None]
    gain = push / (values - w**2 + 2j * ratios * np.sqrt(values) * w)
    return np.asarray(np.einsum("wk,kpx->wpx", gain, shapes))


def _require(run: Run) -> None:
    options, structure = run.options, run.structure
    if options.range is None:
        raise InputError('analysis = "response" needs a range of frequencies: range = [0, 100]')
    if options.count is not None:
        raise InputError('count is for analysis = "modes": leave it out, a response takes the modes it needs')
    fixed = [str(placed.item) for placed in structure.loads if placed.item.fixed]
    if fixed and not options.prestress:
        raise InputError(
            f"{fixed[0]} has fixed = true, and does not shake: prestress = true lets such loads act at rest; or leave "
            "fixed out"
        )
    damping = run.scene.damping
    if options.scheme == "direct" and damping is not None and damping.per_mode is not None:
        raise InputError(
            'damping: a ratio for every mode is for scheme = "modes": a direct solution is damped by the material; '
            "give the ratio of the first mode, a number, or viscosity or drag"
        )
    moved = [
        str(placed.item)
        for placed in structure.supports
        if placed.item.moves and not (placed.item.fixed and options.prestress)
    ]
    if moved:
        raise InputError(
            f"{moved[0]} prescribes a motion: a response is to loads, leave value and rotation out, or, with "
            "prestress = true, give fixed = true: a motion at rest"
        )
    if not structure.probes:
        raise InputError('analysis = "response" needs a probe: it gives the amplitudes there')
    if len(fixed) == len(structure.loads):
        raise InputError(
            'analysis = "response" needs loads that are not fixed: their values are the amplitudes of harmonic ones'
        )
