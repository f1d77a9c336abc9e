// What moves or is aimed at, in the scene: bodies, paths, tracks, start and target.
const kShownGap = 2.0;      // m, up to which the gap to the nearest obstacle is drawn
const kDot = 0.05;          // m, radius of the drawing where the log tells none
const kMostSegments = 700;  // of the whole path, for a smooth picture

/** A ring where a track is, and the way that it is predicted to go, with a dot at each second. */
function drawTrack(ctx, camera, track, trust, ring) {
  const s = camera.project(track.p);
  if (!s) return;
  const ahead = prediction(track, trust);
  drawWay(ctx, camera, ahead, kColors.track, 1.6, [4, 3]);
  ctx.fillStyle = kColors.track;
  for (let i = Math.round(1 / kAheadStep); i < ahead.length; i += Math.round(1 / kAheadStep)) {
    const dot = camera.project(ahead[i]);
    if (dot) ctx.fillRect(dot[0] - 1.5, dot[1] - 1.5, 3, 3);
  }
  if (!ring) return;
  ctx.beginPath();
  ctx.arc(s[0], s[1], Math.max(2, camera.scale * track.r / s[2]), 0, 2 * Math.PI);
  ctx.strokeStyle = kColors.track;
  ctx.lineWidth = 1.2;
  ctx.setLineDash([3, 3]);
  ctx.stroke();
  ctx.setLineDash([]);
}

/** A line through points, in one stroke. */
function drawWay(ctx, camera, points, color, width, dash = []) {
  ctx.strokeStyle = color;
  ctx.lineWidth = width;
  ctx.setLineDash(dash);
  ctx.beginPath();
  for (let i = 1; i < points.length; ++i) {
    const s = camera.segment(points[i - 1], points[i]);
    if (!s) continue;
    if (i === 1) ctx.moveTo(s[0][0], s[0][1]);
    ctx.lineTo(s[1][0], s[1][1]);
  }
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

/** A vehicle's way, thinned: [{t, p}, ...]. */
function thinned(series) {
  const n = series.t.length;
  const step = Math.max(1, Math.ceil(n / kMostSegments));
  const way = [];
  for (let i = 0; i < n; i += step) way.push({t: series.t[i], p: point(series.p, i)});
  if (n > 0 && (n - 1) % step) way.push({t: series.t[n - 1], p: point(series.p, n - 1)});
  return way;
}

/** Draws moments of one flight, and counts what it drew. */
class Scene {
  constructor(canvas, flight, bounds) {
    this.canvas = canvas;
    this.flight = flight;
    this.ctx = canvas.getContext("2d");
    this.ground = new Ground(bounds, flightVolume(flight));
    this.camera = new Camera(this.ground.bounds());
    this.follow = false;
    this.ways = [{way: thinned(flight.vehicle), color: kColors.flown, mark: true}];
    for (const other of flight.others) this.ways.push({way: thinned(other), color: kColors.other, series: other});
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
    this.counts = {obstacles: 0, shapes: 0, tracks: 0, flown: 0, whole: 0, plan: 0, vehicle: 0};
    this.ground.draw(ctx, camera);
    this.drawStanding(moment);
    for (const body of moment.solid) drawShadow(ctx, camera, body.p, body.r, this.solidOf(moment, body));
    for (const v of this.vehicles(moment)) drawShadow(ctx, camera, v.p, v.r);
    this.collectPaths(moment);
    this.collectBodies(moment);
    this.items.sort((a, b) => b.depth - a.depth);
    for (const item of this.items) item.draw();
    for (const v of this.vehicles(moment)) this.drawOutline(v);
    if (moment.nearest) this.drawNearest(moment);
    return this.counts;
  }

  /** What stands and what of it has been seen, from far to near, and under all else: it hides nothing of the flight. */
  drawStanding(moment) {
    const {ctx, camera} = this;
    const drawn = (color) => (body) => ({body, color, depth: camera.view(body.p)[2]});
    const order = this.flight.standing.map(drawn(kColors.map)).concat(moment.seen.map(drawn(kColors.seen)));
    order.sort((a, b) => b.depth - a.depth);
    ctx.globalAlpha = 0.55;
    for (const {body, color} of order) {
      if (body.solid) drawSolid(ctx, camera, body.p, body.solid, color);
      else drawSphere(ctx, camera, body.p, body.r, color);
    }
    ctx.globalAlpha = 1;
    this.counts.map = order.length;
  }

  /** The flight's own vehicle, then the others, as drawn. */
  vehicles(moment) {
    const own = moment.vehicle ? [{...moment.vehicle, r: this.flight.radius || kDot, color: kColors.vehicle}] : [];
    return own.concat(moment.others.map((v) => ({...v, r: v.r || kDot, color: kColors.other})));
  }

  /** The polyhedron of a true obstacle, undefined for a sphere and for tracks, whose shape nobody knows. */
  solidOf(moment, body) { return moment.truth ? this.flight.solidAt(body.id, moment.t) : undefined; }

  add(p, draw) { this.items.push({depth: this.camera.view(p)[2], draw}); }

  addSegment(a, b, color, width, dash) {
    this.add(mix(a, b, 0.5), () => line(this.ctx, this.camera, a, b, color, width, dash));
  }

  collectPaths(moment) {
    for (const {way, color, mark, series} of this.ways) {
      const now = mark ? moment.vehicle : moment.others.find((v) => v.series === series);
      for (let i = 1; i < way.length; ++i) {
        const [a, b] = [way[i - 1], way[i]];
        if (a.t >= moment.t) {  // under everything: it is where nothing is yet
          line(this.ctx, this.camera, a.p, b.p, kColors.whole, mark ? 2 : 1.2);
          ++this.counts.whole;
        } else {
          this.addSegment(a.p, b.t <= moment.t || !now ? b.p : now.p, color, mark ? 3 : 2);
          ++this.counts.flown;
        }
      }
    }
    if (!moment.plan) return;
    const {path} = moment.plan;
    const blocked = isBlocked(moment.plan);
    for (let i = 4; i + 3 < path.length; i += 4) {
      if (path[i] < moment.t) continue;  // the plan's past is not worth a line
      this.addSegment(path.slice(i - 3, i), path.slice(i + 1, i + 4), blocked ? kColors.blocked : kColors.plan, 3,
                      blocked ? [6, 3] : []);
      ++this.counts.plan;
    }
    const way = [path.slice(1, 4), ...Array.from({length: (moment.plan.way || []).length / 3},
                                                 (_, i) => point(moment.plan.way, i))];
    for (let i = 1; i < way.length; ++i) this.addSegment(way[i - 1], way[i], kColors.plan, 1.2, [2, 4]);
    for (const known of moment.plan.known || []) {
      for (let i = 4; i + 3 < known.path.length; i += 4) {
        if (known.path[i] < moment.t) continue;
        this.addSegment(known.path.slice(i - 3, i), known.path.slice(i + 1, i + 4), kColors.track, 1.6, [4, 3]);
      }
    }
  }

  collectBodies(moment) {
    const {ctx, camera, flight} = this;
    for (const body of moment.solid) {
      const near = moment.nearest && moment.nearest.body === body && moment.nearest.free < 0.3;
      const solid = this.solidOf(moment, body);
      const rim = near ? kColors.near : "";
      const draw = () => (solid ? drawSolid(ctx, camera, body.p, solid, kColors.obstacle, rim)
                                : drawSphere(ctx, camera, body.p, body.r, kColors.obstacle, rim));
      this.add(body.p, draw);
      ++this.counts.obstacles;
      if (solid) ++this.counts.shapes;
    }
    for (const track of moment.tracks) {
      const depth = camera.view(track.p)[2] - track.r;  // before the body that it belongs to
      this.items.push({depth, draw: () => drawTrack(ctx, camera, track, moment.trust, moment.truth)});
      ++this.counts.tracks;
    }
    const several = Array.isArray(flight.header.vehicles) && flight.header.vehicles.length > 1;
    (several ? flight.header.vehicles : [flight.header]).forEach((ends, i) => {
      for (const [key, color] of [["start", "#56626f"], ["target", "#00694d"]]) {
        const p = ends && ends[key];
        const text = several ? `${key} ${i}` : key;
        if (isTriple(p)) this.add(p, () => drawMarker(ctx, camera, p, text, color));
      }
    });
    if (moment.setpoint) this.add(moment.setpoint.p, () => this.drawSetpoint(moment.setpoint.p));
    for (const v of this.vehicles(moment)) {
      this.add(v.p, () => drawSphere(ctx, camera, v.p, v.r, v.color, "#ffffff"));
      ++this.counts.vehicle;
    }
  }

  /** Where a vehicle is, even behind or within an obstacle. */
  drawOutline(v) {
    const s = this.camera.project(v.p);
    if (!s) return;
    const {ctx} = this;
    const r = Math.max(3, this.camera.scale * v.r / s[2]);
    ctx.beginPath();
    ctx.arc(s[0], s[1], r, 0, 2 * Math.PI);
    ctx.strokeStyle = v.color;
    ctx.lineWidth = 1.5;
    ctx.stroke();
    if (v.number !== undefined) label(ctx, this.camera, v.p, String(v.number), "#1c2530", 0, -r - 8);
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
    const apart = length(vehicle.p, nearest.at);
    if (apart < 1e-6 || nearest.free > kShownGap) return;
    const color = nearest.free < 0.3 ? kColors.near : "#45525f";
    const edge = mix(vehicle.p, nearest.at, clamp(this.flight.radius / apart, 0, 1));
    line(this.ctx, this.camera, edge, nearest.at, color, 1.4);
    const [from, to] = [this.camera.project(vehicle.p), this.camera.project(nearest.at)];
    if (!from || !to) return;
    // Beside the vehicle, away from the obstacle, so that it covers neither.
    const away = Math.hypot(from[0] - to[0], from[1] - to[1]) || 1;
    const reach = 14 + this.camera.scale * (this.flight.radius || kDot) / from[2];
    const [dx, dy] = [0, 1].map((k) => (from[k] - to[k]) / away * reach);
    const align = dx < -6 ? "right" : dx > 6 ? "left" : "center";
    label(this.ctx, this.camera, vehicle.p, `${nearest.free.toFixed(2)} m`, color, dx, dy, align);
  }
}
