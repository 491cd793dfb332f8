"""Makes the plain sources and the demand of `town`, always the same: python3 town.py"""

import math
import os
import random

R = random.Random(7)
NX, NY, D = 13, 9, 115.0
out = os.path.join(os.path.dirname(os.path.abspath(__file__)), "town.")
cols = "ABCDEFGHIJKLM"
AC = {3, 9}
AR = {2, 6}  # arterial columns and rows
CC = {0, 6, 12}
CR = {4}  # collectors
pos = {}
for i in range(NX):
    for j in range(NY):
        s = 0.13 if (i in AC or j in AR) else 0.2
        dx = R.uniform(-s, s) * D
        dy = R.uniform(-s, s) * D
        if i in AC:
            dx *= 0.3
        if j in AR:
            dy *= 0.3
        # the whole town bends a little
        x = i * D + dx
        y = j * D + dy + 25 * math.sin(i / 2.2)
        pos[i, j] = (round(x, 1), round(y, 1))


def cls(a, b):
    (i, j), (k, l) = a, b
    if i == k and i in AC or j == l and j in AR:
        return "arterial"
    if i == k and i in CC or j == l and j in CR:
        return "collector"
    return "street"


links = []
for i in range(NX):
    for j in range(NY):
        if i + 1 < NX:
            links.append(((i, j), (i + 1, j)))
        if j + 1 < NY:
            links.append(((i, j), (i, j + 1)))
park = {(6, 7), (7, 7), (6, 8), (7, 8)}
keep = []
deg = {}
for a, b in links:
    for n in (a, b):
        deg[n] = deg.get(n, 0) + 1
R.shuffle(links)
for a, b in links:
    c = cls(a, b)
    if c == "street" and R.random() < 0.2 and deg[a] > 3 and deg[b] > 3:
        deg[a] -= 1
        deg[b] -= 1
        continue
    keep.append((a, b, c))
keep.sort()
nm = lambda n: f"{cols[n[0]]}{n[1] + 1}"
kinds = {}
for a, b, c in keep:
    kinds.setdefault(a, []).append(c)
    kinds.setdefault(b, []).append(c)
tl = set()
f = open(out + "nod.xml", "w")
f.write("<nodes>\n")
for n in sorted(pos):
    k = kinds[n]
    big = k.count("arterial")
    if (big >= 2 and "collector" in k) or big == 4:
        t = "traffic_light"
        tl.add(n)
    elif k.count("collector") == 4:
        t = "traffic_light"
        tl.add(n)
    elif big >= 2 and len(k) == 4 and R.random() < 0.4:
        t = "traffic_light"
        tl.add(n)
    elif big or "collector" in k:
        t = "priority"
    else:
        t = "right_before_left"
    f.write(f'    <node id="{nm(n)}" x="{pos[n][0]}" y="{pos[n][1]}" type="{t}"/>\n')
f.write("</nodes>\n")
f.close()
core = {(i, j) for i in range(4, 9) for j in range(3, 6)}
f = open(out + "edg.xml", "w")
f.write("<edges>\n")
E = []
for a, b, c in keep:
    for p, q in ((a, b), (b, a)):
        t = c
        if a in core and b in core:
            t = c + "_walk"
        f.write(f'    <edge id="{nm(p)}{nm(q)}" from="{nm(p)}" to="{nm(q)}" type="{t}"/>\n')
        E.append((p, q, c, t))
f.write("</edges>\n")
f.close()
f = open(out + "typ.xml", "w")
f.write("""<types>
    <!-- Two lanes each way, no bicycles. -->
    <type id="arterial" numLanes="2" speed="13.89" priority="9" disallow="bicycle pedestrian"/>
    <type id="collector" numLanes="1" speed="13.89" priority="6"/>
    <type id="street" numLanes="1" speed="8.33" priority="3"/>
    <!-- The centre has pavements. -->
    <type id="collector_walk" numLanes="1" speed="13.89" priority="6" sidewalkWidth="2"/>
    <type id="street_walk" numLanes="1" speed="8.33" priority="3" sidewalkWidth="2"/>
</types>
""")
f.close()
open(out + "netccfg", "w").write("""<configuration>
    <node-files value="town.nod.xml"/>
    <edge-files value="town.edg.xml"/>
    <type-files value="town.typ.xml"/>
    <offset.disable-normalization value="true"/>
    <crossings.guess value="true"/>
    <no-turnarounds.except-deadend value="true"/>
    <tls.default-type value="static"/>
    <junctions.corner-detail value="2"/>
</configuration>
""")
# demand
eid = lambda e: nm(e[0]) + nm(e[1])
W = {"arterial": 3, "collector": 1.5, "street": 1}


def mid(e):
    (x, y), (u, v) = pos[e[0]], pos[e[1]]
    return ((x + u) / 2, (y + v) / 2)


def pick(w):
    return R.choices(E, w)[0]


w = [W[e[2]] for e in E]
wt = [{"arterial": 5, "collector": 2, "street": 0.3}[e[2]] for e in E]
ws = [{"arterial": 0, "collector": 1.5, "street": 2}[e[2]] for e in E]
END = 600
succ = {}
for e in E:
    if e[2] != "arterial":
        succ[e[:2]] = [g[:2] for g in E if g[2] != "arterial" and g[0] == e[1] and g[1] != e[0]]


def bikable(a, b):
    seen = {a[:2]}
    todo = [a[:2]]
    while todo:
        n = todo.pop()
        if n == b[:2]:
            return True
        for m in succ[n]:
            if m not in seen:
                seen.add(m)
                todo.append(m)
    return False


trips = []


def trip(t, typ):
    ww = {"truck": wt, "bicycle": ws}.get(typ, w)
    lo, hi = (300, 900) if typ == "bicycle" else (500, 1500)
    while True:
        a, b = pick(ww), pick(ww)
        (x, y), (u, v) = mid(a), mid(b)
        if lo < math.hypot(x - u, y - v) < hi and a[:2] != b[1::-1] and (typ != "bicycle" or bikable(a, b)):
            break
    trips.append((t, typ, eid(a), eid(b)))


def typ():
    return R.choices(["car", "van", "truck", "motorcycle", "bicycle"], [70, 9, 7, 3, 11])[0]


INIT = 440
RATE = 1.7
for _ in range(INIT):
    trip(0.0, typ())
t = 0
while True:
    t += R.expovariate(RATE)
    if t > END:
        break
    trip(round(t, 1), typ())
f = open(out + "rou.xml", "w")
f.write("""<routes>
    <vTypeDistribution id="cars">
        <vType id="car" length="4.6" width="1.8" speedDev="0.1" sigma="0.5" probability="0.6"/>
        <vType id="hurried_car" length="4.6" width="1.8" tau="0.7" minGap="1.5" speedFactor="1.15" speedDev="0.05" sigma="0.7" probability="0.25"/>
        <vType id="small_car" length="3.7" width="1.65" speedDev="0.1" sigma="0.5" probability="0.15"/>
    </vTypeDistribution>
    <vType id="van" vClass="delivery" length="6.2" width="2.0"/>
    <vType id="truck" vClass="truck" length="9.5" width="2.5"/>
    <vType id="bus" vClass="bus" length="12" width="2.5"/>
    <vType id="motorcycle" vClass="motorcycle"/>
    <vType id="bicycle" vClass="bicycle"/>
    <vType id="walker" vClass="pedestrian" speedFactor="normc(1,0.15,0.6,1.5)"/>

    <!-- Two bus lines, there and back along the arterial roads. -->
""")


def rowroute(j, rev):
    ns = [(i, j) for i in range(NX)]
    if rev:
        ns = ns[::-1]
    return [nm(a) + nm(b) for a, b in zip(ns, ns[1:])]


def colroute(i, rev):
    ns = [(i, j) for j in range(NY)]
    if rev:
        ns = ns[::-1]
    return [nm(a) + nm(b) for a, b in zip(ns, ns[1:])]


lines = {
    "line1_east": rowroute(2, 0),
    "line1_west": rowroute(2, 1),
    "line2_north": colroute(9, 0),
    "line2_south": colroute(9, 1),
}
stops = []
items = []
for L, r in lines.items():
    f.write(f'    <route id="{L}" edges="{" ".join(r)}">\n')
    for k, e in enumerate(r):
        if k % 3 == 1:
            stops.append((f"stop_{e}", e))
            f.write(f'        <stop busStop="stop_{e}" duration="12"/>\n')
    f.write("    </route>\n")
f.write("\n")
for L in lines:
    items.append(
        (0.0, f'    <flow id="{L}" type="bus" route="{L}" begin="0" end="{END}" period="90" departSpeed="max"/>\n')
    )
for n, (t, ty, a, b) in enumerate(trips):
    ini = ' departPos="random_free"' if t == 0 else ""
    T = "cars" if ty == "car" else ty
    items.append(
        (
            t,
            f'    <trip id="{ty[0] if ty != "truck" else "t"}{n}" type="{T}" depart="{t:g}"{ini} departLane="best" departSpeed="max" from="{a}" to="{b}"/>\n',
        )
    )
walk = [e for e in E if e[3].endswith("_walk")]
for k in range(150):
    a = R.choice(walk)
    b = R.choice(walk)
    t = 0.0 if k < 60 else round(R.uniform(0, END - 60), 1)
    items.append(
        (
            t,
            f'    <person id="w{k}" type="walker" depart="{t:g}" departPos="random"><walk from="{eid(a)}" to="{eid(b)}"/></person>\n',
        )
    )
# parked cars: some stay for the whole run, some leave; vans that deliver stop in the lane
P = random.Random(11)
kerb = [e for e in E if e[3] in ("street", "collector") and math.dist(pos[e[0]], pos[e[1]]) > 90]
lots = P.sample(kerb, 12)
n = 0
for q, e in enumerate(lots):
    for k in range(4):
        if P.random() < 0.7:
            d = P.choice([600, 600, P.randrange(120, 500, 10)])
            nxt = [g for g in E if g[0] == e[1] and g[1] != e[0]]
            t = f"{eid(e)} {eid(P.choice(nxt))}"
            items.append(
                (
                    0.0,
                    f'    <vehicle id="p{n}" type="cars" depart="0" departPos="stop"><route edges="{t}"/><stop parkingArea="lot_{eid(e)}" duration="{d}"/></vehicle>\n',
                )
            )
            n += 1
art = [e for e in E if e[2] == "arterial" and math.dist(pos[e[0]], pos[e[1]]) > 90]
for k in range(10):
    e = P.choice(art)
    j = P.choice([g for g in E if g[1] == e[0] and g[0] != e[1] and g[2] != "street"])
    m = P.choice([g for g in E if g[0] == e[1] and g[1] != e[0] and g[2] != "street"])
    items.append(
        (
            round(20 + k * 45.0, 1),
            f'    <trip id="d{k}" type="van" depart="{20 + k * 45}" departLane="best" departSpeed="max" from="{eid(j)}" to="{eid(m)}"><stop lane="{eid(e)}_0" endPos="70" duration="30"/></trip>\n',
        )
    )
items.sort(key=lambda x: x[0])
for _, s in items:
    f.write(s)
f.write("</routes>\n")
f.close()
f = open(out + "add.xml", "w")
f.write("<additional>\n")
for s, e in stops:
    f.write(f'    <busStop id="{s}" lane="{e}_0" startPos="30" endPos="55"/>\n')
for e in lots:
    f.write(
        f'    <parkingArea id="lot_{eid(e)}" lane="{eid(e)}_0" startPos="25" endPos="55" roadsideCapacity="4" width="2.2"/>\n'
    )
f.write("</additional>\n")
f.close()
open(out + "sumocfg", "w").write(f'''<configuration>
    <net-file value="town.net.xml"/>
    <route-files value="town.rou.xml"/>
    <additional-files value="town.add.xml"/>
    <begin value="0"/>
    <end value="{END}"/>
    <step-length value="0.5"/>
    <seed value="42"/>
    <xml-validation value="never"/>
    <no-step-log value="true"/>
    <time-to-teleport value="120"/>
    <collision.action value="warn"/>
    <collision.check-junctions value="true"/>
</configuration>
''')
