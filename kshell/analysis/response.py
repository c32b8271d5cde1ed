"""Steady vibration under harmonic loads: u(t) = Re(u e^(i omega t)), by modes with damping and a static correction.

With modes phi_k of unit mass, lambda_k = omega_k^2, damping ratios zeta and loads f,

    q = sum_k phi_k (phi_k . f) / (lambda_k - omega^2 + 2 i zeta omega_k omega)
        + K^-1 f - sum_k phi_k (phi_k . f) / lambda_k;

the last two terms are what the modes left out do at rest (Hansteen & Bell, Earthq. Eng. Struct. Dyn. 7 (1979) 481-501).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.modal_result import modal_result
from kshell.analysis.run import Run, described
from kshell.equilibrium.model import Model
from kshell.errors import InputError
from kshell.result.result import Result
from kshell.solvers.eigen import in_range, smallest
from kshell.solvers.pencil import Pencil, Spectrum

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

# modes beyond the last frequency, in octaves and as a number
BEYOND, LEAST = 2.0, 6
MOST = 300
FREQUENCIES = 200
# of the range around a resonance, in half-widths of its peak, that is looked at more closely
CLOSE = np.array([-3.0, -1.0, -0.5, 0.0, 0.5, 1.0, 3.0])


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
    with run.clock.stage("assemble"):
        mass, stiffness = model.mass(), model.stiffness()
        load = model.load_vectors().sum(axis=0)
        pencil = Pencil(stiffness, mass, np.zeros((model.unknowns, 0)), model.energies)
    with run.clock.stage("solve"):
        found = in_range(pencil, 0.0, (2 * np.pi * BEYOND * high) ** 2, MOST)
        if len(found.values) < LEAST:
            found = smallest(pencil, LEAST)
        still = model.solve(options.solver).x
    with run.clock.stage("recover"):
        shapes = model.expand(found.vectors)
        points = np.array(list(structure.probes.values()), dtype=float)
        at_modes = np.array([model.motion_at(x, points) for x in shapes.T])  # (mode, probe, 3)
        push = found.vectors.T @ load
        omega = 2 * np.pi * _frequencies(low, high, found, options.damping)
        rest = model.motion_at(still, points) - np.einsum("k,kpx->px", push / found.values, at_modes)
        u = amplitudes(omega, found.values, push, at_modes, options.damping) + rest
        result = modal_result(model, found.vectors)
    result.response = {
        "frequency": (omega / (2 * np.pi)).tolist(),
        "damping": options.damping,
        "modes": np.sqrt(found.values / (4 * np.pi**2)).tolist(),
        "probes": {
            name: {"u": {"real": u[:, p].real.tolist(), "imag": u[:, p].imag.tolist()}}
            for p, name in enumerate(structure.probes)
        },
    }
    result.warnings += found.notes
    reasons = [
        f"harmonic response: {len(found.values)} modes up to {np.sqrt(found.values[-1]) / (2 * np.pi):.5g} Hz with the "
        f"damping ratio {options.damping:g}, the others by their static share"
    ]
    solver = {"name": found.solver, "why": "modes, by Lanczos' method", "iterations": found.solves}
    return described(result, model, run, reasons, solver, large=False)


def amplitudes(omega: Floats, values: Floats, push: Floats, shapes: Floats, ratio: float) -> Complexes:
    """(frequency, probe, 3) of the modes alone.

    Parameters
    ----------
    omega : (frequency,)
    values, push : (mode,)
        lambda_k, and phi_k . f.
    shapes : (mode, probe, 3)
    """
    w = omega[:, None]
    gain = push / (values - w**2 + 2j * ratio * np.sqrt(values) * w)
    return np.asarray(np.einsum("wk,kpx->wpx", gain, shapes))


def _require(run: Run) -> None:
    options, structure = run.options, run.structure
    if options.range is None:
        raise InputError('analysis = "response" needs a range of frequencies: range = [0, 100]')
    if options.count is not None or options.prestress:
        key = "count" if options.count is not None else "prestress"
        raise InputError(
            f'{key} is for analysis = "modes": leave it out, a response takes the modes it needs'
        )
    moved = [str(placed.item) for placed in structure.supports if placed.item.value is not None]
    if moved:
        raise InputError(f"{moved[0]} prescribes a motion: a response is to loads, leave the value out")
    if not structure.probes:
        raise InputError('analysis = "response" needs a probe: it gives the amplitudes there')
    if not structure.loads:
        raise InputError(
            'analysis = "response" needs loads: their values are the amplitudes of harmonic ones'
        )


def _frequencies(low: float, high: float, found: Spectrum, ratio: float) -> Floats:
    """Evenly spread, and more of them at the resonances."""
    peaks = np.sqrt(found.values) / (2 * np.pi)
    near = peaks[:, None] * (1 + max(ratio, 1e-4) * CLOSE)
    every = np.concatenate([np.linspace(low, high, FREQUENCIES), near.ravel()])
    return np.unique(every[(every >= low) & (every <= high)])
