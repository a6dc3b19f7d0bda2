'use strict';

const errors = [];
window.onerror = message => { errors.push(String(message)); };

const byId = id => document.getElementById(id);

/** A new element at the end of a parent; its text is never read as markup. */
function add(parent, tag, text = '', attributes = {}) {
  const element = document.createElement(tag);
  element.textContent = text;
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  parent.append(element);
  return element;
}

const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
const spoken = name => String(name ?? '').replaceAll('_', ' ');
const withUnit = (name, unit) => unit ? `${name}, ${unit}` : name;

/** A number as short as it can be read: 0.25, 1200, 3.1e−7. */
function short(value, digits = 4) {
  if (!Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  const plain = size === 0 || (size >= 1e-3 && size < 1e6);
  const text = plain ? String(Number(value.toPrecision(digits))) : value.toExponential(digits - 1).replace(/\.?0*e\+?/, 'e');
  return text.replaceAll('-', '−');
}

/** The largest of 1, 2, 5 × 10ᵏ that is not above this. */
function niceBelow(size) {
  const power = 10 ** Math.floor(Math.log10(size));
  return (size / power >= 5 ? 5 : size / power >= 2 ? 2 : 1) * power;
}

/** The multiples of a round step in an interval, about as many as asked for. */
function ticks(low, high, count) {
  const step = niceBelow((high - low) / Math.max(1, count) * 1.8);
  const first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
  return Array.from({ length: clamp(last - first + 1, 0, 50) || 0 }, (_, k) => (first + k) * step);
}

// ---- vectors and rotations

const scaled = (v, factor) => v.map(x => x * factor);
const sum = (a, b) => a.map((x, k) => x + b[k]);
const dot = (a, b) => a.reduce((total, x, k) => total + x * b[k], 0);
const mix = (a, b, t) => a.map((x, k) => x + (b[k] - x) * t);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = v => Math.hypot(...v);
const ORIGIN = [0, 0, 0];
const UNIT = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/** A vector turned by a unit quaternion (w, x, y, z). */
function turned([w, ...axis], v) {
  const twice = scaled(cross(axis, v), 2);
  return sum(sum(v, scaled(twice, w)), cross(axis, twice));
}

/** From one rotation to another at constant speed, the shorter way. */
function slerp(a, b, t) {
  const cosine = dot(a, b), angle = Math.acos(Math.min(1, Math.abs(cosine)));
  const [u, v] = angle < 1e-4 ? [1 - t, t] : [Math.sin((1 - t) * angle), Math.sin(t * angle)];
  const blend = sum(scaled(a, u), scaled(b, cosine < 0 ? -v : v));
  return scaled(blend, 1 / length(blend));
}

/** The angle between two rotations, rad. */
const angleBetween = (a, b) => 2 * Math.acos(Math.min(1, Math.abs(dot(a, b))));

// ---- the data

const page = JSON.parse(byId('data').textContent);
const space = page.space ?? {};

/** Something over the moments of a run: a path, or a value that is always the same. */
class Track {
  constructor(run, value, blend = mix) {
    const whole = v => Array.isArray(v) && v.every(Number.isFinite) ? v : null;
    this.run = run;
    this.constant = !Array.isArray(value[0]) && value[0] !== null;
    this.list = this.constant ? [value] : value.map(whole);
    this.blend = blend;
  }

  at(k) { return this.list[this.constant ? 0 : k] ?? null; }

  /** Its value at the moment, or null. */
  now() {
    if (this.constant) return this.list[0];
    const { index, fraction } = this.run.moment, before = this.at(index), after = this.at(index + 1);
    if (before === null || after === null) return fraction > 0.5 ? after : before;
    return this.blend(before, after, fraction);
  }
}

/** One of the runs that are shown together, each with moments of its own. */
class Run {
  constructor(data, order) {
    this.name = data.name ?? '';
    this.ghost = order > 0;
    this.times = (data.time ?? page.time ?? []).slice();
    if (!this.times.length) this.times.push(0);
    // a run may go back in time: what plays is the time since its start
    this.direction = this.times.at(-1) < this.times[0] ? -1 : 1;
    this.elapsed = this.times.map(t => (t - this.times[0]) * this.direction);
    this.moment = { index: 0, fraction: 0 };
    const track = (value, blend) => value ? new Track(this, value, blend) : null;
    this.bodies = (data.bodies ?? []).map((body, k) => {
      const rotation = track(body.rotation, slerp);
      return {
        ...body, name: spoken(body.name || `body ${k + 1}`), order: k, ghost: this.ghost, run: this, rotation,
        position: track(body.position) ?? track(ORIGIN), axes: body.axes ?? Boolean(rotation),
      };
    });
    this.arrows = (data.arrows ?? []).map((arrow, k) => (
      { ...arrow, name: spoken(arrow.name), run: this, colour: arrow.colour ?? ['c3', 'c4', 'c5', 'c6'][k % 4], vector: track(arrow.vector) }));
    this.links = data.links ?? [];
    this.plots = data.plots ?? [];
    Object.assign(this, this.turning(data));
  }

  get samples() { return this.times.length; }
  get duration() { return this.elapsed.at(-1); }

  /** The largest angle between two kept moments, rad, and the fastest turning, rad/s; what made the run may know better. */
  turning(data) {
    let turn = data.turn ?? 0, rate = data.rate ?? 0;
    for (const { rotation } of this.bodies) {
      for (let k = 1; rotation && !rotation.constant && k < this.samples; k++) {
        const [a, b] = [rotation.at(k - 1), rotation.at(k)];
        if (!a || !b) continue;
        turn = Math.max(turn, angleBetween(a, b));
        rate = Math.max(rate, angleBetween(a, b) / (this.elapsed[k] - this.elapsed[k - 1]) || 0);
      }
    }
    return { turn, rate };
  }

  /** Finds the moment: the sample at or before it, and the part of the way to the next. */
  locate(elapsed) {
    let low = 0, high = this.samples - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.elapsed[middle] <= elapsed) low = middle; else high = middle - 1;
    }
    const [before, after] = [this.elapsed[low], this.elapsed[low + 1]];
    this.moment = { index: low, fraction: clamp((elapsed - before) / (after - before) || 0, 0, 1) };
  }

  /** Where a body is and how it is turned, at a sample or at the moment. */
  pose(body, k = null) {
    const at = track => k === null ? track.now() : track.at(k);
    const place = at(body.position), attitude = body.rotation ? at(body.rotation) : [1, 0, 0, 0];
    return place && attitude && { place, attitude };
  }

  /** Where a point of a body is in space, at a sample or at the moment; without a body, a point of space. */
  point({ body, at = ORIGIN }, k = null) {
    const of = this.bodies[body];
    if (!of) return at;
    const pose = this.pose(of, k);
    return pose && sum(pose.place, turned(pose.attitude, at));
  }

  /** An arrow's vector in space at the moment. */
  vectorNow({ vector, frame, body }) {
    const now = vector.now(), pose = frame === 'body' && this.bodies[body] ? this.pose(this.bodies[body]) : null;
    return now && pose ? turned(pose.attitude, now) : now;
  }
}

const runs = (page.runs ?? []).map((data, order) => new Run(data, order));
if (!runs.length) runs.push(new Run({}, 0));
const first = runs[0];
const duration = Math.max(...runs.map(run => run.duration));
const earliest = Math.min(...runs.map(run => Math.min(run.times[0], run.times.at(-1)))), latest = earliest + duration;
const rate = Math.max(...runs.map(run => run.rate)), turn = Math.max(...runs.map(run => run.turn));

const clock = { elapsed: 0, playing: false, speed: 1 };
const currentTime = () => first.times[0] + first.direction * clock.elapsed;
const locate = () => { for (const run of runs) run.locate(clock.elapsed); };
