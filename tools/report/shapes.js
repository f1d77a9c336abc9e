// Colours, and the true shapes: their corners and faces, how far a point is from them, how they are drawn.
// The colours are those of Okabe and Ito, which people with any colour vision tell apart; what is bad has a second mark
// besides its colour (a dash, a ring, a word).
const kColors = {
  vehicle: "#0072b2", flown: "#0072b2", whole: "#bcd3e3", plan: "#009e73", blocked: "#d55e00", obstacle: "#d9a441",
  track: "#a8478a", setpoint: "#1c2530", map: "#a9aba2", seen: "#7f97ab", near: "#c03a00", other: "#3f9bd1"
};
const kFlightColors = ["#0072b2", "#d55e00", "#009e73", "#a8478a", "#8a6d00", "#3f9bd1"];
const kFlightDashes = [[], [7, 3], [2, 2.5], [8, 3, 2, 3], [4, 4], [12, 3]];
const kLight = [-0.45, -0.6, 0.66];  // towards it; length 1

/** "#rrggbb" mixed with white (share > 0) or black (share < 0). */
function lighter(color, share) {
  const goal = share > 0 ? 255 : 0;
  const parts = [1, 3, 5].map((i) => parseInt(color.slice(i, i + 2), 16));
  return `rgb(${parts.map((c) => Math.round(c + Math.abs(share) * (goal - c))).join(",")})`;
}

/**
 * About the centre: {corners, faces [[i, ...]] counter-clockwise from outside, normals, edges [[i, j, face, face]],
 * box?}.
 */
function polyhedron(shape) {
  const solid = shape.box ? boxSolid(shape.box) : {corners: [], faces: []};
  if (!shape.box) {
    for (let i = 0; i < shape.vertices.length / 3; ++i) solid.corners.push(point(shape.vertices, i));
    for (let i = 0; i < shape.faces.length; i += 3) solid.faces.push(shape.faces.slice(i, i + 3));
  }
  solid.normals = solid.faces.map(([a, b, c]) => {
    const n = cross(minus(solid.corners[b], solid.corners[a]), minus(solid.corners[c], solid.corners[a]));
    return times(n, 1 / (Math.hypot(...n) || 1));
  });
  const sides = new Map();
  solid.faces.forEach((face, f) => face.forEach((a, k) => {
    const b = face[(k + 1) % face.length];
    const key = a < b ? `${a} ${b}` : `${b} ${a}`;
    if (!sides.has(key)) sides.set(key, [a, b, f, f]); else sides.get(key)[3] = f;
  }));
  // Where two faces lie nearly in one plane, as on what is round, the line between them is none of the shape's.
  const flat = (a, b) => a !== b && dot(solid.normals[a], solid.normals[b]) > 0.97;
  solid.edges = [...sides.values()].filter(([, , f, g]) => !flat(f, g));
  solid.yawRate = shape.yaw_rate || 0;
  return solid;
}

function boxSolid(box) {
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => box.map((e, k) => ((i >> k) & 1 ? e / 2 : -e / 2)));
  return {corners, box, faces: [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]};
}

function nearestOnSegment(p, a, b) {
  const along = minus(b, a);
  const s = dot(along, along);
  return plus(a, times(along, s ? clamp(dot(minus(p, a), along) / s, 0, 1) : 0));
}

function nearestOnTriangle(p, [a, b, c], normal) {
  const inside = [[a, b], [b, c], [c, a]].every(([q, r]) => dot(cross(minus(r, q), minus(p, q)), normal) >= 0);
  if (inside && dot(normal, normal) > 0.5) return minus(p, times(normal, dot(minus(p, a), normal)));
  const ends = [[a, b], [b, c], [c, a]].map(([q, r]) => nearestOnSegment(p, q, r));
  return ends.reduce((best, q) => (length(p, q) < length(p, best) ? q : best));
}

/** A solid about the vertical, turned by an angle; of one that does not turn nothing changes. */
function turned(solid, angle) {
  if (!angle) return solid;
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const turn = ([x, y, z]) => [c * x - s * y, s * x + c * y, z];
  return {...solid, corners: solid.corners.map(turn), normals: solid.normals.map(turn)};
}

/** Distance d to a body's surface, and the surface's point q. Inside a hull d is 0, inside others negative. */
function toSurface(from, body, solid) {
  const p = minus(from, body.p);
  const apart = Math.hypot(...p);
  if (!solid) return {d: apart - body.r, q: plus(body.p, times(p, apart ? body.r / apart : 0))};
  if (solid.box) {
    const half = solid.box.map((e) => e / 2);
    const q = p.map((x, k) => clamp(x, -half[k], half[k]));
    const d = Math.hypot(...minus(p, q));
    return {d: d > 0 ? d : Math.max(...p.map((x, k) => Math.abs(x) - half[k])), q: plus(body.p, q)};
  }
  let best = null;
  let within = true;
  solid.faces.forEach((face, f) => {
    const corners = face.map((i) => solid.corners[i]);
    if (dot(minus(p, corners[0]), solid.normals[f]) >= -1e-12) within = false;
    const q = nearestOnTriangle(p, corners, solid.normals[f]);
    const d = length(p, q);
    if (!best || d < best.d) best = {d, q};
  });
  return {d: within ? 0 : best.d, q: plus(body.p, best.q)};
}

/** A sphere shaded from the upper left. Depth to its centre; the size is exact for a sphere in the view's middle. */
function drawSphere(ctx, camera, p, radius, color, rim) {
  const s = camera.project(p);
  if (!s) return;
  const r = Math.max(1.5, camera.scale * radius / s[2]);
  const shade = ctx.createRadialGradient(s[0] - 0.35 * r, s[1] - 0.4 * r, 0.1 * r, s[0], s[1], r);
  shade.addColorStop(0, lighter(color, 0.65));
  shade.addColorStop(0.55, color);
  shade.addColorStop(1, lighter(color, -0.35));
  ctx.beginPath();
  ctx.arc(s[0], s[1], r, 0, 2 * Math.PI);
  ctx.fillStyle = shade;
  ctx.fill();
  if (!rim) return;
  ctx.lineWidth = 2;
  ctx.strokeStyle = rim;
  ctx.stroke();
}

/** A convex body: the faces towards the camera, shaded by where they face. */
function drawSolid(ctx, camera, p, solid, color, rim) {
  const seen = solid.corners.map((c) => camera.project(plus(p, c)));
  if (seen.some((s) => !s)) return;
  const shown = solid.faces.map((face) => {
    let area = 0;  // on the screen, whose y points down: a face towards the camera runs clockwise there
    face.forEach((i, k) => {
      const [a, b] = [seen[i], seen[face[(k + 1) % face.length]]];
      area += a[0] * b[1] - b[0] * a[1];
    });
    return area < 0;
  });
  ctx.lineJoin = "round";
  solid.faces.forEach((face, f) => {
    if (!shown[f]) return;
    const light = dot(solid.normals[f], kLight);
    ctx.fillStyle = ctx.strokeStyle = lighter(color, light > 0 ? 0.5 * light : 0.35 * light);
    ctx.lineWidth = 0.7;  // closes the seams between faces
    ctx.beginPath();
    face.forEach((i, k) => (k ? ctx.lineTo(...seen[i].slice(0, 2)) : ctx.moveTo(...seen[i].slice(0, 2))));
    ctx.closePath();
    ctx.fill();
    ctx.stroke();
  });
  ctx.strokeStyle = rim || lighter(color, -0.45);
  ctx.lineWidth = rim ? 2 : 1;
  ctx.beginPath();
  for (const [a, b, f, g] of solid.edges) {
    if (!shown[f] && !shown[g] && solid.faces.length > 2) continue;
    ctx.moveTo(...seen[a].slice(0, 2));
    ctx.lineTo(...seen[b].slice(0, 2));
  }
  ctx.stroke();
}

/** The corners of the convex hull of points [x, y], in order. */
function outline(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const chain = (list) => {
    const out = [];
    for (const p of list) {
      const turns = () => {
        const [a, b] = out.slice(-2);
        return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) <= 0;
      };
      while (out.length > 1 && turns()) out.pop();
      out.push(p);
    }
    return out.slice(0, -1);
  };
  return [...chain(sorted), ...chain(sorted.reverse())];
}

/** The shadow straight below, which tells where over the ground a body is. */
function drawShadow(ctx, camera, p, radius, solid) {
  if (p[2] < 0) return;
  const angles = Array.from({length: 20}, (_, i) => i * Math.PI / 10);
  const circle = () => angles.map((a) => [radius * Math.cos(a), radius * Math.sin(a)]);
  const ring = solid ? outline(solid.corners.map(([x, y]) => [x, y])) : circle();
  ctx.beginPath();
  for (const [x, y] of ring) {
    const s = camera.project([p[0] + x, p[1] + y, 0]);
    if (!s) return;
    ctx.lineTo(s[0], s[1]);
  }
  ctx.closePath();
  ctx.fillStyle = "#3344551c";
  ctx.fill();
}
