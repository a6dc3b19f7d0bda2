// ---- playing

let awaited = false, lastFrame = null;

function redraw() {
  if (!awaited) requestAnimationFrame(frame);
  awaited = true;
}

const decimals = duration > 0 ? clamp(Math.ceil(-Math.log10(duration / first.samples)), 0, 6) : 0;
const timeText = time => time.toFixed(decimals).replace('-', '−') + ' s';

function frame(now) {
  awaited = false;
  if (clock.playing) {
    // after a time in the background it goes on from where it was
    clock.elapsed += Math.min((now - (lastFrame ?? now)) / 1000, 0.1) * clock.speed;
    lastFrame = now;
    if (clock.elapsed >= duration) {
      clock.elapsed = byId('loop').checked ? clock.elapsed % duration : duration;
      if (!byId('loop').checked) pause();
    }
  }
  show();
  if (clock.playing) redraw();
}

/** Draws the moment. */
function show() {
  locate();
  for (const drawn of [...views, ...plots]) if (drawn.width) drawn.draw();
  byId('slider').value = clock.elapsed;
  byId('slider').setAttribute('aria-valuetext', timeText(currentTime()));
  byId('clock').textContent = `${timeText(currentTime())} of ${timeText(first.times[0] + first.direction * duration)}`;
}

function seek(time) {
  clock.elapsed = clamp((time - first.times[0]) * first.direction || 0, 0, duration);
  locate();
  redraw();
}

/** On by a part of the run. */
const skip = part => seek(currentTime() + first.direction * part * duration);

/** To the next sample, or one before. */
function step(count) {
  pause();
  const start = first.moment.index + (count < 0 && first.moment.fraction > 0 ? 1 : 0);
  seek(first.times[clamp(start + count, 0, first.samples - 1)]);
}

function play() {
  if (clock.elapsed >= duration) clock.elapsed = 0;
  lastFrame = null;
  setPlaying(duration > 0);
}

function pause() { setPlaying(false); }

const toggle = () => { if (clock.playing) pause(); else play(); };

function setPlaying(playing) {
  clock.playing = playing;
  byId('play').setAttribute('aria-label', playing ? 'Pause' : 'Play');
  redraw();
}

// ---- speed, and what is too fast to be seen

/** The turning between two kept moments, or between two frames, beyond which the eye or the page would take it for another, rad. */
const SEEN = 1;

function setSpeed(option) {
  const speed = byId('speed');
  speed.selectedIndex = clamp(option, 0, speed.options.length - 1);
  clock.speed = Number(speed.value);
  notice();
}

/** An angle in rad, and in turns where these are more than one. */
const angleText = angle => `${short(angle, 2)} rad` + (angle > 2 * Math.PI ? ` (${short(angle / 2 / Math.PI, 2)} turns)` : '');

/** Says so where the turning that is shown may not be the true one. */
function notice() {
  const perFrame = rate * clock.speed / 60;
  const words = turn > SEEN ? `This page keeps ${first.samples} moments, and between two of them a body turns by up to ${angleText(turn)}: faster than can be `
    + 'shown. The turning on the screen is not the true one; a shorter duration, or shorter steps, show it. The angles plotted are true.'
    : perFrame > 1.5 * SEEN ? `At this speed a body turns by up to ${angleText(perFrame)} from one frame to the next: play it slower to see how it turns.` : '';
  Object.assign(byId('notice'), { textContent: words, hidden: !words });
}

function setUpSpeed() {
  // what makes a run of days or of milliseconds last some seconds, and lets the eye follow what turns fast
  const natural = Math.min(clamp(1, duration / 60, duration / 4) || 1, turn > SEEN ? Infinity : 60 * SEEN / rate || Infinity);
  const [least, most] = [Math.min(0.1, natural), Math.max(100, natural)].map(speed => Math.floor(Math.log10(speed) + 1e-9));
  const speed = byId('speed');
  for (let power = least; power <= most; power++) {
    for (const digit of [1, 2, 5]) add(speed, 'option', `${short(digit * 10 ** power)}× real time`, { value: `${digit}e${power}` });
  }
  setSpeed([...speed.options].map(option => Number(option.value) <= natural * 1.001).lastIndexOf(true));
  speed.addEventListener('change', () => setSpeed(speed.selectedIndex));
}

// ---- pictures and keys

/** The motion in space as a PNG. */
function png() {
  show();
  return views[0]?.canvas.toDataURL('image/png') ?? '';
}

function savePicture() {
  const link = document.createElement('a');
  link.href = png();
  link.download = `${page.title || 'coadjoint'}-${timeText(currentTime()).replace(' ', '')}.png`;
  if (views.length) link.click();
}

const [TURN, CLOSER] = [0.12, 1.15];
const turnView = (...by) => views[0]?.turn(...by);
const KEYS = {
  ' ': toggle, k: toggle, ArrowLeft: () => skip(-0.01), ArrowRight: () => skip(0.01), ',': () => step(-1), '.': () => step(1),
  Home: () => seek(first.times[0]), End: () => { pause(); seek(first.times[0] + first.direction * duration); },
  '+': () => setSpeed(byId('speed').selectedIndex + 1), '=': () => setSpeed(byId('speed').selectedIndex + 1),
  '-': () => setSpeed(byId('speed').selectedIndex - 1), '−': () => setSpeed(byId('speed').selectedIndex - 1),
  a: () => turnView(-TURN, 0), d: () => turnView(TURN, 0), w: () => turnView(0, TURN), s: () => turnView(0, -TURN),
  e: () => turnView(0, 0, CLOSER), q: () => turnView(0, 0, 1 / CLOSER), 0: () => views.forEach(view => view.reset()),
  p: savePicture, '?': () => byId('help').showModal(),
};
const SHIFTED = { ArrowLeft: KEYS.a, ArrowRight: KEYS.d, ArrowUp: KEYS.w, ArrowDown: KEYS.s };

function setUpPlayback() {
  const slider = byId('slider');
  slider.max = duration || 1;
  slider.disabled = byId('play').disabled = !(duration > 0);
  slider.addEventListener('input', () => seek(first.times[0] + first.direction * slider.valueAsNumber));
  for (const [id, act] of [['play', toggle], ['save', savePicture], ['ask', KEYS['?']]]) byId(id).addEventListener('click', act);
  byId('save').hidden = !views.length;
  setUpSpeed();
  document.addEventListener('keydown', event => {
    const { key, target, shiftKey } = event;
    if (event.ctrlKey || event.altKey || event.metaKey || byId('help').open || target === byId('speed')) return;
    if (key === ' ' && target.matches?.('button, summary, [type=checkbox]')) return; // those have their own use of it
    const action = (shiftKey && SHIFTED[key]) || KEYS[key] || KEYS[key.toLowerCase()];
    action?.();
    if (action) event.preventDefault();
  });
}

// ---- all together

/** What is shown at the moment, in numbers: for tests, and for the curious. */
function sceneNow() {
  locate();
  const view = views[0];
  for (const drawn of views) if (drawn.width) drawn.draw();
  const list = point => point?.toArray(), onScreen = point => point && view?.width ? view.project(point) : null;
  return {
    time: currentTime(), playing: clock.playing, speed: clock.speed, notice: byId('notice').hidden ? '' : byId('notice').textContent,
    camera: view && { yaw: view.yaw, pitch: view.pitch, zoom: view.zoom }, names: view?.names, webgl: view?.webgl, shadows: view?.shadows,
    runs: runs.map(run => ({
      name: run.name,
      bodies: run.bodies.map(body => {
        const pose = run.pose(body), centre = run.point({ body: body.order, at: body.middle });
        return {
          name: body.name, shape: body.shape?.kind ?? null, magnification: body.magnification, centre: list(centre), screen: onScreen(centre),
          origin: list(pose?.place), axes: pose && UNIT.map(axis => list(axis.clone().applyQuaternion(pose.attitude))),
        };
      }),
      arrows: run.arrows.map(arrow => {
        const [from, to] = spaceScene.ends(arrow) ?? [];
        return { name: arrow.name, unit: arrow.unit ?? '', vector: list(run.vectorAt(arrow)), from: list(from), to: list(to), screen: onScreen(to) };
      }),
      links: run.links.map(({ from, to }) => [list(run.point(from ?? {})), list(run.point(to ?? {}))]),
    })),
  };
}

/** The colour of the motion's picture at a place, in pixels of the page, as red, green, blue. */
function pixel([x, y]) {
  const { canvas, ratio } = views[0], copy = document.createElement('canvas').getContext('2d');
  copy.drawImage(canvas, -Math.round(x * ratio), -Math.round(y * ratio));
  return [...copy.getImageData(0, 0, 1, 1).data].slice(0, 3);
}

function setUpDetails() {
  const text = value => Array.isArray(value) ? value.map(text).join(', ') : typeof value === 'number' ? short(value, 6) : String(value ?? '');
  for (const { name, value, unit } of page.details ?? []) {
    const entry = add(document.querySelector('#details dl'), 'div');
    add(entry, 'dt', spoken(name));
    add(entry, 'dd', [text(value), unit].filter(Boolean).join(' '));
  }
  byId('details').hidden = !page.details?.length;
}

document.title = [page.title, 'coadjoint'].filter(Boolean).join(' – ');
for (const id of ['title', 'about', 'subtitle']) byId(id).textContent = page[id] ?? '';
byId('title').textContent = spoken(page.title ?? 'Motion');
readTheme();
setUpDetails();
locate();
setUpViews();
setUpPlots();
setUpPlayback();
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
  readTheme();
  for (const plot of plots) plot.stale = true;
  redraw();
});
window.coadjoint = { scene: sceneNow, pixel, png, seek, play, pause, time: currentTime, pictures: () => View.pictures, errors, theme };
// `#t=12.5` shows that moment
const asked = Number(/^#t=(.+)$/.exec(location.hash)?.[1] ?? NaN);
if (Number.isFinite(asked)) seek(asked);
else if (!matchMedia('(prefers-reduced-motion: reduce)').matches) play();
