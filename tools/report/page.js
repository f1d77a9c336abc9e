// Brings scene, plots and controls together around one thing: the present time.
const kStep = 0.1;  // s, of an arrow key; with shift ten times that
const scene = new Scene($("scene"));
const plots = new Plots($("plot"));
let now = tFirst;
let playing = false;
let speed = 1;
let lastFrame = 0;
let pending = false;

function redraw() {
  pending = false;
  const moment = momentAt(now);
  const counts = scene.draw(moment);
  counts.plotted = plots.draw(now);
  showNow(moment);
  $("slider").value = now;
  $("clock").replaceChildren(`${now.toFixed(2)} s `, element("small", `of ${tLast.toFixed(2)} s`));
  markEvents();
  return counts;
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
  if (playing) requestAnimationFrame(playOn);
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

const eventText = ([t, name, detail]) => `${t.toFixed(2)} s  ${name}${detail ? "\n" + detail : ""}`;
let eventRows = [];
let currentRow = -2;

function showEvents() {
  $("event-count").textContent = flight.events.length ? `(${flight.events.length})` : "– not in this log";
  flight.events.sort((a, b) => a[0] - b[0]);
  eventRows = flight.events.map((event) => {
    const [t, name, detail] = event;
    const row = element("li", "");
    const text = element("span", name + (detail ? " " : ""));
    text.append(element("span", detail, "detail"));
    row.append(element("time", t.toFixed(2)), text);
    row.addEventListener("click", () => setTime(t));
    $("events").append(row);
    const tick = element("i", "", tone(name, detail));
    tick.style.left = `${100 * (t - tFirst) / (tLast - tFirst || 1)}%`;
    tick.addEventListener("click", () => setTime(t));
    tick.addEventListener("mousemove", (e) => showTip(eventText(event), e));
    tick.addEventListener("mouseleave", () => showTip(""));
    $("ticks").append(tick);
    return row;
  });
}

function markEvents() {
  const current = lastUpTo(flight.events.map((event) => event[0]), now + 1e-6);
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

function connectScene() {
  const canvas = $("scene");
  let from = null;
  canvas.addEventListener("pointerdown", (e) => {
    from = e;
    canvas.setPointerCapture(e.pointerId);
  });
  canvas.addEventListener("pointermove", (e) => {
    if (!from) return;
    const [dx, dy] = [e.clientX - from.clientX, e.clientY - from.clientY];
    if (e.shiftKey || from.button === 2) scene.camera.pan(dx, dy); else scene.camera.drag(dx, dy);
    from = {clientX: e.clientX, clientY: e.clientY, button: from.button};
    requestRedraw();
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { from = null; });
  canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    scene.camera.zoom(Math.exp(clamp(e.deltaY, -200, 200) * 0.0015));
    requestRedraw();
  }, {passive: false});
  const views = {free: scene.camera.aside(), top: [0, Math.PI / 2], south: [0, 0.02], west: [Math.PI / 2, 0.02]};
  for (const button of document.querySelectorAll("[data-view]")) {
    button.addEventListener("click", () => {
      scene.camera.look(...views[button.dataset.view]);
      requestRedraw();
    });
  }
  $("follow").addEventListener("click", () => {
    scene.follow = !scene.follow;
    $("follow").setAttribute("aria-pressed", String(scene.follow));
    if (!scene.follow) scene.camera.look(scene.camera.azimuth, scene.camera.elevation);
    requestRedraw();
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
    const close = flight.events.filter((event) => Math.abs(event[0] - t) <= reach).slice(0, 6);
    const known = plots.series.filter((s) => plots.valueAt(s, t) !== null);
    const text = known.map((s) => `${s.title} ${plots.valueAt(s, t).toFixed(2)} ${s.unit}`);
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

showAbout();
showSummary();
showLegend();
showEvents();
connectScene();
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
document.body.dataset.ready = JSON.stringify({...drawn, t: now, events: flight.events.length, ink: inkOf($("scene"))});
