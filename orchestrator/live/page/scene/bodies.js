// The agents as what they are: a few instanced meshes for all bodies of a kind, a shadow on the ground under each, and
// a dot of constant size for those that are too small on the screen to be seen.
import {BoxGeometry, BufferAttribute, BufferGeometry, CircleBufferGeometry, Color, ConeGeometry, CylinderGeometry, DynamicDrawUsage, Geometry, Group, InstancedBufferAttribute, InstancedMesh, Matrix4, MeshBasicMaterial, MeshLambertMaterial, Points, Quaternion, ShaderMaterial, SphereGeometry, TorusGeometry, Vector3, VertexColors} from "/vendor/three/build/three.module.js";

import {agentColours, rgb, styleColour} from "../colours.js";

const DOT_PX = 9, CROWDED_DOT_PX = 6;
const CROWD = 100;     // more agents than this have coarser shapes
const LEAST_PX = 2.5;  // of a body's radius: smaller ones are dots only

// --- shapes: x forward, y left, z up -----------------------------------------------------------------------

function merged(parts) {
  const whole = new Geometry();
  for (const {shape, at = [0, 0, 0], turn = [0, 0, 0]} of parts) {
    shape.rotateX(turn[0]).rotateY(turn[1]).rotateZ(turn[2]).translate(...at);
    whole.merge(shape);
  }
  return new BufferGeometry().fromGeometry(whole);
}

const upright = [Math.PI / 2, 0, 0];
const ROTORS = [[1, 0], [0, 1], [-1, 0], [0, -1]];

/** Shapes of a kind: those in the agent's colour, those in a neutral one, and the factors from the agent's numbers. */
const KINDS = {
  airframe: {
    // arms are of length 1, the hull is 1 high
    tinted: (fine) => merged([
      {shape: new CylinderGeometry(0.34, 0.42, 0.9, fine ? 20 : 7), turn: upright},
      {shape: new ConeGeometry(0.15, 0.5, 3), at: [0.55, 0, 0.25], turn: [0, 0, -Math.PI / 2]},
      ...ROTORS.map(
          ([x, y]) => ({shape: new TorusGeometry(0.46, 0.045, fine ? 5 : 3, fine ? 24 : 8), at: [x, y, 0.45]}))
    ]),
    neutral: (fine) => merged([
      {shape: new BoxGeometry(2, 0.1, 0.25)}, {shape: new BoxGeometry(0.1, 2, 0.25)},
      ...(fine ? ROTORS : [])
          .map(([x, y]) => ({shape: new CylinderGeometry(0.09, 0.09, 0.7, 8), at: [x, y, 0.2], turn: upright}))
    ]),
    scale: ({arm_m, size_m}) => [arm_m, arm_m, size_m[2]],
  },
  roller: {
    // diameter 1, 0.4 high
    tinted: (fine) => merged([
      {shape: new CylinderGeometry(0.5, 0.5, 0.3, fine ? 24 : 9), turn: upright},
      {shape: new ConeGeometry(0.34, 0.7, 3), at: [0.55, 0, 0.05], turn: [0, 0, -Math.PI / 2]}
    ]),
    neutral: (fine) => merged(
        [0.5, -0.5].map((y) => ({shape: new CylinderGeometry(0.3, 0.3, 0.12, fine ? 16 : 7), at: [0, y, -0.1]}))),
    scale: ({size_m}) => size_m,
  },
  ball: {
    tinted: (fine) => merged([{shape: new SphereGeometry(0.5, fine ? 20 : 9, fine ? 14 : 6)}]),
    neutral: null,
    scale: ({size_m}) => size_m,
  },
};
const kindOf = ({arm_m, rolls}) => (arm_m > 0 ? KINDS.airframe : rolls ? KINDS.roller : KINDS.ball);

// --- one mesh of many --------------------------------------------------------------------------------------

function manyOf(geometry, material, count, order = 0) {
  const mesh = new InstancedMesh(geometry, material, count);
  mesh.instanceMatrix.setUsage(DynamicDrawUsage);
  return Object.assign(mesh, {frustumCulled: false, renderOrder: order});
}

function tintedMesh(geometry, colours) {
  geometry.setAttribute("color", new InstancedBufferAttribute(new Float32Array(colours.flatMap(rgb)), 3));
  return manyOf(geometry, new MeshLambertMaterial({vertexColors: VertexColors}), colours.length);
}

function dots(count) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(3 * count), 3).setUsage(DynamicDrawUsage));
  geometry.setAttribute("tint", new BufferAttribute(new Float32Array(3 * count), 3));
  geometry.setAttribute("radius", new BufferAttribute(new Float32Array(count), 1));
  const material = new ShaderMaterial({
    transparent: true,
    depthWrite: false,
    depthTest: false,
    uniforms: {
      dot: {value: count > CROWD ? CROWDED_DOT_PX : DOT_PX},
      ratio: {value: 1},
      height: {value: 1},
      rim: {value: new Color()}
    },
    vertexShader: `
      attribute vec3 tint; attribute float radius;
      uniform float dot, ratio, height;
      varying vec3 vTint; varying float vAlpha;
      void main() {
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        float body_px = radius * projectionMatrix[1][1] * height / gl_Position.w;
        vTint = tint;
        vAlpha = 1.0 - smoothstep(0.8, 1.8, body_px / dot);
        gl_PointSize = (dot + 3.0) * ratio;
      }`,
    fragmentShader: `
      precision highp float;
      uniform float dot; uniform vec3 rim;
      varying vec3 vTint; varying float vAlpha;
      void main() {
        float away = length(gl_PointCoord - 0.5) * (dot + 3.0);
        float cover = clamp(0.5 * dot + 1.5 - away, 0.0, 1.0), inside = clamp(0.5 * dot + 0.3 - away, 0.0, 1.0);
        if (cover * vAlpha < 0.01) discard;
        gl_FragColor = vec4(mix(rim, vTint, inside), cover * vAlpha);
      }`,
  });
  return Object.assign(new Points(geometry, material), {frustumCulled: false, renderOrder: 4});
}

// --- the layer ---------------------------------------------------------------------------------------------

export class Bodies extends Group {
  #groups;  // of each kind: indices of its agents, meshes, scales
  #shadows;
  #dots;
  #neutral = new MeshLambertMaterial();
  #lost = [];  // numbers of agents, which are grey
  #shade = new MeshBasicMaterial({transparent: true, opacity: 0.12, depthWrite: false});

  constructor(agents) {
    super();
    const colours = agentColours(agents.length), fine = agents.length <= CROWD;
    const kinds = new Map();
    agents.forEach((agent, index) => {
      const kind = kindOf(agent);
      kinds.set(kind, [...(kinds.get(kind) ?? []), index]);
    });
    this.#groups = [...kinds].map(([kind, indices]) => ({
                                    indices,
                                    scales: indices.map((index) => new Vector3(...kind.scale(agents[index]))),
                                    tinted: tintedMesh(kind.tinted(fine), indices.map((index) => colours[index])),
                                    neutral: kind.neutral && manyOf(kind.neutral(fine), this.#neutral, indices.length),
                                  }));
    this.#shadows = manyOf(new CircleBufferGeometry(0.5, 20), this.#shade, agents.length, -1);
    this.#dots = dots(agents.length);
    for (const {tinted, neutral} of this.#groups) this.add(tinted, ...(neutral ? [neutral] : []));
    this.add(this.#shadows, this.#dots);
    this.radii_m = agents.map(({size_m, arm_m}) => Math.max(arm_m * 1.4, size_m[0] / 2));
    this.radius_m = Math.max(...this.radii_m);
    this.#dots.geometry.attributes.radius.copyArray(this.radii_m);
    this.paint();
  }

  /** Takes the numbers of the agents that are lost. */
  setLost(lost) {
    if (lost.join() === this.#lost.join()) return;
    this.#lost = lost;
    this.paint();
  }

  paint() {
    const colours = agentColours(this.radii_m.length).map(rgb);
    for (const number of this.#lost) colours[number - 1] = rgb(styleColour("lost-body"));
    for (const {indices, tinted} of this.#groups) {
      tinted.geometry.attributes.color.copyArray(indices.flatMap((index) => colours[index]));
      tinted.geometry.attributes.color.needsUpdate = true;
    }
    this.#dots.geometry.attributes.tint.copyArray(colours.flat());
    this.#dots.geometry.attributes.tint.needsUpdate = true;
    this.#dots.material.uniforms.rim.value.set(styleColour("stage"));
    this.#neutral.color.set(styleColour("frame"));
    this.#shade.color.set(styleColour("shade"));
  }

  setViewport(height, ratio) {
    Object.assign(this.#dots.material.uniforms, {height: {value: height}, ratio: {value: ratio}});
  }

  /** `px_per_m`: at the point that the camera looks at. */
  setScale(px_per_m) {
    const isSeen = this.radius_m * px_per_m > LEAST_PX;
    for (const {tinted, neutral} of this.#groups)
      for (const mesh of [tinted, neutral])
        if (mesh) mesh.visible = isSeen;
  }

  update({p, q}) {
    for (const {indices, scales, tinted, neutral} of this.#groups) {
      indices.forEach((index, k) => {
        place.fromArray(p, 3 * index);
        turn.set(q[4 * index + 1], q[4 * index + 2], q[4 * index + 3], q[4 * index]);
        matrix.compose(place, turn, scales[k]);
        matrix.toArray(tinted.instanceMatrix.array, 16 * k);
      });
      tinted.instanceMatrix.needsUpdate = true;
      if (!neutral) continue;
      neutral.instanceMatrix.array.set(tinted.instanceMatrix.array);
      neutral.instanceMatrix.needsUpdate = true;
    }
    this.#updateShadows(p);
    this.#dots.geometry.attributes.position.copyArray(p);
    this.#dots.geometry.attributes.position.needsUpdate = true;
  }

  #updateShadows(p) {
    this.radii_m.forEach((radius, index) => {
      matrix.makeScale(2 * radius, 2 * radius, 1).setPosition(p[3 * index], p[3 * index + 1], 0.004);
      matrix.toArray(this.#shadows.instanceMatrix.array, 16 * index);
    });
    this.#shadows.instanceMatrix.needsUpdate = true;
  }

  dispose() { this.traverse((part) => part.geometry?.dispose()); }
}

const matrix = new Matrix4(), place = new Vector3(), turn = new Quaternion();
