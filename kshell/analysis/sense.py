"""Options that contradict each other or the structure: refused before a model is chosen."""

from __future__ import annotations

from dataclasses import replace

from kshell.errors import InputError
from kshell.scene.options import SolveOptions
from kshell.scene.structure import Structure
from kshell.values.naming import listing

# analyses that take a flat structure as a plate in bending, with what its loads do in the plane found beside it
BENDING = ("modes", "buckling")


def at_rest_first(options: SolveOptions) -> bool:
    """Whether some loads act at rest before others shake the structure: those with fixed = true."""
    return options.analysis == "response" and bool(options.prestress)


def shaking(structure: Structure) -> Structure:
    """The structure under the loads that shake it alone."""
    return replace(structure, loads=tuple(placed for placed in structure.loads if not placed.item.fixed))


def require_sense(structure: Structure, options: SolveOptions) -> None:
    """Raise InputError where options contradict each other or the structure."""
    if options.element in ("morley", "hhj") and options.model == "shell":
        raise InputError(
            f'element = "{options.element}" is for plates: a shell takes "koiter", on a chart also "argyris"'
        )
    if options.order != "auto" and options.element in ("morley", "argyris"):
        raise InputError(
            f'order = {options.order} is for element = "koiter" or "hhj": "{options.element}" has one order only, '
            "leave order out"
        )
    if options.large_asked:
        _require_large(options)
    for key, given in (("control", options.control is not None), ("branch", options.branch != 0)):
        if given and options.analysis != "path":
            raise InputError(
                f'{key} is for analysis = "path" (kshell trace): leave it out, or follow the path'
            )
    if options.control is not None and options.branch:
        raise InputError(
            "control and branch given: a branch is followed by its length, leave one of them out"
        )
    for key, given in (
        ("count", options.count is not None),
        ("range", options.range is not None),
        ("prestress", options.prestress),
    ):
        if given and options.analysis not in (*BENDING, "response"):
            raise InputError(
                f'{key} is for analysis = "modes" (kshell modes) or "buckling" (kshell buckling): leave it out, or '
                "take one of them"
            )
    _require_scheme(options)
    for key, given in (
        ("time", options.time is not None),
        ("step", options.step != "auto"),
        ("ramp", options.ramp is not None),
    ):
        if given and options.analysis != "dynamic":
            raise InputError(
                f'{key} is for analysis = "dynamic" (kshell simulate): leave it out, or take that'
            )
    if options.tolerance is not None and options.analysis == "path":
        raise InputError(
            "tolerance: the error of a path is not known: leave it out, or take one state with "
            "large_deflection = true"
        )
    linear = options.analysis in (*BENDING, "response")
    if options.large_deflection is True and linear and not options.prestress:
        instead = (
            f"give prestress = true, for {options.analysis} about the state of large deflections"
            if options.analysis != "buckling"
            else 'follow the path, analysis = "path"'
        )
        raise InputError(
            f'large_deflection = true with analysis = "{options.analysis}": that is linear theory; leave it out, or '
            f"{instead}"
        )
    if options.analysis == "dynamic":
        _require_motion(structure, options)
    if structure.touching:
        _require_contact(options)
    if yields(structure, options):
        _require_yielding(options)
    followers = [p.item for p in structure.loads if getattr(p.item, "follower", False)]
    if followers and options.large_deflection is False and options.analysis in ("static", "dynamic"):
        raise InputError(
            f"{followers[0]}: follower = true turns the pressure with the surface, which matters only under large "
            "deflections; leave it out for small ones"
        )
    if structure.chart is not None and (options.model == "plate" or options.element in ("morley", "hhj")):
        raise InputError("the scene has a chart, so it is a shell: leave model and element out, or the chart")


SCHEMES = {"response": ("modes", "direct"), "dynamic": ("alpha", "em", "bdf2", "euler")}


def _require_scheme(options: SolveOptions) -> None:
    fitting = SCHEMES.get(options.analysis, ())
    if options.scheme == "auto" or options.scheme in fitting:
        return
    owner = next(analysis for analysis, schemes in SCHEMES.items() if options.scheme in schemes)
    instead = f", or take one of {listing(fitting)}" if fitting else ""
    raise InputError(f'scheme = "{options.scheme}" is for analysis = "{owner}": leave it out{instead}')


def _require_motion(structure: Structure, options: SolveOptions) -> None:
    if options.tolerance is not None:
        raise InputError(
            "tolerance: the error of a motion is not known yet: leave it out, and refine mesh and step by hand"
        )
    small = options.large_deflection is False
    if not (small or options.model == "plate" or options.element in ("morley", "argyris", "hhj")):
        return
    if structure.section.inelastic().relaxation and (small or structure.chart is None):
        raise InputError(
            "a material that relaxes (relaxation) moves with large deflections: leave model, element and "
            "large_deflection = false out, or relaxation"
        )


def yields(structure: Structure, options: SolveOptions) -> bool:
    """Whether the section yields, in an analysis that knows of it."""
    return (
        options.analysis in ("static", "path", "dynamic")
        and structure.section.inelastic().yielding is not None
    )


def _require_yielding(options: SolveOptions) -> None:
    """Refuse what does not go with materials that yield, rather than leave it out."""
    if options.large_deflection is False:
        raise InputError(
            "a material that yields (hardening) is computed with large deflections: leave large_deflection = false "
            "out, or hardening, which leaves it elastic"
        )
    if options.tolerance is not None:
        raise InputError(
            "tolerance: the error of a shell that yields (hardening) is not known: leave it out, and refine by hand"
        )
    if options.model == "plate" or options.element in ("morley", "argyris", "hhj"):
        raise InputError(
            'a material that yields (hardening) is for shells with the element "koiter", flat ones too: leave model '
            "and element out, or hardening"
        )


def _require_contact(options: SolveOptions) -> None:
    """Refuse what does not go with contact, rather than leave it out."""
    if options.analysis not in ("static", "dynamic"):
        raise InputError(
            f'contact is for analysis = "static" and "dynamic" (kshell solve, kshell simulate), not for '
            f'"{options.analysis}": take one of them, or leave contact and obstacles out'
        )
    if options.large_deflection is False:
        raise InputError("contact is computed with large deflections: leave large_deflection = false out")
    if options.tolerance is not None:
        raise InputError(
            "tolerance: the error of what touches is not known: leave it out, and refine the mesh by hand"
        )
    if options.model == "plate" or options.element in ("morley", "hhj", "argyris"):
        raise InputError(
            'contact is that of a shell, flat ones too, with the element "koiter": leave model and element out'
        )


def require_plate(structure: Structure) -> None:
    """Refuse what a plate does not have, rather than leave it out."""
    offsets = structure.offset[structure.offset != 0.0]
    shells_only = [f"offset = {offsets[0]:g}"] if len(offsets) else []
    shells_only += ["imperfection"] if structure.imperfection is not None else []
    shells_only += ["direction"] if structure.direction is not None else []
    if shells_only:
        raise InputError(f'{shells_only[0]} is for shells: take model = "shell", or leave it out')


def _require_large(options: SolveOptions) -> None:
    what = 'analysis = "path"' if options.analysis == "path" else "large_deflection = true"
    if options.analysis == "path" and options.large_deflection is False:
        raise InputError('analysis = "path" follows large deflections: leave large_deflection = false out')
    if options.model == "plate":
        raise InputError(f'{what} is for shells, flat ones too: leave model = "plate" out')
    if options.element in ("morley", "hhj"):
        raise InputError(f'{what} is for shells: leave element = "{options.element}" out, or take "koiter"')
