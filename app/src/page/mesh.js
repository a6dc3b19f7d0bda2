// ---- solids: parts in the solid's own axes, each { geometry, edges, light, colour, clear }

/** A part with sharp edges. */
const part = (shape, look) => ({ geometry: THREE.toCreasedNormals(shape, 0.6), edges: new THREE.EdgesGeometry(shape, 30), light: 1, ...look });

/** A solid of revolution by its profile, [radius, height] from below; its quarters differ in light, so that spinning is seen. */
function revolved(profile, stretch = [1, 1, 1]) {
  const points = profile.map(at => new THREE.Vector2(...at));
  const lathe = (sectors, ...turn) => new THREE.LatheGeometry(points, sectors, ...turn).rotateX(Math.PI / 2).scale(...stretch);
  const edges = k => k ? null : new THREE.EdgesGeometry(lathe(64), 30);
  return [0, 1, 2, 3].map(k => part(lathe(16, k * Math.PI / 2, Math.PI / 2), { light: k % 2 ? 0.84 : 1, edges: edges(k) }));
}

const BALL = Array.from({ length: 29 }, (_, k) => Math.PI * (k / 28 - 0.5)).map((angle, k) => [k % 28 ? Math.cos(angle) : 0, Math.sin(angle)]);

/** Crossed arms along the first two axes, a hub, and four rotors; the arm ahead, along the first axis, is marked. */
function quadrotor(arm) {
  const arms = [[1, 0], [0, 1], [-1, 0], [0, -1]].flatMap(([x, y]) => {
    const beam = new THREE.BoxGeometry(x ? 0.9 : 0.09, y ? 0.9 : 0.09, 0.07).translate(0.55 * x, 0.55 * y, 0);
    const rotor = new THREE.CylinderGeometry(0.42, 0.42, 0.01, 48).rotateX(Math.PI / 2).translate(x, y, 0.13);
    return [beam, rotor].map(shape => part(shape.scale(arm, arm, arm), { colour: x === 1 ? 'c0' : null, clear: shape === rotor }));
  });
  return [part(new THREE.BoxGeometry(0.36 * arm, 0.36 * arm, 0.16 * arm), { light: 0.84 }), ...arms];
}

/** A cone that stands on its tip: a top, with a rim and a knob to spin it by. */
const spinningTop = (height, radius) => revolved([
  [0, 0], [0.08, 0.06], [0.9, 0.62], [1, 0.68], [1, 0.74], [0.9, 0.79], [0.12, 0.86], [0.1, 0.97], [0.06, 1], [0, 1],
].map(([r, z]) => [r * radius, z * height]));

const SOLIDS = {
  box: ({ size }) => [part(new THREE.BoxGeometry(...size, 6, 6, 6))], // an SVG's facets are sorted: they are to be small
  ellipsoid: ({ semi_axes }) => revolved(BALL, semi_axes),
  sphere: ({ radius }) => revolved(BALL, [radius, radius, radius]),
  rod: ({ length, radius }) => revolved(BALL.map(([r, z]) => [r * radius, z * radius + Math.sign(z + 1e-9) * Math.max(0, length / 2 - radius)])),
  disc: ({ radius, thickness: t }) => revolved([[0, -t / 2], [radius, -t / 2], [radius, t / 2], [0, t / 2]]),
  cone: ({ height, radius }) => spinningTop(height, radius),
  quadrotor: ({ arm }) => quadrotor(arm),
};

/** The parts of a body's shape about the shape's own centre, and how that stands in the body's axes; null if it has none. */
function meshOf(shape) {
  const parts = SOLIDS[shape?.kind]?.(shape);
  if (!parts) return null;
  const far = ({ geometry: { attributes: { position } } }) => Array.from({ length: position.count }, (_, k) => Math.hypot(...position.array.slice(3 * k, 3 * k + 3)));
  return { parts, centre: vector(shape.centre ?? [0, 0, 0]), rotation: rotation(shape.rotation ?? [1, 0, 0, 0]), extent: Math.max(...parts.flatMap(far)) };
}
