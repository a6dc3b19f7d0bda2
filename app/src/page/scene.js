// ---- what is drawn

/** About so many points of a path, for measuring. */
const thinned = (run, most = 400) => {
  const stride = Math.ceil(run.samples / most);
  return Array.from({ length: Math.ceil(run.samples / stride) }, (_, k) => k * stride);
};

const bodies = runs.flatMap(run => run.bodies);
const moving = body => !body.position.constant;
/** From a body's origin to the farthest point of its shape, and a little more. */
const sizeOf = ({ mesh }) => (mesh?.extent || 1) + length(mesh?.centre ?? ORIGIN);

/** How the motion looks in space. */
class SpaceScene {
  constructor() {
    for (const body of bodies) body.mesh = meshOf(body.shape);
    this.free = bodies.some(moving);
    this.measure();
    for (const body of bodies) this.equip(body);
    this.scaleArrows();
    this.flat = this.width.map(x => x < 1e-6 * this.reach);
    this.square = (this.free && !this.flat[1]) || Number.isFinite(space.ground) ? niceBelow(this.radius / 2) : null;
    this.look = this.chooseLook();
  }

  /** Finds the middle and the radius of all that moves, and the size at which bodies without a length are drawn. */
  measure() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    const include = point => point?.forEach((x, k) => {
      low[k] = Math.min(low[k], x);
      high[k] = Math.max(high[k], x);
    });
    const sized = body => body.mesh && !body.shape.relative, real = body => sized(body) ? body.mesh.extent : 0;
    const middle = body => sized(body) ? body.mesh.centre : ORIGIN;
    for (const run of runs) {
      for (const k of thinned(run)) {
        run.bodies.forEach((body, order) => include(run.point({ body: order, at: middle(body) }, k)));
        for (const { from, to } of run.links) [from, to].forEach(end => include(run.point(end ?? {}, k)));
      }
    }
    if (low[0] > high[0]) include(ORIGIN);
    this.width = sum(high, scaled(low, -1));
    const reach = length(this.width) / 2;
    // bodies that turn about a fixed point are drawn large; moving ones small, so that their way is seen
    const still = bodies.filter(body => !moving(body)).map(real);
    this.reach = reach;
    const largest = Math.max(...still, 0);
    this.wide = this.free || reach > 2 * (largest || Infinity); // what moves goes farther than bodies are large
    const offset = this.wide ? 0 : Math.max(...bodies.map(body => length(middle(body))), 0);
    this.size = this.free ? 0.16 * reach || Math.max(...bodies.map(real)) || 1 : largest + offset || 1;
    this.centre = this.wide ? scaled(sum(low, high), 0.5) : first.point({ body: 0 }, 0) ?? ORIGIN;
    const margin = Math.max(0.5 * this.size, ...bodies.filter(moving).map(real));
    this.radius = this.wide ? 1.02 * reach + Math.min(this.free ? margin : this.size, reach || Infinity) : 1.62 * this.size;
    this.low = low;
    // where even the largest could hardly be seen, all that move are drawn larger
    const seen = Math.max(...bodies.filter(body => moving(body) && sized(body)).map(sizeOf), 0);
    this.enlargement = seen > 0 && seen < 0.08 * this.radius ? 0.17 * this.radius / seen : 1;
  }

  /** Chooses how large a body is drawn, how long its axes are, and which of its points leaves a trace. */
  equip(body) {
    const { mesh, shape } = body, extent = sizeOf(body);
    body.magnification = shape?.relative ? this.size / extent : moving(body) ? this.enlargement : 1;
    // where bodies share a place, the later ones are slimmer
    const under = body.run.bodies.slice(0, body.order).some(other => other.mesh && !moving(other) && !moving(body) && shape?.relative);
    if (under) body.magnification *= 0.72;
    body.middle = scaled(mesh?.centre ?? ORIGIN, shape?.relative ? body.magnification : 1);
    body.extent = extent * body.magnification;
    body.reach = mesh ? 1.3 * body.extent : (this.free ? 0.5 : 1.3) * this.size;
    body.dots = !mesh && !body.axes;
    const tracer = moving(body) || !body.axes ? body.middle : [0, 0, body.reach];
    body.trailPoint = body.trail === false ? null : Array.isArray(body.trail) ? body.trail : body.rotation || moving(body) ? tracer : null;
    body.trailPath = body.trailPoint && Array.from({ length: body.run.samples }, (_, k) => body.run.point({ body: body.order, at: body.trailPoint }, k));
    body.paint = body.colour ?? ['solid', 'second'][body.order % 2];
  }

  /** Arrows of one unit are drawn on one scale, the longest a little longer than the bodies; those of a length to be true are left as they are. */
  scaleArrows() {
    const longest = new Map(), arrows = runs.flatMap(run => run.arrows);
    const most = ({ vector }) => vector.list.reduce((most, v) => Math.max(most, v ? length(v) : 0), 0);
    for (const arrow of arrows) {
      arrow.kind = arrow.unit || arrow.name;
      longest.set(arrow.kind, Math.max(longest.get(arrow.kind) ?? 0, most(arrow)));
    }
    const reach = this.wide ? 0.27 * this.radius : 1.2 * this.size;
    for (const arrow of arrows) arrow.scale = arrow.true_length ? 1 : reach / longest.get(arrow.kind) || 0;
  }

  /** A motion in a plane is seen best from before it. */
  chooseLook() {
    if (Array.isArray(space.look)) return space.look;
    if (this.wide && this.flat[1]) return [-1.42, 0.12];
    if (this.wide && this.flat[2]) return [-1.2, 0.95];
    return [-0.95, 0.32];
  }

  floor(view) {
    const { square, radius, centre } = this, z = space.ground ?? this.low[2];
    const [x, y] = centre.map(middle => Math.round(middle / square) * square);
    const edge = Math.ceil(0.55 * radius / square) * square, lines = [];
    for (let at = -edge; at <= edge * 1.01; at += square) {
      lines.push([x - edge, y + at, z], [x + edge, y + at, z], null);
      lines.push([x + at, y - edge, z], [x + at, y + edge, z], null);
    }
    view.add(view.stroke(lines.map(at => at && view.local(at)), 'muted', { alpha: 0.18 }));
    if (view.shadows) view.shade([x, y, z], 2 * edge);
  }

  traceColour(body) {
    return body.trail_colour ?? (body.rotation && !moving(body) && body.axes ? 'c2' : ['c2', 'c0', 'c1'][body.order % 3]);
  }

  buildBody(view, body) {
    const { run, mesh } = body, pose = () => run.pose(body), place = () => pose()?.place, alpha = body.ghost ? 0.3 : 1;
    if (body.dots) view.dot(place, body.paint === 'solid' ? 'ink' : body.paint, 5, body.ghost ? 0.5 : 1);
    if (mesh) {
      view.add(view.solid(mesh, body.paint, alpha), solid => {
        const now = pose();
        if (!now) return false;
        const [w, ...axis] = now.attitude;
        solid.position.copy(view.vector(sum(now.place, turned(now.attitude, body.middle))));
        solid.quaternion.set(...axis, w);
        solid.scale.setScalar(body.magnification / this.radius);
      });
    }
    if (body.axes) {
      UNIT.forEach((axis, k) => {
        const ends = () => { const now = pose(); return now && [now.place, sum(now.place, turned(now.attitude, scaled(axis, body.reach)))]; };
        const name = body.ghost || (this.free && !mesh) ? '' : k + 1 + '′'.repeat(body.order);
        view.arrow(ends, 'c' + k, body.ghost || body.order ? 1.6 : 2.4, name, body.ghost ? 0.45 : 1);
      });
    }
    if (moving(body) && mesh && this.square) {
      const ground = space.ground ?? this.low[2], high = () => { const at = place(); return at && this.low[2] < at[2] ? at : null; };
      const below = () => { const at = high(); return at && [at[0], at[1], ground]; };
      view.add(view.stroke(DASHES, 'muted', { alpha: 0.5 }), line => { const at = high(); return Boolean(at) && view.span(line, at, below(), 1); });
      view.dot(below, 'muted', 3, 0.6);
    }
  }

  /** Where an arrow starts and ends in space at the moment. */
  ends(arrow) {
    const from = arrow.run.point({ body: arrow.body, at: arrow.from ?? ORIGIN }), vector = arrow.run.vectorNow(arrow);
    return from && vector && [from, sum(from, scaled(vector, arrow.scale))];
  }

  build(view) {
    if (this.square) this.floor(view);
    else if (!this.wide) view.sphere(bodies.length === 1 && bodies[0].axes ? bodies[0].reach : this.size * 1.3, [2], this.centre);
    const frame = this.wide ? 0.25 * this.radius : 1.48 * this.size, names = space.axes ?? ['x', 'y', 'z'];
    UNIT.forEach((axis, k) => { if (names[k]) view.arrow(() => [ORIGIN, scaled(axis, frame)], 'muted', 1, names[k], 0.6); });
    for (const body of bodies) if (body.trailPath) view.trace(body.trailPath, body.run, this.traceColour(body), body.ghost ? 0.5 : 1);
    for (const run of runs) {
      for (const { from, to, spring } of run.links) {
        const end = point => () => run.point(point ?? {}), [a, b] = [end(from), end(to)], alpha = run.ghost ? 0.35 : 1;
        view.link(() => a() && b() && [a(), b()], spring, alpha);
        view.dot(a, 'ink', 3.5, alpha);
      }
    }
    for (const body of bodies) this.buildBody(view, body);
    for (const { arrows, ghost } of runs) {
      for (const arrow of arrows) {
        const ends = () => this.ends(arrow);
        if (arrow.scale > 0) view.arrow(ends, arrow.colour, 2, ghost ? '' : arrow.symbol ?? arrow.name, ghost ? 0.45 : 1);
      }
    }
  }
}

/** How vectors move as a rider on the body sees them: those that are given in a body's axes and move there. */
class BodyScene {
  constructor() {
    this.vectors = runs.flatMap(run => run.arrows).filter(({ frame, vector }) => frame === 'body' && !vector.constant);
    // vectors of different kinds are compared by direction: each in units of its greatest length
    for (const arrow of this.vectors) {
      const unit = arrow.vector.list.reduce((most, v) => Math.max(most, v ? length(v) : 0), 0) || 1;
      arrow.bodyPath = arrow.vector.list.map(v => v && scaled(v, 1 / unit));
      arrow.bodyUnit = unit;
    }
    Object.assign(this, { centre: ORIGIN, radius: 1.6, look: [-0.95, 0.38] });
  }

  build(view) {
    view.sphere(1, [0, 1, 2]);
    UNIT.forEach((axis, k) => view.arrow(() => [ORIGIN, scaled(axis, 1.2)], 'c' + k, 1.4, String(k + 1)));
    for (const { run, vector, bodyPath, bodyUnit, colour } of this.vectors) {
      const alpha = run.ghost ? 0.5 : 1;
      view.trace(bodyPath, run, colour, alpha);
      view.arrow(() => { const now = vector.now(); return now && [ORIGIN, scaled(now, 1 / bodyUnit)]; }, colour, 2, '', alpha);
    }
  }
}

const views = [];
let spaceScene = null;

/** Headed entries below the views, each a text and its colours. */
function explain(heading, entries) {
  if (!entries.length) return;
  add(byId('legend'), 'b', heading);
  const list = add(byId('legend'), 'ul');
  for (const [text, ...colours] of entries) {
    const item = add(list, 'li');
    for (const colour of colours) add(item, 'span', '', { class: 'swatch', style: `--colour: var(--${colour})` });
    add(item, 'span', text);
  }
}

/** What a body looks like, in words where its look is not the true one. */
function remarks(body) {
  const { name, order, axes, shape, magnification, trailPath } = body;
  const words = axes && order < 3 ? [[`axes of ${name}`, 'c0', 'c1', 'c2']] : [];
  if (trailPath && (!axes || moving(body))) words.push([`path of ${name}`, spaceScene.traceColour(body)]);
  if (shape?.note) words.push([`${name}: ${shape.note}`]);
  else if (shape?.relative) words.push([`${name}: shape by its inertia, not its size`]);
  else if (shape && magnification > 1) words.push([`${name} drawn ${short(magnification, 2)} times as large`]);
  return words;
}

function setUpViews() {
  spaceScene = new SpaceScene();
  const inSpace = bodies.length > 0, bodyScene = new BodyScene(), inBody = bodyScene.vectors.length > 0;
  byId('motion').hidden = !inSpace;
  byId('body').hidden = !inBody;
  if (inSpace) {
    views.push(new View(byId('space'), 'The motion in space', spaceScene));
    const arrows = first.arrows.map(({ name, symbol, unit, colour, scale }) => scale > 0 && [withUnit(symbol ? `${symbol} ${name}` : name, unit), colour]);
    const square = spaceScene.square && space.unit !== '' && [`squares of ${short(spaceScene.square)} ${space.unit ?? 'm'}`];
    const ghost = runs.length > 1 && [`solid: ${runs[0].name || 'first run'}; faint: ${runs.slice(1).map(run => run.name || 'second run').join(', ')}`];
    explain('In space', [...first.bodies.flatMap(remarks), ...arrows, square, ghost].filter(Boolean));
  }
  if (inBody) {
    views.push(new View(byId('body'), 'Vectors seen from the body', bodyScene));
    const seen = bodyScene.vectors.filter(({ run }) => !run.ghost);
    explain('Seen from the body', seen.map(({ name, symbol, colour }) => [symbol ? `${symbol} ${name}` : name, colour]));
  }
}
