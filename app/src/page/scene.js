// ---- what is drawn

const bodies = runs.flatMap(run => run.bodies);
const moving = body => !body.position.constant;
/** From a body's origin to the farthest point of its shape, and a little more. */
const sizeOf = ({ mesh }) => (mesh?.extent || 1) + (mesh?.centre ?? ORIGIN).length();

/** The greatest length of a vector that moves. */
const greatest = ({ vector }) => vector.list.reduce((most, v) => Math.max(most, v?.length() ?? 0), 0);

/** How the motion looks in space. */
class SpaceScene {
  constructor() {
    for (const body of bodies) body.mesh = meshOf(body.shape);
    this.free = bodies.some(moving);
    this.measure();
    for (const body of bodies) this.equip(body);
    this.scaleArrows();
    this.axes = UNIT.map((axis, k) => (space.axes ?? ['x', 'y', 'z'])[k] ? scaled(axis, this.wide ? 0.25 * this.radius : 1.48 * this.size) : null);
    this.flat = this.width.toArray().map(x => x < 1e-6 * this.reach);
    this.square = (this.free && !this.flat[1]) || Number.isFinite(space.ground) ? niceBelow(this.radius / 2) : null;
    // a motion in a plane is seen best from before it
    this.look = space.look ?? (this.wide && this.flat[1] ? [-1.42, 0.12] : this.wide && this.flat[2] ? [-1.2, 0.95] : [-0.95, 0.32]);
  }

  /** Finds the middle and the radius of all that moves, and the size at which bodies without a length are drawn. */
  measure() {
    const box = new THREE.Box3(), include = point => { if (point) box.expandByPoint(point); };
    const sized = body => body.mesh && !body.shape.relative, real = body => sized(body) ? body.mesh.extent : 0;
    const middle = body => sized(body) ? body.mesh.centre : ORIGIN;
    for (const run of runs) {
      for (let k = 0; k < run.samples; k += Math.ceil(run.samples / 400)) {
        run.bodies.forEach((body, order) => include(run.point({ body: order, at: middle(body) }, k)));
        for (const { from, to } of run.links) [from, to].forEach(end => include(run.point(end ?? {}, k)));
      }
    }
    if (box.isEmpty()) include(ORIGIN);
    this.width = box.getSize(new THREE.Vector3());
    const reach = this.reach = this.width.length() / 2;
    // bodies that turn about a fixed point are drawn large; moving ones small, so that their way is seen
    const largest = Math.max(...bodies.filter(body => !moving(body)).map(real), 0);
    this.wide = this.free || reach > 2 * (largest || Infinity); // what moves goes farther than bodies are large
    const offset = this.wide ? 0 : Math.max(...bodies.map(body => middle(body).length()), 0);
    this.size = this.free ? 0.16 * reach || Math.max(...bodies.map(real)) || 1 : largest + offset || 1;
    this.centre = this.wide ? box.getCenter(new THREE.Vector3()) : first.point({ body: 0 }, 0) ?? ORIGIN;
    const margin = Math.max(0.5 * this.size, ...bodies.filter(moving).map(real));
    this.radius = this.wide ? 1.02 * reach + Math.min(this.free ? margin : this.size, reach || Infinity) : 1.62 * this.size;
    // the eye, six radii away, is outside of all solids, also of those larger than the motion
    const far = body => Math.max(...[0, 1].map(end => (body.run.point({ body: body.order, at: middle(body) }, end * (body.run.samples - 1)) ?? this.centre).distanceTo(this.centre)));
    this.radius = Math.max(this.radius, ...bodies.filter(sized).map(body => (far(body) + real(body)) / 2));
    [this.low, this.ground] = [box.min.z, space.ground ?? box.min.z];
    // where even the largest could hardly be seen, all that move are drawn larger
    const seen = Math.max(...bodies.filter(body => moving(body) && sized(body)).map(sizeOf), 0);
    this.enlargement = seen > 0 && seen < 0.08 * this.radius ? 0.17 * this.radius / seen : 1;
  }

  /** Chooses how large a body is drawn, how long its axes are, and which of its points leaves a trace. */
  equip(body) {
    const { mesh, shape } = body, extent = sizeOf(body);
    // where bodies share a place, the later ones are slimmer
    const under = body.run.bodies.slice(0, body.order).some(other => other.mesh && !moving(other) && !moving(body));
    body.magnification = shape?.relative ? this.size / extent * (under ? 0.72 : 1) : moving(body) ? this.enlargement : 1;
    body.middle = scaled(mesh?.centre ?? ORIGIN, shape?.relative ? body.magnification : 1);
    body.extent = extent * body.magnification;
    body.reach = mesh ? 1.3 * body.extent : (this.free ? 0.5 : 1.3) * this.size;
    body.dots = !mesh && !body.axes;
    const tracer = moving(body) || !body.axes ? body.middle : vector([0, 0, body.reach]);
    body.trailPoint = body.trail === false ? null : Array.isArray(body.trail) ? body.trail : body.rotation || moving(body) ? tracer : null;
    body.trailPath = body.trailPoint && Array.from({ length: body.run.samples }, (_, k) => body.run.point({ body: body.order, at: body.trailPoint }, k));
    body.paint = body.colour ?? ['solid', 'second'][body.order % 2];
  }

  /** Arrows of one unit are drawn on one scale, the longest a little longer than the bodies; those of a length to be true are left as they are. */
  scaleArrows() {
    const arrows = runs.flatMap(run => run.arrows), kind = ({ unit, name }) => unit || name, reach = this.wide ? 0.27 * this.radius : 1.2 * this.size;
    const longest = arrow => Math.max(...arrows.filter(other => kind(other) === kind(arrow)).map(greatest));
    for (const arrow of arrows) arrow.scale = arrow.true_length ? 1 : reach / longest(arrow) || 0;
  }

  floor(view) {
    const { square, radius, centre, ground } = this, [x, y] = [centre.x, centre.y].map(middle => Math.round(middle / square) * square);
    const edge = Math.ceil(0.55 * radius / square) * square, lines = [], at = (dx, dy) => view.local(vector([x + dx, y + dy, ground]));
    for (let k = -edge; k <= edge * 1.01; k += square) lines.push(at(-edge, k), at(edge, k), null, at(k, -edge), at(k, edge), null);
    view.add(view.stroke(lines, 'muted', { alpha: 0.18 }));
    if (!view.shadows) return;
    const shade = new THREE.Mesh(new THREE.PlaneGeometry(2 * edge / radius, 2 * edge / radius), new THREE.ShadowMaterial({ opacity: 0.2 }));
    shade.position.copy(at(0, 0));
    view.add(Object.assign(shade, { receiveShadow: true }));
  }

  traceColour(body) {
    return body.trail_colour ?? (body.rotation && !moving(body) && body.axes ? 'c2' : ['c2', 'c0', 'c1'][body.order % 3]);
  }

  buildBody(view, body) {
    const { run, mesh, ghost } = body, pose = () => run.pose(body), place = () => pose()?.place;
    if (body.dots) view.dot(place, body.paint === 'solid' ? 'ink' : body.paint, 5, ghost ? 0.5 : 1);
    if (mesh) {
      const middle = () => run.point({ body: body.order, at: body.middle }), size = body.magnification / this.radius;
      view.add(view.solid(mesh, body.paint, ghost ? 0.3 : 1), solid => view.put(solid, middle(), size, pose()?.attitude.clone().multiply(mesh.rotation)));
    }
    UNIT.forEach((axis, k) => {
      const ends = () => { const now = pose(); return now && [now.place, run.point({ body: body.order, at: scaled(axis, body.reach) })]; };
      const name = ghost || (this.free && !mesh) ? '' : k + 1 + '′'.repeat(body.order);
      if (body.axes) view.arrow(ends, 'c' + k, ghost || body.order ? 1.6 : 2, name, ghost ? 0.45 : 1);
    });
    if (!moving(body) || !mesh || !this.square) return;
    const drop = () => { const at = place(); return at && this.low < at.z ? [at, vector([at.x, at.y, this.ground])] : null; };
    view.add(view.stroke(DASHES, 'muted', { alpha: 0.5 }), line => { const ends = drop(); return Boolean(ends) && view.span(line, ends, 1); });
    view.dot(() => drop()?.[1], 'muted', 3, 0.6);
  }

  /** All that should be in the first view, each a point and what is about it, at some moments of the runs. */
  shown() {
    const shown = this.axes.filter(Boolean).map(tip => [tip, 0]);
    for (const run of runs) {
      for (let k = 0; k < run.samples; k += Math.ceil(run.samples / 100)) {
        for (const body of run.bodies) {
          shown.push([run.point({ body: body.order, at: body.middle }, k), body.mesh ? body.extent : 0]);
          if (body.axes && body.mesh) for (const axis of UNIT) shown.push([run.point({ body: body.order, at: scaled(axis, body.reach) }, k), 0]);
        }
        for (const arrow of run.arrows) shown.push([this.ends(arrow, k)?.[1], 0]);
      }
    }
    return shown.filter(([point]) => point);
  }

  /** Where an arrow starts and ends in space, at a sample or at the moment. */
  ends(arrow, k = null) {
    const from = arrow.run.point({ body: arrow.body, at: arrow.from ?? undefined }, k), along = arrow.run.vectorAt(arrow, k);
    return from && along && [from, sum(from, scaled(along, arrow.scale))];
  }

  /** A rod or a spring, and a dot where it starts. */
  buildLink(view, { ghost }, ends, spring) {
    const alpha = ghost ? 0.35 : 1, link = spring ? view.stroke(COIL, 'muted', { width: 1.6, alpha }) : view.surface(SHAFT, 'ink', alpha);
    view.add(link, () => { const at = ends(); return at.every(Boolean) && view.span(link, at, spring ? 6 : 1.25); });
    view.dot(() => ends()[0], 'ink', 3.5, alpha);
  }

  build(view) {
    if (this.square) this.floor(view);
    else if (!this.wide) view.sphere(bodies.length === 1 && bodies[0].axes ? bodies[0].reach : this.size * 1.3, [2], this.centre);
    this.axes.forEach((tip, k) => { if (tip) view.arrow(() => [ORIGIN, tip], 'muted', 1, (space.axes ?? ['x', 'y', 'z'])[k], 0.6); });
    for (const body of bodies) {
      if (body.trailPath) view.trace(body.trailPath, body.run, this.traceColour(body), body.ghost ? 0.5 : 1);
      this.buildBody(view, body);
    }
    for (const run of runs) {
      for (const { from, to, spring } of run.links) this.buildLink(view, run, () => [run.point(from ?? {}), run.point(to ?? {})], spring);
      for (const arrow of run.arrows.filter(({ scale }) => scale > 0))
        view.arrow(() => this.ends(arrow), arrow.colour, 2.4, run.ghost ? '' : arrow.symbol ?? arrow.name, run.ghost ? 0.45 : 1);
    }
  }
}

/** How vectors move as a rider on the body sees them: those that are given in a body's axes and move there. */
class BodyScene {
  constructor() {
    this.vectors = runs.flatMap(run => run.arrows).filter(({ frame, vector }) => frame === 'body' && !vector.constant);
    // vectors of different kinds are compared by direction: each in units of its greatest length
    for (const arrow of this.vectors) arrow.bodyUnit = greatest(arrow) || 1;
    Object.assign(this, { centre: ORIGIN, radius: 1.6, look: [-0.95, 0.38] });
  }

  build(view) {
    view.sphere(1, [0, 1, 2]);
    UNIT.forEach((axis, k) => view.arrow(() => [ORIGIN, scaled(axis, 1.2)], 'c' + k, 1.4, String(k + 1)));
    for (const { run, vector, bodyUnit, colour } of this.vectors) {
      const alpha = run.ghost ? 0.5 : 1, one = v => v && scaled(v, 1 / bodyUnit);
      view.trace(vector.list.map(one), run, colour, alpha);
      view.arrow(() => { const now = vector.now(); return now && [ORIGIN, one(now)]; }, colour, 2, '', alpha);
    }
  }
}

const views = [], spaceScene = new SpaceScene(), bodyScene = new BodyScene();

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
  const inSpace = bodies.length > 0, inBody = bodyScene.vectors.length > 0;
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
