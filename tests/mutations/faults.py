"""Faults to seed into the kernels, each of a kind that has happened in such codes."""

from typing import NamedTuple


class Fault(NamedTuple):
    """One fault: in `file`, from impactlab/solver on, `old` (found there once) becomes `new`."""

    name: str
    file: str
    old: str
    new: str


FAULTS = (
    Fault("Hertz: 4/3 is 1.3", "contact/hertz.py", "K = 4.0 / 3.0 * E", "K = 1.3 * E"),
    Fault(
        "Stronge: residual indentation without R_e/R*",
        "contact/stronge.py",
        "delta - delta_y * radius_ratio, 1.5",
        "delta - delta_y, 1.5",
    ),
    Fault(
        "unloading: sign of the residual indentation",
        "contact/history.py",
        "over = approach - contact.delta_r\n    if over <= 0.0:\n        return 0.0\n    if",
        "over = approach + contact.delta_r\n    if over <= 0.0:\n        return 0.0\n    if",
    ),
    Fault(
        "contact: a narrow beam without sides",
        "contact/finite_element.py",
        "if max(crowding) > 0.0:",
        "if max(crowding) < 0.0:",
    ),
    Fault(
        "contact: a narrow beam that bends without losing force",
        "contact/prestress.py",
        "if max(pair.crowding) > 0.0:",
        "if max(pair.crowding) < 0.0:",
    ),
    Fault(
        "contact: stress of bending as tension",
        "contact/prestress.py",
        "along * contact.F_m - left",
        "along * contact.F_m + left",
    ),
    Fault(
        "contact: damping at the rate half a step before",
        "contact_damping.py",
        "(3.0 * approach - 4.0 * before + earlier) / (2.0 * dt)",
        "(approach - before) / dt",
    ),
    Fault(
        "contact: sign of the axis' lift by pressure",
        "contact/axis_lift.py",
        "lift = pressure * F",
        "lift = -pressure * F",
    ),
    Fault(
        "fibre: sign of the back stress",
        "section.py",
        "(strain - plastic_strain) - H_k * plastic_strain\n",
        "(strain - plastic_strain) + H_k * plastic_strain\n",
    ),
    Fault(
        "section: moment from the plastic strain before the step",
        "section.py",
        "H_k)\n        plastic_strain[i, j], peeq[i, j] = strain, slipped\n"
        "        M_0 -= lever[j] * strain\n",
        "H_k)\n        M_0 -= lever[j] * plastic_strain[i, j]\n"
        "        plastic_strain[i, j], peeq[i, j] = strain, slipped\n",
    ),
    Fault(
        "section: each fibre counted once",
        "section.py",
        "fibres[0, j], fibres[1, j]",
        "fibres[0, j], 0.5 * fibres[1, j]",
    ),
    Fault(
        "section: levers of the fibres in reverse order",
        "section.py",
        "H_k)\n        plastic_strain[i, j], peeq[i, j] = strain, slipped\n"
        "        M_0 -= lever[j] * strain\n",
        "H_k)\n        plastic_strain[i, j], peeq[i, j] = strain, slipped\n"
        "        M_0 -= lever[z.size - 1 - j] * strain\n",
    ),
    Fault(
        "section: the tangent leaves out kinematic hardening",
        "section.py",
        "z[j] * E / (E + H_i + H_k)",
        "z[j] * E / (E + H_i)",
    ),
    Fault(
        "beam: wrong mirror node at mid-span",
        "beam.py",
        "w[after, last + 1] = w[after, last - 1]",
        "w[after, last + 1] = w[after, last - 2]",
    ),
    Fault(
        "beam: half of the contact force",
        "beam.py",
        "change = grid.push * F\n",
        "change = 0.5 * grid.push * F\n",
    ),
    Fault(
        "beam: a clamped end that turns",
        "beam.py",
        "w[end - inward], w[end - 2 * inward] = beside, inside",
        "w[end - inward], w[end - 2 * inward] = -beside, inside",
    ),
    Fault(
        "beam: a free end with a whole node's mass for plastic moments",
        "beam.py",
        "plastic[i + ONE] += 2.0 * share if",
        "plastic[i + ONE] += share if",
    ),
    Fault(
        "timoshenko: a clamped section that turns",
        "timoshenko.py",
        "psi[1] = psi[2] if grid.left == FREE else -psi[2]",
        "psi[1] = psi[2]",
    ),
    Fault(
        "beam: the wave front lags a node behind",
        "beam.py",
        "max(first - 2, 2) if moved",
        "max(first - 1, 2) if moved",
    ),
    Fault(
        "Timoshenko beam: rotary inertia four times too large",
        "timoshenko.py",
        "case.rotary_inertia,",
        "4.0 * case.rotary_inertia,",
    ),
    Fault(
        "Timoshenko beam: twice the shear modulus",
        "timoshenko.py",
        "case.shear_stiffness,",
        "2.0 * case.shear_stiffness,",
    ),
    Fault(
        "Timoshenko beam: shear acts on mid-span from one side",
        "timoshenko.py",
        "push * (Q[mid] - Q[mid - 1] + F)",
        "push * (F - Q[mid - 1])",
    ),
    Fault(
        "von Karman's beam: the axial force does not pull at the slope",
        "von_karman.py",
        "bent + P[i] - P[i - ONE]",
        "bent",
    ),
    Fault(
        "von Karman's beam: plastic strains leave the axial force as it is",
        "section.py",
        "N_0 -= E * section.area[j] * strain",
        "N_0 -= 0.0",
    ),
    Fault(
        "von Karman's beam: rollers hold the axis",
        "von_karman.py",
        "case.axis_held_right > 0",
        "case.support_right == 0",
    ),
    Fault(
        "elastic ends: half the stiffness against deflection",
        "beam.py",
        "lift = 2.0 * dx**3 / EI",
        "lift = dx**3 / EI",
    ),
    Fault(
        "foundation: pushes the wrong way",
        "resistance.py",
        "- h * before[i] - bed * w[now, i]",
        "- h * before[i] + bed * w[now, i]",
    ),
    Fault(
        "place: the node to the left of the strike",
        "stability.py",
        "case.strike_position * (case.nodes - 1) + 0.5",
        "case.strike_position * (case.nodes - 1) - 0.5",
    ),
    Fault(
        "several spheres: each comes without its delay",
        "several_spheres.py",
        "t = step * dt - sphere.delay",
        "t = step * dt",
    ),
    Fault(
        "Rayleigh damping: twice that of the mass",
        "resistance.py",
        "0.5 * case.mass_damping * grid.dt",
        "case.mass_damping * grid.dt",
    ),
    Fault(
        "Rayleigh damping: fourth difference of a step with four of its six",
        "resistance.py",
        "share * (fourth + 6.0 * step)",
        "share * (fourth + 4.0 * step)",
    ),
    Fault(
        "Rayleigh damping of modes: that of the stiffness does not grow with the frequency",
        "resisted_modes.py",
        "case.stiffness_damping * theta * theta / dt",
        "case.stiffness_damping * theta / dt",
    ),
    Fault(
        "strikes: plastic curvature at rest of the wrong sign",
        "settle.py",
        "slope += dx * (share * M_0[i] - M) / EI",
        "slope += dx * (-share * M_0[i] - M) / EI",
    ),
    Fault(
        "strikes: the stretched beam rests as long as without its deflection",
        "settle_stretch.py",
        "return 0.5 * total / grid.dx",
        "return 0.0 * total / grid.dx",
    ),
    Fault(
        "strikes: a second rest that an antisymmetric shape leaves",
        "settle_stretch.py",
        "negative > 1 or turned",
        "negative > 1",
    ),
    Fault(
        "strikes: half a beam at rest does not buckle on its foundation",
        "settle_stretch.py",
        "return _factor(bands, _rows(grid, PINNED), 0) > 0",
        "return False",
    ),
    Fault(
        "strikes on the moving beam: what further spheres have given left out",
        "leapfrog.py",
        "events.ledger += work(state)",
        "events.ledger += 0.0 * work(state)",
    ),
    Fault(
        "box, I-section: the core's share of the plastic modulus left out",
        "../model/shapes.py",
        "0.25 * (self.width * (self.depth * self.depth) - b * (h * h))",
        "0.25 * (self.width * (self.depth * self.depth))",
    ),
    Fault(
        "box: one wall thickness off its depth",
        "../model/shapes.py",
        "self.width - 2.0 * self.wall_thickness, self.depth - 2.0 * self.wall_thickness",
        "self.width - 2.0 * self.wall_thickness, self.depth - self.wall_thickness",
    ),
    Fault(
        "I-section: one flange thickness off its depth",
        "../model/shapes.py",
        "self.depth - 2.0 * self.flange_thickness",
        "self.depth - self.flange_thickness",
    ),
    Fault(
        "circle: second moment of its radius",
        "../model/shapes.py",
        "_PI / 64.0",
        "_PI / 32.0",
    ),
    Fault(
        "tube: one wall thickness off its bore",
        "../model/shapes.py",
        "return self.depth - 2.0 * self.wall_thickness\n\n\ndef",
        "return self.depth - self.wall_thickness\n\n\ndef",
    ),
    Fault(
        "width profile: second moment of half of it",
        "../model/shapes.py",
        "0.25 * (area * z * z).sum()",
        "0.125 * (area * z * z).sum()",
    ),
    Fault(
        "laminate: fibres yield at the outer layer's strain",
        "../model/laminate.py",
        "self._ratio_at(z, 1) / self._ratio_at(z, 0)",
        "self._ratio_at(z, 1) / self._ratio_at(z, 1)",
    ),
    Fault(
        "laminate: mass from the ratios of the moduli",
        "../model/laminate.py",
        "density * self._sum(2, 1)",
        "density * self._sum(0, 1)",
    ),
    Fault(
        "spring-mass: half of the beam's mass", "lumped.py", "17.0 / 35.0 * beam,", "0.5 * beam,"
    ),
    Fault(
        "rigid beam: gives way as the spring-mass model",
        "lumped.py",
        "if case.beam_model == RIGID:",
        "if False:",
    ),
    Fault(
        "leapfrog: the first kick is a whole one, not half",
        "leapfrog.py",
        "case.velocity - 0.5 * dt * case.gravity",
        "case.velocity",
    ),
    Fault(
        "time step: the paper's bar-wave limit",
        "stability.py",
        "omega_squared = 16.0 * EI / (mu * dx**4)",
        "omega_squared = 4.0 * case.beam_youngs_modulus / (case.beam_density * dx**2)",
    ),
    Fault(
        "energy audit: kinetic energy of mid-span from one half step",
        "beam.py",
        "u[grid.mid] * u_mid",
        "u[grid.mid] * u[grid.mid]",
    ),
    Fault(
        "event tracker: the end of contact is not interpolated",
        "event_tracker.py",
        "end = t - dt * gap / (gap - gap_before)",
        "end = t",
    ),
    Fault(
        "modal: fast modes exact, too",
        "modes.py",
        "min(speed * k2, 0.5 * math.pi)",
        "min(speed * k2, math.pi)",
    ),
    Fault(
        "modal: of the modes left out the first alone",
        "modes.py",
        "max(flexibility, left)",
        "flexibility",
    ),
    Fault(
        "modal: sections that come near their limit late",
        "modal.py",
        "near[0] > 0 or slack[1] >= slack[0]:",
        "near[0] > 0 or slack[1] >= 3.0 * slack[0]:",
    ),
    Fault(
        "modal: mid-span's section counted twice",
        "modal.py",
        "copies(grid, i) * grid.dx",
        "2.0 * grid.dx",
    ),
    Fault(
        "modal: energy without the plastic moments",
        "modes.py",
        "(0.5 * stiffness * q_now - source[p])",
        "(0.5 * stiffness * q_now)",
    ),
    Fault(
        "modal: leaps over sections that yield",
        "modal.py",
        "if low < plastic.kappa_min[i] or high > plastic.kappa_max[i]:",
        "if False:",
    ),
)
