// Four plots over one time axis, with the events above them and a cursor. One canvas.
const kPlot = {left: 58, right: 14, top: 26, height: 84, gap: 12, axis: 26};
const kFont = "12px system-ui, sans-serif";
const kHalo = "#ffffffe0";

/** Round numbers that divide [low, high] in about `count` parts. */
function axisTicks(low, high, count) {
  const raw = (high - low) / count || 1;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((s) => s * power).find((s) => s >= raw - 1e-12);
  const ticks = [];
  const first = Math.ceil(low / step - 1e-9);
  for (let i = 0; i < 200 && (first + i) * step <= high + 1e-9 * step; ++i) ticks.push((first + i) * step);
  return {ticks, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9))};
}

const heights = (series) => series.t.map((_, i) => series.p[3 * i + 2]);

/** The lines of one flight in the plots of clearance, speed and height; `main` is the one whose value is told. */
function linesOf(flight, values, setpoints, others) {
  const look = {gap: Math.max(1, 5 * flight.log.interval), flight};
  const lines = [];
  if (several || !setpoints) {
    if (values) lines.push({...values, ...look, color: flight.color, dash: flight.dash, width: 1.7, main: true});
    return lines;
  }
  if (setpoints.t.length) lines.push({...setpoints, ...look, color: "#a3adb8", dash: [], width: 1.2});
  for (const other of others) lines.push({...other, ...look, color: kColors.other, dash: [], width: 1});
  if (values && values.t.length) {
    lines.push({...values, ...look, color: kColors.vehicle, dash: [], width: 1.7, main: true});
  }
  return lines;
}

/** What the four plots show: {title, note, unit, lines: [{t, y, color, ...}], ...}. No data: no lines. */
function plotSeries() {
  const first = flights[0];
  const from = !first.clearance ? "" : first.clearance.from === "true" ? "true" : "from tracks";
  const to = flights.some((f) => f.vehicle.radius === null) ? "vehicle's centre to" : "to";
  const team = first.others.length ? "; thin: the others" : "";
  const nearest = `${to} the nearest obstacle${first.others.length ? " or vehicle" : ""}`;
  const what = (first.vehicle.from === "truth" ? "true" : "estimate") +
               (first.setpoints.t.length ? "; grey: setpoint" : "");
  const who = several ? "" : what + team;
  const motion = (pick) => flights.flatMap((f) => linesOf(
    f, {t: f.vehicle.t, y: pick(f.vehicle)}, {t: f.setpoints.t, y: pick(f.setpoints)},
    f.others.map((o) => ({t: o.t, y: pick(o)}))));
  const gaps = flights.flatMap((f) => linesOf(
    f, f.clearance && {t: f.clearance.t, y: f.clearance.d}, {t: [], y: []},
    f.others.filter((o) => o.clearance).map((o) => ({t: o.clearance.t, y: o.clearance.d}))));
  const least = flights.flatMap((f) => (f.clearance ? [{...f.clearance.min, flight: f}] : []));
  const plans = flights.flatMap((f) => f.plans.map((plan) => ({...plan, flight: f})));
  return [
    {title: "clearance", note: several ? nearest : nearest + (from ? ", " + from : "") + team,
     unit: "m", lines: gaps, least, zero: true, ceiling: 6},
    {title: "speed", note: who, unit: "m/s", lines: motion((s) => s.speed), floor: 0},
    {title: "height", note: who, unit: "m", lines: motion(heights), floor: 0},
    {title: "plan time", note: "diamond: blocked, ring: deadline missed", unit: "ms", lines: [], plans, floor: 0}
  ];
}

class Plots {
  constructor(canvas) {
    this.canvas = canvas;
    this.ctx = canvas.getContext("2d");
    this.series = plotSeries();
    for (const s of this.series) s.range = this.rangeOf(s);
    this.points = 0;
  }

  rangeOf(s) {
    let values = s.plans ? s.plans.map((plan) => plan.ms) : s.lines.flatMap((l) => l.y);
    // Far obstacles must not flatten what happens near the vehicle.
    if (s.ceiling) values = values.map((v) => Math.min(v, s.ceiling));
    let low = values.reduce((a, b) => Math.min(a, b), s.floor ?? (s.zero ? 0 : Infinity));
    let high = values.reduce((a, b) => Math.max(a, b), -Infinity);
    if (!isNumber(low) || !isNumber(high)) [low, high] = [0, 1];
    if (high - low < 0.5) high = low + 0.5;
    return [low - (low < 0 ? 0.05 * (high - low) : 0), high + 0.3 * (high - low)];  // the title's room
  }

  get span() { return this.width - kPlot.left - kPlot.right; }
  get bottom() { return kPlot.top + 4 * (kPlot.height + kPlot.gap) - kPlot.gap; }
  x(t) { return kPlot.left + (t - tFirst) / (tLast - tFirst || 1) * this.span; }
  time(x) { return clamp(tFirst + (x - kPlot.left) / this.span * (tLast - tFirst), tFirst, tLast); }

  draw(t) {
    const ratio = window.devicePixelRatio || 1;
    this.width = this.canvas.clientWidth;
    const height = this.canvas.clientHeight;
    if (!this.still || this.still.key !== `${this.width} ${height} ${ratio}`) this.drawStill(height, ratio);
    this.canvas.width = this.still.width;
    this.canvas.height = this.still.height;
    this.ctx.drawImage(this.still, 0, 0);
    this.ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.drawCursor(t);
    return this.points;
  }

  /** All that does not move with the cursor, once per size. */
  drawStill(height, ratio) {
    this.still = document.createElement("canvas");
    this.still.key = `${this.width} ${height} ${ratio}`;
    this.still.width = Math.round(this.width * ratio);
    this.still.height = Math.round(height * ratio);
    const ctx = this.still.getContext("2d");
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.points = 0;
    const axis = axisTicks(tFirst, tLast, Math.max(3, this.width / 110));
    ctx.font = kFont;
    ctx.textBaseline = "middle";
    for (const s of axis.ticks) {
      ctx.fillStyle = "#e8ecf0";
      ctx.fillRect(this.x(s) - 0.5, kPlot.top, 1, this.bottom - kPlot.top);
      ctx.fillStyle = "#56626f";
      ctx.textAlign = "center";
      ctx.fillText(`${s.toFixed(axis.digits)} s`, this.x(s), this.bottom + 13);
    }
    this.drawEvents(ctx);
    this.series.forEach((s, i) => this.drawPanel(ctx, s, kPlot.top + i * (kPlot.height + kPlot.gap)));
  }

  /** A line through all plots for each event, and above them the names of those that matter, where there is room. */
  drawEvents(ctx) {
    const colors = {good: "#007a58", warn: "#9a6400", bad: "#c03a00"};
    let free = kPlot.left;
    for (const {flight, event: [at, name, detail, kind]} of allEvents) {
      const x = this.x(at);
      ctx.fillStyle = kind ? colors[kind] + "80" : "#9aa6b255";
      ctx.fillRect(x - 0.5, kind ? kPlot.top - 6 : kPlot.top, 1, this.bottom - kPlot.top + (kind ? 6 : 0));
      if (!kind) continue;
      const what = name === "phase" || name === "fault" || name === "plan_status" ? detail : name;
      const text = (several ? `${flight.letter} ` : "") + what.split(/[,;]/)[0].replace("_", " ");
      const width = ctx.measureText(text).width;
      const start = clamp(x - width / 2, kPlot.left, this.width - kPlot.right - width);
      if (start < free || width > 240) continue;
      ctx.fillStyle = colors[kind];
      ctx.textAlign = "left";
      ctx.fillText(text, start, 10);
      free = start + width + 10;
    }
  }

  drawPanel(ctx, s, top) {
    s.top = top;
    const y = s.y = (v) => top + kPlot.height * (1 - (v - s.range[0]) / (s.range[1] - s.range[0]));
    ctx.strokeStyle = "#cdd5dd";
    ctx.lineWidth = 1;
    ctx.strokeRect(kPlot.left + 0.5, top + 0.5, this.span - 1, kPlot.height - 1);
    const {ticks, digits} = axisTicks(s.range[0], s.range[1], 3);
    ctx.textAlign = "right";
    for (const v of ticks) {
      ctx.fillStyle = s.zero && Math.abs(v) < 1e-9 ? kColors.near : "#e8ecf0";
      ctx.fillRect(kPlot.left + 1, Math.round(y(v)) - 0.5, this.span - 2, 1);
      ctx.fillStyle = "#56626f";
      if (y(v) > top + 4) ctx.fillText(v.toFixed(digits), kPlot.left - 6, y(v));
    }
    ctx.save();
    ctx.translate(11, top + kPlot.height / 2);
    ctx.rotate(-Math.PI / 2);
    ctx.textAlign = "center";
    ctx.fillText(s.unit, 0, 0);
    ctx.restore();
    ctx.save();
    ctx.beginPath();
    ctx.rect(kPlot.left, top, this.span, kPlot.height);
    ctx.clip();
    for (const l of s.lines) this.drawLine(ctx, l, y);
    if (s.plans) this.drawPlans(ctx, s.plans, y);
    for (const least of s.least || []) this.drawLeast(ctx, least, y);
    this.drawTitle(ctx, s, top);
    ctx.restore();
  }

  drawTitle(ctx, s, top) {
    const empty = s.plans ? s.plans.length === 0 : s.lines.length === 0;
    ctx.textAlign = "left";
    ctx.lineWidth = 4;
    ctx.strokeStyle = kHalo;
    let x = kPlot.left + 8;
    for (const [text, font, color] of [[s.title, `600 ${kFont}`, "#1c2530"],
                                       [empty ? "not in this log" : s.note, kFont, "#56626f"]]) {
      ctx.font = font;
      ctx.strokeText(text, x, top + 11);
      ctx.fillStyle = color;
      ctx.fillText(text, x, top + 11);
      x += ctx.measureText(text).width + 8;
    }
    ctx.font = kFont;
  }

  drawLine(ctx, l, y) {
    ctx.beginPath();
    for (let i = 0; i < l.t.length; ++i) {
      const [px, py] = [this.x(l.t[i]), y(l.y[i])];
      // A gap in the log is a gap in the line.
      if (i === 0 || l.t[i] - l.t[i - 1] > l.gap) ctx.moveTo(px, py); else ctx.lineTo(px, py);
    }
    ctx.strokeStyle = l.color;
    ctx.lineWidth = l.width;
    ctx.lineJoin = "round";
    ctx.setLineDash(l.dash);
    ctx.stroke();
    ctx.setLineDash([]);
    this.points += l.t.length;
  }

  drawPlans(ctx, plans, y) {
    for (const plan of plans) {
      const [px, py] = [this.x(plan.t), y(plan.ms)];
      const blocked = isBlocked(plan);
      ctx.fillStyle = several ? plan.flight.color : blocked ? kColors.blocked : kColors.plan;
      ctx.beginPath();
      if (blocked) {
        for (const [dx, dy] of [[0, -4.5], [4.5, 0], [0, 4.5], [-4.5, 0]]) ctx.lineTo(px + dx, py + dy);
      } else {
        ctx.arc(px, py, 1.8, 0, 2 * Math.PI);
      }
      ctx.fill();
      if (!plan.missed) continue;
      ctx.beginPath();
      ctx.arc(px, py, 5.5, 0, 2 * Math.PI);
      ctx.strokeStyle = "#1c2530";
      ctx.lineWidth = 1.3;
      ctx.stroke();
    }
    this.points += plans.length;
  }

  drawLeast(ctx, least, y) {
    const [px, py] = [this.x(least.t), y(least.d)];
    const color = several ? least.flight.color : kColors.near;
    ctx.beginPath();
    ctx.arc(px, py, 3.5, 0, 2 * Math.PI);
    ctx.fillStyle = color;
    ctx.fill();
    const left = px > this.width - 130;
    ctx.textAlign = left ? "right" : "left";
    ctx.lineWidth = 4;
    ctx.strokeStyle = kHalo;
    const text = several ? `${least.flight.letter} ${least.d.toFixed(2)}` : `least ${least.d.toFixed(3)} m`;
    ctx.strokeText(text, px + (left ? -8 : 8), py - 8);
    ctx.fillText(text, px + (left ? -8 : 8), py - 8);
  }

  /** Flight's value in panel s at t: between two samples, or the newest plan's; null with none in the last second. */
  valueAt(s, flight, t) {
    const main = s.plans ? {t: flight.planTimes, y: flight.plans.map((plan) => plan.ms)}
                         : s.lines.find((l) => l.main && l.flight === flight);
    const i = main ? lastUpTo(main.t, t + 1e-6) : -1;
    if (i < 0 || t - main.t[i] > 1) return null;
    if (s.plans || i + 1 >= main.t.length || main.t[i + 1] - main.t[i] > 1) return main.y[i];
    return main.y[i] + clamp((t - main.t[i]) / (main.t[i + 1] - main.t[i]), 0, 1) * (main.y[i + 1] - main.y[i]);
  }

  drawCursor(t) {
    const {ctx} = this;
    const x = this.x(t);
    ctx.fillStyle = "#1c2530";
    ctx.fillRect(x - 0.5, kPlot.top, 1, this.bottom - kPlot.top);
    ctx.font = `600 ${kFont}`;
    ctx.textAlign = "right";
    ctx.textBaseline = "middle";
    ctx.lineWidth = 4;
    ctx.strokeStyle = kHalo;
    for (const s of this.series) {
      let right = this.width - kPlot.right - 8;
      for (const flight of [...flights].reverse()) {
        const value = this.valueAt(s, flight, t);
        if (value === null) continue;
        const text = (several ? `${flight.letter} ` : "") + `${value.toFixed(s.plans ? 1 : 2)} ${s.unit}`;
        ctx.fillStyle = several ? flight.color : "#1c2530";
        ctx.strokeText(text, right, s.top + 11);
        ctx.fillText(text, right, s.top + 11);
        right -= ctx.measureText(text).width + 14;
        ctx.beginPath();
        ctx.arc(x, clamp(s.y(value), s.top, s.top + kPlot.height), 3.5, 0, 2 * Math.PI);
        ctx.fill();
      }
    }
  }
}
