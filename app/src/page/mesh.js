// ---- solids: parts in the solid's own axes, each { geometry, colour, clear }

const {
  AmbientLight, BoxGeometry, BufferAttribute, BufferGeometry, Color, ColorManagement, ConeGeometry, CylinderGeometry, DirectionalLight, DoubleSide,
  EdgesGeometry, Group, LatheGeometry, LineBasicMaterial, LineSegments, LinearSRGBColorSpace, Matrix4, Mesh, MeshLambertMaterial,
  NotEqualStencilFunc, PerspectiveCamera, PlaneGeometry, Quaternion, ReplaceStencilOp, Scene, ShaderMaterial, ShadowMaterial, SphereGeometry,
  SVGRenderer, toCreasedNormals, Vector2, Vector3, WebGLRenderer,
} = THREE;

const SECTORS = 48;

/** A part with sharp edges; each facet has the tone of its middle. */
function part(shape, { tone = () => 1, colour = null, clear = false } = {}) {
  const geometry = toCreasedNormals(shape, 0.6), corners = geometry.attributes.position, tones = [];
  for (let k = 0; k < corners.count; k += 3) {
    const middle = axis => corners.array[3 * k + axis] + corners.array[3 * k + 3 + axis] + corners.array[3 * k + 6 + axis];
    tones.push(...Array(9).fill(tone(middle(0), middle(1))));
  }
  return { geometry: geometry.setAttribute('color', new BufferAttribute(new Float32Array(tones), 3)), colour, clear };
}

/** A solid of revolution by its profile, [radius, height] from below; its quarters differ in tone, so that spinning is seen. */
function revolved(profile, stretch = [1, 1, 1]) {
  const lathe = new LatheGeometry(profile.map(at => new Vector2(...at)), SECTORS).rotateX(Math.PI / 2).scale(...stretch);
  return part(lathe, { tone: (x, y) => x * y < 0 ? 0.84 : 1 });
}

const BALL = Array.from({ length: 25 }, (_, k) => Math.PI * (k / 24 - 0.5)).map((angle, k) => [k % 24 ? Math.cos(angle) : 0, Math.sin(angle)]);
const cylinder = (radius, low, high) => revolved([[0, low], [radius, low], [radius, high], [0, high]]);
const capsule = (radius, half) => revolved(BALL.map(([r, z]) => [r * radius, z * radius + Math.sign(z + 1e-9) * half]));

/** Crossed arms along the first two axes, a hub, and four rotors; the arm ahead, along the first axis, is marked. */
function quadrotor(arm) {
  const arms = [[1, 0], [0, 1], [-1, 0], [0, -1]].map(([x, y]) => {
    const colour = x === 1 ? 'c0' : null, long = axis => axis ? 0.9 : 0.09;
    const beam = new BoxGeometry(long(x), long(y), 0.07).translate(0.55 * x, 0.55 * y, 0);
    const rotor = new CylinderGeometry(0.42, 0.42, 0.01, SECTORS).rotateX(Math.PI / 2).translate(x, y, 0.13);
    return [part(beam.scale(arm, arm, arm), { colour }), part(rotor.scale(arm, arm, arm), { colour, clear: true })];
  });
  return [part(new BoxGeometry(0.36 * arm, 0.36 * arm, 0.16 * arm), { tone: () => 0.84 }), ...arms.flat()];
}

/** A cone that stands on its tip: a top, with a rim and a knob to spin it by. */
const spinningTop = (height, radius) => revolved([
  [0, 0], [0.08, 0.06], [0.9, 0.62], [1, 0.68], [1, 0.74], [0.9, 0.79], [0.12, 0.86], [0.1, 0.97], [0.06, 1], [0, 1],
].map(([r, z]) => [r * radius, z * height]));

const SOLIDS = {
  box: ({ size }) => part(new BoxGeometry(...size)),
  ellipsoid: ({ semi_axes }) => revolved(BALL, semi_axes),
  sphere: ({ radius }) => revolved(BALL, [radius, radius, radius]),
  rod: ({ length, radius }) => capsule(radius, Math.max(0, length / 2 - radius)),
  disc: ({ radius, thickness }) => cylinder(radius, -thickness / 2, thickness / 2),
  cone: ({ height, radius }) => spinningTop(height, radius),
  quadrotor: ({ arm }) => quadrotor(arm),
};

/** The parts of a body's shape in the body's axes, about the shape's own centre; null if it has none. */
function meshOf(shape) {
  const solid = SOLIDS[shape?.kind]?.(shape);
  if (!solid) return null;
  const parts = [solid].flat(), [w, x, y, z] = shape.rotation ?? [1, 0, 0, 0];
  const corner = new Vector3();
  let extent = 0;
  for (const { geometry } of parts) {
    geometry.applyQuaternion(new Quaternion(x, y, z, w));
    const corners = geometry.attributes.position;
    for (let k = 0; k < corners.count; k++) extent = Math.max(extent, corner.fromBufferAttribute(corners, k).length());
  }
  return { parts, centre: shape.centre ?? ORIGIN, extent };
}
