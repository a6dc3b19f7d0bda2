// ---- drawing in three dimensions, by three.js

ColorManagement.enabled = false; // colours are mixed and lit as they are written

const theme = {}, hues = new Map();
function readTheme() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ['panel', 'ink', 'muted', 'line', 'solid', 'second', 'planet', 'c0', 'c1', 'c2', 'c3', 'c4', 'c5', 'c6'])
    theme[name] = style.getPropertyValue('--' + name).trim();
  for (const { colour, name, light } of hues.values()) colour.set(theme[name]).multiplyScalar(light);
}

/** A colour of the theme, more or less light; it changes with the theme. */
function hue(name, light = 1) {
  const key = name + light;
  if (!hues.has(key)) hues.set(key, { colour: new Color(theme[name]).multiplyScalar(light), name, light });
  return hues.get(key).colour;
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

/** Lines as wide as they are to be in pixels. Those with a tail are what a moving point left: the tail ends `now`, and fades. */
const STROKE = {
  vertexShader: `
    attribute vec3 before, after;
    attribute float side, moment;
    uniform vec2 half_size;
    uniform float width, now, tail;
    varying float v_moment;
    vec4 seen(vec3 point) { return projectionMatrix * modelViewMatrix * vec4(point, 1.0); }
    void main() {
      vec4 from = seen(before), to = seen(after);
      gl_Position = seen(position);
      vec2 way = (to.xy / to.w - from.xy / from.w) * half_size;
      way = length(way) > 1e-9 ? normalize(way) : vec2(1.0, 0.0);
      float wide = tail > 0.0 ? 0.5 + 0.5 * clamp(1.0 - (now - moment) / tail, 0.0, 1.0) : 1.0;
      gl_Position.xy += vec2(-way.y, way.x) / half_size * side * 0.5 * width * wide * gl_Position.w;
      v_moment = moment;
    }`,
  fragmentShader: `
    uniform vec3 colour;
    uniform float alpha, now, tail;
    varying float v_moment;
    void main() {
      float fresh = tail > 0.0 ? 1.0 - (now - v_moment) / tail : 1.0;
      if (v_moment > now || fresh <= 0.0) discard;
      gl_FragColor = vec4(colour, alpha * pow(fresh, 1.5));
    }`,
};

/** The pairs of neighbours in a list of points with gaps, as indices of the second. */
const joined = points => points.map((_, k) => k).filter(k => k > 0 && points[k] && points[k - 1]);

/** The band of a line through points, for `STROKE`. What came last is drawn first: where a line crosses itself, the first stays. */
function band(points) {
  const geometry = new BufferGeometry(), twice = value => points.flatMap((point, k) => [value(point, k), value(point, k)].flat());
  const set = (name, size, values) => geometry.setAttribute(name, new BufferAttribute(new Float32Array(values), size));
  const beside = way => (point, k) => points[k + way] ?? point ?? ORIGIN;
  set('position', 3, twice(point => point ?? ORIGIN));
  set('before', 3, twice(beside(-1)));
  set('after', 3, twice(beside(1)));
  set('moment', 1, twice((_, k) => k));
  set('side', 1, points.flatMap(() => [-1, 1]));
  return geometry.setIndex(joined(points).reverse().flatMap(k => [2 * k - 2, 2 * k - 1, 2 * k, 2 * k, 2 * k - 1, 2 * k + 1]));
}

const segments = points => new BufferGeometry().setFromPoints(joined(points).flatMap(k => [points[k - 1], points[k]]).map(at => new Vector3(...at)));

const UP = new Vector3(0, 0, 1);
const SHAFT = new CylinderGeometry(1, 1, 1, 12, 1, true).rotateX(Math.PI / 2).translate(0, 0, 0.5);
const HEAD = new ConeGeometry(1, 1, 24).rotateX(Math.PI / 2).translate(0, 0, 0.5);
const DISC = new SphereGeometry(1, 24, 16);
/** A coil along the third axis, one long and in pixels wide. */
const COIL = [[0, 0, 0], ...Array.from({ length: 193 }, (_, k) => [Math.sin(k * Math.PI / 8), Math.cos(k * Math.PI / 8), 0.12 + 0.76 * k / 192]), [0, 0, 1]];
const DASHES = Array.from({ length: 24 }, (_, k) => k % 3 === 2 ? null : [0, 0, (k % 3 ? k : k + 0.5) / 23]);

/** A scene in mild perspective that can be turned and zoomed, with names over it. Its middle is the origin for three.js, its radius 1. */
class View {
  static pictures = 0;

  constructor(parent, label, scene) {
    Object.assign(this, { scene, things: [], names: [], strokes: 0, fingers: new Map(), space: new Scene(), camera: new PerspectiveCamera() });
    this.halfSize = { value: new Vector2(1, 1) };
    const canvas = sharpCanvas(this, parent, label);
    this.setUpRenderer();
    this.light();
    scene.build(this);
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

  /** Draws by WebGL where there is one, without shadows where the processor has to do it; else as SVG. */
  setUpRenderer() {
    const canvas = document.createElement('canvas'), context = canvas.getContext('webgl2', { antialias: true, stencil: true, alpha: false });
    this.webgl = Boolean(context);
    this.renderer = context ? new WebGLRenderer({ canvas, context, stencil: true }) : new SVGRenderer();
    if (!context) return;
    this.renderer.outputColorSpace = LinearSRGBColorSpace; // colours are those that the page names
    const names = context.getExtension('WEBGL_debug_renderer_info');
    const card = String(context.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : context.RENDERER));
    this.renderer.shadowMap.enabled = !/swiftshader|llvmpipe|softpipe|software|basic render/i.test(card);
    canvas.addEventListener('webglcontextrestored', redraw);
  }

  get shadows() { return this.webgl && this.renderer.shadowMap.enabled; }

  /** Light from everywhere, from above, and from the eye. */
  light() {
    const unit = this.webgl ? Math.PI : 1, [yaw] = this.scene.look;
    const sun = new DirectionalLight(0xffffff, 0.28 * unit);
    sun.position.set(1.3 * Math.cos(yaw - 0.7), 1.3 * Math.sin(yaw - 0.7), 3.5);
    sun.castShadow = this.shadows;
    sun.shadow.mapSize.set(2048, 2048);
    Object.assign(sun.shadow.camera, { left: -2, right: 2, top: 2, bottom: -2, near: 0.5, far: 8 });
    Object.assign(sun.shadow, { normalBias: 0.01, radius: 3, intensity: 0.8 });
    this.lamp = new DirectionalLight(0xffffff, 0.22 * unit);
    this.space.add(new AmbientLight(new Color().setScalar(0.56 * unit)), sun, this.lamp);
    this.space.background = hue('panel');
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

  /** A point of the scene as three.js has it. */
  local(point) {
    const { centre, radius } = this.scene;
    return point.map((x, k) => (x - centre[k]) / radius);
  }

  vector(point) { return new Vector3(...this.local(point)); }

  /** Where a point of the scene is on the canvas. */
  project(point) {
    const { x, y } = this.vector(point).project(this.camera);
    return [(1 + x) / 2 * this.width, (1 - y) / 2 * this.height];
  }

  draw() {
    const { camera } = this, [c, s, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    const eye = new Vector3(cp * c, cp * s, sp), scale = Math.min(this.width * 0.47, this.height * (this.scene.free ? 0.6 : 0.47)) * this.zoom;
    this.pixel = 1 / scale;
    this.halfSize.value.set(this.width / 2, this.height / 2);
    Object.assign(camera, { fov: 360 / Math.PI * Math.atan(this.height / 12 / scale), aspect: this.width / this.height, near: 0.5, far: 50 });
    camera.quaternion.setFromRotationMatrix(new Matrix4().makeBasis(new Vector3(-s, c, 0), new Vector3(-sp * c, -sp * s, cp), eye));
    camera.position.copy(eye).multiplyScalar(6); // the eye is 6 radii away
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    this.lamp.position.copy(new Vector3(-0.4, 0.5, 0.8).applyQuaternion(camera.quaternion));
    this.names = [];
    for (const { object, place } of this.things) object.visible = place(object) !== false;
    View.pictures++;
    if (this.webgl) {
      this.renderer.setSize(this.canvas.width, this.canvas.height, false);
      this.renderer.render(this.space, camera);
      return this.paint(this.renderer.domElement, this.names);
    }
    this.renderer.setSize(this.width, this.height);
    this.renderer.render(this.space, camera);
    const image = new Image(), { names } = this;
    image.onload = () => this.paint(image, names);
    image.src = 'data:image/svg+xml,' + encodeURIComponent(new XMLSerializer().serializeToString(this.renderer.domElement));
  }

  /** Shows a picture, and names over it, with a rim, so that lines beneath do not cut them. */
  paint(picture, names) {
    const { pen } = this;
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.fillStyle = theme.panel;
    pen.fillRect(0, 0, this.width, this.height);
    pen.drawImage(picture, 0, 0, this.width, this.height);
    pen.lineJoin = 'round';
    pen.textAlign = 'center';
    pen.textBaseline = 'middle';
    for (const { name, x, y, colour, bold } of names) {
      pen.font = `${bold ? 600 : 400} 13px system-ui, sans-serif`;
      const half = pen.measureText(name).width / 2 + 4, at = clamp(x, half, this.width - half);
      pen.lineWidth = 3.5;
      pen.strokeStyle = theme.panel;
      pen.strokeText(name, at, y);
      pen.fillStyle = theme[colour];
      pen.fillText(name, at, y);
    }
  }

  /** Adds what `place` puts in its place before each picture, unless it says `false`: then it is not there. */
  add(object, place = () => true) {
    this.space.add(object);
    this.things.push({ object, place });
    return object;
  }

  /** Puts what stands along the third axis, one long, between two points, so many pixels thick. */
  span(object, from, to, thickness) {
    const start = this.vector(from), way = this.vector(to).sub(start), long = way.length();
    object.position.copy(start);
    object.quaternion.setFromUnitVectors(UP, way.normalize());
    object.scale.set(thickness * this.pixel, thickness * this.pixel, long);
    return long > 0;
  }

  /** A surface in the light. */
  surface(geometry, colour, alpha = 1, options = {}) {
    const clear = alpha < 1;
    const material = new MeshLambertMaterial({ transparent: clear, opacity: alpha, depthWrite: !clear, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, ...options });
    material.color = hue(colour, options.vertexColors ? 1 : 0.65);
    if (!options.vertexColors) material.emissive = hue(colour, 0.4); // what is thin shows its colour from all sides
    const mesh = new Mesh(geometry, material);
    mesh.castShadow = mesh.receiveShadow = !clear;
    return mesh;
  }

  /** A line in pixels wide through points as three.js has them, with gaps where they are null. */
  stroke(points, colour, { width = 1, alpha = 1, light = 1, tail = 0, geometry = null } = {}) {
    if (!this.webgl) {
      const line = new LineSegments(segments(points), new LineBasicMaterial({ opacity: alpha, linewidth: width, linecap: 'butt' }));
      line.material.color = hue(colour, light);
      return line;
    }
    const value = value => ({ value });
    const material = new ShaderMaterial({
      ...STROKE, transparent: true, depthWrite: false, side: DoubleSide,
      uniforms: { half_size: this.halfSize, colour: value(hue(colour, light)), width: value(width), alpha: value(alpha), now: value(1e9), tail: value(tail) },
      // each pixel is painted once, however often the line comes by
      stencilWrite: true, stencilFunc: NotEqualStencilFunc, stencilRef: ++this.strokes % 255 + 1, stencilZPass: ReplaceStencilOp,
    });
    const line = new Mesh(geometry ?? band(points), material);
    line.frustumCulled = false;
    return line;
  }

  /** The way of a moving point; what is long past is faint, what is to come fainter. */
  trace(path, run, colour, alpha) {
    const points = path.map(point => point && this.local(point)), tail = Math.ceil(run.samples / 6) + 2;
    const whole = this.add(this.stroke(points, colour, { alpha: 0.13 * alpha }));
    const recent = this.stroke(points, colour, { width: 2.4, alpha: 0.9 * alpha, tail, geometry: whole.geometry });
    this.add(recent, () => {
      const { index, fraction } = run.moment;
      const now = index + fraction, fading = Math.min(tail, now + 1);
      if (this.webgl) Object.assign(recent.material.uniforms, { now: { value: now }, tail: { value: fading } });
      else recent.geometry = segments(points.slice(Math.max(0, Math.round(now - fading / 2)), index + 1));
    });
  }

  /** An arrow and beyond its head a name; `ends` tells where it is at the moment. */
  arrow(ends, colour, width, name = '', alpha = 1) {
    const arrow = new Group(), shaft = this.surface(SHAFT, colour, alpha), head = this.surface(HEAD, colour, alpha);
    arrow.add(shaft, head);
    this.add(arrow, () => {
      const at = ends();
      if (!at || !this.span(arrow, ...at, 1)) return false;
      const { pixel } = this, long = arrow.scale.z, size = Math.min((5 + 3 * width) * pixel, long);
      arrow.scale.setScalar(1);
      shaft.scale.set(0.6 * width * pixel, 0.6 * width * pixel, long - size);
      head.scale.set(0.36 * size, 0.36 * size, size);
      head.position.z = long - size;
      if (!name) return;
      const [[x0, y0], [x, y]] = at.map(end => this.project(end)), apart = Math.hypot(x - x0, y - y0) || 1;
      this.names.push({ name, x: x + (x - x0) / apart * 12, y: y + (y - y0) / apart * 12, colour, bold: width > 1.5 });
    });
  }

  /** A rod or a spring. */
  link(ends, spring, alpha) {
    const link = spring ? this.stroke(COIL, 'muted', { width: 1.6, alpha }) : this.surface(SHAFT, 'ink', alpha);
    this.add(link, () => { const at = ends(); return Boolean(at) && this.span(link, ...at, spring ? 6 : 1.25); });
  }

  /** A dot so many pixels large. */
  dot(place, colour, size, alpha = 1) {
    this.add(this.surface(DISC, colour, alpha), dot => {
      const at = place();
      if (!at) return false;
      dot.position.copy(this.vector(at));
      dot.scale.setScalar(size * this.pixel);
    });
  }

  /** A level square that shows nothing but shadows. */
  shade(middle, size) {
    const plane = this.add(new Mesh(new PlaneGeometry(size, size), new ShadowMaterial({ opacity: 0.2 })));
    plane.position.copy(this.vector(middle));
    plane.scale.setScalar(1 / this.scene.radius);
    plane.receiveShadow = true;
  }

  /** A body's solid. */
  solid({ parts }, colour, alpha) {
    const solid = new Group();
    for (const { geometry, colour: own, clear } of parts) {
      solid.add(this.surface(geometry, own ?? colour, clear ? 0.45 * alpha : alpha, { vertexColors: true }));
      const edges = new EdgesGeometry(geometry, 30).attributes.position, points = [];
      for (let k = 0; k < edges.count; k += 2) points.push(...[k, k + 1].map(at => new Vector3().fromBufferAttribute(edges, at).toArray()), null);
      if (points.length) solid.add(this.stroke(points, own ?? colour, { light: 0.7, alpha: clear ? 0.5 * alpha : alpha }));
    }
    return solid;
  }

  /** The outline of a sphere about a point, and where it meets the planes across some axes. */
  sphere(radius, normals, centre = ORIGIN) {
    const circle = (u, v) => Array.from({ length: 97 }, (_, k) => k * Math.PI / 48).map(angle => sum(scaled(u, Math.cos(angle)), scaled(v, Math.sin(angle))));
    const put = (line, attitude) => this.add(line, () => {
      line.position.copy(this.vector(centre));
      line.scale.setScalar(radius / this.scene.radius);
      if (attitude) line.quaternion.copy(attitude);
    });
    put(this.stroke(circle(UNIT[0], UNIT[1]), 'muted', { alpha: 0.25 }), this.camera.quaternion);
    for (const k of normals) put(this.stroke(circle(UNIT[(k + 1) % 3], UNIT[(k + 2) % 3]), 'muted', { alpha: 0.25 }));
  }
}
