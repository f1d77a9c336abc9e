// Four plots over one time axis, with a cursor. One canvas.
const kPlot = {left: 58, right: 14, top: 4, height: 70, gap: 10, axis: 22};

/** Round numbers that divide [low, high] in about `count` parts. */
function axisTicks(low, high, count) {
  const raw = (high - low) / count || 1;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((s) => s * power).find((s) => s >= raw - 1e-12);
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) ticks.push(i * step);
  return {ticks, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9))};
}

const heights = (series) => series.t.map((_, i) => series.p[3 * i + 2]);

/** What the four plots show: {title, unit, lines: [{t, y, color}], ...}. No data: an empty line list. */
function plotSeries() {
  const {clearance, vehicle, setpoints, plans} = flight;
  const source = !clearance ? "" : clearance.from === "true" ? "true" : "from tracks";
  const to = flight.vehicle.radius === null ? "vehicle's centre to" : "to";
  const who = (vehicle.from === "truth" ? "true" : "estimate") + (setpoints.t.length ? "; grey: setpoint" : "");
  const motion = (y, set) => {
    const lines = [];
    if (setpoints.t.length) lines.push({t: setpoints.t, y: set, color: "#b9c2cc", width: 1.2});
    if (vehicle.t.length) lines.push({t: vehicle.t, y, color: kColors.vehicle, width: 1.6, name: true});
    return lines;
  };
  const gap = clearance ? [{t: clearance.t, y: clearance.d, color: "#b06a10", width: 1.6, name: true}] : [];
  return [
    {title: "clearance", note: `${to} the nearest obstacle${source ? ", " + source : ""}`, unit: "m", lines: gap,
     min: clearance && clearance.min, zero: true, ceiling: 6},
    {title: "speed", note: who, unit: "m/s", lines: motion(vehicle.speed, setpoints.speed), floor: 0},
    {title: "height", note: who, unit: "m", lines: motion(heights(vehicle), heights(setpoints)), floor: 0},
    {title: "plan time", note: "red: blocked, ring: deadline missed", unit: "ms", lines: [], plans, floor: 0}
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
    return [low - (low < 0 ? 0.05 * (high - low) : 0), high + 0.32 * (high - low)];  // the title's room
  }

  get span() { return this.width - kPlot.left - kPlot.right; }
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
    const bottom = kPlot.top + 4 * (kPlot.height + kPlot.gap) - kPlot.gap;
    const axis = axisTicks(tFirst, tLast, Math.max(3, this.width / 110));
    ctx.font = "11px system-ui, sans-serif";
    ctx.textBaseline = "middle";
    for (const s of axis.ticks) {
      ctx.fillStyle = "#eef1f4";
      ctx.fillRect(this.x(s) - 0.5, kPlot.top, 1, bottom - kPlot.top);
      ctx.fillStyle = "#7b8794";
      ctx.textAlign = "center";
      ctx.fillText(`${s.toFixed(axis.digits)} s`, this.x(s), bottom + 12);
    }
    for (const [at, name, detail] of flight.events) {
      const color = {good: "#14915a66", warn: "#e09a1a77", bad: "#c8321f66"}[tone(name, detail)];
      ctx.fillStyle = color || "#9aa6b255";
      ctx.fillRect(this.x(at) - 0.5, kPlot.top, 1, bottom - kPlot.top);
    }
    this.series.forEach((s, i) => this.drawPanel(ctx, s, kPlot.top + i * (kPlot.height + kPlot.gap)));
  }

  drawPanel(ctx, s, top) {
    s.top = top;
    const y = s.y = (v) => top + kPlot.height * (1 - (v - s.range[0]) / (s.range[1] - s.range[0]));
    ctx.strokeStyle = "#dfe4ea";
    ctx.lineWidth = 1;
    ctx.strokeRect(kPlot.left + 0.5, top + 0.5, this.span - 1, kPlot.height - 1);
    const {ticks, digits} = axisTicks(s.range[0], s.range[1], 3);
    ctx.textAlign = "right";
    for (const v of ticks) {
      ctx.fillStyle = s.zero && Math.abs(v) < 1e-9 ? "#c8321f99" : "#eef1f4";
      ctx.fillRect(kPlot.left + 1, Math.round(y(v)) - 0.5, this.span - 2, 1);
      ctx.fillStyle = "#7b8794";
      if (y(v) > top + 4) ctx.fillText(v.toFixed(digits), kPlot.left - 6, y(v));
    }
    ctx.save();
    ctx.beginPath();
    ctx.rect(kPlot.left, top, this.span, kPlot.height);
    ctx.clip();
    for (const l of s.lines) this.drawLine(ctx, l, y);
    if (s.plans) this.drawPlans(ctx, s.plans, y);
    if (s.min) this.drawLeast(ctx, s.min, y);
    this.drawTitle(ctx, s, top);
    ctx.restore();
  }

  drawTitle(ctx, s, top) {
    const empty = s.plans ? s.plans.length === 0 : s.lines.length === 0;
    ctx.textAlign = "left";
    ctx.lineWidth = 4;
    ctx.strokeStyle = "#ffffffe0";
    let x = kPlot.left + 8;
    const note = `${s.unit}, ${empty ? "not in this log" : s.note}`;
    for (const [text, font, color] of [[s.title, "600 12px system-ui, sans-serif", "#1c2530"],
                                       [note, "11px system-ui, sans-serif", "#7b8794"]]) {
      ctx.font = font;
      ctx.strokeText(text, x, top + 11);
      ctx.fillStyle = color;
      ctx.fillText(text, x, top + 11);
      x += ctx.measureText(text).width + 6;
    }
    ctx.font = "11px system-ui, sans-serif";
  }

  drawLine(ctx, l, y) {
    ctx.beginPath();
    // A gap in the log is a gap in the line.
    const gap = Math.max(1, 5 * flight.log.interval);
    for (let i = 0; i < l.t.length; ++i) {
      const [px, py] = [this.x(l.t[i]), y(l.y[i])];
      if (i === 0 || l.t[i] - l.t[i - 1] > gap) ctx.moveTo(px, py); else ctx.lineTo(px, py);
    }
    ctx.strokeStyle = l.color;
    ctx.lineWidth = l.width;
    ctx.lineJoin = "round";
    ctx.stroke();
    this.points += l.t.length;
  }

  drawPlans(ctx, plans, y) {
    for (const plan of plans) {
      const [px, py] = [this.x(plan.t), y(plan.ms)];
      ctx.fillStyle = isBlocked(plan) ? kColors.blocked : kColors.plan;
      if (isBlocked(plan)) ctx.fillRect(px - 1, py, 2, y(0) - py);
      ctx.beginPath();
      ctx.arc(px, py, isBlocked(plan) ? 3 : 1.8, 0, 2 * Math.PI);
      ctx.fill();
      if (!plan.missed) continue;
      ctx.beginPath();
      ctx.arc(px, py, 5, 0, 2 * Math.PI);
      ctx.strokeStyle = "#b87400";
      ctx.lineWidth = 1.5;
      ctx.stroke();
    }
    this.points += plans.length;
  }

  drawLeast(ctx, least, y) {
    const [px, py] = [this.x(least.t), y(least.d)];
    ctx.beginPath();
    ctx.arc(px, py, 3, 0, 2 * Math.PI);
    ctx.fillStyle = kColors.near;
    ctx.fill();
    const left = px > this.width - 120;
    ctx.textAlign = left ? "right" : "left";
    ctx.lineWidth = 4;
    ctx.strokeStyle = "#ffffffe0";
    const text = `least ${least.d.toFixed(3)} m`;
    ctx.strokeText(text, px + (left ? -7 : 7), py - 8);
    ctx.fillText(text, px + (left ? -7 : 7), py - 8);
  }

  /** The value of panel s at t: between two samples, or the newest plan's; null with none in the last second. */
  valueAt(s, t) {
    const main = s.plans ? {t: planTimes, y: s.plans.map((plan) => plan.ms)} : s.lines.find((l) => l.name);
    const i = main ? lastUpTo(main.t, t + 1e-6) : -1;
    if (i < 0 || t - main.t[i] > 1) return null;
    if (s.plans || i + 1 >= main.t.length || main.t[i + 1] - main.t[i] > 1) return main.y[i];
    return main.y[i] + clamp((t - main.t[i]) / (main.t[i + 1] - main.t[i]), 0, 1) * (main.y[i + 1] - main.y[i]);
  }

  drawCursor(t) {
    const {ctx} = this;
    const x = this.x(t);
    ctx.fillStyle = "#1c2530";
    ctx.fillRect(x - 0.5, kPlot.top, 1, 4 * (kPlot.height + kPlot.gap) - kPlot.gap);
    ctx.font = "600 12px system-ui, sans-serif";
    ctx.textAlign = "right";
    ctx.textBaseline = "middle";
    for (const s of this.series) {
      const value = this.valueAt(s, t);
      if (value === null) continue;
      const text = `${value.toFixed(s.plans ? 1 : 2)} ${s.unit}`;
      ctx.lineWidth = 4;
      ctx.strokeStyle = "#ffffffe0";
      ctx.strokeText(text, this.width - kPlot.right - 8, s.top + 11);
      ctx.fillText(text, this.width - kPlot.right - 8, s.top + 11);
      ctx.beginPath();
      ctx.arc(x, clamp(s.y(value), s.top, s.top + kPlot.height), 3, 0, 2 * Math.PI);
      ctx.fill();
    }
  }
}
