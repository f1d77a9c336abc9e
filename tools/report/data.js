// The flights' data, as report_data.cpp writes them, and the questions asked of them. Lengths in m, times in s, ENU.
// flights [{file, t [first, last];
//   vehicle {from: "truth"|"state", radius|null, t [], p [x,y,z,...], speed []};
//   others [{number, radius|null, t, p, speed, clearance}] the further vehicles of a team;
//   map [{p, r, shape: null | {vertices, faces}}] what stands, near the flight;
//   seen [{p, r, box, from, until|null}] what of it had been seen, and when;
//   setpoints {t, p, speed}; shapes {id: {box}|{vertices, faces, yaw_rate?}} of obstacles that are no spheres;
//   obstacles, tracks null | {t [], stride, frames [[id,x,y,z,radius(,vx,vy,vz,ax,ay,az,age),...], ...]};
//   plans [{t, ms, status, kept, missed, path [t,x,y,z,...], trust?, way? [x,y,z,...], known? [{id, radius, path}]}];
//   events [[t, name, detail, "good"|"warn"|"bad"|""]]; clearance null | {from: "true"|"tracks", t, d, min {t, d}};
//   summary null | jink-flight/1; derived {...}}].
const kOldestTracks = 1.0;     // s, without a message after which tracks are no longer drawn
const kOldestObstacles = 0.5;  // s, the same for true obstacles
const kAhead = 2.0;            // s, that a track's prediction is drawn for
const kAheadStep = 0.25;       // s

const clamp = (x, low, high) => Math.min(high, Math.max(low, x));
const isNumber = (x) => typeof x === "number" && Number.isFinite(x);
const isTriple = (v) => Array.isArray(v) && v.length === 3 && v.every(isNumber);
const point = (flat, i) => [flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]];
const mix = (a, b, s) => a.map((x, k) => x + s * (b[k] - x));
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

/** Index of the last of the rising times that is not after t; -1: all are. */
function lastUpTo(times, t) {
  let low = 0, high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle + 1; else high = middle;
  }
  return low - 1;
}

/** Position and speed at t, linear between samples, null outside the series. */
function motionAt(series, t) {
  const i = lastUpTo(series.t, t + 1e-6);
  const last = series.t.length - 1;
  if (i < 0) return null;
  if (i >= last) {
    return t - series.t[last] > kOldestTracks ? null : {p: point(series.p, last), speed: series.speed[last]};
  }
  const s = clamp((t - series.t[i]) / (series.t[i + 1] - series.t[i]), 0, 1);
  const speed = series.speed[i] + s * (series.speed[i + 1] - series.speed[i]);
  return {p: mix(point(series.p, i), point(series.p, i + 1), s), speed};
}

function bodyFrom(list, k, stride) {
  const body = {id: list[k], p: [list[k + 1], list[k + 2], list[k + 3]], r: list[k + 4]};
  if (stride > 5) [body.v, body.a, body.age] = [list.slice(k + 5, k + 8), list.slice(k + 8, k + 11), list[k + 11]];
  return body;
}

/** Obstacles or tracks at t: those of the newest frame, moved towards the next one where that has them too. */
function bodiesAt(series, t, oldest) {
  if (!series) return [];
  const i = lastUpTo(series.t, t + 1e-6);
  if (i < 0 || t - series.t[i] > oldest) return [];
  const next = series.frames[i + 1] || [];
  const gap = (series.t[i + 1] ?? Infinity) - series.t[i];
  const places = new Map();
  if (gap <= oldest) for (let k = 0; k < next.length; k += series.stride) places.set(next[k], k);
  const bodies = [];
  for (let k = 0; k < series.frames[i].length; k += series.stride) {
    const body = bodyFrom(series.frames[i], k, series.stride);
    const there = places.get(body.id);
    const share = clamp((t - series.t[i]) / gap, 0, 1);
    if (there !== undefined) body.p = mix(body.p, next.slice(there + 1, there + 4), share);
    bodies.push(body);
  }
  return bodies;
}

/** Where a track is predicted to be, from now on: constant acceleration while it is trusted, then constant velocity. */
function prediction(track, trust) {
  const believed = Math.max(0, trust - track.age);
  const points = [];
  for (let t = 0; t <= kAhead + 1e-9; t += kAheadStep) {
    const s = Math.min(t, believed);
    points.push(track.p.map((x, k) =>
      x + t * track.v[k] + (s ? track.a[k] * (0.5 * s * s + (t - s) * s) : 0)));
  }
  return points;
}

const isBlocked = (plan) => plan.status !== "reaches" && plan.status !== "progresses";

class Flight {
  constructor(raw, index) {
    Object.assign(this, raw);
    this.index = index;
    this.letter = String.fromCharCode(65 + index % 26);
    this.color = kFlightColors[index % kFlightColors.length];
    this.dash = kFlightDashes[index % kFlightDashes.length];
    this.events.sort((a, b) => a[0] - b[0]);
    this.planTimes = this.plans.map((plan) => plan.t);
    this.solids = new Map(Object.entries(this.shapes).map(([id, shape]) => [Number(id), polyhedron(shape)]));
    this.standing = this.map.map(({p, r, shape}) => ({p, r, solid: shape ? polyhedron(shape) : undefined}));
    for (const body of this.seen) body.solid = polyhedron(body);
    this.radius = this.vehicle.radius || 0;
  }

  get name() {
    const name = this.header.scenario ?? this.header.mission ?? this.file;
    return typeof name === "string" ? name : JSON.stringify(name);
  }

  planAt(t) { return this.plans[lastUpTo(this.planTimes, t + 1e-6)] || null; }

  /** The newest event of that name at t, or null. */
  eventAt(name, t) {
    let found = null;
    for (const event of this.events) if (event[0] <= t + 1e-6 && event[1] === name) found = event;
    return found;
  }

  /** An obstacle's polyhedron at t, undefined for a sphere. */
  solidAt(id, t) {
    const solid = this.solids.get(id);
    return solid && turned(solid, solid.yawRate * Math.max(0, t));
  }

  /** The nearest surface to a point at t: {body, free, at}, free less the vehicle's radius; null without any. */
  nearest(p, t, solid, others, standing) {
    let nearest = null;
    const regard = (body, shape) => {
      if (nearest && length(p, body.p) - body.r - this.radius >= nearest.free) return;
      const {d, q} = toSurface(p, body, shape);
      if (!nearest || d - this.radius < nearest.free) nearest = {body, free: d - this.radius, at: q};
    };
    for (const body of [...solid, ...others]) regard(body, this.solidAt(body.id, t));
    for (const body of standing) regard(body, body.solid);
    return nearest;
  }

  /**
   * What is drawn and measured at t; after the log's end what it ended with. Solid obstacles are the true ones; where
   * the log has none, the tracks.
   */
  momentAt(time) {
    const t = clamp(time, ...this.t);
    const truth = this.obstacles !== null;
    const tracks = bodiesAt(this.tracks, t, kOldestTracks);
    const solid = truth ? bodiesAt(this.obstacles, t, kOldestObstacles) : tracks;
    const vehicle = motionAt(this.vehicle, t);
    const others = this.others.flatMap((other) => {
      const motion = motionAt(other, t);
      return motion ? [{...motion, r: other.radius || 0, number: other.number, series: other}] : [];
    });
    const plan = this.planAt(t);
    const seen = this.seen.filter(({from, until}) => from <= t && (until === null || t < until));
    const standing = this.vehicle.from === "truth" ? this.standing : this.standing.concat(seen);
    const nearest = vehicle ? this.nearest(vehicle.p, t, solid, others, standing) : null;
    return {t, over: time > this.t[1] + 1e-6, truth, tracks, solid, vehicle, others, seen, nearest, plan,
            trust: plan ? plan.trust ?? Infinity : 0, setpoint: motionAt(this.setpoints, t)};
  }
}

const flights = JSON.parse(document.getElementById("flight-data").textContent).flights
  .map((raw, i) => new Flight(raw, i));
const several = flights.length > 1;
const tFirst = Math.min(...flights.map((flight) => flight.t[0]));
const tLast = Math.max(...flights.map((flight) => flight.t[1]));
const allEvents = flights.flatMap((flight) => flight.events.map((event) => ({flight, event})))
  .sort((a, b) => a.event[0] - b.event[0]);
