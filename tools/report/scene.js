// The camera, and lines and labels in its view: a small perspective renderer on a 2D canvas. Whatever can hide
// something else is collected with its depth and drawn from far to near.
const kNear = 0.15;   // m, nearest depth that is drawn
const kFarthest = 1e5;  // m, beyond which nothing need be in view
const kFocal = 3.2;   // focal length over half the canvas height: a mild perspective

class Camera {
  constructor(bounds) {
    this.bounds = bounds;
    this.width = this.height = 1;
    this.look(...this.aside());
  }

  /** From the side of the way from start to target, a little behind and above: it then runs across the picture. */
  aside() {
    const {start, target} = flights[0].header;
    const way = isTriple(start) && isTriple(target) ? [target[0] - start[0], target[1] - start[1]] : [1, 0];
    return [Math.atan2(-way[1], way[0]) + 0.4, 0.42];
  }

  /** Looks from that azimuth (rad, 0: from the south, rising towards the west) and elevation (rad). */
  look(azimuth, elevation) {
    this.azimuth = azimuth;
    this.elevation = elevation;
    this.center = this.bounds.min.map((x, k) => (x + this.bounds.max[k]) / 2);
    this.fitted = false;
  }

  resize(width, height) {
    const changed = this.width !== width || this.height !== height;
    this.width = width;
    this.height = height;
    if (!this.fitted || changed && !this.moved) this.fit();
  }

  /** Goes as near as the bounds allow. */
  fit() {
    this.fitted = true;
    const corner = (i) => [0, 1, 2].map((k) => ((i >> k) & 1 ? this.bounds.max : this.bounds.min)[k]);
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map(corner);
    const inside = (v) => v && v[0] > 44 && v[0] < this.width - 44 && v[1] > 40 && v[1] < this.height - 24;
    for (let round = 0; round < 3; ++round) {  // perspective shifts the middle, and the middle the distance
      for (this.distance = 1; this.distance < 1e5; this.distance *= 1.02) {
        if (corners.every((p) => inside(this.project(p)))) break;
      }
      const seen = corners.map((p) => this.project(p));
      const middle = (k) => (Math.min(...seen.map((v) => v[k])) + Math.max(...seen.map((v) => v[k]))) / 2;
      this.pan(this.width / 2 - middle(0), this.height / 2 - middle(1));
    }
    this.moved = false;
  }

  /** Right, up (screen) and depth of a point, before the perspective. */
  view(p) {
    const [x, y, z] = [p[0] - this.center[0], p[1] - this.center[1], p[2] - this.center[2]];
    const [ca, sa] = [Math.cos(this.azimuth), Math.sin(this.azimuth)];
    const [ce, se] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    const right = ca * x - sa * y;
    const forward = sa * x + ca * y;
    return [right, z * ce + forward * se, this.distance + forward * ce - z * se];
  }

  get scale() { return kFocal * this.height / 2; }
  toScreen(v) { return [this.width / 2 + this.scale * v[0] / v[2], this.height / 2 - this.scale * v[1] / v[2], v[2]]; }
  /** x, y in CSS pixels and the depth; null behind the camera. */
  project(p) {
    const v = this.view(p);
    return v[2] < kNear ? null : this.toScreen(v);
  }

  /** A segment's two screen points, cut at the near plane; null where nothing is left. */
  segment(a, b) {
    let [va, vb] = [this.view(a), this.view(b)];
    if (va[2] < kNear && vb[2] < kNear) return null;
    const s = (kNear - va[2]) / (vb[2] - va[2]);
    if (va[2] < kNear) va = mix(va, vb, s); else if (vb[2] < kNear) vb = mix(va, vb, s);
    return [this.toScreen(va), this.toScreen(vb)];
  }

  drag(dx, dy) {
    this.moved = true;
    this.azimuth += dx * 0.008;
    this.elevation = clamp(this.elevation + dy * 0.008, -0.2, Math.PI / 2);
  }

  pan(dx, dy) {
    this.moved = true;
    const perPixel = this.distance / this.scale;
    const [ca, sa, se] = [Math.cos(this.azimuth), Math.sin(this.azimuth), Math.sin(this.elevation)];
    const up = dy * perPixel;
    this.center[0] += -dx * perPixel * ca + up * se * sa;
    this.center[1] += dx * perPixel * sa + up * se * ca;
    this.center[2] += up * Math.cos(this.elevation);
  }

  zoom(factor) {
    this.moved = true;
    this.distance = clamp(this.distance * factor, 0.5, 2000);
  }
}

/** The flight volume, null where the log has none. */
function flightVolume(flight) {
  const world = flight.header.world;
  return world && isTriple(world.min) && isTriple(world.max) ? world : null;
}

/** What must be in view at first: the paths, starts and targets, and the air around them. The ground below is drawn. */
function sceneBounds() {
  const min = [Infinity, Infinity, Infinity], max = [-Infinity, -Infinity, -Infinity];
  const include = (p) => p.map((x) => clamp(x, -kFarthest, kFarthest)).forEach((x, k) => {
    min[k] = Math.min(min[k], x);
    max[k] = Math.max(max[k], x);
  });
  for (const flight of flights) {
    for (const series of [flight.vehicle, ...flight.others]) {
      for (let i = 0; i < series.t.length; ++i) include(point(series.p, i));
    }
    for (const key of ["start", "target"]) if (isTriple(flight.header[key])) include(flight.header[key]);
  }
  const world = flightVolume(flights[0]) || {min: [-5, -5, 0], max: [5, 5, 3]};
  if (!isNumber(min[0])) {
    include(world.min);
    include(world.max);
  }
  for (const k of [0, 1]) {
    const pad = Math.max(1.5, 3 - (max[k] - min[k]) / 2);
    min[k] -= pad;
    max[k] += pad;
  }
  min[2] = Math.min(min[2], 0);
  max[2] = Math.max(max[2], min[2] + 2);
  return {min, max};
}

function line(ctx, camera, a, b, color, width, dash = []) {
  const s = camera.segment(a, b);
  if (!s) return;
  ctx.strokeStyle = color;
  ctx.lineWidth = width;
  ctx.setLineDash(dash);
  ctx.beginPath();
  ctx.moveTo(s[0][0], s[0][1]);
  ctx.lineTo(s[1][0], s[1][1]);
  ctx.stroke();
  ctx.setLineDash([]);
}

function label(ctx, camera, p, text, color, dx = 0, dy = 0, align = "center") {
  const s = camera.project(p);
  if (!s) return;
  ctx.font = "12px system-ui, sans-serif";
  ctx.textAlign = align;
  ctx.textBaseline = "middle";
  ctx.lineWidth = 3;
  ctx.strokeStyle = "#ffffffd8";
  ctx.strokeText(text, s[0] + dx, s[1] + dy);
  ctx.fillStyle = color;
  ctx.fillText(text, s[0] + dx, s[1] + dy);
}

/** The ground: a grid with metre labels on the edges towards the camera, and heights on the corner away from both. */
class Ground {
  constructor(bounds, world) {
    this.world = world;
    const extent = Math.max(bounds.max[0] - bounds.min[0], bounds.max[1] - bounds.min[1]);
    this.step = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000].find((s) => extent / s <= 16) || 20000;
    this.min = [0, 1].map((k) => Math.floor(bounds.min[k] / this.step + 1e-9) * this.step);
    this.max = [0, 1].map((k) => Math.ceil(bounds.max[k] / this.step - 1e-9) * this.step);
    this.top = Math.ceil(bounds.max[2]);
    this.bottom = bounds.min[2];
  }

  /** The ground and the air over it. */
  bounds() { return {min: [...this.min, this.bottom], max: [...this.max, this.top]}; }

  draw(ctx, camera) {
    for (const k of [0, 1]) {
      for (let x = this.min[k]; x <= this.max[k] + 1e-9; x += this.step) {
        const end = (limits) => (k === 0 ? [x, limits[1], 0] : [limits[0], x, 0]);
        line(ctx, camera, end(this.min), end(this.max), x === 0 ? "#aeb9c4" : "#dde3e9", 1);
      }
    }
    if (this.world) this.drawVolume(ctx, camera);
    this.drawLabels(ctx, camera);
  }

  drawVolume(ctx, camera) {
    const {min, max} = this.world;
    const corner = (i) => [0, 1, 2].map((k) => ((i >> k) & 1 ? max : min)[k]);
    for (let i = 0; i < 8; ++i) {
      for (const k of [1, 2, 4]) if (!(i & k)) line(ctx, camera, corner(i), corner(i | k), "#9fb3c8", 1, [5, 4]);
    }
  }

  drawLabels(ctx, camera) {
    const middle = [0, 1].map((k) => (this.min[k] + this.max[k]) / 2);
    const nearer = (a, b) => (camera.view(a)[2] <= camera.view(b)[2] ? a : b);
    const y = nearer([middle[0], this.min[1], 0], [middle[0], this.max[1], 0])[1];
    const x = nearer([this.min[0], middle[1], 0], [this.max[0], middle[1], 0])[0];
    const off = 0.35 * this.step;
    const [outX, outY] = [x === this.min[0] ? x - off : x + off, y === this.min[1] ? y - off : y + off];
    for (let e = this.min[0]; e <= this.max[0] + 1e-9; e += this.step) {
      label(ctx, camera, [e, outY, 0], String(e), "#56626f");
    }
    for (let n = this.min[1]; n <= this.max[1] + 1e-9; n += this.step) {
      label(ctx, camera, [outX, n, 0], String(n), "#56626f");
    }
    label(ctx, camera, [this.max[0] + 0.8 * this.step, outY, 0], "E, m", "#45525f");
    label(ctx, camera, [outX, this.max[1] + 0.8 * this.step, 0], "N, m", "#45525f");
    if (camera.elevation > 1.3) return;  // seen from above, heights fall on one point
    const c = [x === this.min[0] ? this.max[0] : this.min[0], y === this.min[1] ? this.max[1] : this.min[1]];
    line(ctx, camera, [c[0], c[1], 0], [c[0], c[1], this.top], "#aeb9c4", 1);
    const rise = this.top > 40 ? 10 : this.top > 12 ? 5 : this.top > 5 ? 2 : 1;
    for (let u = rise; u <= this.top; u += rise) {
      label(ctx, camera, [c[0], c[1], u], String(u), "#56626f", -8, 0, "right");
    }
    label(ctx, camera, [c[0], c[1], this.top], "U, m", "#45525f", 0, -12);
  }
}
