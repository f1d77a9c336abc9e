// The words and figures around the picture. Text of the logs goes in by textContent only.
const $ = (id) => document.getElementById(id);

function element(tag, text, className = "") {
  const node = document.createElement(tag);
  node.textContent = text;
  if (className) node.className = className;
  return node;
}

/** A square in a flight's colour with its letter: what tells flights apart where they share a plot or a list. */
function chip(flight) {
  const node = element("span", flight.letter, "chip");
  node.style.background = flight.color;
  return node;
}

/** The summary's figure, or else the log's; null where neither has it. */
function figure(flight, key) {
  const given = flight.summary && flight.summary[key];
  if (given !== null && given !== undefined) return {value: given, note: ""};
  const derived = flight.derived[key];
  return derived === null || derived === undefined ? null : {value: derived, note: "whole log"};
}

/** One figure as text: {value|null, unit, note, bad}. */
function numberFigure(flight, key, digits, unit) {
  const found = figure(flight, key);
  const value = found && isNumber(found.value) ? found.value.toFixed(digits) : null;
  return {value, unit, note: value === null ? "" : found.note,
          bad: key === "deadline_misses" && found !== null && found.value > 0};
}

/** The summary's clearance is the true one or null; the log may then still hold one, by the tracks. */
function clearanceFigure(flight) {
  const given = flight.summary && flight.summary.min_clearance;
  const measured = flight.clearance;
  const value = isNumber(given) ? given : measured ? measured.min.d : null;
  const from = isNumber(given) || measured && measured.from === "true" ? "true" : "tracks";
  const placed = value !== null && measured && Math.abs(measured.min.d - value) < 0.01;
  const note = value === null ? "" : from + (placed ? `, at ${measured.min.t.toFixed(2)} s` : "");
  const centre = value !== null && !isNumber(given) && flight.vehicle.radius === null;
  return {value: value === null ? null : value.toFixed(3), unit: "m", note: centre ? `vehicle's centre, ${from}` : note,
          bad: value !== null && value < 0};
}

function planFigure(flight, key) {
  const ms = figure(flight, "plan_ms");
  const value = ms && isNumber(ms.value[key]) ? ms.value[key].toFixed(1) : null;
  return {value, unit: "ms", note: value === null ? "" : ms.note, bad: false};
}

const kFigures = [
  ["flight time", (f) => numberFigure(f, "flight_time_s", 2, "s")],
  ["path length", (f) => numberFigure(f, "path_length", 2, "m")],
  ["SLR", (f) => numberFigure(f, "slr", 4, "")],
  ["min clearance", clearanceFigure],
  ["top speed", (f) => numberFigure(f, "max_speed", 2, "m/s")],
  ["plans", (f) => numberFigure(f, "plans", 0, "")],
  ["deadline misses", (f) => numberFigure(f, "deadline_misses", 0, "")],
  ["plan p50", (f) => planFigure(f, "p50")],
  ["plan p99", (f) => planFigure(f, "p99")],
  ["plan max", (f) => planFigure(f, "max")]
];

function addTile([name, read]) {
  const {value, unit, note, bad} = read(flights[0]);
  const tile = element("div", "", bad ? "tile bad" : "tile");
  tile.append(element("div", name, "name"));
  const shown = element("div", value ?? "not in this log", value === null ? "value none" : "value");
  if (value !== null && unit) shown.append(element("small", ` ${unit}`));
  tile.append(shown, element("div", note, "note"));
  $("tiles").append(tile);
}

function badge(flight) {
  const outcome = figure(flight, "outcome");
  const node = element("span", outcome ? String(outcome.value).replace("_", " ") : "outcome not in this log", "badge");
  if (outcome) node.classList.add(outcome.value === "reached" ? "good" : "bad");
  return node;
}

/** Flights in rows, figures in columns; the best of a column is not marked: what is best depends on the question. */
function showComparison() {
  const head = element("tr", "");
  head.append(element("th", "flight"), element("th", "outcome"));
  for (const [name, read] of kFigures) {
    const unit = read(flights[0]).unit;
    const cell = element("th", name, "figure");
    if (unit) cell.append(element("small", ` ${unit}`));
    head.append(cell);
  }
  const table = element("table", "");
  table.id = "comparison";
  table.append(head);
  for (const flight of flights) {
    const row = element("tr", "");
    const name = element("td", "");
    name.append(chip(flight), ` ${flight.name}`, element("small", ` ${flight.file}`));
    const outcome = element("td", "");
    outcome.append(badge(flight));
    const reason = figure(flight, "reason");
    if (reason) outcome.title = String(reason.value);
    row.append(name, outcome);
    for (const [, read] of kFigures) {
      const {value, note, bad} = read(flight);
      const cell = element("td", value ?? "–", bad ? "figure bad" : "figure");
      cell.title = value === null ? "not in this log" : note;
      row.append(cell);
    }
    table.append(row);
  }
  $("tiles").className = "table";
  $("tiles").append(table);
}

function showSummary() {
  if (several) {
    showComparison();
    return;
  }
  const reason = figure(flights[0], "reason");
  $("badge").append(badge(flights[0]));
  $("reason").textContent = reason ? String(reason.value) : "";
  kFigures.forEach(addTile);
}

function warningsOf(flight) {
  const {log} = flight;
  const warnings = [];
  if (log.cut_off) warnings.push("the log's last line is cut off (the writer was killed) and was skipped");
  if (log.not_finite) warnings.push(`${log.not_finite} records without finite numbers were skipped`);
  if (log.unknown) warnings.push(`${log.unknown} records of an unknown type were skipped`);
  if (flight.vehicle.radius === null && flight.vehicle.t.length) {
    warnings.push("the vehicle's radius is not in this log: it is drawn as a point");
  }
  return several ? warnings.map((text) => `${flight.letter}: ${text}`) : warnings;
}

function showParameters() {
  const parameters = flights.map((f) => (f.header.parameters instanceof Object ? f.header.parameters : {}));
  const keys = new Set(parameters.flatMap(Object.keys));
  $("parameters").hidden = keys.size === 0;
  const text = (value) => (value === undefined ? "–" : typeof value === "string" ? value : JSON.stringify(value));
  const table = $("parameters").querySelector("table");
  if (several) {
    const head = element("tr", "");
    head.append(element("td", ""), ...flights.map((f) => {
      const cell = element("td", "");
      cell.append(chip(f));
      return cell;
    }));
    table.append(head);
  }
  for (const key of keys) {
    const values = parameters.map((p) => text(p[key]));
    const row = element("tr", "", values.some((v) => v !== values[0]) ? "differs" : "");
    row.append(element("td", key), ...values.map((v) => element("td", v)));
    table.append(row);
  }
}

function showAbout() {
  const {header, file} = flights[0];
  const text = (value) => (typeof value === "string" ? value : JSON.stringify(value));
  if (several) {
    $("about").textContent = `${flights.length} flights under one time`;
    document.title = "jink: flights compared";
  } else {
    const parts = [["seed", header.seed], ["jink", header.version], ["log", file]];
    if (header.scenario !== undefined || header.mission !== undefined) {
      $("about").append(header.scenario !== undefined ? "scenario " : "mission ", element("b", flights[0].name), " · ");
      document.title = `${flights[0].name} – jink flight report`;
    }
    const known = parts.filter(([, value]) => value !== undefined);
    $("about").append(known.map(([key, value]) => `${key} ${text(value)}`).join(" · "));
  }
  const warnings = flights.flatMap(warningsOf);
  $("warning").hidden = warnings.length === 0;
  $("warning").textContent = warnings.length ? `Note: ${warnings.join("; ")}.` : "";
  showParameters();
}

function legendStroke(c, color, dash = []) {
  c.strokeStyle = color;
  c.lineWidth = 5;
  c.setLineDash(dash.map((d) => 2 * d));
  c.beginPath();
  c.moveTo(2, 14);
  c.lineTo(50, 14);
  c.stroke();
}

function legendMark(c, color, kind) {
  c.fillStyle = c.strokeStyle = color;
  c.lineWidth = 4;
  c.beginPath();
  if (kind === "cross") {
    [[15, 14], [37, 14], [26, 3], [26, 25]].forEach(([x, y], i) => (i % 2 ? c.lineTo(x, y) : c.moveTo(x, y)));
    c.stroke();
    return;
  }
  c.arc(26, 14, 11, 0, 2 * Math.PI);
  if (kind === "ring") {
    c.setLineDash([5, 4]);
    c.lineWidth = 3;
    c.stroke();
  } else {
    c.fill();
  }
}

function showLegend() {
  const any = (has) => flights.some(has);
  const truth = any((f) => f.obstacles !== null);
  const tracks = any((f) => f.tracks !== null);
  const path = any((f) => f.vehicle.t.length > 0);
  const rows = [
    ["vehicle", (c) => legendMark(c, kColors.vehicle), path],
    ["other vehicles", (c) => legendMark(c, kColors.other), any((f) => f.others.length > 0)],
    [truth ? "obstacle" : "obstacle, as tracked", (c) => legendMark(c, kColors.obstacle), truth || tracks],
    ["map", (c) => legendMark(c, kColors.map), any((f) => f.standing.length > 0)],
    ["map, as seen", (c) => legendMark(c, kColors.seen), any((f) => f.seen.length > 0)],
    ["track", (c) => legendMark(c, kColors.track, "ring"), truth && tracks],
    [`predicted, ${kAhead} s`, (c) => legendStroke(c, kColors.track, [4, 3]), tracks],
    ["plan", (c) => legendStroke(c, kColors.plan), any((f) => f.plans.length > 0)],
    ["plan, blocked", (c) => legendStroke(c, kColors.blocked, [5, 3]), any((f) => f.plans.some(isBlocked))],
    ["guide", (c) => legendStroke(c, kColors.plan, [2, 4]), any((f) => f.plans.some((plan) => plan.way))],
    ["flown", (c) => legendStroke(c, kColors.flown), path],
    ["still to come", (c) => legendStroke(c, kColors.whole), path],
    ["setpoint", (c) => legendMark(c, kColors.setpoint, "cross"), any((f) => f.setpoints.t.length > 0)]
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

/** The rows of the table of the present moment: [name, text, alarm]. */
function nowRows(flight, moment) {
  const {vehicle, nearest, plan} = moment;
  const body = !nearest ? "" : nearest.body.number !== undefined ? `vehicle ${nearest.body.number}`
    : nearest.body.id === undefined ? "map" : `${moment.truth ? "obstacle" : "track"} ${nearest.body.id}`;
  const extra = plan ? (plan.kept ? ", kept" : "") + (plan.missed ? ", late" : "") : "";
  const [mode, phase] = [flight.eventAt("mode", moment.t), flight.eventAt("phase", moment.t)];
  return [
    ["position", vehicle ? vehicle.p.map((x) => x.toFixed(2)).join(", ") : "–"],
    ["speed", vehicle ? `${vehicle.speed.toFixed(2)} m/s` : "–"],
    ["clearance", nearest ? `${nearest.free.toFixed(2)} m, ${body}` : "–", nearest && nearest.free < 0],
    ["plan", plan ? `${plan.status}, ${plan.ms.toFixed(1)} ms${extra}` : "–", plan && isBlocked(plan)],
    ["tracks", flight.tracks ? String(moment.tracks.length) : "–"],
    ["mode", mode ? mode[2] : "–"],
    ["phase", moment.over ? "log has ended" : phase ? phase[2].split(":")[0] : "–"]
  ];
}

function showNow(moments) {
  const columns = flights.map((flight, i) => nowRows(flight, moments[i]));
  const rows = columns[0].map(([key], r) => {
    const row = element("tr", "");
    row.append(element("td", key), ...columns.map((c) => element("td", c[r][1], c[r][2] ? "alarm" : "")));
    return row;
  });
  if (several) {
    const head = element("tr", "");
    head.append(element("td", ""), ...flights.map((f) => {
      const cell = element("td", "");
      cell.append(chip(f));
      return cell;
    }));
    rows.unshift(head);
  }
  $("now").replaceChildren(...rows);
}
