// ---- drawing in three dimensions, by three.js

THREE.ColorManagement.enabled = false; // colours are mixed and lit as they are written

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
  if (!hues.has(key)) hues.set(key, { colour: new THREE.Color(theme[name]).multiplyScalar(light), name, light });
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

/** Lines as wide as they are to be in pixels. Those with a tail are what a moving point left: the tail ends `now`, and fades. */
const STROKE = {
  vertexShader: `
    attribute vec3 before, after; attribute float side, moment;
    uniform float width, now, tail; uniform vec2 half_size;
    varying float fresh, late;
    vec2 on_screen(vec3 point) { vec4 at = projectionMatrix * modelViewMatrix * vec4(point, 1.0); return at.xy / at.w * half_size; }
    void main() {
      vec2 way = on_screen(after) - on_screen(before), across = length(way) > 1e-9 ? normalize(vec2(-way.y, way.x)) : vec2(0.0, 1.0);
      late = moment - now;
      fresh = tail > 0.0 ? 1.0 + late / tail : 1.0;
      gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      gl_Position.xy += across / half_size * side * width * (1.0 + clamp(fresh, 0.0, 1.0)) / 4.0 * gl_Position.w;
    }`,
  fragmentShader: `
    uniform vec3 colour; uniform float alpha;
    varying float fresh, late;
    void main() {
      if (late > 0.0 || fresh <= 0.0) discard;
      gl_FragColor = vec4(colour, alpha * pow(fresh, 1.5));
    }`,
};

/** Where a list of points with gaps has two beside each other: the places of the second. */
const joined = points => [...points.keys()].filter(k => k > 0 && points[k] && points[k - 1]);

/** The band of a line through points, for `STROKE`. What came last is drawn first: where a line crosses itself, the first stays. */
function band(points) {
  const geometry = new THREE.BufferGeometry(), order = joined(points).reverse();
  const set = (name, size, value) => geometry.setAttribute(name, new THREE.BufferAttribute(
    new Float32Array(points.flatMap((_, k) => [-1, 1].flatMap(side => value(k, side)))), size));
  const at = (way = 0) => k => [...points[k + way] ?? points[k] ?? ORIGIN];
  for (const [name, value] of [['position', at()], ['before', at(-1)], ['after', at(1)]]) set(name, 3, value);
  set('moment', 1, k => k);
  set('side', 1, (_, side) => side);
  geometry.userData = order;
  return geometry.setIndex(order.flatMap(k => [2 * k - 2, 2 * k - 1, 2 * k, 2 * k, 2 * k - 1, 2 * k + 1]));
}

/** The same for SVG. */
const segments = points => new THREE.BufferGeometry().setFromPoints(joined(points).flatMap(k => [points[k - 1], points[k]]));

const SHAFT = new THREE.CylinderGeometry(1, 1, 1, 12, 1, true).rotateX(Math.PI / 2).translate(0, 0, 0.5);
const HEAD = new THREE.ConeGeometry(1, 1, 24).rotateX(Math.PI / 2).translate(0, 0, 0.5);
const DISC = new THREE.SphereGeometry(1, 24, 16);
const CIRCLE = Array.from({ length: 97 }, (_, k) => vector([Math.cos(k * Math.PI / 48), Math.sin(k * Math.PI / 48), 0]));
const COIL = [[0, 0, 0], ...Array.from({ length: 193 }, (_, k) => [Math.sin(k * Math.PI / 8), Math.cos(k * Math.PI / 8), 0.12 + 0.76 * k / 192]), [0, 0, 1]].map(vector);
const DASHES = Array.from({ length: 24 }, (_, k) => k % 3 === 2 ? null : vector([0, 0, k / 23]));

/** Where a name may be, in pixels along its arrow and aside. */
const PLACES = [0, 14, 28, 56].flatMap(on => [0, 16, -16].map(aside => [on, aside]));

/** A scene in mild perspective that can be turned and zoomed, with names over it. Its middle is the origin for three.js, its radius 1. */
class View {
  /** How many pictures of all scenes were drawn. */
  static pictures = 0;

  constructor(parent, label, scene) {
    Object.assign(this, { scene, things: [], strokes: 0, fingers: new Map(), halfSize: { value: new THREE.Vector2() } });
    Object.assign(this, { space: new THREE.Scene(), camera: new THREE.PerspectiveCamera() });
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
    const canvas = document.createElement('canvas'), context = canvas.getContext('webgl2', { antialias: true, stencil: true });
    this.webgl = Boolean(context);
    this.renderer = context ? new THREE.WebGLRenderer({ canvas, context }) : new THREE.SVGRenderer();
    if (!context) return;
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // colours are those that the page names
    const card = context.getParameter(context.getExtension('WEBGL_debug_renderer_info')?.UNMASKED_RENDERER_WEBGL ?? context.RENDERER);
    this.shadows = this.renderer.shadowMap.enabled = !/swiftshader|llvmpipe|softpipe|software|basic render/i.test(card);
    canvas.addEventListener('webglcontextrestored', redraw);
  }

  /** Light from everywhere, from above, and from the eye. */
  light() {
    const unit = this.webgl ? Math.PI : 1, [yaw] = this.scene.look, sun = new THREE.DirectionalLight(0xffffff, 0.28 * unit);
    sun.position.set(1.3 * Math.cos(yaw - 0.7), 1.3 * Math.sin(yaw - 0.7), 3.5);
    sun.castShadow = Boolean(this.shadows);
    sun.shadow.mapSize.set(2048, 2048);
    Object.assign(sun.shadow.camera, { left: -2, right: 2, top: 2, bottom: -2, near: 0.5, far: 8 });
    this.lamp = new THREE.DirectionalLight(0xffffff, 0.22 * unit);
    this.space.add(new THREE.AmbientLight(new THREE.Color().setScalar(0.56 * unit)), sun, this.lamp);
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
  local(point) { return point.clone().sub(this.scene.centre).divideScalar(this.scene.radius); }

  /** Where a point of the scene is on the canvas. */
  project(point) {
    const { x, y } = this.local(point).project(this.camera);
    return [(1 + x) / 2 * this.width, (1 - y) / 2 * this.height];
  }

  /** How many pixels a radius of the scene is in the first view: so many that all of it is seen, with its names. */
  unit() {
    const { width, height, scene } = this, size = `${width}×${height}`;
    if (this.fitted?.size === size) return this.fitted.unit;
    let unit = Math.min(width * 0.47, height * (scene.free ? 0.6 : 0.47));
    const [yaw, pitch] = scene.look, eye = vector([Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch)]);
    const right = vector([-Math.sin(yaw), Math.cos(yaw), 0]), up = eye.clone().cross(right);
    for (const [point, about] of scene.shown?.() ?? []) {
      const local = this.local(point), near = 6 / Math.max(1, 6 - local.dot(eye));
      const reach = way => Math.max((Math.abs(local.dot(way)) + about / scene.radius) * near, 1e-9);
      unit = Math.min(unit, Math.max(width / 2 - 22, 0.3 * width) / reach(right), Math.max(height / 2 - 24, 0.3 * height) / reach(up));
    }
    if (width && height) this.fitted = { size, unit };
    return unit;
  }

  draw() {
    const { camera, renderer, yaw, pitch, width, height } = this, right = vector([-Math.sin(yaw), Math.cos(yaw), 0]);
    const eye = vector([Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch)]);
    this.pixel = 1 / (this.unit() * this.zoom);
    this.halfSize.value.set(width / 2, height / 2);
    Object.assign(camera, { fov: 360 / Math.PI * Math.atan(this.pixel * height / 12), aspect: width / height, near: 0.5, far: 50 });
    camera.position.copy(eye).multiplyScalar(6); // the eye is 6 radii away
    camera.quaternion.setFromRotationMatrix(new THREE.Matrix4().makeBasis(right, eye.clone().cross(right), eye));
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    this.lamp.position.set(-0.4, 0.5, 0.8).applyQuaternion(camera.quaternion);
    const names = this.names = [];
    for (const { object, place } of this.things) object.visible = place(object) !== false;
    View.pictures++;
    if (this.webgl) renderer.setSize(this.canvas.width, this.canvas.height, false); else renderer.setSize(width, height);
    renderer.render(this.space, camera);
    if (this.webgl) return this.paint(renderer.domElement, names);
    const image = new Image();
    image.onload = () => this.paint(image, names);
    image.src = 'data:image/svg+xml,' + encodeURIComponent(new XMLSerializer().serializeToString(renderer.domElement));
  }

  /** Shows a picture, and names over it, with a rim, so that lines beneath do not cut them. */
  paint(picture, names) {
    const { pen } = this;
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.drawImage(picture, 0, 0, this.width, this.height);
    Object.assign(pen, { lineJoin: 'round', textAlign: 'center', textBaseline: 'middle', lineWidth: 3.5, strokeStyle: theme.panel });
    const placed = [];
    for (const label of names) {
      const { name, x, y, way: [right, down], colour, bold } = label;
      pen.font = `${bold ? 600 : 400} 13px system-ui, sans-serif`;
      pen.fillStyle = theme[colour];
      const half = pen.measureText(name).width / 2 + 2;
      const at = ([on, aside]) => [clamp(x + (on + half) * right - aside * down, half + 2, this.width - half - 2), clamp(y + on * down + aside * right, 9, this.height - 9)];
      const isFree = ([x, y]) => placed.every(other => Math.abs(other.x - x) > other.half + half || Math.abs(other.y - y) > 14);
      // behind its arrow's tip, or beside that place where another name is
      const [left, top] = PLACES.map(at).find(isFree) ?? at(PLACES[0]);
      placed.push(Object.assign(label, { x: left, y: top, half }));
      pen.strokeText(name, left, top);
      pen.fillText(name, left, top);
    }
  }

  /** Adds what `place` puts in its place before each picture, unless it says `false`: then it is not there. */
  add(object, place = () => true) {
    this.space.add(object);
    this.things.push({ object, place });
  }

  /** Puts something at a point of the scene; without a point it is not there. */
  put(object, at, size, attitude = object.quaternion) {
    if (at) object.position.copy(this.local(at));
    object.quaternion.copy(attitude);
    object.scale.setScalar(size);
    return Boolean(at);
  }

  /** Puts what stands along the third axis, one long, between two points, so many pixels thick. */
  span(object, [from, to], thickness) {
    const way = this.local(to).sub(object.position.copy(this.local(from))), long = way.length();
    object.quaternion.setFromUnitVectors(UNIT[2], way.normalize());
    object.scale.set(thickness * this.pixel, thickness * this.pixel, long);
    return long > 0;
  }

  /** A surface in the light. What is thin glows, so that it shows its colour from all sides. */
  surface(geometry, colour, alpha = 1, { light = 0.5, glow = 0.53 } = {}) {
    const material = new THREE.MeshLambertMaterial({ transparent: alpha < 1, opacity: alpha, depthWrite: alpha === 1 });
    Object.assign(material, { color: hue(colour, light), emissive: hue(colour, glow), polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    return Object.assign(new THREE.Mesh(geometry, material), { castShadow: alpha === 1, receiveShadow: alpha === 1 });
  }

  /** A line through points as three.js has them, with gaps where they are null; its width is in pixels. */
  stroke(points, colour, { width = 1, alpha = 1, light = 1, geometry = null } = {}) {
    if (!this.webgl) {
      const material = new THREE.LineBasicMaterial({ opacity: alpha, linewidth: width, linecap: 'butt' });
      return new THREE.LineSegments(segments(points), Object.assign(material, { color: hue(colour, light) }));
    }
    const uniforms = { half_size: this.halfSize, colour: { value: hue(colour, light) } };
    for (const [name, value] of Object.entries({ width, alpha, now: 1e9, tail: 0 })) uniforms[name] = { value };
    const line = new THREE.Mesh(geometry ?? band(points), new THREE.ShaderMaterial({
      ...STROKE, uniforms, transparent: true, depthWrite: false, side: THREE.DoubleSide,
      // each pixel is painted once, however often the line comes by
      stencilWrite: true, stencilFunc: THREE.NotEqualStencilFunc, stencilRef: ++this.strokes % 255 + 1, stencilZPass: THREE.ReplaceStencilOp,
    }));
    return Object.assign(line, { frustumCulled: false });
  }

  /** The way of a moving point, by no more points than can be drawn; what is long past is faint, what is to come fainter. */
  trace(path, run, colour, alpha) {
    const stride = Math.ceil(run.samples / (this.webgl ? 20000 : 1000)), few = path.filter((_, k) => k % stride === 0);
    const points = few.map(point => point && this.local(point)), most = Math.ceil(points.length / 6) + 2;
    const whole = this.stroke(points, colour, { alpha: 0.13 * alpha }), { attributes, index, userData: order } = whole.geometry;
    const recent = this.stroke(points, colour, { width: 2.4, alpha: 0.9 * alpha, geometry: Object.assign(new THREE.BufferGeometry(), { attributes, index }) });
    this.add(whole);
    this.add(recent, () => {
      const now = (run.moment.index + run.moment.fraction) / stride, tail = Math.min(most, now + 1);
      if (!this.webgl) return void (recent.geometry = segments(points.slice(Math.max(0, Math.round(now - tail / 2)), Math.floor(now) + 1)));
      Object.assign(recent.material.uniforms, { now: { value: now }, tail: { value: tail } });
      const [start, end] = [now + 1, now - tail].map(moment => order.filter(k => k > moment).length);
      recent.geometry.setDrawRange(6 * start, 6 * (end - start));
    });
  }

  /** An arrow and beyond its head a name; `ends` tells where it is at the moment. */
  arrow(ends, colour, width, name = '', alpha = 1) {
    const arrow = new THREE.Group(), shaft = this.surface(SHAFT, colour, alpha), head = this.surface(HEAD, colour, alpha);
    this.add(arrow.add(shaft, head), () => {
      const at = ends();
      if (!at || !this.span(arrow, at, 1)) return false;
      const { pixel } = this, long = arrow.scale.z, size = Math.min((5 + 3 * width) * pixel, long);
      arrow.scale.setScalar(1);
      shaft.scale.set(0.6 * width * pixel, 0.6 * width * pixel, long - size);
      head.scale.set(0.36 * size, 0.36 * size, size);
      head.position.z = long - size;
      if (!name) return;
      const [[x0, y0], [x, y]] = at.map(end => this.project(end)), apart = Math.hypot(x - x0, y - y0) || 1;
      const way = [(x - x0) / apart, (y - y0) / apart];
      this.names.push({ name, x: x + way[0] * 9, y: y + way[1] * 12, way, colour, bold: width > 1.5 });
    });
  }

  /** A dot so many pixels large. */
  dot(place, colour, size, alpha = 1) {
    this.add(this.surface(DISC, colour, alpha), dot => this.put(dot, place(), size * this.pixel));
  }

  /** A body's solid. */
  solid({ parts }, paint, alpha) {
    const solid = new THREE.Group();
    for (const { geometry, edges, light, colour, clear } of parts) {
      solid.add(this.surface(geometry, colour ?? paint, clear ? 0.45 * alpha : alpha, { light, glow: 0 }));
      const { array = [] } = edges?.attributes.position ?? {}, ends = k => [vector(array.slice(k, k + 3)), vector(array.slice(k + 3, k + 6)), null];
      const points = Array.from({ length: array.length / 6 }, (_, k) => ends(6 * k)).flat();
      if (points.length) solid.add(this.stroke(points, colour ?? paint, { light: 0.7, alpha: clear ? 0.5 * alpha : alpha }));
    }
    return solid;
  }

  /** The outline of a sphere about a point, and where it meets the planes across some axes. */
  sphere(radius, normals, centre = ORIGIN) {
    const attitudes = normals.map(k => new THREE.Quaternion().setFromUnitVectors(UNIT[2], UNIT[k]));
    for (const attitude of [this.camera.quaternion, ...attitudes])
      this.add(this.stroke(CIRCLE, 'muted', { alpha: 0.25 }), circle => this.put(circle, centre, radius / this.scene.radius, attitude));
  }
}
