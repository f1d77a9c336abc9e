// What moves or is aimed at, in the scene: spheres, paths, tracks, start and target.
const kColors = {
  vehicle: "#1761c7", flown: "#1761c7", whole: "#c5d8ef", plan: "#14915a", blocked: "#c8321f", obstacle: "#c98b3c",
  track: "#7a4fb5", setpoint: "#d0368a", near: "#c8321f"
};
const kShownGap = 2.0;      // m, up to which the gap to the nearest obstacle is drawn
const kVehicleRadius = flight.vehicle.radius || 0.05;  // m, of the drawing; a dot where the log tells none
const kMostSegments = 700;  // of the whole path, for a smooth picture

/** A sphere shaded from the upper left. Depth to its centre; the size is exact for a sphere in the view's middle. */
function drawSphere(ctx, camera, p, radius, color, rim) {
  const s = camera.project(p);
  if (!s) return;
  const r = Math.max(1.5, camera.scale * radius / s[2]);
  const shade = ctx.createRadialGradient(s[0] - 0.35 * r, s[1] - 0.4 * r, 0.1 * r, s[0], s[1], r);
  shade.addColorStop(0, lighter(color, 0.75));
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

/** "#rrggbb" mixed with white (share > 0) or black (share < 0). */
function lighter(color, share) {
  const goal = share > 0 ? 255 : 0;
  const parts = [1, 3, 5].map((i) => parseInt(color.slice(i, i + 2), 16));
  return `rgb(${parts.map((c) => Math.round(c + Math.abs(share) * (goal - c))).join(",")})`;
}

/** The shadow straight below, which tells where over the ground a sphere is. */
function drawShadow(ctx, camera, p, radius) {
  if (p[2] < 0) return;
  ctx.beginPath();
  for (let i = 0; i <= 20; ++i) {
    const a = i * Math.PI / 10;
    const s = camera.project([p[0] + radius * Math.cos(a), p[1] + radius * Math.sin(a), 0]);
    if (!s) return;
    if (i === 0) ctx.moveTo(s[0], s[1]); else ctx.lineTo(s[0], s[1]);
  }
  ctx.fillStyle = "#33445518";
  ctx.fill();
}

/** A ring where a track is, and what it predicts: its velocity times 1 s. */
function drawTrack(ctx, camera, track, ring) {
  const s = camera.project(track.p);
  if (!s) return;
  line(ctx, camera, track.p, track.p.map((x, k) => x + track.v[k]), kColors.track, 1.6, [4, 3]);
  if (!ring) return;
  ctx.beginPath();
  ctx.arc(s[0], s[1], Math.max(2, camera.scale * track.r / s[2]), 0, 2 * Math.PI);
  ctx.strokeStyle = kColors.track;
  ctx.lineWidth = 1.2;
  ctx.setLineDash([3, 3]);
  ctx.stroke();
  ctx.setLineDash([]);
}

function drawMarker(ctx, camera, p, text, color) {
  line(ctx, camera, [p[0], p[1], 0], p, color, 1, [2, 3]);
  const s = camera.project(p);
  if (!s) return;
  ctx.beginPath();
  ctx.moveTo(s[0], s[1] - 6);
  ctx.lineTo(s[0] + 6, s[1]);
  ctx.lineTo(s[0], s[1] + 6);
  ctx.lineTo(s[0] - 6, s[1]);
  ctx.closePath();
  ctx.fillStyle = "#fff";
  ctx.fill();
  ctx.strokeStyle = color;
  ctx.lineWidth = 2;
  ctx.stroke();
  label(ctx, camera, p, text, color, 0, -16);
}

/** Draws moments, and counts what it drew. */
class Scene {
  constructor(canvas) {
    this.canvas = canvas;
    this.ctx = canvas.getContext("2d");
    this.ground = new Ground(sceneBounds());
    this.camera = new Camera(this.ground.bounds());
    this.follow = false;
    const n = flight.vehicle.t.length;
    const step = Math.max(1, Math.ceil(n / kMostSegments));
    this.whole = [];
    for (let i = 0; i < n; i += step) this.whole.push({t: flight.vehicle.t[i], p: point(flight.vehicle.p, i)});
    if (n > 0 && (n - 1) % step) this.whole.push({t: flight.vehicle.t[n - 1], p: point(flight.vehicle.p, n - 1)});
  }

  draw(moment) {
    const {ctx, camera} = this;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.clearRect(0, 0, width, height);
    camera.resize(width, height);
    if (this.follow && moment.vehicle) camera.center = [...moment.vehicle.p];
    this.items = [];
    this.counts = {obstacles: 0, tracks: 0, flown: 0, whole: 0, plan: 0, vehicle: 0};
    this.ground.draw(ctx, camera);
    for (const body of moment.solid) drawShadow(ctx, camera, body.p, body.r);
    if (moment.vehicle) drawShadow(ctx, camera, moment.vehicle.p, kVehicleRadius);
    this.collectPaths(moment);
    this.collectBodies(moment);
    this.items.sort((a, b) => b.depth - a.depth);
    for (const item of this.items) item.draw();
    if (moment.vehicle) this.drawOutline(moment.vehicle.p);
    if (moment.nearest) this.drawNearest(moment);
    return this.counts;
  }

  add(p, draw) { this.items.push({depth: this.camera.view(p)[2], draw}); }

  addSegment(a, b, color, width, dash) {
    this.add(mix(a, b, 0.5), () => line(this.ctx, this.camera, a, b, color, width, dash));
  }

  collectPaths(moment) {
    for (let i = 1; i < this.whole.length; ++i) {
      const [a, b] = [this.whole[i - 1], this.whole[i]];
      if (a.t >= moment.t) {  // under everything: it is where nothing is yet
        line(this.ctx, this.camera, a.p, b.p, kColors.whole, 2);
        ++this.counts.whole;
      } else {
        const end = b.t <= moment.t || !moment.vehicle ? b.p : moment.vehicle.p;
        this.addSegment(a.p, end, kColors.flown, 2.5);
        ++this.counts.flown;
      }
    }
    if (!moment.plan) return;
    const {path} = moment.plan;
    const color = isBlocked(moment.plan) ? kColors.blocked : kColors.plan;
    for (let i = 4; i + 3 < path.length; i += 4) {
      if (path[i] < moment.t) continue;  // the plan's past is not worth a line
      this.addSegment(path.slice(i - 3, i), path.slice(i + 1, i + 4), color, 2.5);
      ++this.counts.plan;
    }
  }

  collectBodies(moment) {
    const {ctx, camera} = this;
    for (const body of moment.solid) {
      const near = moment.nearest && moment.nearest.body === body && moment.nearest.free < 0.3;
      this.add(body.p, () => drawSphere(ctx, camera, body.p, body.r, kColors.obstacle, near ? kColors.near : ""));
      ++this.counts.obstacles;
    }
    for (const track of moment.tracks) {
      const depth = camera.view(track.p)[2] - track.r;  // before the sphere that it belongs to
      this.items.push({depth, draw: () => drawTrack(ctx, camera, track, moment.truth)});
      ++this.counts.tracks;
    }
    for (const [key, color] of [["start", "#5d6b7a"], ["target", kColors.plan]]) {
      const p = flight.header[key];
      if (isTriple(p)) this.add(p, () => drawMarker(ctx, camera, p, key, color));
    }
    if (moment.setpoint) this.add(moment.setpoint.p, () => this.drawSetpoint(moment.setpoint.p));
    if (!moment.vehicle) return;
    const {p} = moment.vehicle;
    this.add(p, () => drawSphere(ctx, camera, p, kVehicleRadius, kColors.vehicle, "#ffffff"));
    ++this.counts.vehicle;
  }

  /** Where the vehicle is, even behind or within an obstacle. */
  drawOutline(p) {
    const s = this.camera.project(p);
    if (!s) return;
    const {ctx} = this;
    ctx.beginPath();
    ctx.arc(s[0], s[1], Math.max(2, this.camera.scale * kVehicleRadius / s[2]), 0, 2 * Math.PI);
    ctx.strokeStyle = kColors.vehicle;
    ctx.lineWidth = 1.5;
    ctx.stroke();
  }

  drawSetpoint(p) {
    const s = this.camera.project(p);
    if (!s) return;
    const {ctx} = this;
    ctx.strokeStyle = kColors.setpoint;
    ctx.lineWidth = 1.6;
    ctx.beginPath();
    ctx.moveTo(s[0] - 5, s[1]);
    ctx.lineTo(s[0] + 5, s[1]);
    ctx.moveTo(s[0], s[1] - 5);
    ctx.lineTo(s[0], s[1] + 5);
    ctx.stroke();
  }

  /** The gap to the nearest obstacle, drawn over everything: surface to surface. */
  drawNearest({vehicle, nearest}) {
    const apart = length(vehicle.p, nearest.body.p);
    if (apart < 1e-6 || nearest.free > kShownGap) return;
    const a = mix(vehicle.p, nearest.body.p, clamp((flight.vehicle.radius || 0) / apart, 0, 1));
    const b = mix(nearest.body.p, vehicle.p, clamp(nearest.body.r / apart, 0, 1));
    const color = nearest.free < 0.3 ? kColors.near : "#45525f";
    line(this.ctx, this.camera, a, b, color, 1.2);
    const [from, to] = [this.camera.project(vehicle.p), this.camera.project(nearest.body.p)];
    if (!from || !to) return;
    // Beside the vehicle, away from the obstacle, so that it covers neither.
    const away = Math.hypot(from[0] - to[0], from[1] - to[1]) || 1;
    const reach = 14 + this.camera.scale * kVehicleRadius / from[2];
    const [dx, dy] = [0, 1].map((k) => (from[k] - to[k]) / away * reach);
    const align = dx < -6 ? "right" : dx > 6 ? "left" : "center";
    label(this.ctx, this.camera, vehicle.p, `${nearest.free.toFixed(2)} m`, color, dx, dy, align);
  }
}
