// Brings scenes, plots and controls together around one thing: the present time.
const kStep = 0.1;  // s, of an arrow key; with shift ten times that
const scenes = flights.map((flight) => new Scene(addStage(flight), flight, sceneBounds()));
const plots = new Plots($("plot"));
let now = tFirst;
let playing = false;
let speed = 1;
let lastFrame = 0;
let pending = false;

/** A place for a flight's scene; of several with a heading. */
function addStage(flight) {
  const stage = element("div", "", "stage");
  if (several) {
    const heading = element("div", "", "heading");
    heading.append(chip(flight), element("b", flight.name), badge(flight), element("span", flight.file, "file"));
    stage.append(heading);
  }
  const canvas = document.createElement("canvas");
  canvas.className = "scene";
  canvas.tabIndex = 0;
  canvas.setAttribute("aria-label", `The flight ${flight.name} in three dimensions`);
  stage.append(canvas);
  $("stages").append(stage);
  return canvas;
}

function redraw() {
  pending = false;
  const moments = flights.map((flight) => flight.momentAt(now));
  const counts = {};
  scenes.forEach((scene, i) => {
    for (const [key, n] of Object.entries(scene.draw(moments[i]))) counts[key] = (counts[key] || 0) + n;
  });
  counts.plotted = plots.draw(now);
  showNow(moments);
  tellChecks(moments);
  $("slider").value = now;
  $("clock").replaceChildren(`${now.toFixed(2)} s `, element("small", `of ${tLast.toFixed(2)} s`));
  markEvents();
  return counts;
}

/** For checks without eyes: the time, and where on the page the vehicles are. */
function tellChecks(moments) {
  const vehicles = moments.map(({vehicle}, i) => {
    const s = vehicle && scenes[i].camera.project(vehicle.p);
    const box = scenes[i].canvas.getBoundingClientRect();
    return s ? [box.left + s[0], box.top + s[1]] : null;
  });
  document.body.dataset.shown = JSON.stringify({t: now, playing, vehicles});
}

function requestRedraw() {
  if (!pending) requestAnimationFrame(redraw);
  pending = true;
}

function setTime(t) {
  now = clamp(t, tFirst, tLast);
  requestRedraw();
}

function setPlaying(on) {
  playing = on && tLast > tFirst;
  if (playing && now >= tLast) now = tFirst;
  $("play").textContent = playing ? "❚❚" : "▶";
  lastFrame = 0;
  if (playing) requestAnimationFrame(playOn); else requestRedraw();
}

function playOn(stamp) {
  if (!playing) return;
  if (lastFrame) now = Math.min(tLast, now + speed * Math.min(0.2, (stamp - lastFrame) / 1000));
  lastFrame = stamp;
  redraw();
  if (now >= tLast) setPlaying(false); else requestAnimationFrame(playOn);
}

function setSpeed(x) {
  speed = x;
  for (const button of document.querySelectorAll("[data-speed]")) {
    button.setAttribute("aria-pressed", String(Number(button.dataset.speed) === x));
  }
}

function showTip(text, event) {
  const tip = $("tip");
  tip.hidden = !text;
  if (!text) return;
  tip.textContent = text;
  tip.style.left = `${clamp(event.clientX + 12, 4, window.innerWidth - tip.offsetWidth - 8)}px`;
  tip.style.top = `${clamp(event.clientY - tip.offsetHeight - 10, 4, window.innerHeight)}px`;
}

const eventText = ({flight, event: [t, name, detail]}) =>
  `${several ? flight.letter + "  " : ""}${t.toFixed(2)} s  ${name}${detail ? "\n" + detail : ""}`;
let eventRows = [];
let currentRow = -2;

function showEvents() {
  $("event-count").textContent = allEvents.length ? `(${allEvents.length})` : "– not in this log";
  eventRows = allEvents.map((item) => {
    const [t, name, detail, tone] = item.event;
    const row = element("li", "", tone);
    const text = element("span", "");
    if (several) text.append(chip(item.flight), " ");
    text.append(name + (detail ? " " : ""), element("span", detail, "detail"));
    row.append(element("time", t.toFixed(2)), text);
    row.addEventListener("click", () => setTime(t));
    $("events").append(row);
    const tick = element("i", "", tone);
    tick.style.left = `${100 * (t - tFirst) / (tLast - tFirst || 1)}%`;
    tick.addEventListener("click", () => setTime(t));
    tick.addEventListener("mousemove", (e) => showTip(eventText(item), e));
    tick.addEventListener("mouseleave", () => showTip(""));
    $("ticks").append(tick);
    return row;
  });
}

function markEvents() {
  const current = lastUpTo(allEvents.map(({event}) => event[0]), now + 1e-6);
  if (current === currentRow) return;
  currentRow = current;
  eventRows.forEach((row, i) => {
    row.classList.toggle("future", i > current);
    row.classList.toggle("current", i === current);
  });
  // Scrolls the list alone: scrollIntoView would move the page.
  const row = eventRows[Math.max(0, current)];
  const list = $("events");
  if (row) list.scrollTop = row.offsetTop - list.offsetTop - list.clientHeight / 2;
}

/** Turns all cameras as one: flights side by side are seen from the same place. */
function turn(action) {
  for (const scene of scenes) action(scene.camera);
  requestRedraw();
}

function connectScene({canvas}) {
  let from = null;
  canvas.addEventListener("pointerdown", (e) => {
    from = e;
    canvas.setPointerCapture(e.pointerId);
  });
  canvas.addEventListener("pointermove", (e) => {
    if (!from) return;
    const [dx, dy] = [e.clientX - from.clientX, e.clientY - from.clientY];
    const shift = e.shiftKey || from.button === 2;
    turn((camera) => (shift ? camera.pan(dx, dy) : camera.drag(dx, dy)));
    from = {clientX: e.clientX, clientY: e.clientY, button: from.button};
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { from = null; });
  canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    const factor = Math.exp(clamp(e.deltaY, -200, 200) * 0.0015);
    turn((camera) => camera.zoom(factor));
  }, {passive: false});
}

function connectViews() {
  const views = {free: scenes[0].camera.aside(), top: [0, Math.PI / 2], south: [0, 0.02], west: [Math.PI / 2, 0.02]};
  for (const button of document.querySelectorAll("[data-view]")) {
    button.addEventListener("click", () => turn((camera) => camera.look(...views[button.dataset.view])));
  }
  $("follow").addEventListener("click", () => {
    const on = !scenes[0].follow;
    for (const scene of scenes) scene.follow = on;
    $("follow").setAttribute("aria-pressed", String(on));
    turn((camera) => { if (!on) camera.look(camera.azimuth, camera.elevation); });
  });
}

function connectPlots() {
  const canvas = $("plot");
  let seeking = false;
  const timeOf = (e) => plots.time(e.clientX - canvas.getBoundingClientRect().left);
  canvas.addEventListener("pointerdown", (e) => {
    seeking = true;
    canvas.setPointerCapture(e.pointerId);
    setTime(timeOf(e));
  });
  canvas.addEventListener("pointermove", (e) => {
    const t = timeOf(e);
    if (seeking) setTime(t);
    const reach = plots.time(plots.x(tFirst) + 4) - tFirst;  // s, of four pixels
    const close = allEvents.filter(({event}) => Math.abs(event[0] - t) <= reach).slice(0, 6);
    const text = plots.series.flatMap((s) => flights.flatMap((flight) => {
      const value = plots.valueAt(s, flight, t);
      return value === null ? [] : [`${several ? flight.letter + "  " : ""}${s.title} ${value.toFixed(2)} ${s.unit}`];
    }));
    showTip([`${t.toFixed(2)} s`, ...text, ...close.map(eventText)].join("\n"), e);
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { seeking = false; });
  canvas.addEventListener("pointerleave", () => showTip(""));
}

function connectKeys() {
  window.addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const step = kStep * (e.shiftKey ? 10 : 1);
    const action = {
      " ": () => setPlaying(!playing), ArrowLeft: () => setTime(now - step), ArrowRight: () => setTime(now + step),
      Home: () => setTime(tFirst), End: () => setTime(tLast)
    }[e.key];
    if (!action) return;
    e.preventDefault();
    action();
  });
  // A focused button would take the space bar as a click as well.
  document.addEventListener("click", (e) => { if (e.target.tagName === "BUTTON") e.target.blur(); });
}

function timeFromAddress() {
  const found = /[#&]t=(-?[0-9.]+)/.exec(window.location.hash);
  if (found && isNumber(Number(found[1]))) setTime(Number(found[1]));
}

/** Share of the scene's pixels that something was drawn on: for checks without eyes. */
function inkOf(canvas) {
  if (!canvas.width || !canvas.height) return 0;
  const {data} = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let inked = 0;
  for (let i = 3; i < data.length; i += 4) if (data[i]) ++inked;
  return inked / (canvas.width * canvas.height);
}

document.body.classList.toggle("several", several);
showAbout();
showSummary();
showLegend();
showEvents();
scenes.forEach(connectScene);
connectViews();
connectPlots();
connectKeys();
setSpeed(1);
$("slider").min = tFirst;
$("slider").max = tLast;
$("slider").addEventListener("input", () => setTime(Number($("slider").value)));
$("play").addEventListener("click", () => setPlaying(!playing));
for (const button of document.querySelectorAll("[data-speed]")) {
  button.addEventListener("click", () => setSpeed(Number(button.dataset.speed)));
}
window.addEventListener("hashchange", timeFromAddress);
window.addEventListener("resize", requestRedraw);
timeFromAddress();
const drawn = redraw();
const ink = Math.min(...scenes.map(({canvas}) => inkOf(canvas)));
document.body.dataset.ready =
  JSON.stringify({...drawn, t: now, flights: flights.length, events: allEvents.length, ink});
