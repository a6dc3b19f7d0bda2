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

// ---- points, vectors and rotations, as three.js has them

const vector = components => new THREE.Vector3(...components);
const rotation = ([w, x, y, z]) => new THREE.Quaternion(x, y, z, w);
const scaled = (v, factor) => v.clone().multiplyScalar(factor);
const sum = (a, b) => a.clone().add(b);
const ORIGIN = vector([0, 0, 0]);
const UNIT = [vector([1, 0, 0]), vector([0, 1, 0]), vector([0, 0, 1])];

// ---- the data

const page = JSON.parse(byId('data').textContent);
const space = page.space ?? {};

/** Something over the moments of a run: a path, or a value that is always the same. */
class Track {
  constructor(run, value, read = vector) {
    this.run = run;
    this.constant = !Array.isArray(value[0]) && value[0] !== null;
    this.list = (this.constant ? [value] : value).map(v => Array.isArray(v) && v.every(Number.isFinite) ? read(v) : null);
  }

  at(k) { return this.list[this.constant ? 0 : k] ?? null; }

  /** Its value at the moment, or null. */
  now() {
    if (this.constant) return this.list[0];
    const { index, fraction } = this.run.moment, before = this.at(index), after = this.at(index + 1);
    if (before === null || after === null) return fraction > 0.5 ? after : before;
    return before.clone()[before.slerp ? 'slerp' : 'lerp'](after, fraction);
  }
}

/** One of the runs that are shown together, each with moments of its own. */
class Run {
  constructor(data, order) {
    Object.assign(this, { name: data.name ?? '', ghost: order > 0, links: data.links ?? [], plots: data.plots ?? [] });
    this.times = (data.time ?? page.time ?? []).slice();
    if (!this.times.length) this.times.push(0);
    // a run may go back in time: what plays is the time since its start
    this.direction = this.times.at(-1) < this.times[0] ? -1 : 1;
    this.elapsed = this.times.map(t => (t - this.times[0]) * this.direction);
    this.moment = { index: 0, fraction: 0 };
    const track = (value, read) => value ? new Track(this, value, read) : null;
    this.bodies = (data.bodies ?? []).map((body, k) => {
      const turning = track(body.rotation, rotation);
      return {
        ...body, name: spoken(body.name || `body ${k + 1}`), order: k, ghost: this.ghost, run: this, rotation: turning,
        position: track(body.position ?? [0, 0, 0]), axes: body.axes ?? Boolean(turning),
      };
    });
    this.arrows = (data.arrows ?? []).map((arrow, k) => (
      { ...arrow, name: spoken(arrow.name), run: this, colour: arrow.colour ?? ['c3', 'c4', 'c5', 'c6'][k % 4], vector: track(arrow.vector) }));
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
        turn = Math.max(turn, a.angleTo(b));
        rate = Math.max(rate, a.angleTo(b) / (this.elapsed[k] - this.elapsed[k - 1]) || 0);
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
    const place = at(body.position), attitude = body.rotation ? at(body.rotation) : new THREE.Quaternion();
    return place && attitude && { place, attitude };
  }

  /** Where a point of a body is in space, at a sample or at the moment; without a body, a point of space. */
  point({ body, at = [0, 0, 0] }, k = null) {
    const point = vector(at), of = this.bodies[body], pose = of && this.pose(of, k);
    return pose ? point.applyQuaternion(pose.attitude).add(pose.place) : of ? null : point;
  }

  /** An arrow's vector in space, at a sample or at the moment. */
  vectorAt({ vector, frame, body }, k = null) {
    const now = k === null ? vector.now() : vector.at(k), pose = frame === 'body' && this.bodies[body] ? this.pose(this.bodies[body], k) : null;
    return now && pose ? now.clone().applyQuaternion(pose.attitude) : now;
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
