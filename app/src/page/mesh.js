// ---- solids: facets in the solid's own axes, each { corners, tone }; a tone tells facets apart, so that spinning is seen

const SECTORS = 40;

/** A facet around a regular polygon or, with a profile [radius, height] from below, a solid of revolution; sectors differ in tone. */
function revolved(profile, stretch = [1, 1, 1]) {
  const facets = [], at = ([r, z], k) => {
    const angle = 2 * Math.PI * k / SECTORS;
    return [r * Math.cos(angle) * stretch[0], r * Math.sin(angle) * stretch[1], z * stretch[2]];
  };
  for (let row = 1; row < profile.length; row++) {
    for (let k = 0; k < SECTORS; k++) {
      const [low, high] = [profile[row - 1], profile[row]];
      const corners = [at(low, k), at(low, k + 1), at(high, k + 1), at(high, k)].filter((_, c) => (c < 2 ? low : high)[0] > 0 || c % 3 === 0);
      facets.push({ corners, tone: Math.floor(4 * k / SECTORS) % 2 });
    }
  }
  return facets;
}

const BALL = Array.from({ length: 21 }, (_, k) => Math.PI * (k / 20 - 0.5)).map((angle, k) => [k % 20 ? Math.cos(angle) : 0, Math.sin(angle)]);
const cylinder = (radius, low, high) => revolved([[0, low], [radius, low], [radius, high], [0, high]]);
const capsule = (radius, half) => revolved(BALL.map(([r, z]) => [r * radius, z * radius + Math.sign(z + 1e-9) * half]));

function box(size, centre = ORIGIN, tone = 0) {
  const facets = [];
  for (let k = 0; k < 3; k++) {
    for (const side of [-1, 1]) {
      const corner = (p, q) => {
        const way = [0, 0, 0];
        [way[k], way[(k + 1) % 3], way[(k + 2) % 3]] = [side, p * side, q];
        return way.map((w, axis) => centre[axis] + w * size[axis] / 2);
      };
      facets.push({ corners: [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)], tone, edged: true });
    }
  }
  return facets;
}

/** Crossed arms along the first two axes, a hub, and four rotors; the arm ahead, along the first axis, is marked. */
function quadrotor(arm) {
  const rotors = [[1, 0], [0, 1], [-1, 0], [0, -1]].map(([x, y]) => ({
    corners: Array.from({ length: 24 }, (_, k) => Math.PI * k / 12)
      .map(angle => [arm * (x + 0.42 * Math.cos(angle)), arm * (y + 0.42 * Math.sin(angle)), 0.13 * arm]),
    tone: x === 1 ? 'c0' : 0, clear: true,
  }));
  const beams = [0, 1].flatMap(axis => [-1, 1].flatMap(side => {
    const size = [0.09, 0.09, 0.07], centre = [0, 0, 0];
    [size[axis], centre[axis]] = [0.9, 0.55 * side];
    return box(scaled(size, arm), scaled(centre, arm), axis === 0 && side === 1 ? 'c0' : 0);
  }));
  return [...box(scaled([0.36, 0.36, 0.16], arm), ORIGIN, 1), ...beams, ...rotors];
}

/** A cone that stands on its tip: a top, with a rim and a knob to spin it by. */
const spinningTop = (height, radius) => revolved([
  [0, 0], [0.08, 0.06], [0.9, 0.62], [1, 0.68], [1, 0.74], [0.9, 0.79], [0.12, 0.86], [0.1, 0.97], [0.06, 1], [0, 1],
].map(([r, z]) => [r * radius, z * height]));

const SOLIDS = {
  box: ({ size }) => box(size),
  ellipsoid: ({ semi_axes }) => revolved(BALL, semi_axes),
  sphere: ({ radius }) => revolved(BALL, [radius, radius, radius]),
  rod: ({ length, radius }) => capsule(radius, Math.max(0, length / 2 - radius)),
  disc: ({ radius, thickness }) => cylinder(radius, -thickness / 2, thickness / 2),
  cone: ({ height, radius }) => spinningTop(height, radius),
  quadrotor: ({ arm }) => quadrotor(arm),
};

/** The facets of a body's shape in the body's axes, about the shape's own centre, with outward normals; null if it has none. */
function meshOf(shape) {
  const facets = SOLIDS[shape?.kind]?.(shape);
  if (!facets) return null;
  for (const facet of facets) {
    if (shape.rotation) facet.corners = facet.corners.map(corner => turned(shape.rotation, corner));
    const [a, b, c] = facet.corners, normal = cross(sum(b, scaled(a, -1)), sum(c, scaled(a, -1)));
    facet.normal = scaled(normal, 1 / (length(normal) || 1));
  }
  return { facets, centre: shape.centre ?? ORIGIN, extent: Math.max(...facets.flatMap(facet => facet.corners.map(length))) };
}
