// The flight's data, as report_data.cpp writes them, and the questions asked of them. Lengths in m, times in s, ENU.
//   t [first, last]; vehicle {from: "truth"|"state", radius|null, t [], p [x,y,z,...], speed []};
//   setpoints {t, p, speed};
//   obstacles, tracks null | {t [], stride, frames [[id,x,y,z,radius(,vx,vy,vz),...], ...]};
//   plans [{t, ms, status, kept, missed, path [t,x,y,z,...]}]; events [[t, name, detail]];
//   clearance null | {from: "true"|"tracks", t, d, min {t, d}}; summary null | jink-flight/1; derived {...}.
const flight = JSON.parse(document.getElementById("flight-data").textContent);
const [tFirst, tLast] = flight.t;
const kOldestTracks = 1.0;     // s, without a message after which tracks are no longer drawn
const kOldestObstacles = 0.5;  // s, the same for true obstacles

const clamp = (x, low, high) => Math.min(high, Math.max(low, x));
const isNumber = (x) => typeof x === "number" && Number.isFinite(x);
const isTriple = (v) => Array.isArray(v) && v.length === 3 && v.every(isNumber);
const point = (flat, i) => [flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]];
const mix = (a, b, s) => a.map((x, k) => x + s * (b[k] - x));
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
  return {id: list[k], p: [list[k + 1], list[k + 2], list[k + 3]], r: list[k + 4],
          v: stride > 5 ? [list[k + 5], list[k + 6], list[k + 7]] : null};
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

const planTimes = flight.plans.map((plan) => plan.t);
const planAt = (t) => flight.plans[lastUpTo(planTimes, t + 1e-6)] || null;
const isBlocked = (plan) => plan.status !== "reaches" && plan.status !== "progresses";

/** The newest event of that name at t, or null. */
function eventAt(name, t) {
  let found = null;
  for (const event of flight.events) {
    if (event[0] <= t + 1e-6 && event[1] === name) found = event;
  }
  return found;
}

/** How an event is coloured: good, warn, bad or nothing. */
function tone(name, detail) {
  if (name === "reached" || /^done: reached/.test(detail)) return "good";
  if (/^(collision|timeout|left_world|start_blocked|aborted)$/.test(name)) return "bad";
  if (/^done: (?!reached)/.test(detail)) return "bad";
  if (name === "plan_status") return /^(blocked|start_blocked|invalid)$/.test(detail) ? "bad" : "";
  return /^(hazard|refused|send_failed|reference_lost|tracks_refused)$/.test(name) ? "warn" : "";
}

/** What is drawn and measured at t. Solid obstacles are the true ones; where the log has none, the tracks. */
function momentAt(t) {
  const truth = flight.obstacles !== null;
  const tracks = bodiesAt(flight.tracks, t, kOldestTracks);
  const solid = truth ? bodiesAt(flight.obstacles, t, kOldestObstacles) : tracks;
  const vehicle = motionAt(flight.vehicle, t);
  let nearest = null;
  for (const body of vehicle ? solid : []) {
    const free = length(vehicle.p, body.p) - body.r - (flight.vehicle.radius || 0);
    if (!nearest || free < nearest.free) nearest = {body, free};
  }
  return {t, truth, tracks, solid, vehicle, nearest, plan: planAt(t), setpoint: motionAt(flight.setpoints, t)};
}
