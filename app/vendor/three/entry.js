// what the page uses of three.js
export {
  AmbientLight, Box3, BoxGeometry, BufferAttribute, BufferGeometry, Color, ColorManagement, ConeGeometry, CylinderGeometry, DirectionalLight,
  DoubleSide, EdgesGeometry, Group, LatheGeometry, LineBasicMaterial, LineSegments, LinearSRGBColorSpace, Matrix4, Mesh, MeshLambertMaterial,
  NotEqualStencilFunc, PerspectiveCamera, PlaneGeometry, Quaternion, ReplaceStencilOp, Scene, ShaderMaterial, ShadowMaterial, SphereGeometry,
  Vector2, Vector3, WebGLRenderer,
} from 'three';
export { SVGRenderer } from 'three/examples/jsm/renderers/SVGRenderer.js';
export { toCreasedNormals } from 'three/examples/jsm/utils/BufferGeometryUtils.js';
