# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Machines of dyads to many digits, by other formulas, and random ones.

Places and directions are complex numbers with two derivatives by time; the loads are the solution
of one dense system of all bodies (Newton-Euler), whose unknowns are the forces of all joints.
"""
from fourbar_ros import Applied, Body, InvalidParameter
from fourbar_ros.mechanisms.machine.describe.description import Cylinder, Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import mpmath as mp
import numpy as np


class Jet:
    """A complex function of time by its value and two derivatives."""

    def __init__(self, value, rate=0, change=0):
        self.value, self.rate, self.change = mp.mpc(value), mp.mpc(rate), mp.mpc(change)

    @staticmethod
    def of(value):
        return value if isinstance(value, Jet) else Jet(value)

    def __add__(self, other):
        other = Jet.of(other)
        return Jet(self.value + other.value, self.rate + other.rate, self.change + other.change)

    def __neg__(self):
        return Jet(-self.value, -self.rate, -self.change)

    def __sub__(self, other):
        return self + -Jet.of(other)

    def __mul__(self, other):
        a, b = self, Jet.of(other)
        return Jet(a.value * b.value, a.value * b.rate + a.rate * b.value,
                   a.value * b.change + 2 * a.rate * b.rate + a.change * b.value)

    def __truediv__(self, other):
        b = Jet.of(other)
        return self * Jet(1 / b.value, -b.rate / b.value**2,
                          2 * b.rate**2 / b.value**3 - b.change / b.value**2)

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other):
        return Jet.of(other) - self

    def sqrt(self):
        root = mp.sqrt(self.value)
        return Jet(root, self.rate / (2 * root),
                   self.change / (2 * root) - self.rate**2 / (4 * root**3))

    def conj(self):
        return Jet(*map(mp.conj, (self.value, self.rate, self.change)))

    @property
    def real(self):
        return (self + self.conj()) * mp.mpf(0.5)

    @property
    def imag(self):
        return (self - self.conj()) / mp.mpc(0, 2)

    def size(self):
        return (self * self.conj()).sqrt()

    def turning(self):
        """Return angle, rate and acceleration of a direction."""
        e = mp.conj(self.value)
        return (mp.arg(self.value), (e * self.rate).imag, (e * self.change).imag)


I = mp.mpc(0, 1)  # noqa: E741


def turn(angle):
    return mp.expj(mp.mpf(angle))


def rrr(dyad, p, q, _one, _other):
    r1, r2 = mp.mpf(dyad.length_1), mp.mpf(dyad.length_2)
    d = q - p
    size = d.size()
    along = (size * size + (r1 * r1 - r2 * r2)) / (size * 2)
    across = (r1 * r1 - along * along).sqrt() * (-dyad.sign)
    # B to the right of P Q has e1 x e2 < 0
    b = p + d / size * (along - across * I)
    return (p, (b - p) / r1), (q, (b - q) / r2), b


def rrp(dyad, p, q, _one, other):
    r1, t = mp.mpf(dyad.length_1), other[1] * turn(dyad.direction_2)
    d = (q - p) * t.conj()
    h = d.imag
    b = p + t * ((r1 * r1 - h * h).sqrt() * dyad.sign + h * I)
    return (p, (b - p) / r1), (b, t), b


def rpr(dyad, p, q, _one, _other):
    h, d = mp.mpf(dyad.offset), p - q
    s = (d * d.conj() - h * h).sqrt() * dyad.sign
    t = d / (s + I * h)
    return (p, t), (q, t), p


def rpp(dyad, p, q, _one, other):
    t = other[1] * turn(dyad.direction_2)
    c = t * turn(dyad.slot)
    # p = q + s t + d c: across c it is s alone
    s = ((p - q) * c.conj()).imag / (t * c.conj()).imag
    return (p, c), (q + t * s, t), p


def prp(dyad, p, q, one, other):
    t1, t2 = one[1] * turn(dyad.direction_1), other[1] * turn(dyad.direction_2)
    s1 = ((q - p) * t2.conj()).imag / (t1 * t2.conj()).imag
    b = p + t1 * s1
    return (b, t1), (b, t2), b


MOVES = {'RRR': rrr, 'RRP': rrp, 'RPR': rpr, 'RPP': rpp, 'PRP': prp}


def crank_of_cylinder(cylinder, s):
    """Return the direction of the crank by the law of cosines."""
    pin, base = mp.mpc(*cylinder.pin[1:]), mp.mpc(*cylinder.base[1:])
    rho, b = abs(pin), abs(base)
    cosine = (rho**2 + b**2 - s * s) / (2 * rho * b)
    sine = (1 - cosine * cosine).sqrt() * (1 if cylinder.mode == 2 else -1)
    return (cosine + sine * I) * (base / b * rho / pin)


def links_of(machine, given):
    """Return {link: (place of the first joint, direction)} and {dyad: place of its pin}."""
    x = Jet(*map(mp.mpf, given))
    links, pins = {machine.layout.links[0]: (Jet(0), Jet(1))}, {}
    if machine.input == 'slide':
        links['slider'] = x, Jet(1)
    elif machine.input == 'crank':
        e = mp.expj(x.value)
        links['crank'] = Jet(0), Jet(e, I * e * x.rate, I * e * x.change - e * x.rate**2)
    else:
        links['crank'] = Jet(0), crank_of_cylinder(machine.cylinder, x)
    for dyad in machine.stages:
        own = Dyad(**{**dyad.__dict__, 'mode': 2}) if dyad.name == 'cylinder' else dyad
        one, other = links[dyad.first.link], links[dyad.second.link]
        *its, pins[dyad.name] = MOVES[dyad.kind](own, on(one, dyad.first), on(other, dyad.second),
                                                 one, other)
        links.update(zip(dyad.links, its))
    z, e = links['ground'][0], links['ground'][1].conj()      # a frame that moves is turned back
    return ({name: ((place - z) * e, its * e) for name, (place, its) in links.items()},
            {name: (place - z) * e for name, place in pins.items()})


def on(link, point):
    """Return the place of a point of a link."""
    return link[0] + link[1] * mp.mpc(*point[1:])


def motion_of(machine, given):
    """Return {field: value} of all coordinates of links, and the links and pins."""
    links, pins = links_of(machine, given)
    found = {}
    for name in machine.layout.moving:
        found.update(zip((f'theta_{name}', f'omega_{name}', f'alpha_{name}'),
                         links[name][1].turning()))
        found[f'x_{name}'], found[f'y_{name}'] = (links[name][0].value.real,
                                                  links[name][0].value.imag)
    for pin, i, j in machine.layout.pins():
        one, two = (links[machine.layout.links[k]][1] for k in (i, j))
        found.update(zip((f'theta_{pin}', f'omega_{pin}', f'alpha_{pin}'),
                         (two * one.conj()).turning()))
    for dyad in machine.stages:
        for place, link in slides_of(dyad):
            start = on(links[dyad.second.link if place != 'first' else dyad.first.link],
                       dyad.second if place != 'first' else dyad.first)
            if place == 'inner':     # of P along the bar or slot
                start = start if dyad.kind == 'RPR' else links[dyad.links[1]][0]
            way = ((links[link][0] - start) * links[link][1].conj()).real
            found.update(zip((f'slide_{link}', f'slide_{link}_velocity',
                              f'slide_{link}_acceleration'),
                             (way.value.real, way.rate.real, way.change.real)))
    return found, links, pins


def slides_of(dyad):
    """Return (place, link that slides) of a dyad."""
    return {'RRR': (), 'RRP': (('second', dyad.links[1]),), 'RPR': (('inner', dyad.links[0]),),
            'RPP': (('inner', dyad.links[0]), ('second', dyad.links[1])),
            'PRP': (('first', dyad.links[0]), ('second', dyad.links[1]))}[dyad.kind]


# --- loads: one dense system ---------------------------------------------------------------------

class System:
    """Newton's and Euler's equations of all links, a column for each component of a joint."""

    def __init__(self, machine, links):
        self.names, self.links = machine.layout.moving, links
        self.columns, self.labels = [], []

    def add(self, label, at, on_link, by_link, force, couple=0):
        """Add an unknown that acts on a link and back on another: a force, a couple."""
        column = [mp.mpf(0)] * (3 * len(self.names))
        for link, sign in ((on_link, 1), (by_link, -1)):
            if link != 'ground':
                row, arm = 3 * self.names.index(link), at - self.links[link][0].value
                column[row:row + 3] = [column[row] + sign * force.real,
                                       column[row + 1] + sign * force.imag,
                                       column[row + 2] + sign * (couple + (mp.conj(arm)
                                                                           * force).imag)]
        self.columns.append(column)
        self.labels.append(label)

    def pin(self, name, at, on_link, by_link):
        self.add((name, 'x'), at, on_link, by_link, mp.mpc(1))
        self.add((name, 'y'), at, on_link, by_link, I)

    def slide(self, name, at, on_link, by_link, direction):
        self.add((name, 'normal'), at, on_link, by_link, I * direction)
        self.add((name, 'couple'), at, on_link, by_link, mp.mpc(0), 1)

    def solve(self, needs):
        matrix = mp.matrix(self.columns).T
        return dict(zip(self.labels, mp.lu_solve(matrix, mp.matrix(needs))))


def needs_of(machine, links):
    """Return what the joints of all links must add up to: force x, y, moment about its joint."""
    needs, gravity = [], mp.mpc(*machine.gravity)
    for name in machine.layout.moving:
        (place, e), body = links[name], getattr(machine.bodies, name)
        act = getattr(machine.external, name, Applied())
        centre = place + e * mp.mpc(body.cg_along, body.cg_across)
        force = body.mass * (centre.change - gravity)
        push = mp.mpc(act.force_x, act.force_y)
        moment = (body.inertia * e.turning()[2] - act.couple
                  + (mp.conj(centre.value - place.value) * force).imag
                  - (mp.conj(e.value * mp.mpc(act.along, act.across)) * push).imag)
        force -= push
        needs += [force.real, force.imag, moment]
    return needs


def loads_of(machine, given):
    """Return {joint: complex force, joint_normal, joint_couple, drive: number}."""
    _, links, pins = motion_of(machine, given)
    system, (frame, driven, *_) = System(machine, links), machine.layout.links
    at = links[driven][0].value
    if machine.input == 'slide':
        system.slide('base', at, driven, frame, mp.mpc(1))
        system.add('drive', at, driven, frame, mp.mpc(1))
    else:
        system.pin('base', at, driven, frame)
        if machine.input == 'crank':
            system.add('drive', at, driven, frame, mp.mpc(0), 1)
    for dyad in machine.stages:
        _joints(system, machine, dyad, links, pins[dyad.name].value)
    found = system.solve(needs_of(machine, links))
    return _named(machine, found, links)


def _joints(system, machine, dyad, links, inner):
    """Add the joints of one dyad."""
    one, two = dyad.links
    joints = {'first': (one, dyad.first.link, on(links[dyad.first.link], dyad.first).value),
              'inner': (one, two, inner),
              'second': (two, dyad.second.link, on(links[dyad.second.link], dyad.second).value)}
    slides = dict(slides_of(dyad))
    for place, (its, by, at) in joints.items():
        name = f'{dyad.name}_{place}'
        if place not in slides:
            system.pin(name, at, its, by)
            continue
        link = slides[place]
        at, t = links[link][0].value, links[link][1].value
        system.slide(name, at, its, by, t)
        if dyad.name == 'cylinder':
            system.add('drive', at, its, by, t)


def _named(machine, found, links):
    drive = found['drive']
    loads = {'driving_torque': drive if machine.input == 'crank' else mp.mpf(0),
             'driving_force': drive if machine.input != 'crank' else mp.mpf(0)}
    directions = {f'{dyad.name}_{place}': links[link][1].value for dyad in machine.stages
                  for place, link in slides_of(dyad)}
    directions['base'] = mp.mpc(1)
    for name, is_slide in machine.layout.joints():
        if is_slide:
            force = I * directions[name] * found[name, 'normal']
            if name == 'cylinder_inner' or name == 'base':
                force += drive * directions[name]
            loads[f'{name}_normal'] = found[name, 'normal']
            loads[f'{name}_couple'] = found[name, 'couple']
        else:
            force = mp.mpc(found[name, 'x'], found[name, 'y'])
        loads[name] = force
    return loads


def exact_values(machine, name, inputs, rates):
    """Return a quantity at some inputs to many digits; None if the reference does not have it."""
    values = []
    with mp.workdps(40):
        for x in inputs:
            given = (float(x), *rates)
            found = motion_of(machine, given)[0]
            if name not in found:
                found = loads_of(machine, given)
            if name not in found:
                return None
            value = found[name]
            values.append(abs(value) if isinstance(value, mp.mpc) else value)
    return values


# --- random machines -----------------------------------------------------------------------------

def random_dimensions(rng, kind):
    """Return the dimensions of a dyad by name."""
    draw = {'RRR': lambda: {'length_1': rng.uniform(1.5, 3.0), 'length_2': rng.uniform(1.5, 3.0)},
            'RRP': lambda: {'length_1': rng.uniform(2.0, 4.0),
                            'direction_2': rng.uniform(-0.4, 0.4)},
            'RPR': lambda: {'offset': rng.uniform(-0.2, 0.2)},
            'RPP': lambda: {'direction_2': rng.uniform(-1.0, 1.0), 'slot': rng.uniform(0.8, 2.0)},
            'PRP': lambda: {'direction_1': rng.uniform(-0.3, 0.3),
                            'direction_2': rng.uniform(1.0, 2.0)}}[kind]
    return {name: float(value) for name, value in draw().items()}


def random_dyads(rng, driven, count, structure=None, before=()):
    """
    Return dyads that hang on each other at random, or as (kind, first, second) of each say.

    ``before``: dyads that are there already.
    """
    links, dyads = ['ground', driven, *(link for dyad in before for link in dyad.links)], []
    for number in range(count):
        if structure:
            kind, *ends = structure[number]
            i, j = map(links.index, ends)
        else:
            kind = str(rng.choice(tuple(MOVES)))
            i, j = rng.choice(len(links), 2, replace=False).tolist()
        place = rng.uniform(-1.0, 1.0, 4)
        place[2] += 1.2 if not j else 0.0
        own = f'a{number}', f'b{number}'
        mode = 2 if kind in ('RPP', 'PRP') else int(rng.integers(1, 3))
        dyads.append(Dyad(f'd{number}', kind, Point(links[i], *place[:2].tolist()),
                          Point(links[j], *place[2:].tolist()), own,
                          **random_dimensions(rng, kind), mode=mode))
        links += own
    return dyads


def random_masses(rng, machine_links, loadable):
    """Return bodies, gravity and external loads, everything acting."""
    bodies = {name: Body(float(rng.uniform(0.5, 2.0)), *rng.uniform(-0.5, 0.5, 2).tolist(),
                         float(rng.uniform(0.1, 0.5))) for name in machine_links}
    external = {name: Applied(*rng.uniform(-5.0, 5.0, 2).tolist(),
                              *rng.uniform(-1.0, 1.0, 2).tolist(), float(rng.uniform(-5.0, 5.0)))
                for name in loadable}
    return {'bodies': bodies, 'external': external,
            'gravity': tuple(rng.uniform(-10.0, 10.0, 2).tolist())}


def random_machines(seed, count, dyads=(1, 6), least_sine=0.0, near_limit=False, structure=None,
                    driver=None):
    """
    Yield (machine with everything acting, input) of machines that can be assembled.

    ``structure``, ``driver``: as :func:`random_dyads` takes them, and 'crank' or another drive.

    None has a link ten metres away, nor with derivatives above ten (m, rad): places and rates
    relative to another such link have lost a digit in absolute ones. ``near_limit``: the input is
    1e-1 to 1e-12 of its range from a toggle.
    """
    rng = np.random.default_rng(seed)
    while count:
        drive = driver or str(rng.choice(('crank', 'crank', 'slide', 'cylinder')))
        driven, more = 'slider' if drive == 'slide' else 'crank', {}
        if drive == 'slide':
            more['stroke'] = (-1.5, 1.5)
        if drive == 'cylinder':
            more['cylinder'] = Cylinder(Point('ground', *rng.uniform(-1.5, -0.5, 2).tolist()),
                                        Point('crank', float(rng.uniform(0.5, 1.0)), 0.1),
                                        mode=int(rng.integers(1, 3)))
        number = len(structure) if structure else int(rng.integers(*dyads))
        own = random_dyads(rng, driven, number, structure)
        try:
            machine = Machine(own, input=drive, **more)
            machine = Machine(own, input=drive, **more, **random_masses(
                rng, machine.layout.moving, machine.EXTERNAL._fields))
        except InvalidParameter:
            continue
        low, high = machine.input_ranges[int(rng.integers(len(machine.input_ranges)))]
        share = 10.0**rng.uniform(-12.0, -1.0) if near_limit else rng.uniform(0.02, 0.98)
        if near_limit and (machine.turns_fully or machine.stroke):
            continue
        given = (float(low + (high - low) * (share if rng.random() < 0.5 else 1.0 - share)),
                 *rng.uniform(-3.0, 3.0, 2).tolist())
        motion = machine.motion(*given)
        sizes = [abs(getattr(motion, f'{what}_{link}')) for link in machine.layout.moving
                 for what in (('x', 'y') if near_limit else
                              ('x', 'y', 'dx', 'dy', 'ratio', 'ddx', 'ddy', 'bend'))]
        if max(sizes) < 10.0 and abs(machine.transmission_sine(motion)) > least_sine:
            count -= 1
            yield machine, given
