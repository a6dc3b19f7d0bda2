// ---- drawing in three dimensions

const theme = {};
const rgb = hex => [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16));
function readTheme() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ['panel', 'ink', 'muted', 'line', 'solid', 'second', 'planet', 'c0', 'c1', 'c2', 'c3', 'c4', 'c5', 'c6'])
    theme[name] = style.getPropertyValue('--' + name).trim();
}

/** Gives its owner a canvas as sharp as the screen, and keeps the owner told of its size. */
function sharpCanvas(owner, parent, label) {
  const canvas = owner.canvas = add(parent, 'canvas', '', { role: 'img', 'aria-label': label });
  owner.pen = canvas.getContext('2d');
  new ResizeObserver(() => {
    const [width, height, ratio] = [canvas.clientWidth, canvas.clientHeight, window.devicePixelRatio || 1];
    canvas.width = Math.max(1, Math.round(width * ratio));
    canvas.height = Math.max(1, Math.round(height * ratio));
    Object.assign(owner, { width, height, ratio, stale: true });
    owner.draw(); // at once: a canvas of a new size is empty
  }).observe(canvas);
  return canvas;
}

/** Calls back when the pointer goes down on an element, and with every move until it is let go, wherever that is. */
function onDrag(element, moved) {
  element.addEventListener('pointerdown', event => {
    element.setPointerCapture(event.pointerId);
    if (event.button === 0) moved(event);
  });
  element.addEventListener('pointermove', event => { if (event.buttons === 1) moved(event); });
}

function disc(pen, [x, y], size, colour, alpha = 1) {
  pen.beginPath();
  pen.arc(x, y, size, 0, 2 * Math.PI);
  pen.globalAlpha = alpha;
  pen.lineWidth = 1.5;
  pen.fillStyle = theme[colour];
  pen.strokeStyle = theme.panel;
  pen.fill();
  pen.stroke();
}

/** A scene in mild perspective that can be turned and zoomed. What may hide other things is collected, and drawn from far to near. */
class View {
  constructor(parent, label, scene) {
    this.scene = scene;
    this.pieces = [];
    this.names = [];
    this.fingers = new Map();
    const canvas = sharpCanvas(this, parent, label);
    this.reset();
    canvas.addEventListener('pointerdown', event => {
      canvas.setPointerCapture(event.pointerId);
      this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, event => this.fingers.delete(event.pointerId));
    canvas.addEventListener('pointermove', event => this.drag(event));
    canvas.addEventListener('dblclick', () => this.reset());
    canvas.addEventListener('wheel', event => {
      event.preventDefault();
      this.turn(0, 0, Math.exp(-clamp(event.deltaY, -200, 200) * 0.0015));
    }, { passive: false });
  }

  /** One finger or the mouse turns, two zoom as they part. */
  drag({ pointerId, clientX, clientY }) {
    const before = this.fingers.get(pointerId);
    if (!before) return;
    const apart = () => { const [a, b] = this.fingers.values(); return Math.hypot(a[0] - b[0], a[1] - b[1]); };
    const gap = this.fingers.size === 2 ? apart() : 0;
    this.fingers.set(pointerId, [clientX, clientY]);
    if (gap > 0) this.turn(0, 0, apart() / gap);
    else if (this.fingers.size === 1) this.turn((clientX - before[0]) * 0.008, (clientY - before[1]) * 0.008);
  }

  reset() {
    [this.yaw, this.pitch, this.zoom] = [...this.scene.look, 1];
    redraw();
  }

  turn(right, down, closer = 1) {
    this.yaw -= right;
    this.pitch = clamp(this.pitch + down, -Math.PI / 2, Math.PI / 2);
    this.zoom = clamp(this.zoom * closer, 0.2, 30);
    redraw();
  }

  draw() {
    const [c, s, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    this.axes = [[-s, c, 0], [-sp * c, -sp * s, cp], [cp * c, cp * s, sp]]; // to the right, up, and to the eye
    const { centre, radius } = this.scene;
    this.lens = this.axes.map(axis => [...axis, -dot(axis, centre)].map(x => x / radius));
    this.light = [0, 1, 2].map(k => -0.35 * this.axes[0][k] + 0.6 * this.axes[1][k] + 0.72 * this.axes[2][k]);
    this.scale = Math.min(this.width * 0.47, this.height * (this.scene.free ? 0.6 : 0.47)) * this.zoom;
    this.pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    this.pen.globalAlpha = 1;
    this.pen.fillStyle = theme.panel;
    this.pen.fillRect(0, 0, this.width, this.height);
    this.pen.lineJoin = 'round';
    this.scene.draw(this);
  }

  /** Where a point of the scene is on the canvas, and how near; written out, as it is done for every point of every trace. */
  project([x, y, z]) {
    const [right, up, near] = this.lens, depth = near[0] * x + near[1] * y + near[2] * z + near[3];
    const scale = this.scale / Math.max(0.2, 1 - depth / 6); // the eye is 6 radii away
    return [
      this.width / 2 + (right[0] * x + right[1] * y + right[2] * z + right[3]) * scale,
      this.height / 2 - (up[0] * x + up[1] * y + up[2] * z + up[3]) * scale,
      depth,
    ];
  }

  /** A line through points at once, with gaps where they are null or `shown` does not hold. */
  stroke(list, colour, width, alpha = 1, shown = null) {
    const pen = this.pen;
    let before = null, joined = false;
    pen.beginPath();
    for (const point of list) {
      const at = point && this.project(point), drawn = at && before && (!shown || shown(at[2]) || shown(before[2]));
      if (drawn && !joined) pen.moveTo(before[0], before[1]);
      if (drawn) pen.lineTo(at[0], at[1]);
      joined = drawn;
      before = at;
    }
    pen.strokeStyle = theme[colour];
    pen.lineWidth = width;
    pen.globalAlpha = alpha;
    pen.stroke();
  }

  /** A line to be drawn among the other pieces, in so many parts that each is before or behind what it passes. */
  line(from, to, colour, width, alpha = 1, parts = 8, dashed = false) {
    let before = this.project(from);
    for (let k = 1; k <= parts; k++) {
      const start = before, end = before = this.project(mix(from, to, k / parts));
      if (dashed && k % 2) continue;
      this.pieces.push({ depth: (start[2] + end[2]) / 2, draw: pen => {
        pen.beginPath();
        pen.moveTo(start[0], start[1]);
        pen.lineTo(end[0], end[1]);
        pen.globalAlpha = alpha;
        pen.strokeStyle = theme[colour];
        pen.lineWidth = width;
        pen.stroke();
      } });
    }
  }

  /** An arrow among the other pieces, and beyond its head a name. */
  arrow(from, to, colour, width, name = '', alpha = 1) {
    const [x0, y0] = this.project(from), [x, y, depth] = this.project(to);
    const long = Math.hypot(x - x0, y - y0) || 1, size = Math.min(4 + 2.2 * width, long);
    const [u, v] = [(x - x0) / long, (y - y0) / long];
    this.line(from, to, colour, width, alpha);
    this.pieces.push({ depth: depth + 1e-6, draw: pen => {
      pen.beginPath();
      pen.moveTo(x + u * size * 0.4, y + v * size * 0.4);
      for (const side of [-0.42, 0.42]) pen.lineTo(x - (u * 0.7 + v * side) * size, y - (v * 0.7 - u * side) * size);
      pen.globalAlpha = alpha;
      pen.fillStyle = theme[colour];
      pen.fill();
    } });
    if (name) this.names.push({ name, x: x + u * 14, y: y + v * 14, colour, bold: width > 1.5 });
  }

  /** A zigzag, as springs are drawn. */
  spring(from, to, alpha) {
    const [x0, y0] = this.project(from), [x, y] = this.project(to);
    const long = Math.hypot(x - x0, y - y0) || 1, wide = 6, turns = 12;
    const [u, v] = [(y - y0) / long * wide, -(x - x0) / long * wide];
    this.pieces.push({ depth: (this.project(from)[2] + this.project(to)[2]) / 2, draw: pen => {
      pen.beginPath();
      pen.moveTo(x0, y0);
      for (let k = 0; k <= turns; k++) {
        const part = 0.12 + 0.76 * k / turns, side = k === 0 || k === turns ? 0 : k % 2 ? 1 : -1;
        pen.lineTo(x0 + (x - x0) * part + u * side, y0 + (y - y0) * part + v * side);
      }
      pen.lineTo(x, y);
      pen.globalAlpha = alpha;
      pen.strokeStyle = theme.muted;
      pen.lineWidth = 1.6;
      pen.stroke();
    } });
  }

  dot(point, colour, size, alpha = 1) {
    const at = this.project(point);
    this.pieces.push({ depth: at[2], draw: pen => disc(pen, at, size, colour, alpha) });
  }

  /** The facets of a solid about its middle that are turned to the eye, shaded. */
  solid(facets, middle, attitude, magnification, colour, alpha) {
    const [along, across, beyond] = UNIT.map(axis => turned(attitude, axis));
    const carry = ([x, y, z]) => [0, 1, 2].map(k => x * along[k] + y * across[k] + z * beyond[k]);
    const distance = 6 * this.scene.radius, eye = sum(this.scene.centre, scaled(this.axes[2], distance));
    for (const facet of facets) {
      const corners = facet.corners.map(corner => sum(middle, scaled(carry(corner), magnification)));
      const normal = carry(facet.normal), facing = dot(normal, sum(eye, scaled(corners[0], -1))) > 0;
      if (!facing && !facet.clear) continue;
      const points = corners.map(corner => this.project(corner));
      const shine = facet.clear ? 0.85 : 0.66 + 0.36 * Math.max(-0.4, dot(normal, this.light));
      const base = rgb(theme[typeof facet.tone === 'string' ? facet.tone : colour]);
      const paint = base.map(x => Math.round(Math.min(255, x * shine * (facet.tone === 1 ? 0.84 : 1))));
      this.pieces.push({
        depth: points.reduce((total, point) => total + point[2], 0) / points.length,
        draw: pen => {
          pen.beginPath();
          points.forEach(([x, y], k) => { if (k) pen.lineTo(x, y); else pen.moveTo(x, y); });
          pen.closePath();
          pen.globalAlpha = facet.clear ? 0.35 * alpha : alpha;
          pen.fillStyle = pen.strokeStyle = `rgb(${paint})`;
          pen.lineWidth = facet.clear || facet.edged ? 1 : 0.8;
          pen.fill();
          if (facet.edged || facet.clear) pen.strokeStyle = `rgb(${paint.map(x => Math.round(x * 0.75))})`;
          if (alpha === 1) pen.stroke();
        },
      });
    }
  }

  /** Draws what was collected, from far to near, and the names over it, with a rim, so that lines beneath do not cut them. */
  flush() {
    const pen = this.pen;
    for (const piece of this.pieces.sort((a, b) => a.depth - b.depth)) piece.draw(pen);
    pen.globalAlpha = 1;
    pen.textAlign = 'center';
    pen.textBaseline = 'middle';
    for (const { name, x, y, colour, bold } of this.names) {
      pen.font = `${bold ? 600 : 400} 13px system-ui, sans-serif`;
      const half = pen.measureText(name).width / 2 + 4, at = clamp(x, half, this.width - half);
      pen.lineWidth = 3.5;
      pen.strokeStyle = theme.panel;
      pen.strokeText(name, at, y);
      pen.fillStyle = theme[colour];
      pen.fillText(name, at, y);
    }
    [this.pieces, this.names] = [[], []];
  }

  /** The outline of a sphere about the origin, and where it meets the planes across some axes. */
  sphere(radius, normals, centre = ORIGIN) {
    const [right, up] = this.axes;
    for (const [u, v] of [[right, up], ...normals.map(k => [UNIT[(k + 1) % 3], UNIT[(k + 2) % 3]])]) {
      const circle = Array.from({ length: 73 }, (_, k) => k * Math.PI / 36)
        .map(angle => sum(centre, scaled(sum(scaled(u, Math.cos(angle)), scaled(v, Math.sin(angle))), radius)));
      this.stroke(circle, 'muted', 1, 0.25);
    }
  }
}
