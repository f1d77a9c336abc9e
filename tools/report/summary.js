// The words and figures around the picture. Text of the log goes in by textContent only.
const $ = (id) => document.getElementById(id);

function element(tag, text, className = "") {
  const node = document.createElement(tag);
  node.textContent = text;
  if (className) node.className = className;
  return node;
}

/** The summary's figure, or else the log's; null where neither has it. */
function figure(key) {
  const given = flight.summary && flight.summary[key];
  if (given !== null && given !== undefined) return {value: given, note: ""};
  const derived = flight.derived[key];
  return derived === null || derived === undefined ? null : {value: derived, note: "whole log"};
}

function addTile(name, value, unit, note, bad) {
  const tile = element("div", "", bad ? "tile bad" : "tile");
  tile.append(element("div", name, "name"));
  const shown = element("div", value ?? "not in this log", value === null ? "value none" : "value");
  if (value !== null && unit) shown.append(element("small", ` ${unit}`));
  tile.append(shown, element("div", note, "note"));
  $("tiles").append(tile);
}

function addFigure(name, key, digits, unit) {
  const found = figure(key);
  const value = found && isNumber(found.value) ? found.value.toFixed(digits) : null;
  addTile(name, value, unit, value === null ? "" : found.note, key === "deadline_misses" && found && found.value > 0);
}

/** The summary's clearance is the true one or null; the log may then still hold one, by the tracks. */
function addClearance() {
  const given = flight.summary && flight.summary.min_clearance;
  const measured = flight.clearance;
  const value = isNumber(given) ? given : measured ? measured.min.d : null;
  const from = isNumber(given) || measured && measured.from === "true" ? "true" : "tracks";
  const placed = value !== null && measured && Math.abs(measured.min.d - value) < 0.01;
  const note = value === null ? "" : from + (placed ? `, at ${measured.min.t.toFixed(2)} s` : "");
  const centre = value !== null && !isNumber(given) && flight.vehicle.radius === null;
  const shown = value === null ? null : value.toFixed(3);
  addTile("min clearance", shown, "m", centre ? `vehicle's centre, ${from}` : note, value !== null && value < 0);
}

function showSummary() {
  const outcome = figure("outcome");
  const reason = figure("reason");
  $("badge").textContent = outcome ? String(outcome.value).replace("_", " ") : "outcome not in this log";
  if (outcome) $("badge").classList.add(outcome.value === "reached" ? "good" : "bad");
  $("reason").textContent = reason ? String(reason.value) : "";
  addFigure("flight time", "flight_time_s", 2, "s");
  addFigure("path length", "path_length", 2, "m");
  addFigure("SLR", "slr", 4, "");
  addClearance();
  addFigure("top speed", "max_speed", 2, "m/s");
  addFigure("plans", "plans", 0, "");
  addFigure("deadline misses", "deadline_misses", 0, "");
  const ms = figure("plan_ms");
  for (const [name, key] of [["plan p50", "p50"], ["plan p99", "p99"], ["plan max", "max"]]) {
    const value = ms && isNumber(ms.value[key]) ? ms.value[key].toFixed(1) : null;
    addTile(name, value, "ms", value === null ? "" : ms.note, false);
  }
}

function showAbout() {
  const {header, log} = flight;
  const name = header.scenario ?? header.mission;
  const text = (value) => (typeof value === "string" ? value : JSON.stringify(value));
  const parts = [["seed", header.seed], ["jink", header.version], ["log", flight.file]];
  if (name !== undefined) {
    $("about").append(header.scenario !== undefined ? "scenario " : "mission ", element("b", text(name)), " · ");
    document.title = `${text(name)} – jink flight report`;
  }
  const known = parts.filter(([, value]) => value !== undefined);
  $("about").append(known.map(([key, value]) => `${key} ${text(value)}`).join(" · "));
  const warnings = [];
  if (log.cut_off) warnings.push("the log's last line is cut off (the writer was killed) and was skipped");
  if (log.not_finite) warnings.push(`${log.not_finite} records without finite numbers were skipped`);
  if (log.unknown) warnings.push(`${log.unknown} records of an unknown type were skipped`);
  if (flight.vehicle.radius === null && flight.vehicle.t.length) {
    warnings.push("the vehicle's radius is not in this log: it is drawn as a point");
  }
  $("warning").hidden = warnings.length === 0;
  $("warning").textContent = warnings.length ? `Note: ${warnings.join("; ")}.` : "";
  const parameters = Object.entries(header.parameters instanceof Object ? header.parameters : {});
  $("parameters").hidden = parameters.length === 0;
  for (const [key, value] of parameters) {
    const row = element("tr", "");
    row.append(element("td", key), element("td", text(value)));
    $("parameters").querySelector("table").append(row);
  }
}

function showLegend() {
  const dot = (c, color) => {
    c.fillStyle = color;
    c.beginPath();
    c.arc(26, 14, 10, 0, 2 * Math.PI);
    c.fill();
  };
  const stroke = (c, color, dash = []) => {
    c.strokeStyle = color;
    c.lineWidth = 4;
    c.setLineDash(dash.map((d) => 2 * d));
    c.beginPath();
    const cross = color === kColors.setpoint;
    const ends = cross ? [[15, 14], [37, 14], [26, 3], [26, 25]] : [[2, 14], [50, 14]];
    ends.forEach(([x, y], i) => (i % 2 ? c.lineTo(x, y) : c.moveTo(x, y)));
    c.stroke();
  };
  const truth = flight.obstacles !== null;
  const [tracks, plans, path] = [flight.tracks !== null, flight.plans.length > 0, flight.vehicle.t.length > 0];
  const rows = [
    ["vehicle", (c) => dot(c, kColors.vehicle), path],
    [truth ? "obstacle" : "obstacle, as tracked", (c) => dot(c, kColors.obstacle), truth || tracks],
    [truth ? "track, 1 s ahead" : "1 s ahead", (c) => stroke(c, kColors.track, [4, 3]), tracks],
    ["plan", (c) => stroke(c, kColors.plan), plans],
    ["plan, blocked", (c) => stroke(c, kColors.blocked), flight.plans.some(isBlocked)],
    ["flown", (c) => stroke(c, kColors.flown), path],
    ["still to come", (c) => stroke(c, kColors.whole), path],
    ["setpoint", (c) => stroke(c, kColors.setpoint), flight.setpoints.t.length > 0]
  ];
  for (const [name, draw, present] of rows) {
    if (!present) continue;
    const row = element("div", "");
    const icon = document.createElement("canvas");
    icon.width = 52;
    icon.height = 28;
    draw(icon.getContext("2d"));
    row.append(icon, element("span", name));
    $("legend").append(row);
  }
}

/** The table of the present moment. */
function showNow(moment) {
  const {vehicle, nearest, plan} = moment;
  const alarm = nearest && nearest.free < 0;
  const what = moment.truth ? "obstacle" : "track";
  const extra = plan ? (plan.kept ? ", kept" : "") + (plan.missed ? ", late" : "") : "";
  const [mode, phase] = [eventAt("mode", moment.t), eventAt("phase", moment.t)];
  const rows = [
    ["position", vehicle ? vehicle.p.map((x) => x.toFixed(2)).join(", ") : "–"],
    ["speed", vehicle ? `${vehicle.speed.toFixed(2)} m/s` : "–"],
    ["clearance", nearest ? `${nearest.free.toFixed(2)} m, ${what} ${nearest.body.id}` : "–", alarm],
    ["plan", plan ? `${plan.status}, ${plan.ms.toFixed(1)} ms${extra}` : "–", plan && isBlocked(plan)],
    ["tracks", flight.tracks ? String(moment.tracks.length) : "–"],
    ["mode", mode ? mode[2] : "–"],
    ["phase", phase ? phase[2].split(":")[0] : "–"]
  ];
  $("now").replaceChildren(...rows.map(([key, value, bad]) => {
    const row = element("tr", "");
    row.append(element("td", key), element("td", value, bad ? "alarm" : ""));
    return row;
  }));
}
