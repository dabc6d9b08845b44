"""Validation of cases whose bodies are drawn: an ogive, a cone liner, a slope, a V-hull and a plate at 12 degrees."""
import matplotlib.pyplot as plt
import numpy as np
from brisance.point_figures import RISING, Flat, scalar, time_title
from matplotlib.colors import Normalize

from common import COLOURS, INK, RC, ROOT, listed, nearest, per_cent, style, table

HEADER = ["quantity", "known", "calculated", "difference"]
GURNEY = 0.5 * (2370.0 + 2440.0)  # sqrt(2E) of TNT [m/s], the middle of the range in points.py


def row(what, known, found, form="{:.4g}", digits=1):
    return [what, form.format(known), form.format(found), per_cent(found / known, digits)]


def mass_row(unit, known, found):
    return [f"mass [{unit}]", f"{known:.6g}", f"{found:.6g}", f"{found / known - 1.0:.0e}"]


def mass_of(result, body):
    return next(b["mass"] for b in result.points["bodies"] if b["name"] == body)


def balance(result):
    """Drift of the energy beside its reference, as the audit reports it [%]."""
    return 100.0 * result.log["audit"]["findings"]["drift"]["share"]


def draw(result, times, field, top, label, size, window=None):
    """The particles at some times, coloured by a quantity."""
    plt.rcParams.update(RC)
    flat = Flat(result)
    figure, panels = plt.subplots(1, len(times), figsize=size, layout="constrained", sharey=True)
    for panel, time in zip(panels, times):
        dump = nearest(result.point_dumps, time)
        drawn = flat.draw(panel, dump, scalar(dump, field, 1.0), Normalize(0.0, top), RISING)
        panel.set_title(time_title(result, dump.time))
        panel.set_xlabel("mm" if flat.factor == 1e3 else "m")
        if window:
            panel.set_xlim(*window[:2])
            panel.set_ylim(*window[2:])
    figure.colorbar(drawn, ax=panels.tolist(), label=label, shrink=0.85, extend="max")
    return figure


# --- ogive

ROD = {"radius": 6.45e-3, "length": 88.9e-3, "density": 7830.0, "speed": 500.0}
HEAD = 3.0  # caliber-radius-head: the radius of the arc over the diameter
TARGET = {"E": 68.9e9, "yield": 276e6, "density": 2710.0}


def ogive_mass():
    """The nose by integration of the arc, and the shank."""
    a, arc = ROD["radius"], 2.0 * HEAD * ROD["radius"]
    nose = a * np.sqrt(4.0 * HEAD - 1.0)
    # Integral of (sqrt(arc^2 - z^2) - (arc - a))^2 from 0 to the nose's length.
    c = arc - a
    part = 0.5 * (nose * np.sqrt(arc ** 2 - nose ** 2) + arc ** 2 * np.arcsin(nose / arc))
    volume = np.pi * (arc ** 2 * nose - nose ** 3 / 3.0 - 2.0 * c * part + c ** 2 * nose)
    return ROD["density"] * (volume + np.pi * a ** 2 * (ROD["length"] - nose))


def resistance():
    """Stress [Pa] on the nose at rest, and the factor of density times speed squared."""
    static = 2.0 / 3.0 * TARGET["yield"] * (1.0 + np.log(2.0 * TARGET["E"] / (3.0 * TARGET["yield"])))
    return static, 1.5 * (8.0 * HEAD - 1.0) / (24.0 * HEAD ** 2)


def ogive_depth(mass):
    """Depth [m] by the formula of a rigid rod that has its whole nose in the target from the start."""
    static, shape = resistance()
    inertia = shape * TARGET["density"]
    area = np.pi * ROD["radius"] ** 2
    return mass / (2.0 * area * inertia) * np.log(1.0 + inertia * ROD["speed"] ** 2 / static)


def entering_depth(mass):
    """The same with the stress on that part of the nose that has entered: integrated over the depth."""
    static, _ = resistance()
    a, arc = ROD["radius"], 2.0 * HEAD * ROD["radius"]
    nose = a * np.sqrt(4.0 * HEAD - 1.0)
    z = np.linspace(0.0, nose, 2001)  # from the base to the tip
    radius = np.sqrt(arc ** 2 - z ** 2) - (arc - a)
    slope = z / np.sqrt(arc ** 2 - z ** 2)
    sine = slope ** 2 / (1.0 + slope ** 2)  # square of the cosine between the motion and the normal of the face
    steps = 0.5 * (z[1] - z[0]) * 2.0 * np.pi
    ring = radius * slope
    still = np.concatenate([[0.0], np.cumsum(steps * (ring[1:] + ring[:-1])[::-1])])
    fast = np.concatenate([[0.0], np.cumsum(steps * ((ring * sine)[1:] + (ring * sine)[:-1])[::-1])])
    square, depth, step = ROD["speed"] ** 2, 0.0, z[1] - z[0]
    while square > 0.0:
        n = min(int(depth / step), len(still) - 1)
        square -= 2.0 * step / mass * (static * still[n] + 1.5 * TARGET["density"] * square * fast[n])
        depth += step
    return depth


def ogive(run):
    results = {h: run("ogive_2d", f"{h:g}", {"cell": f"{h:g} mm"}) for h in (1.5, 1.0, 0.75)}
    fine = results[0.75]
    mass = ogive_mass()
    rows = [mass_row("kg", mass, mass_of(fine, "rod"))]
    for h, result in results.items():
        y = result.gauge("end")["y"]
        depth = y[0] - y.min()
        rows += [row(f"depth on cells of {h:g} mm, whole nose [mm]", 1e3 * ogive_depth(mass), 1e3 * depth, "{:.1f}"),
                 row(f"depth on cells of {h:g} mm, nose that enters [mm]", 1e3 * entering_depth(mass), 1e3 * depth,
                     "{:.1f}")]
    figure = draw(fine, (0.0, 100e-6, 250e-6), "plastic_strain", 2.0, "plastic strain", (10.6, 5.4))
    other, axes = plt.subplots(figsize=(5.4, 3.4), layout="constrained")
    style(axes)
    excess = []
    for (h, result), colour in zip(results.items(), COLOURS[1:]):
        path, stress, formula = deceleration(result, mass)
        axes.plot(1e3 * path, 1e-9 * stress, color=colour, label=f"cells of {h:g} mm")
        deep = (path > 0.05) & (path < 0.06)
        excess.append(100.0 * (float((stress[deep] / formula[deep]).mean()) - 1.0))
    axes.plot(1e3 * path, 1e-9 * formula, "--", color=INK, label="cavity expansion")
    axes.set_xlabel("depth of the tip [mm]")
    axes.set_title("Resistance over the rod's section [GPa]")
    axes.legend()
    return {"ogive_table": table(HEADER, rows), "ogive_balance": f"{balance(fine):.0e}",
            "ogive_deep": f"{listed(f'{e:.0f}' for e in excess)} %"}, {
                "drawn_ogive": figure, "drawn_ogive_stress": other}


def deceleration(result, mass):
    """While the rod moves: its depth [m], the stress over its section that brakes it, and that of the formula [Pa]."""
    g = result.gauge("rod")
    speed, time = -g["velocity_y"], g["time"]
    static, shape = resistance()
    path = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
    stress = mass / (np.pi * ROD["radius"] ** 2) * -np.gradient(speed, time)
    width = 15
    stress = np.convolve(stress, np.ones(width) / width, "same")
    moving = (speed > 30.0) & (time > width * 0.5e-6)
    return path[moving], stress[moving], (static + shape * TARGET["density"] * speed ** 2)[moving]


# --- cone liner

CONE = {"angle": np.radians(21.0), "base": 23e-3, "wall": 1.2e-3, "density": 8960.0, "speed": 7980.0}


def liner_mass():
    tangent = np.tan(CONE["angle"])
    inner = CONE["base"] - CONE["wall"] / np.cos(CONE["angle"])
    return CONE["density"] * np.pi / (3.0 * tangent) * (CONE["base"] ** 3 - inner ** 3)


def elements(result, stations):
    """Of the liner at places along its axis [m below the apex]: the largest mean speed over the wall, which is that of
    its collapse, and the speed of the fastest point of it at the end."""
    apex = CONE["base"] / np.tan(CONE["angle"])
    s, c = np.sin(CONE["angle"]), np.cos(CONE["angle"])
    speeds, jets = np.zeros(len(stations)), np.zeros(len(stations))
    for dump in result.point_dumps:
        d = dump.read()
        liner = d["body"] == 1
        start, v = (d["position"] - d["displacement"])[liner], d["velocity"][liner]
        # Where an element lay along the wall: its distance from the apex along the slant.
        along = (apex - start[:, 1]) * c + start[:, 0] * s
        for n, x in enumerate(stations):
            here = np.abs(along - x / c) < 1e-3
            speeds[n] = max(speeds[n], np.linalg.norm(v[here, :2].mean(axis=0)))
            jets[n] = -v[here, 1].min()
    return speeds, jets


def jet_speed(speed):
    """Speed of the jet and angle of the collapsing wall, in steady flow [Birkhoff48]: the front passes along the axis
    at the detonation speed, and the wall moves in the direction that halves the angle by which it turns."""
    alpha = CONE["angle"]
    delta = np.arcsin(speed * np.cos(alpha) / (2.0 * CONE["speed"]))
    beta = alpha + 2.0 * delta
    return speed * np.cos(alpha + delta - 0.5 * beta) / np.sin(0.5 * beta), np.degrees(beta)


def tip(result):
    """The foremost point of the liner on the axis, over the last dumps."""
    at, times = [], []
    for dump in result.point_dumps[-6:]:
        d = dump.read()
        at.append(d["position"][(d["body"] == 1) & (d["position"][:, 0] < CONE["wall"]), 1].min())
        times.append(dump.time)
    return -np.polyfit(times, at, 1)[0]


def cone_liner(run):
    results = {h: run("cone_liner_2d", f"{h:g}", {"cell": f"{h:g} mm"}) for h in (0.5, 0.3)}
    stations = np.linspace(15e-3, 45e-3, 7)
    rows = [mass_row("kg", liner_mass(), mass_of(results[0.3], "liner"))]
    for h, result in results.items():
        speed, jets = elements(result, stations)
        known, angle = jet_speed(speed)
        fastest = int(np.argmax(known))
        rows += [row(f"jet from where theory has it fastest, cells of {h:g} mm [m/s]", known[fastest], jets[fastest],
                     "{:.0f}"),
                 row(f"foremost point of the jet, cells of {h:g} mm [m/s]", known[fastest], tip(result), "{:.0f}")]
    lines = [[f"{1e3 * x:.0f}", f"{v:.0f}", f"{b:.1f}", f"{k:.0f}", f"{j:.0f}", per_cent(j / k)]
             for x, v, b, k, j in zip(stations, speed, angle, known, jets)]
    figure = draw(result, (8e-6, 12e-6, 20e-6), "velocity", 8000.0, "speed [m/s]", (10.6, 5.2),
                  (-32.0, 32.0, -65.0, 90.0))
    head = ["below the apex [mm]", "collapse [m/s]", "angle of collapse [deg]", "jet: theory [m/s]",
            "fastest point at the end [m/s]", "difference"]
    return {"cone_table": table(HEADER, rows), "cone_stations": table(head, lines),
            "cone_balance": f"{balance(result):.2f}"}, {"drawn_cone_liner": figure}


# --- slope

ROCK = {"E": 50e9, "nu": 0.25, "density": 2600.0, "pressure": 10e6}
SLOPE = np.radians(30.0)


def free_surface():
    """Velocity [m/s] of the free face of a half-space, by x and y, under a plane wave that moves along y and whose
    particle velocity is 1; the face rises along x by the angle of the slope. Sums of the incident wave and of the
    reflected pressure and shear wave leave no stress on the face."""
    cp, cs = speeds()
    lame = ROCK["density"] * (cp ** 2 - 2.0 * cs ** 2)
    shear = ROCK["density"] * cs ** 2
    along = np.array([np.cos(SLOPE), np.sin(SLOPE)])
    normal = np.array([-np.sin(SLOPE), np.cos(SLOPE)])
    up = np.array([0.0, 1.0])
    sine = up @ along
    reflected_p = sine * along - np.sqrt(1.0 - sine ** 2) * normal
    slow = sine * cs / cp
    direction_s = slow * along - np.sqrt(1.0 - slow ** 2) * normal
    motion_s = np.array([direction_s[1], -direction_s[0]])

    def traction(direction, motion, speed):
        # Velocity gradient of a plane wave: the stress of motion * f(t - x.direction / speed).
        gradient = -np.outer(motion, direction) / speed
        stress = lame * np.trace(gradient) * np.eye(2) + shear * (gradient + gradient.T)
        return stress @ normal
    matrix = np.column_stack([traction(reflected_p, reflected_p, cp), traction(direction_s, motion_s, cs)])
    p, s = np.linalg.solve(matrix, -traction(up, up, cp))
    return up + p * reflected_p + s * motion_s


def speeds():
    e, nu, rho = ROCK["E"], ROCK["nu"], ROCK["density"]
    return np.sqrt(e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu) * rho)), np.sqrt(e / (2.0 * (1.0 + nu) * rho))


def slope(run):
    results = {h: run("slope_2d", f"{h:g}", {"cell": f"{h:g} mm"}) for h in (20.0, 10.0)}
    cp, cs = speeds()
    incident = ROCK["pressure"] / (ROCK["density"] * cp)
    known = incident * free_surface()
    area = 2.4 * 1.3  # below the middle of the face, where the slope crosses half of the width
    rows = [mass_row("kg/m", ROCK["density"] * area, mass_of(results[10.0], "slope"))]
    for h, result in results.items():
        below, face = result.gauge("below"), result.gauge("face")
        window = (face["time"] > 340e-6) & (face["time"] < 400e-6)
        early = (below["time"] > 210e-6) & (below["time"] < 260e-6)
        rows.append(row(f"incident, cells of {h:g} mm [m/s]", incident, below["velocity_y"][early].mean(), "{:.4f}"))
        for d, name in enumerate("xy"):
            rows.append(row(f"face along {name}, cells of {h:g} mm [m/s]", known[d],
                            face[f"velocity_{name}"][window].mean(), "{:.4f}"))
    plt.rcParams.update(RC)
    figure = draw(results[10.0], (200e-6, 280e-6, 360e-6), "velocity", 2.0, "speed [m/s]", (10.6, 3.8))
    other, axes = plt.subplots(figsize=(5.4, 3.2), layout="constrained")
    style(axes)
    for (h, result), dashes in zip(results.items(), (":", "-")):
        face = result.gauge("face")
        for name, colour in (("x", "#c8641b"), ("y", "#1f4f88")):
            axes.plot(1e6 * face["time"], face[f"velocity_{name}"], dashes, color=colour,
                      label=f"along {name}, {h:g} mm")
    for value in known:
        axes.axhline(value, color=INK, linewidth=0.8, linestyle="--")
    axes.set_xlim(250.0, 440.0)
    axes.set_xlabel("time [us]")
    axes.set_title("Velocity of the face [m/s]; dashed: closed form")
    axes.legend()
    return {"slope_table": table(HEADER, rows), "slope_speeds": f"{cp:.0f} and {cs:.0f}"}, {
        "drawn_slope": figure, "drawn_slope_face": other}


# --- V-hull

HULL = {"half": 0.4, "keel": 0.4, "thickness": 40e-3, "density": 7850.0, "angle": np.radians(30.0)}
CHARGE = {"radius": 40e-3, "density": 1630.0}


def stream(angle):
    """Share of the momentum of a stream from the charge's middle, spread evenly over the upper half, that half a plate
    takes along y, whose side rises by the angle. What meets the plate keeps its motion along it and loses the rest."""
    height = HULL["keel"] - CHARGE["radius"]
    edge = np.arctan2(HULL["half"], height + HULL["half"] * np.tan(angle))
    return np.cos(angle) * (np.sin(edge + angle) - np.sin(angle)) / np.pi


def v_hull(run):
    flat = (ROOT / "cases" / "v_hull_2d" / "flat.toml").read_text()
    grids = {h: {"V": run("v_hull_2d", f"V-{h:g}", {"cell": f"{h:g} mm"}),
                 "flat": run("v_hull_2d", f"flat-{h:g}", {"cell": f"{h:g} mm"}, text=flat)} for h in (8.0, 6.25)}
    results = grids[6.25]
    mass = HULL["density"] * HULL["half"] * HULL["thickness"] / np.cos(HULL["angle"])
    rows = [mass_row(f"kg/m, half of {name}", mass, mass_of(result, "hull")) for name, result in results.items()]
    # Products of a line charge, of even density and a velocity that grows with the radius: their mean speed is 2/3 of
    # that at the edge, and the mean of its square half of the edge's.
    charge = np.pi * CHARGE["radius"] ** 2 * CHARGE["density"]
    whole = charge * 2.0 * np.sqrt(2.0) / 3.0 * GURNEY
    shares = {"V": stream(HULL["angle"]), "flat": stream(0.0)}
    for h, both in grids.items():
        impulse = {name: float(result.gauge("hull")["momentum_y"][-1]) for name, result in both.items()}
        rows += [row(f"impulse of half of {name}, cells of {h:g} mm [N s/m]", shares[name] * whole, impulse[name],
                     "{:.0f}") for name in both]
        rows.append(row(f"impulse, V / flat, cells of {h:g} mm", shares["V"] / shares["flat"],
                        impulse["V"] / impulse["flat"], "{:.3f}"))
    plt.rcParams.update(RC)
    figure, panels = plt.subplots(1, 3, figsize=(10.6, 4.2), layout="constrained")
    for panel, (name, result) in zip(panels, results.items()):
        dump = nearest(result.dumps, 0.2e-3)
        drawn = panel.pcolormesh(dump.edges(0), dump.edges(1), 1e-6 * dump.values("pressure"), cmap=RISING,
                                 norm=Normalize(0.0, 20.0), rasterized=True)
        points = nearest(result.point_dumps, dump.time).read()
        body = points["body"] == 0
        panel.plot(*points["position"][body][:, :2].T, "s", markersize=1.5, color=INK)
        panel.set_aspect("equal")
        panel.set_title(f"{name}, t = {1e3 * dump.time:.1f} ms")
        panel.set_xlabel("m")
    figure.colorbar(drawn, ax=panels[:2].tolist(), label="pressure [MPa]", shrink=0.85, extend="max")
    style(panels[2])
    for (name, result), colour in zip(results.items(), ("#1f4f88", "#c8641b")):
        g = result.gauge("hull")
        panels[2].plot(1e3 * g["time"], 1e-3 * g["momentum_y"], color=colour, label=name)
        panels[2].axhline(1e-3 * shares[name] * whole, color=colour, linewidth=0.8, linestyle="--")
    panels[2].set_xlabel("time [ms]")
    panels[2].set_title("Impulse [kN s/m]; dashed: stream")
    panels[2].set_ylim(0.0, 5.0)
    panels[2].legend(loc="lower right")
    late = {name: float(np.interp(1e-3, r.gauge("hull")["time"], r.gauge("hull")["momentum_y"])) / impulse[name] - 1.0
            for name, r in results.items()}
    return {"hull_table": table(HEADER, rows), "hull_square": f"{np.cos(HULL['angle']) ** 2:.2f}",
            "hull_late": ", ".join(f"{-100 * v:+.1f} % ({name})" for name, v in late.items())}, {
                "drawn_v_hull": figure}


# --- plate at 12 degrees

PLATE = {"angle": np.radians(12.0), "thickness": 3e-3, "length": 160e-3, "density": 8960.0}
LAYER = {"thickness": 10e-3, "density": 1630.0, "speed": 6930.0}


def welded_plate(run):
    results = {h: run("welded_plate_2d", f"{h:g}", {"cell": f"{h:g} mm"}) for h in (1.0, 0.5)}
    ratio = PLATE["density"] * PLATE["thickness"] / (LAYER["density"] * LAYER["thickness"])
    gurney = GURNEY * (((1.0 + 2.0 * ratio) ** 3 + 1.0) / (6.0 * (1.0 + ratio)) + ratio) ** -0.5
    rows = [mass_row("kg/m", PLATE["density"] * PLATE["thickness"] * PLATE["length"], mass_of(results[0.5], "flyer"))]
    for h, result in results.items():
        found = flight(result)
        bend = 2.0 * np.arcsin(found["speed"] / (2.0 * LAYER["speed"]))
        point = LAYER["speed"] * np.sin(bend) / np.sin(bend + PLATE["angle"])
        on = f", cells of {h:g} mm"
        rows += [row(f"speed of the plate{on}: Gurney [m/s]", gurney, found["speed"], "{:.0f}"),
                 row(f"bend of the plate{on}: Taylor, from its speed [deg]", np.degrees(bend),
                     np.degrees(found["bend"]), "{:.2f}"),
                 row(f"collision point{on}: from speed and bend [m/s]", point, found["point"], "{:.0f}")]
    figure = draw(results[0.5], (10e-6, 20e-6, 30e-6), "velocity", 1500.0, "speed [m/s]", (10.6, 2.9),
                  (-25.0, 180.0, -14.0, 78.0))
    return {"plate_table": table(HEADER, rows), "plate_ratio": f"{ratio:.2f}",
            "plate_balance": f"{balance(results[0.5]):.2f}"}, {"drawn_welded_plate": figure}


def flight(result):
    """The plate in flight: its speed and bend just before it meets the base, and the speed of the collision point."""
    c, s = np.cos(PLATE["angle"]), np.sin(PLATE["angle"])
    places = np.arange(40e-3, 121e-3, 10e-3)
    fastest, bends = np.zeros(len(places)), np.zeros(len(places))
    arrival, landed = np.full(len(places), np.nan), np.full(len(places), np.nan)
    low, before = None, 0.0
    for dump in result.point_dumps:
        d = dump.read()
        flyer = d["body"] == 0
        x, v = d["position"][flyer][:, :2], d["velocity"][flyer][:, :2]
        start = x - d["displacement"][flyer][:, :2]
        along = start @ np.array([c, s])
        across = start @ np.array([-s, c])
        bottom = across < across.min() + 0.6 * result.cell_size
        lower = np.array([x[bottom & (np.abs(along - p) < 1e-3)].mean(axis=0) for p in places])
        for n, p in enumerate(places):
            if lower[n, 1] < 2.0 * result.cell_size:
                if np.isnan(arrival[n]) and low is not None:
                    share = (low[n, 1] - 1e-3) / (low[n, 1] - lower[n, 1])
                    arrival[n] = before + share * (dump.time - before)
                    landed[n] = low[n, 0] + share * (lower[n, 0] - low[n, 0])
                continue
            here = np.abs(along - p) < 1e-3
            mean = v[here].mean(axis=0)
            fastest[n] = np.linalg.norm(mean)
            ahead = (along > p) & (along < p + 20e-3)  # not yet bent back by the base
            fit = np.column_stack([np.ones(ahead.sum()), along[ahead], across[ahead]])
            tangent = np.linalg.lstsq(fit, x[ahead], rcond=None)[0][1]
            bends[n] = np.arctan2(tangent[1], tangent[0]) - PLATE["angle"]
        low, before = lower, dump.time
    known = ~np.isnan(arrival)
    point = np.polyfit(arrival[known], landed[known], 1)[0]
    return {"speed": fastest[known].mean(), "bend": bends[known].mean(), "point": point}


PARTS = {"ogive": ogive, "cone_liner": cone_liner, "slope": slope, "v_hull": v_hull, "welded_plate": welded_plate}
